//! Numbers in rows and columns, for programs (CSV) and for people (Markdown).

use pullout_run::number::{push_exact, significant};

/// Rows under named columns.
#[derive(Clone, Debug)]
pub(super) struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<Cell>>,
}

/// An entry.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell {
    /// Words.
    Text(String),
    /// A count.
    Count(u64),
    /// A number; not finite: there is no such number.
    Number(f64),
    /// The reason why there is no number.
    Absent(&'static str),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

/// An entry, or that there is none.
impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Absent("–"), Self::Number)
    }
}

/// Digits of numbers for people.
const DIGITS: usize = 3;

impl Table {
    /// Makes a table without rows.
    pub fn new<const N: usize>(columns: [&str; N]) -> Self {
        Self { columns: columns.map(str::to_owned).into(), rows: Vec::new() }
    }

    /// Adds a row; as many entries as columns.
    pub fn push<const N: usize>(&mut self, row: [Cell; N]) {
        debug_assert_eq!(N, self.columns.len());
        self.rows.push(row.into());
    }

    /// Returns it as CSV with a header line; exact numbers, empty where there is none.
    pub fn csv(&self) -> String {
        let line = |cells: Vec<String>| cells.iter().map(|text| quoted(text)).collect::<Vec<_>>().join(",") + "\n";
        let header = line(self.columns.clone());
        let rows = self.rows.iter().map(|row| line(row.iter().map(Cell::exact).collect()));
        std::iter::once(header).chain(rows).collect()
    }

    /// Returns it as a Markdown table, numbers rounded.
    pub fn markdown(&self) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let is_number = |k: usize| self.rows.iter().all(|row| !matches!(row.get(k), Some(Cell::Text(_))));
        let rule = (0..self.columns.len()).map(|k| if is_number(k) { "---:".into() } else { "---".into() }).collect();
        let rows = self.rows.iter().map(|row| line(row.iter().map(Cell::rounded).collect()));
        [line(self.columns.clone()), line(rule)].into_iter().chain(rows).collect()
    }

    /// Aligned with blanks, for a terminal.
    pub fn text(&self) -> String {
        let rows: Vec<Vec<String>> = std::iter::once(self.columns.clone())
            .chain(self.rows.iter().map(|row| row.iter().map(Cell::rounded).collect()))
            .collect();
        let width = |k: usize| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        let padded = |row: &Vec<String>| {
            let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
            cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
        };
        rows.iter().map(padded).collect()
    }
}

impl Cell {
    fn exact(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(number) if number.is_finite() => {
                let mut text = Vec::new();
                push_exact(&mut text, *number);
                String::from_utf8(text).unwrap_or_default()
            }
            Self::Number(_) | Self::Absent(_) => String::new(),
        }
    }

    fn rounded(&self) -> String {
        match self {
            Self::Text(text) => text.replace('|', "\\|"),
            Self::Count(count) => count.to_string(),
            Self::Number(number) if number.is_finite() => significant(*number, DIGITS),
            Self::Number(_) => "–".into(),
            Self::Absent(why) => (*why).into(),
        }
    }
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod test {
    use super::*;

    #[test]
    fn a_table_is_exact_for_programs_and_rounded_for_people() {
        let mut table = Table::new(["law", "ratio", "calls"]);
        table.push(["a, \"b\"".into(), (1.0 / 3.0).into(), 12_usize.into()]);
        table.push(["c|d".into(), f64::NAN.into(), Cell::Absent("not installed")]);
        assert_eq!(table.csv(), "law,ratio,calls\n\"a, \"\"b\"\"\",0.3333333333333333,12\nc|d,,\n");
        assert_eq!(
            table.markdown(),
            "| law | ratio | calls |\n| --- | ---: | ---: |\n| a, \"b\" | 0.333 | 12 |\n| c\\|d | – | not installed |\n"
        );
    }
}
