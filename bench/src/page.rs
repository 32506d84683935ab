//! Findings of an item as files.

use super::machine::Machine;
use super::table::Table;
use pullout_report::plots::figure::Figure;
use std::fmt::Write;
use std::io;
use std::path::Path;

/// The results of an item.
#[derive(Debug)]
pub(super) struct Page {
    /// Subject of the measurements.
    pub title: &'static str,
    /// Method, in a few sentences.
    pub method: String,
    /// Every number.
    pub data: Table,
    /// Conclusions: headings, sentences and tables.
    pub summaries: Vec<(String, Table)>,
    /// Observations on them.
    pub notes: Vec<String>,
    /// Pictures.
    pub figures: Vec<Figure>,
    /// Findings that should not be among them.
    pub failed: Option<String>,
}

impl Page {
    /// Writes `<stem>.csv`, `<stem>.md` and the pictures into a folder (made if missing). Pictures of the item that were
    /// there go.
    pub fn write(&self, folder: &Path, stem: &str, quick: bool) -> io::Result<()> {
        let at = |path: &Path| {
            let path = path.display().to_string();
            move |error: io::Error| io::Error::new(error.kind(), format!("{path}: {error}"))
        };
        std::fs::create_dir_all(folder).map_err(at(folder))?;
        let prefix = format!("{stem}-");
        for entry in std::fs::read_dir(folder).map_err(at(folder))?.flatten() {
            let path = entry.path();
            let is_svg = path.extension().is_some_and(|extension| extension == "svg");
            if is_svg && entry.file_name().to_string_lossy().starts_with(&prefix) {
                std::fs::remove_file(&path).map_err(at(&path))?;
            }
        }
        let write = |name: String, text: &str| {
            let path = folder.join(name);
            std::fs::write(&path, text).map_err(at(&path))
        };
        let mut pictures = Vec::new();
        for figure in &self.figures {
            let name = format!("{prefix}{}.svg", figure.name);
            write(name.clone(), &figure.svg().map_err(io::Error::other)?)?;
            pictures.push((name, figure.title.clone()));
        }
        write(format!("{stem}.csv"), &self.data.csv())?;
        write(format!("{stem}.md"), &self.markdown(stem, quick, &pictures))
    }

    fn markdown(&self, stem: &str, quick: bool, pictures: &[(String, String)]) -> String {
        let mut text = format!("# {}\n\n{}\n", self.title, self.method.trim());
        // writing to a String cannot fail
        let _ = write!(text, "\n{}.\n", Machine::here().line());
        if quick {
            text += "\n**Made with `--quick`: it shows that the benchmark works; its times mean little.**\n";
        }
        for (heading, table) in &self.summaries {
            let _ = write!(text, "\n## {heading}\n\n{}", table.markdown());
        }
        if !self.notes.is_empty() {
            text += "\n## Notes\n\n";
            self.notes.iter().for_each(|note| text += &format!("- {note}\n"));
        }
        if !pictures.is_empty() {
            text += "\n## Pictures\n\n";
            pictures.iter().for_each(|(name, title)| text += &format!("![{title}]({name})\n"));
        }
        let _ = write!(
            text,
            "\nAll numbers: [{stem}.csv]({stem}.csv). Made anew by `cargo run --release -p pullout-bench -- {stem}`.\n"
        );
        text
    }

    /// The summaries for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n", self.title);
        for (heading, table) in &self.summaries {
            let _ = write!(text, "\n{heading}\n{}", table.text());
        }
        self.notes.iter().for_each(|note| text += &format!("\n{note}\n"));
        text
    }
}
