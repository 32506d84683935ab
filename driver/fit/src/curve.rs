//! The measured load–slip curve.

use pullout_case::CsvFile;
use std::path::Path;

/// Smallest number of rows from which a bond law can be distinguished from noise.
const FEWEST_ROWS: usize = 12;
/// Fraction of the largest slip. A slip that falls back by more is unloading, not scatter.
const LARGEST_RETURN: f64 = 0.05;
/// A load below minus this part of the greatest is no scatter about 0: the signs are wrong.
const LARGEST_COMPRESSION: f64 = 0.2;

/// A load–slip curve of a fibre that is pulled out monotonically, in the order of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadSlipCurve {
    /// Slips, mm.
    pub slips: Vec<f64>,
    /// Loads, N.
    pub loads: Vec<f64>,
}

impl LoadSlipCurve {
    /// Reads a CSV file: the columns of these names; without a name the columns `slip` and `load` if both are there, else
    /// the first two.
    ///
    /// # Errors
    /// One sentence for each thing that is wrong, with its line.
    pub fn read(path: &Path, slip: Option<&str>, load: Option<&str>) -> Result<Self, Vec<String>> {
        let csv = CsvFile::read(path)?;
        let rows = csv.numbers(&columns(&csv, slip, load)?, false)?;
        let curve =
            Self { slips: rows.iter().map(|row| row[0]).collect(), loads: rows.iter().map(|row| row[1]).collect() };
        curve.check().map_err(|(row, message)| csv.fault(csv.line(row), message))?;
        Ok(curve)
    }

    /// Checks that it is the curve of a pull-out; the error is the reason why not, with its row.
    fn check(&self) -> Result<(), (usize, String)> {
        let last = self.slips.len() - 1;
        if self.slips.len() < FEWEST_ROWS {
            return Err((last, format!("the curve ends after {} rows; at least {FEWEST_ROWS} are needed", last + 1)));
        }
        let (peak, largest) = (self.peak(), self.largest_slip());
        if peak.load <= 0.0 || largest <= 0.0 {
            return Err((last, "no slip and load above 0: pull-out has positive slips and loads".into()));
        }
        let mut furthest = 0.0_f64;
        for (row, (&slip, &load)) in self.slips.iter().zip(&self.loads).enumerate() {
            if load < -LARGEST_COMPRESSION * peak.load {
                return Err((row, format!("the load {load} N pushes the fibre in: pull-out has positive loads")));
            }
            if slip < furthest - LARGEST_RETURN * largest {
                return Err((
                    row,
                    format!("the slip falls back from {furthest} to {slip} mm: no cycles can be fitted"),
                ));
            }
            furthest = furthest.max(slip);
        }
        if peak.slip >= largest {
            return Err((last, "the load still rises at the end of the curve: it cannot determine a law".into()));
        }
        Ok(())
    }

    /// The point of the greatest load.
    pub(crate) fn peak(&self) -> Peak {
        let points = self.slips.iter().zip(&self.loads).map(|(&slip, &load)| Peak { slip, load });
        points.max_by(|a, b| a.load.total_cmp(&b.load)).unwrap_or_default()
    }

    /// The greatest slip, mm.
    pub fn largest_slip(&self) -> f64 {
        self.slips.iter().fold(0.0, |largest, &slip| slip.max(largest))
    }
}

/// A point of greatest load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Peak {
    /// mm.
    pub slip: f64,
    /// N.
    pub load: f64,
}

/// Indices of the columns of slip and load.
fn columns(csv: &CsvFile, slip: Option<&str>, load: Option<&str>) -> Result<[usize; 2], Vec<String>> {
    let header = &csv.header;
    if header.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Err(csv.fault(1, "these are numbers, but the first line must name the columns, e.g. 'slip,load'"));
    }
    let by_habit = csv.column("slip").ok().zip(csv.column("load").ok());
    if header.len() < 2 {
        return Err(csv.fault(1, "one column, but slip and load are needed"));
    }
    let default = by_habit.unwrap_or((0, 1));
    let slip = slip.map_or(Ok(default.0), |name| csv.column(name))?;
    let load = load.map_or(Ok(default.1), |name| csv.column(name))?;
    if slip == load {
        return Err(csv.fault(1, format!("slip and load would both be the column '{}'", header[slip])));
    }
    Ok([slip, load])
}
