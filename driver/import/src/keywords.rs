//! Reads the keyword lines of an ABAQUS input file and of the files it includes, with their parameters and data lines.

use pullout_run::input::{self, Input, folder_of};
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Files within files; deeper, a file includes itself.
const DEEPEST: usize = 10;

/// Position of a line: file and number.
#[derive(Clone, Debug)]
pub(super) struct LinePosition {
    file: Rc<Path>,
    line: usize,
}

impl fmt::Display for LinePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file.display(), self.line)
    }
}

/// A line of values.
#[derive(Clone, Debug)]
pub(super) struct Data {
    pub(super) place: LinePosition,
    /// Text between the commas, without surrounding blanks.
    pub(super) fields: Vec<String>,
}

impl Data {
    /// Returns a field; empty if the line is shorter.
    pub(super) fn text(&self, field: usize) -> &str {
        self.fields.get(field).map_or("", String::as_str)
    }

    /// A field as a number; 0 where it is empty.
    pub(super) fn number(&self, field: usize) -> Result<f64, String> {
        let text = self.text(field);
        if text.is_empty() {
            return Ok(0.0);
        }
        // Fortran's exponents
        let number =
            text.to_ascii_lowercase().replace('d', "e").parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| format!("{}: '{text}' is no number", self.place))
    }

    /// All fields as numbers from one on.
    pub(super) fn numbers(&self, from: usize) -> Result<Vec<f64>, String> {
        (from..self.fields.len()).map(|field| self.number(field)).collect()
    }
}

/// A keyword with its parameters and data lines.
#[derive(Clone, Debug)]
pub(super) struct Keyword {
    pub(super) place: LinePosition,
    /// Name in capitals, without the star.
    pub(super) name: String,
    /// Names in capitals, and values.
    parameters: Vec<(String, String)>,
    pub(super) data: Vec<Data>,
}

impl Keyword {
    /// Returns a parameter's value; empty if it has none.
    pub(super) fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Names of its parameters.
    pub(super) fn options(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().map(|(name, _)| name.as_str())
    }

    /// Returns the first of these parameters that is present.
    pub(super) fn first_of<'o>(&self, names: &[&'o str]) -> Option<&'o str> {
        names.iter().copied().find(|name| self.parameter(name).is_some())
    }

    /// A parameter's value in capitals; empty for one without a value.
    pub(super) fn capitals(&self, name: &str) -> Option<String> {
        self.parameter(name).map(str::to_ascii_uppercase)
    }

    fn new(place: LinePosition, line: &str) -> Self {
        let mut parts = line.trim_start_matches('*').split(',').map(str::trim);
        let name = parts.next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ");
        let parameters = parts.filter(|part| !part.is_empty()).map(|part| {
            let (name, value) = part.split_once('=').unwrap_or((part, ""));
            let name = name.split_whitespace().collect::<Vec<_>>().join(" ");
            (name.to_ascii_uppercase(), value.trim().trim_matches('"').to_owned())
        });
        Self { place, name: name.to_ascii_uppercase(), parameters: parameters.collect(), data: Vec::new() }
    }
}

/// Reads a job; included files stand in the job's folder.
///
/// # Errors
/// Problem with the job, with its place.
pub(super) fn read(job: &Path) -> Result<Vec<Keyword>, String> {
    let mut keywords = Vec::new();
    read_into(&mut keywords, job, folder_of(job), 0)?;
    Ok(keywords)
}

fn read_into(keywords: &mut Vec<Keyword>, file: &Path, folder: &Path, depth: usize) -> Result<(), String> {
    let unreadable = |error: io::Error| format!("{}: {error}", file.display());
    let content = input::read(file, Input::Job).map_err(unreadable)?;
    let content = input::without_mark(&content).map_err(unreadable)?;
    let text = String::from_utf8_lossy(content);
    let file: Rc<Path> = file.into();
    let mut lines = text.lines().enumerate().map(|(number, line)| (number + 1, line.trim()));
    while let Some((number, line)) = lines.next() {
        let place = LinePosition { file: Rc::clone(&file), line: number };
        if line.is_empty() || line.starts_with("**") {
            continue;
        }
        if !line.starts_with('*') {
            let Some(keyword) = keywords.last_mut() else {
                return Err(format!("{place}: values before any keyword: this is no input file"));
            };
            let mut fields: Vec<_> = line.split(',').map(|field| field.trim().to_owned()).collect();
            if fields.last().is_some_and(String::is_empty) {
                fields.pop();
            }
            keyword.data.push(Data { place, fields });
            continue;
        }
        let mut whole = line.to_owned();
        while whole.ends_with(',') {
            // a comma at the end: the next line is of the same keyword
            match lines.next() {
                Some((_, next)) => whole.push_str(next),
                None => break,
            }
        }
        let keyword = Keyword::new(place, &whole);
        if keyword.name != "INCLUDE" {
            keywords.push(keyword);
            continue;
        }
        let place = &keyword.place;
        let input = keyword.parameter("INPUT").ok_or_else(|| format!("{place}: *INCLUDE without INPUT"))?;
        if depth == DEEPEST {
            return Err(format!("{place}: {input} is included {DEEPEST} files deep"));
        }
        let included: PathBuf = folder.join(input);
        read_into(keywords, &included, folder, depth + 1).map_err(|error| format!("{place}: {error}"))?;
    }
    Ok(())
}
