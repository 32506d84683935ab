//! `pullout plugin build`: a UMAT's sources, in Fortran, C or C++, to a library that this program (and any host) loads.
//!
//! Each source is compiled by gfortran, gcc or g++ as its suffix says, with the flags that codes of this kind need, and
//! an `ABA_PARAM.INC` of our own. The linker then says, by name, what the library would not find at run time: the
//! utility routines of ABAQUS that this program offers are known to it.

mod includes;
mod source;
mod symbols;
#[cfg(test)]
mod test;

pub use source::Form;

use source::{Language, Source};
use std::ffi::OsString;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use symbols::Symbols;
use umat_abi::host::{UnavailableUtilities, library_file_name, utilities_path};

/// What is to be built.
#[derive(Clone, Debug)]
pub struct Request {
    /// Sources; `.o` files are linked as they are.
    pub sources: Vec<PathBuf>,
    /// The library; `None`: `lib<first source>.so` in the present folder.
    pub output: Option<PathBuf>,
    /// Form of all Fortran sources; `None`: as each suffix says.
    pub form: Option<Form>,
    /// Further flags for every compiler.
    pub flags: Vec<String>,
}

/// A library that was built.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Built {
    /// The file.
    pub library: PathBuf,
    /// The entry points that it exports: `umat_`, `uinter_`, …
    pub entry_points: Vec<String>,
}

/// Why there is no library.
#[derive(Debug)]
pub enum Refusal {
    /// A source that is no file, or of no known language.
    Source {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// A compiler is not installed.
    NoCompiler {
        /// Its program.
        program: &'static str,
        /// What it is needed for.
        file: PathBuf,
    },
    /// A compiler or the linker refused.
    Compilation {
        /// The program.
        program: &'static str,
        /// What it was to make: a source, or the library.
        file: PathBuf,
        /// Its own words.
        output: String,
        /// What may help.
        hint: String,
    },
    /// The library would find these neither in itself nor in this program.
    Undefined {
        /// The library.
        library: PathBuf,
        /// Names of the symbols.
        symbols: Vec<String>,
    },
    /// It has no entry point.
    NoEntryPoint {
        /// The library.
        library: PathBuf,
        /// What it has instead.
        hint: String,
    },
    /// The library of the utility routines is missing.
    Utilities(UnavailableUtilities),
    /// A file could not be read or written.
    File(io::Error),
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Self::File(error)
    }
}

impl Refusal {
    /// Whether the request itself was wrong, and nothing was run.
    pub fn is_bad_input(&self) -> bool {
        matches!(self, Self::Source { .. })
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Source { file, message } => write!(f, "{}: {message}", file.display()),
            Self::NoCompiler { program, file } => write!(
                f,
                "{}: {program} is needed for it and is not installed (on Debian: apt install {program})",
                file.display()
            ),
            Self::Compilation { program, file, output, hint } => {
                write!(f, "{}\n{}: {program} could not make it{hint}", output.trim_end(), file.display())
            }
            Self::Undefined { library, symbols } => write!(
                f,
                "{}: not built: undefined {}: {}; add the source or the library that defines {} (of the utility \
                 routines of ABAQUS this program offers ROTSIG, SINV, SPRINC, SPRIND, XIT, STDB_ABQERR, GETOUTDIR, \
                 GETJOBNAME, GETVRM, GETRANK, GETNUMCPUS, GETPARTINFO, MutexInit, MutexLock, MutexUnlock)",
                library.display(),
                if symbols.len() == 1 { "symbol" } else { "symbols" },
                symbols.join(", "),
                if symbols.len() == 1 { "it" } else { "them" },
            ),
            Self::NoEntryPoint { library, hint } => {
                write!(f, "{}: not built: it has none of the symbols umat_, uinter_, fric_{hint}", library.display())
            }
            Self::Utilities(unavailable) => unavailable.fmt(f),
            Self::File(error) => error.fmt(f),
        }
    }
}

/// Builds a library.
///
/// # Errors
/// [`Refusal`]; then an older library of that name stays as it is.
pub fn build(request: &Request) -> Result<Built, Refusal> {
    let sources = request.sources.iter().map(|file| Source::new(file, request.form)).collect::<Result<Vec<_>, _>>()?;
    let output = request.output.clone().unwrap_or_else(|| default_output(&request.sources));
    let utilities = utilities_path().map_err(Refusal::Utilities)?;
    let folder = tempfile::tempdir()?;
    includes::write(folder.path(), &sources)?;
    let mut objects = Vec::new();
    for (number, source) in sources.iter().enumerate() {
        objects.push(compile(source, number, folder.path(), &request.flags)?);
    }
    let linker = linker(&sources);
    // What no one defines: the utility routines are at hand for this question, but are not linked in.
    let trial = folder.path().join("trial.so");
    let mut question = linker.command(&objects, &trial, &request.flags);
    question.arg("-Wl,--no-undefined").arg(&utilities);
    let (answered, words) = run(linker.program, &output, &mut question)?;
    if !answered {
        let symbols = symbols::undefined(&words);
        if !symbols.is_empty() {
            return Err(Refusal::Undefined { library: output, symbols });
        }
        return Err(linker.refusal(output, words));
    }
    let made = folder.path().join("made.so");
    let (linked, words) = run(linker.program, &output, &mut linker.command(&objects, &made, &request.flags))?;
    if !linked {
        return Err(linker.refusal(output, words));
    }
    let symbols = Symbols::read(&made)?;
    let entry_points = symbols.entry_points();
    if !symbols.has_law(&output) {
        return Err(Refusal::NoEntryPoint { hint: symbols.hint(), library: output });
    }
    std::fs::copy(&made, &output)
        .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", output.display())))?;
    Ok(Built { library: output, entry_points })
}

fn default_output(sources: &[PathBuf]) -> PathBuf {
    let stem = sources.first().and_then(|file| file.file_stem()).unwrap_or_default();
    library_file_name(&stem.to_string_lossy()).into()
}

/// Compiles one source; an object file is taken as it is.
fn compile(source: &Source, number: usize, folder: &Path, flags: &[String]) -> Result<PathBuf, Refusal> {
    let Some(program) = source.language.compiler() else { return Ok(source.file.clone()) };
    let object = folder.join(format!("{number}.o"));
    let mut command = Command::new(program);
    command.args(["-c", "-fPIC", "-O2", "-g"]).args(source.language.flags());
    // modules that one source defines and a later one uses
    command.arg("-I").arg(folder);
    if let Language::Fortran(_) = source.language {
        command.arg("-J").arg(folder);
    }
    if let Some(own) = source.file.parent().filter(|own| !own.as_os_str().is_empty()) {
        command.arg("-I").arg(own);
    }
    command.args(flags).arg("-o").arg(&object).arg(absolute(&source.file));
    let (done, output) = run(program, &source.file, &mut command)?;
    if done {
        return Ok(object);
    }
    let hint = match source.language {
        Language::Fortran(Form::Fixed) => "; it was read in fixed form: --free if it is in free form",
        Language::Fortran(Form::Free) => "; it was read in free form: --fixed if it is in fixed form",
        _ => "",
    };
    Err(Refusal::Compilation { program, file: source.file.clone(), output, hint: hint.into() })
}

/// A path that no compiler takes for an option.
fn absolute(file: &Path) -> PathBuf {
    std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf())
}

/// Runs a compiler; whether it succeeded, and its words.
fn run(program: &'static str, file: &Path, command: &mut Command) -> Result<(bool, String), Refusal> {
    // Names in messages are looked for: no translations.
    let output = command.env("LC_ALL", "C").output().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => Refusal::NoCompiler { program, file: file.to_path_buf() },
        _ => Refusal::File(error),
    })?;
    Ok((output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned()))
}

/// The compiler that links, and the libraries of the other languages.
struct Linker {
    program: &'static str,
    libraries: &'static [&'static str],
}

fn linker(sources: &[Source]) -> Linker {
    let any = |wanted: fn(&Language) -> bool| sources.iter().any(|source| wanted(&source.language));
    let cpp = any(|language| *language == Language::Cpp);
    // An object file may come from any compiler; Fortran is what UMATs are written in.
    if any(|language| matches!(language, Language::Fortran(_) | Language::Object)) {
        return Linker { program: "gfortran", libraries: if cpp { &["-lstdc++", "-lm"] } else { &["-lm"] } };
    }
    Linker { program: if cpp { "g++" } else { "gcc" }, libraries: &["-lm"] }
}

impl Linker {
    fn command(&self, objects: &[PathBuf], library: &Path, flags: &[String]) -> Command {
        let mut command = Command::new(self.program);
        // A call of a routine of the library's own stays in it, also under hosts that load all symbols globally.
        command.args(["-shared", "-Wl,-Bsymbolic", "-o"]).arg(library);
        command.args(objects.iter().map(|object| absolute(object))).args(flags);
        command.args(self.libraries.iter().map(OsString::from));
        command
    }

    fn refusal(&self, library: PathBuf, output: String) -> Refusal {
        Refusal::Compilation { program: self.program, file: library, output, hint: String::new() }
    }
}
