//! `pullout plugin build`: a UMAT's sources, in Fortran, C or C++, to a library that this program (and any host) loads.
//!
//! Each source is compiled by gfortran, gcc or g++ as its suffix says, with the flags that codes of this kind need, and
//! an `ABA_PARAM.INC` and other includes of our own; what defines a module before what uses it. The linker then says, by
//! name, what the library would not find at run time: the utility routines of ABAQUS that this program offers are known
//! to it, and others of them get a routine that ends the run if it is reached.

mod includes;
mod kept;
mod lapack;
mod scan;
mod source;
mod stubs;
mod symbols;
#[cfg(test)]
mod test;

pub use kept::{inputs, kept};
pub use source::Form;

use object::{Object, ObjectKind};
use pullout_run::input::{self, Input};
use scan::Scan;
use source::{Language, PluginSource};
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use symbols::Symbols;
use umat_abi::host::{library_file_name, real_path, utilities_path};

/// The C part of a library built with `--debug`. It holds a mark, on which the host traps invalid operations, divisions by zero
/// and overflow during calls, and a handler that prints the source lines of a fatal signal.
/// (Fortran's own handlers and `-ffpe-trap` work in Fortran main programs only.)
const DEBUG: &str = include_str!("debug.c");

/// Sources to build, and the library to make of them.
#[derive(Clone, Debug)]
pub struct BuildRequest {
    /// Sources; `.o` files are linked as they are.
    pub sources: Vec<PathBuf>,
    /// The library; `None`: `lib<first source>.so` in the current folder.
    pub output: Option<PathBuf>,
    /// Form of all Fortran sources; `None`: according to each suffix.
    pub form: Option<Form>,
    /// Further flags for every compiler.
    pub flags: Vec<String>,
    /// Whether to enable run-time checks and source lines in error messages.
    pub debug: bool,
}

/// A library that was built.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Built {
    /// The file.
    pub library: PathBuf,
    /// The entry points that it exports: `umat_`, `uinter_`, …
    pub entry_points: Vec<String>,
    /// Names of ABAQUS utility routines that it calls and pullout does not offer.
    pub not_offered: Vec<String>,
    /// Names of its routines that ABAQUS calls and this program does not: UEL, HETVAL, …
    pub not_called: Vec<String>,
    /// What was done that nobody asked for: another form, a further library.
    pub remarks: Vec<String>,
}

impl Built {
    /// Returns what is to be said of it: what was done unasked, and what the library has or calls that this program has not.
    pub fn words(&self) -> Vec<String> {
        let library = self.library.display();
        let offered = self.not_offered.iter().map(|routine| {
            format!(
                "{library}: {routine} is a utility routine of ABAQUS that this program does not offer: a run that reaches a call \
                 of it ends there and says so"
            )
        });
        let called = self.not_called.iter().map(|routine| {
            format!("{library}: its {routine} is not called by this program: what the law expects of it is missing")
        });
        self.remarks.iter().cloned().chain(offered).chain(called).collect()
    }
}

/// Reason why there is no library.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// A source that is no file, or of no known language; an output that must not be overwritten: nothing was run.
    #[error("{}: {message}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Problem with it.
        message: String,
    },
    /// A compiler is not installed.
    #[error("{}: {program} is needed for it and is not installed (on Debian: apt install {program})", file.display())]
    NoCompiler {
        /// Program.
        program: &'static str,
        /// File that it is needed for.
        file: PathBuf,
    },
    /// A compiler that refuses, a library that would not work.
    #[error("{0}")]
    Failed(String),
    /// A file could not be read or written.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// A compiler or the linker could not make something of `file`; `output`: its own words, `hint`: advice that may help.
fn refused(program: &str, file: &Path, output: &str, hint: &str) -> Refusal {
    Refusal::Failed(format!("{}\n{}: {program} could not make it{hint}", output.trim_end(), file.display()))
}

/// Builds a library.
///
/// # Errors
/// [`Refusal`]; then an older library of that name stays as it is.
pub fn build(request: &BuildRequest) -> Result<Built, Refusal> {
    let sources =
        request.sources.iter().map(|file| PluginSource::new(file, request.form)).collect::<Result<Vec<_>, _>>()?;
    let output = request.output.clone().unwrap_or_else(|| default_output(&request.sources));
    may_be_written(&output, &sources)?;
    let utilities = utilities_path().map_err(Refusal::Failed)?;
    let folder = tempfile::tempdir()?;
    let scans: Vec<_> = sources.iter().map(Scan::of).collect();
    includes::write(folder.path(), &scans)?;
    let order = scan::order(&scans).map_err(|circle| {
        let names: Vec<_> = circle.iter().map(|&k| sources[k].file.display().to_string()).collect();
        let message = format!("cannot be ordered: modules in {} USE each other", names.join(", "));
        Refusal::File { file: sources[circle[0]].file.clone(), message }
    })?;
    let (mut objects, mut remarks) = (Vec::new(), Vec::new());
    for number in order {
        let (source, scan) = (&sources[number], &scans[number]);
        objects.push(compile_in_either_form(source, scan, number, folder.path(), request, &mut remarks)?);
    }
    let mut linker = linker(&sources);
    let not_offered = undefined(&mut linker, &objects, &utilities, &output, folder.path(), &request.flags)?;
    if let Some(symbol) = &linker.of_lapack {
        remarks.push(format!("{}: linked with {}, for {symbol}", output.display(), lapack::FLAGS.join(" ")));
    }
    if !not_offered.is_empty() {
        objects.push(compile_own("stubs.c", &stubs::source(&not_offered), folder.path())?);
    }
    if request.debug {
        objects.push(compile_own("debug.c", DEBUG, folder.path())?);
    }
    let made = folder.path().join("made.so");
    let (linked, words) = run(linker.program, &output, &mut linker.command(&objects, &made, &request.flags))?;
    if !linked {
        return Err(refused(linker.program, &output, &words, ""));
    }
    let symbols = Symbols::read(&made)?;
    let entry_points = symbols.entry_points();
    if !symbols.has_law(&output) {
        let none = "not built: it has none of the symbols umat_, uinter_, fric_";
        return Err(Refusal::Failed(format!("{}: {none}{}", output.display(), symbols.hint())));
    }
    put(&made, &output).map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", output.display())))?;
    let not_offered = not_offered.iter().map(|symbol| stubs::name(symbol)).collect();
    Ok(Built { library: output, entry_points, not_offered, not_called: symbols.not_called(), remarks })
}

/// Returns whether a library defines a symbol; it is not loaded.
///
/// # Errors
/// The file cannot be read, or is no whole library.
pub fn defines(library: &Path, symbol: &str) -> io::Result<bool> {
    Ok(Symbols::read(library)?.defines(symbol))
}

/// Only a shared library is overwritten: never a source, nor anything else of the user's.
fn may_be_written(output: &Path, sources: &[PluginSource]) -> Result<(), Refusal> {
    let refusal = |message: &str| Err(Refusal::File { file: output.to_path_buf(), message: message.into() });
    if output.parent().is_some_and(|folder| !folder.as_os_str().is_empty() && !folder.is_dir()) {
        return refusal("the folder is not there");
    }
    let Ok(place) = output.canonicalize() else { return Ok(()) };
    if sources.iter().any(|source| source.file.canonicalize().is_ok_and(|file| file == place)) {
        return refusal("is one of the sources and would be overwritten; -o names the library");
    }
    let content = if place.is_file() { input::read(&place, Input::Library)? } else { Vec::new() };
    let is_library = object::File::parse(&*content).is_ok_and(|file| {
        // an executable may be laid out as a library, but names the loader that runs it
        file.kind() == ObjectKind::Dynamic && file.section_by_name(".interp").is_none()
    });
    if is_library { Ok(()) } else { refusal("is there and is no shared library; it is not overwritten") }
}

/// Puts a library in its place at once: a process that has the old one loaded keeps it.
fn put(made: &Path, output: &Path) -> io::Result<()> {
    let output = real_path(output);
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let temporary = tempfile::Builder::new().prefix(".pullout-build-").tempfile_in(folder)?;
    std::fs::copy(made, &temporary)?;
    temporary.persist(output).map_err(|error| error.error).map(drop)
}

/// Returns what the objects call and no one defines: the utility routines are at hand for this question, but are not linked in.
///
/// # Errors
/// There is anything but further routines of ABAQUS.
fn undefined(
    linker: &mut Linker,
    objects: &[PathBuf],
    utilities: &Path,
    output: &Path,
    folder: &Path,
    flags: &[String],
) -> Result<Vec<String>, Refusal> {
    let mut question = linker.command(objects, &folder.join("trial.so"), flags);
    question.arg("-Wl,--no-undefined").arg(utilities);
    let (answered, words) = run(linker.program, output, &mut question)?;
    if answered {
        return Ok(Vec::new());
    }
    let symbols = symbols::undefined(&words);
    if symbols.is_empty() {
        return Err(refused(linker.program, output, &words, ""));
    }
    let (known, unknown): (Vec<_>, Vec<_>) = symbols.into_iter().partition(|symbol| stubs::is_utility(symbol));
    if unknown.is_empty() {
        return Ok(known);
    }
    let of_lapack = unknown.iter().find(|symbol| lapack::has(symbol)).cloned();
    if of_lapack.is_some() && linker.of_lapack.is_none() {
        // ABAQUS brings it along
        linker.of_lapack.clone_from(&of_lapack);
        let again = undefined(linker, objects, utilities, output, folder, flags);
        if again.is_ok() || lapack::is_installed(linker.program) {
            return again;
        }
        linker.of_lapack = None;
    }
    let hint = match of_lapack {
        Some(symbol) => format!("; {symbol} is a routine of LAPACK: {}", lapack::ADVICE),
        None => String::new(),
    };
    let offered = Symbols::read(utilities)?.routines();
    let (what, them) = if unknown.len() == 1 { ("symbol", "it") } else { ("symbols", "them") };
    Err(Refusal::Failed(format!(
        "{}: not built: undefined {what}: {}; add the source or the library that defines {them}{hint} (of the \
         utility routines of ABAQUS this program offers {})",
        output.display(),
        unknown.join(", "),
        offered.join(", "),
    )))
}

fn default_output(sources: &[PathBuf]) -> PathBuf {
    let stem = sources.first().and_then(|file| file.file_stem()).unwrap_or_default();
    library_file_name(&stem.to_string_lossy()).into()
}

/// Largest number of compiler errors that are printed.
const MOST_ERRORS: usize = 12;

/// Compiles one source, in the other form of Fortran if that of its suffix is not it.
fn compile_in_either_form(
    source: &PluginSource,
    scan: &Scan,
    number: usize,
    folder: &Path,
    request: &BuildRequest,
    remarks: &mut Vec<String>,
) -> Result<PathBuf, Refusal> {
    let first = match compile(source, scan, number, folder, request)? {
        Ok(object) => return Ok(object),
        Err(output) => output,
    };
    let mut words = (source, first);
    let other = source.in_other_form();
    if let Some(other) = &other {
        let scan = Scan::of(other);
        includes::write(folder, std::slice::from_ref(&scan))?;
        match compile(other, &scan, number, folder, request)? {
            Ok(object) => {
                remarks.push(format!(
                    "{}: read in {} form, not its suffix's",
                    source.file.display(),
                    other.form_in_words()
                ));
                return Ok(object);
            }
            // the form with fewer errors is likelier the right one
            Err(output) if errors_in(&output) < errors_in(&words.1) => words = (other, output),
            Err(_) => {}
        }
    }
    let (read, output) = words;
    let hint = match (read.form_in_words(), &other) {
        ("", _) => String::new(),
        (form, Some(_)) => format!("; it was tried in both forms, and these are the errors in {form} form"),
        (form, None) => format!("; it was read in {form} form, as is said: --free and --fixed say otherwise"),
    };
    let program = source.language.compiler().unwrap_or_default();
    Err(refused(program, &source.file, &shortened(&output), &hint))
}

fn errors_in(output: &str) -> usize {
    output.lines().filter(|line| is_error(line)).count()
}

fn is_error(line: &str) -> bool {
    line.starts_with("Error:") || line.starts_with("Fatal Error:") || line.contains(": error:")
}

/// The first errors of a compiler.
fn shortened(output: &str) -> String {
    let errors = errors_in(output);
    if errors <= MOST_ERRORS {
        return output.to_owned();
    }
    let mut left = MOST_ERRORS;
    let mut text: String = output
        .lines()
        .take_while(|line| {
            let is_wanted = left > 0;
            left -= usize::from(is_wanted && is_error(line));
            is_wanted
        })
        .flat_map(|line| [line, "\n"])
        .collect();
    text += &format!("... and {} errors more", errors - MOST_ERRORS);
    text
}

/// Compiles one source; an object file is taken as it is. Within: what the compiler says if it refuses.
fn compile(
    source: &PluginSource,
    scan: &Scan,
    number: usize,
    folder: &Path,
    request: &BuildRequest,
) -> Result<Result<PathBuf, String>, Refusal> {
    let Some(program) = source.language.compiler() else { return Ok(Ok(source.file.clone())) };
    let object = folder.join(format!("{number}.o"));
    let mut command = Command::new(program);
    command.args(["-c", "-fPIC"]).args(source.language.flags());
    command.args(if request.debug { source.language.debug_flags() } else { &["-O2", "-g"] });
    command.args(Some(source::STRUCTURES).filter(|_| scan.has_structures));
    // modules that one source defines and a later one uses
    command.arg("-I").arg(folder);
    if let Language::Fortran(_) = source.language {
        command.arg("-J").arg(folder);
    }
    let own = source.file.parent().into_iter().chain(scan.folders.iter().map(PathBuf::as_path));
    for folder in own.filter(|folder| !folder.as_os_str().is_empty()) {
        command.arg("-I").arg(folder);
    }
    for folder in source.header_folders() {
        command.arg("-I").arg(folder);
    }
    if scan.preprocessed {
        command.args(source::PREPROCESSED);
    }
    let mut file = absolute(&source.file);
    if let Some(text) = &scan.rewritten {
        file = folder.join(format!("{number}.f"));
        std::fs::write(&file, text)?;
    }
    command.args(&request.flags).arg("-o").arg(&object).arg(file);
    let (done, output) = run(program, &source.file, &mut command)?;
    Ok(if done { Ok(object) } else { Err(output) })
}

/// Compiles a C source of ours.
fn compile_own(name: &str, text: &str, folder: &Path) -> Result<PathBuf, Refusal> {
    let file = folder.join(name);
    std::fs::write(&file, text)?;
    let object = file.with_extension("o");
    let mut command = Command::new("gcc");
    command.args(["-c", "-fPIC", "-O1", "-o"]).arg(&object).arg(&file);
    let (done, output) = run("gcc", &file, &mut command)?;
    if done { Ok(object) } else { Err(refused("gcc", &file, &output, "")) }
}

/// Returns a path that no compiler mistakes for an option.
fn absolute(file: &Path) -> PathBuf {
    std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf())
}

/// Runs a compiler; whether it succeeded, and its words.
fn run(program: &'static str, file: &Path, command: &mut Command) -> Result<(bool, String), Refusal> {
    // Names in messages are looked for: no translations.
    let output = command.env("LC_ALL", "C").output().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => Refusal::NoCompiler { program, file: file.to_path_buf() },
        _ => Refusal::Io(error),
    })?;
    Ok((output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned()))
}

/// The compiler that links, and the libraries of the other languages.
struct Linker {
    program: &'static str,
    libraries: &'static [&'static str],
    /// Symbol for which LAPACK is linked.
    of_lapack: Option<String>,
}

fn linker(sources: &[PluginSource]) -> Linker {
    let any = |wanted: fn(&Language) -> bool| sources.iter().any(|source| wanted(&source.language));
    let cpp = any(|language| *language == Language::Cpp);
    // An object file may come from any compiler; Fortran is what UMATs are written in.
    if any(|language| matches!(language, Language::Fortran(_) | Language::Object)) {
        return Linker {
            program: "gfortran",
            libraries: if cpp { &["-lstdc++", "-lm"] } else { &["-lm"] },
            of_lapack: None,
        };
    }
    Linker { program: if cpp { "g++" } else { "gcc" }, libraries: &["-lm"], of_lapack: None }
}

impl Linker {
    fn command(&self, objects: &[PathBuf], library: &Path, flags: &[String]) -> Command {
        let mut command = Command::new(self.program);
        // A call of a routine of the library's own stays in it, also under hosts that load all symbols globally.
        command.args(["-shared", "-Wl,-Bsymbolic", "-o"]).arg(library);
        command.args(objects.iter().map(|object| absolute(object))).args(flags);
        if self.of_lapack.is_some() {
            command.args(lapack::FLAGS);
        }
        command.args(self.libraries.iter().map(OsString::from));
        command
    }
}
