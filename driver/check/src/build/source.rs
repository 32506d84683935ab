//! Sources and the languages that they are in.

use super::Refusal;
use pullout_run::input::{self, Input};
use std::path::{Path, PathBuf};

/// Layout of a Fortran source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Statements from column 7, up to 132 columns.
    Fixed,
    /// Anywhere.
    Free,
}

/// Flags of every Fortran source besides its form: extensions that Intel's compiler accepts by default. (Not `-fdec` as
/// a whole: its integer intrinsics are named like many a routine of a UMAT, KDIM or IMAX.)
const FORTRAN: [&str; 9] = [
    "-std=legacy",
    "-fdollar-ok",
    "-fcray-pointer",
    "-fdec-static",
    "-fdec-math",
    "-fdec-include",
    "-fdec-char-conversions",
    "-fdec-blank-format-item",
    "-fdec-format-defaults",
];

/// Flag of a Fortran source with STRUCTURE or RECORD. (Not of any: it takes the dots of operators for those of components.)
pub(super) const STRUCTURES: &str = "-fdec-structure";

/// Flags of a source with preprocessor lines: ABAQUS's own definitions.
pub(super) const PREPROCESSED: [&str; 4] = ["-cpp", "-DABQ_LINUX", "-DABQ_LNX86_64", "-DFOR_TRAIL"];

/// Language of a source, which decides its compiler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Language {
    Fortran(Form),
    C,
    Cpp,
    /// Compiled already.
    Object,
}

impl Language {
    /// Returns the language of a file from its suffix.
    fn of(suffix: &str) -> Option<Self> {
        Some(match suffix {
            // capital C is C++, as compilers have it
            "C" => Self::Cpp,
            _ => match suffix.to_ascii_lowercase().as_str() {
                "f" | "for" | "ftn" | "f77" | "fpp" => Self::Fortran(Form::Fixed),
                "f90" | "f95" | "f03" | "f08" | "f18" => Self::Fortran(Form::Free),
                "c" => Self::C,
                "cpp" | "cc" | "cxx" | "cp" | "c++" => Self::Cpp,
                "o" | "obj" => Self::Object,
                _ => return None,
            },
        })
    }

    /// Returns the compiler; `None` if there is nothing to compile.
    pub(super) fn compiler(self) -> Option<&'static str> {
        match self {
            Self::Fortran(_) => Some("gfortran"),
            Self::C => Some("gcc"),
            Self::Cpp => Some("g++"),
            Self::Object => None,
        }
    }

    /// Returns what sources of this kind need.
    pub(super) fn flags(self) -> Vec<&'static str> {
        let form: &[&str] = match self {
            Self::Fortran(Form::Fixed) => &["-ffixed-form", "-ffixed-line-length-132", "-fd-lines-as-comments"],
            Self::Fortran(Form::Free) => &["-ffree-form", "-ffree-line-length-none"],
            // unique symbols are shared across libraries, whatever flags the loader is given
            Self::Cpp => return vec!["-fno-gnu-unique"],
            Self::C | Self::Object => return Vec::new(),
        };
        [&FORTRAN, form].concat()
    }

    /// Returns what `--debug` adds in place of optimisation.
    pub(super) fn debug_flags(self) -> &'static [&'static str] {
        match self {
            Self::Fortran(_) => &[
                "-Og",
                "-g",
                "-fbacktrace",
                "-fcheck=all,no-array-temps",
                "-finit-real=snan",
                "-fsignaling-nans",
                "-finit-derived",
            ],
            _ => &["-Og", "-g", "-fno-omit-frame-pointer"],
        }
    }
}

/// A file and its language.
#[derive(Clone, Debug)]
pub(super) struct PluginSource {
    pub(super) file: PathBuf,
    pub(super) language: Language,
    /// The text; empty for an object file.
    pub(super) text: String,
    /// Whether the form of a Fortran source is that of its suffix, because nobody says which.
    form_is_guessed: bool,
}

impl PluginSource {
    pub(super) fn new(file: &Path, form: Option<Form>) -> Result<Self, Refusal> {
        let refusal = |message: String| Refusal::File { file: file.to_path_buf(), message };
        let suffix = file.extension().unwrap_or_default().to_string_lossy();
        let Some(language) = Language::of(&suffix) else {
            return Err(refusal(
                "its suffix is that of no language (fixed form: .f .for .ftn .f77; free form: .f90 .f95 .f03 .f08; .c; .cpp \
                 .cc .cxx; .o)"
                    .into(),
            ));
        };
        // Old sources have letters of any code page in their comments.
        let content = input::read(file, Input::Source).map_err(|error| refusal(error.to_string()))?;
        let text = if language == Language::Object { String::new() } else { String::from_utf8_lossy(&content).into() };
        let given = form.or_else(|| directive(&text));
        let language = match language {
            Language::Fortran(by_suffix) => Language::Fortran(given.unwrap_or(by_suffix)),
            other => other,
        };
        Ok(Self { file: file.to_path_buf(), language, text, form_is_guessed: given.is_none() })
    }

    /// The form of a Fortran source in a word; nothing for any other.
    pub(super) fn form_in_words(&self) -> &'static str {
        match self.language {
            Language::Fortran(Form::Fixed) => "fixed",
            Language::Fortran(Form::Free) => "free",
            _ => "",
        }
    }

    /// Returns the same Fortran source in the other form, unless somebody says which it has.
    pub(super) fn in_other_form(&self) -> Option<Self> {
        let language = match self.language {
            Language::Fortran(Form::Fixed) => Language::Fortran(Form::Free),
            Language::Fortran(Form::Free) => Language::Fortran(Form::Fixed),
            _ => return None,
        };
        self.form_is_guessed.then(|| Self { language, ..self.clone() })
    }

    /// Returns the folders of header-only libraries that a source includes: Eigen, which Debian installs in its own subfolder.
    pub(super) fn header_folders(&self) -> Vec<PathBuf> {
        const EIGEN: [&str; 3] = ["/usr/include/eigen3", "/usr/local/include/eigen3", "/opt/homebrew/include/eigen3"];
        let includes = |line: &str| {
            let line = line.trim_start().strip_prefix('#').map(str::trim_start);
            line.and_then(|line| line.strip_prefix("include"))
                .is_some_and(|rest| rest.trim_start().starts_with("<Eigen/"))
        };
        let wants = self.language == Language::Cpp && self.text.lines().any(includes);
        EIGEN.into_iter().filter(|_| wants).map(PathBuf::from).find(|folder| folder.is_dir()).into_iter().collect()
    }
}

/// `!DIR$ FREEFORM` or `!DEC$ NOFREEFORM` before the first statement says more than the suffix.
fn directive(text: &str) -> Option<Form> {
    for line in text.lines() {
        let line = line.trim().to_ascii_uppercase();
        let is_comment = line.is_empty() || line.starts_with(['!', 'C', '*']);
        if !is_comment {
            break;
        }
        match line.get(1..).map(|rest| rest.split_whitespace().collect::<Vec<_>>()).as_deref() {
            Some(["DIR$" | "DEC$", "FREEFORM"]) => return Some(Form::Free),
            Some(["DIR$" | "DEC$", "NOFREEFORM" | "FIXEDFORM"]) => return Some(Form::Fixed),
            _ => {}
        }
    }
    None
}
