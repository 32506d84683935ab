//! σ(w) as tables for other programs.
//!
//! The opening w of a crack is its whole elongation less the elastic part σ/E of the concrete next to it. This is ABAQUS's *cracking
//! displacement*, and h times the *crack strain* of programs that smear the crack over a width h.

use crate::directory::ResultDirectory;
use pullout_bridging::Polyline;
use pullout_run::bridging::ForeignTables;
use pullout_run::number::{self, exact, significant};
use std::io;

#[cfg(test)]
mod test;

/// A crack that falls at once from the strength of the matrix to the stress of the fibres does so up to this part of the first opening:
/// abscissae must rise.
const DROP: f64 = 1e-3;

/// σ(w) from the beginning of a crack.
#[derive(Clone, Debug)]
pub struct SofteningTable {
    /// w, mm, and σ, MPa: w rises from 0, σ is not negative.
    rows: Vec<[f64; 2]>,
    /// Young's modulus of the concrete next to the crack, MPa.
    modulus: f64,
}

impl SofteningTable {
    /// Makes that of a law, up to an opening. A crack begins at the given strength, MPa, if this is more than σ(0), and the stress falls to
    /// σ(0) at once.
    pub fn new(law: &Polyline, strength: f64, modulus: f64, last_opening: f64) -> Self {
        let mut points = law.points().filter(|point| point.0 <= last_opening);
        let first = points.next().map_or(0.0, |point| point.1.max(0.0));
        let later: Vec<[f64; 2]> = points.map(|(opening, stress)| [opening, stress.max(0.0)]).collect();
        let mut rows = vec![[0.0, strength.max(first)]];
        if first < strength
            && let Some([opening, _]) = later.first()
        {
            rows.push([DROP * opening, first]);
        }
        rows.extend(later);
        Self { rows, modulus }
    }

    /// Writes the tables that a case asks for. The result is what the user should be warned of.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, directory: &mut ResultDirectory, tables: ForeignTables) -> io::Result<Option<String>> {
        if tables.abaqus {
            directory.write("abaqus.inp", self.abaqus())?;
        }
        let Some(width) = tables.crack_band else { return Ok(None) };
        match self.crack_band(width) {
            Ok(text) => directory.write("crack_band.csv", text).map(|_| None),
            Err(warning) => Ok(Some(warning)),
        }
    }

    /// `*CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT` of ABAQUS's concrete damaged plasticity: lines of the stress after cracking and the
    /// cracking displacement, the first 0 (*ABAQUS Keywords Reference Guide* 2017, under this keyword).
    fn abaqus(&self) -> String {
        let last = self.rows.last().map_or(0.0, |row| row[0]);
        let mut text = format!(
            "** sigma(w) up to an opening of {} mm: stress, MPa, and cracking displacement, mm\n\
             *CONCRETE TENSION STIFFENING, TYPE=DISPLACEMENT\n",
            exact(last)
        );
        for [opening, stress] in &self.rows {
            text += &format!("{}, {}\n", exact(*stress), exact(*opening));
        }
        text
    }

    /// σ over the crack strain w/h and the strain w/h + σ/E of elements in which a crack has the width h.
    ///
    /// # Errors
    /// A message: in so wide elements the strain would fall.
    fn crack_band(&self, width: f64) -> Result<Vec<u8>, String> {
        let steepest = self.rows.windows(2).map(|ends| (ends[0][1] - ends[1][1]) / (ends[1][0] - ends[0][0]));
        let widest = self.modulus / steepest.fold(0.0, f64::max);
        if width >= widest {
            return Err(format!(
                "output.crack_band: σ falls so steeply that the strain of elements of {} mm would fall with it; no crack_band.csv: give \
                 less than {} mm",
                number::rounded(width),
                significant(widest, 3)
            ));
        }
        let mut text = b"crack_strain,strain,stress\n".to_vec();
        for [opening, stress] in &self.rows {
            let crack = opening / width;
            for (value, end) in [(crack, b','), (crack + stress / self.modulus, b','), (*stress, b'\n')] {
                number::push_exact(&mut text, value);
                text.push(end);
            }
        }
        Ok(text)
    }
}
