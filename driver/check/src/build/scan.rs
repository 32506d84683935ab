//! Information from a source before it is compiled: preprocessor lines, the files it includes, the modules it defines
//! and uses.

use super::includes::{self, is_ours};
use super::source::{Form, Language, PluginSource};
use pullout_run::input::{self, Input};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Files within files; deeper, a file includes itself.
const DEEPEST: usize = 20;
/// Beginnings of preprocessor lines, after `#`.
const DIRECTIVES: [&str; 9] = ["define", "undef", "include", "if", "ifdef", "ifndef", "else", "elif", "endif"];

/// Information about a source and the files that it includes.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// Whether it has lines of the preprocessor.
    pub(super) preprocessed: bool,
    /// The text with included files in it, where a compiler would not find them as they are written.
    pub(super) rewritten: Option<String>,
    /// Folders of included files.
    pub(super) folders: BTreeSet<PathBuf>,
    /// Whether it has STRUCTURE or RECORD.
    pub(super) has_structures: bool,
    /// Whether the unit that is being read has begun with IMPLICIT NONE.
    is_typed: bool,
    /// Files that it includes.
    pub(super) files: Vec<PathBuf>,
    /// Names of included files of ours, as they are spelled.
    pub(super) ours: BTreeSet<String>,
    /// Modules that it defines.
    defines: BTreeSet<String>,
    /// Modules that it uses.
    uses: BTreeSet<String>,
}

impl Scan {
    /// Reads a source and what it includes.
    pub(super) fn of(source: &PluginSource) -> Self {
        let mut scan = Self::default();
        let Language::Fortran(form) = source.language else {
            return scan;
        };
        let text = scan.read(&source.file, &source.text, form, 0);
        if let Some(text) = text {
            scan.preprocessed = true;
            scan.rewritten = Some(format!("# 1 \"{}\"\n{text}", quoted(&source.file)));
        }
        scan.preprocessed |= source.file.extension().is_some_and(|suffix| suffix.to_string_lossy().starts_with('F'));
        scan
    }

    /// Reads a file; its text as it must be written, if that is not as it is.
    fn read(&mut self, file: &Path, text: &str, form: Form, depth: usize) -> Option<String> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut written = String::with_capacity(text.len());
        let mut changed = false;
        for (number, line) in text.lines().enumerate() {
            let include = Include::of(line);
            match include.as_ref().and_then(|include| self.replacement(include, folder, form, depth)) {
                Some(replacement) => {
                    changed = true;
                    let _ = writeln!(written, "{replacement}\n# {} \"{}\"", number + 2, quoted(file));
                    continue;
                }
                None if include.is_none() => self.statement(line, form),
                None => {}
            }
            written.push_str(line);
            written.push('\n');
        }
        changed.then_some(written)
    }

    /// Reads an included file; what must stand in place of the line, if the compiler would not find the file or not
    /// show it to the preprocessor.
    fn replacement(&mut self, include: &Include<'_>, folder: &Path, form: Form, depth: usize) -> Option<String> {
        self.preprocessed |= include.by_preprocessor;
        let Some(file) = find(folder, include.name) else {
            if let Some(text) = includes::without_typing(include.name).filter(|_| self.is_typed) {
                return Some(text.into());
            }
            if is_ours(include.name) {
                self.ours.insert(include.name.to_owned());
            }
            return include.is_in_capitals.then(|| format!("#include \"{}\"", include.name));
        };
        let content = input::read(&file, Input::Source).ok().filter(|_| depth < DEEPEST)?;
        let content = String::from_utf8_lossy(&content);
        self.files.push(file.clone());
        let before = std::mem::take(&mut self.preprocessed);
        let inner = self.read(&file, &content, form, depth + 1);
        let has_directives = self.preprocessed || inner.is_some();
        self.preprocessed = before || has_directives;
        self.folders.extend(file.parent().map(Path::to_path_buf));
        let is_found = folder.join(include.name).is_file() && !include.is_in_capitals;
        // an INCLUDE statement does not show its file to the preprocessor
        let is_seen = include.by_preprocessor || !has_directives;
        if is_found && is_seen && inner.is_none() {
            return None;
        }
        let text = inner.as_deref().unwrap_or(&content);
        Some(format!("# 1 \"{}\"\n{}", quoted(&file), text.trim_end_matches('\n')))
    }

    /// Notes what a line that includes nothing says.
    fn statement(&mut self, line: &str, form: Form) {
        if let Some(directive) = line.strip_prefix('#') {
            let word = directive.trim_start().split(|c: char| !c.is_ascii_alphabetic()).next().unwrap_or_default();
            self.preprocessed |= DIRECTIVES.contains(&word);
            return;
        }
        if form == Form::Fixed && line.starts_with(['c', 'C', '*', '!', 'd', 'D']) {
            return;
        }
        let code = line.split('!').next().unwrap_or_default();
        for statement in code.split(';') {
            let statement = statement.trim().to_ascii_lowercase();
            let mut words = statement.split([' ', '\t', ',', ':', '(', ')']).filter(|word| !word.is_empty());
            match statement.split([' ', '\t', '/', '(']).next() {
                Some("structure" | "record") if statement.contains('/') => self.has_structures = true,
                Some("implicit") => self.is_typed = statement.split_whitespace().nth(1) == Some("none"),
                Some("end") => self.is_typed = false,
                _ => {
                    let unit = ["subroutine", "function", "program", "module", "submodule"];
                    self.is_typed &= !statement.split([' ', '\t', '(']).any(|word| unit.contains(&word));
                }
            }
            match (words.next(), words.next(), words.next(), words.next()) {
                (Some("use"), Some("intrinsic"), ..) if statement.contains("::") => {}
                (Some("use"), Some("non_intrinsic"), Some(name), _) if statement.contains("::") => {
                    self.uses.insert(name.to_owned());
                }
                (Some("use"), Some(name), ..) if !name.starts_with(['=', '%']) => {
                    self.uses.insert(name.to_owned());
                }
                (Some("module"), Some(name), None, _) => {
                    self.defines.insert(name.to_owned());
                }
                // SUBMODULE (parent) name
                (Some("submodule"), Some(parent), Some(_), _) => {
                    self.uses.insert(parent.to_owned());
                }
                _ => {}
            }
        }
    }
}

/// A line that includes a file.
struct Include<'t> {
    name: &'t str,
    by_preprocessor: bool,
    /// `#INCLUDE`, which is none to the preprocessor.
    is_in_capitals: bool,
}

impl<'t> Include<'t> {
    fn of(line: &'t str) -> Option<Self> {
        let statement = line.trim_start();
        let (by_preprocessor, statement) = match line.strip_prefix('#') {
            Some(directive) => (true, directive.trim_start()),
            None => (false, statement),
        };
        let (word, rest) = statement.split_at_checked("include".len())?;
        let rest = rest.trim_start();
        if !word.eq_ignore_ascii_case("include") {
            return None;
        }
        let closing = match rest.chars().next()? {
            '<' if by_preprocessor => '>',
            quote @ ('\'' | '"') => quote,
            _ => return None,
        };
        let name = rest[1..].split(closing).next().map(str::trim).filter(|name| !name.is_empty())?;
        Some(Self { name, by_preprocessor, is_in_capitals: by_preprocessor && word != "include" })
    }
}

/// A file by the name that a source gives it: Windows' separators and letters of either case are understood.
fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    let exact = folder.join(name);
    if exact.is_file() {
        return Some(exact);
    }
    let path = folder.join(name.replace('\\', "/"));
    let wanted = path.file_name()?.to_str()?;
    let entries =
        std::fs::read_dir(path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new(".")));
    let mut found: Vec<_> = entries
        .ok()?
        .flatten()
        .filter(|entry| entry.file_name().to_str().is_some_and(|name| name.eq_ignore_ascii_case(wanted)))
        .map(|entry| path.with_file_name(entry.file_name()))
        .filter(|path| path.is_file())
        .collect();
    found.sort();
    found.into_iter().next()
}

/// A path in a line marker.
fn quoted(file: &Path) -> String {
    super::absolute(file).to_string_lossy().replace('\\', "\\\\").replace('"', "\\\"")
}

/// Returns the sources in an order in which they can be compiled, otherwise in the given order.
///
/// # Errors
/// The sources that use each other's modules.
pub(super) fn order(scans: &[Scan]) -> Result<Vec<usize>, Vec<usize>> {
    let needs = |user: usize, owner: usize| {
        user != owner && scans[user].uses.iter().any(|name| scans[owner].defines.contains(name))
    };
    let mut left: Vec<usize> = (0..scans.len()).collect();
    let mut ordered = Vec::with_capacity(left.len());
    while !left.is_empty() {
        let ready = left.iter().position(|&user| !left.iter().any(|&owner| needs(user, owner)));
        match ready {
            Some(place) => ordered.push(left.remove(place)),
            None => {
                // those that nobody in the circle needs are not of it
                while let Some(place) = left.iter().position(|&owner| !left.iter().any(|&user| needs(user, owner))) {
                    left.remove(place);
                }
                return Err(left);
            }
        }
    }
    Ok(ordered)
}
