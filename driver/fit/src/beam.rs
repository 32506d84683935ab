//! `pullout fit beam`: σ(w) behind the test of a notched beam, and the bond behind σ(w).
//!
//! ```text
//! CSV ── rigid hinge (start) ── hinge model, L-curve ── σ(w), E, f_t ± error ── τ and f ± error ── output
//! ```

use crate::doubt::doubts;
use pullout_bridging::{
    Beam, Bond, BridgingFit, Estimate, Fitted, Inclination, Invalid, Measured, NotchedBeam, Polyline, RESIDUAL_CMOD,
    Residual, SectionLaw, bond_from_bridging, fast_inverse, full_inverse,
};
use pullout_case::CsvFile;
use pullout_run::bridging::{BridgingProgram, LoadSource};
use std::path::Path;

mod output;
pub use output::{describe, write};

/// Columns of strengths.
const STRENGTHS: [&str; 5] = ["f_L", "f_R1", "f_R2", "f_R3", "f_R4"];
/// Openings whose σ_f the bond is sought from, mm: what the matrix carries is spent, and the test tells them.
const BOND_OPENINGS: [f64; 6] = [0.3, 0.6, 1.0, 1.5, 2.0, 2.5];
/// Points of the computed curve and of the case's own law.
const POINTS: usize = 160;

/// Columns that are read from a test's file.
#[derive(Clone, Debug, Default)]
pub struct BeamColumns {
    /// CMOD, mm.
    pub cmod: Option<String>,
    /// Load.
    pub load: Option<String>,
    /// N for the unit of the file's load.
    pub load_factor: f64,
}

/// Reads the test of a beam: the columns `cmod` and `load` (or those that are named), or strengths `f_L`, `f_R1` …
/// `f_R4`, of several beams their means.
///
/// # Errors
/// One sentence for each thing that is wrong.
pub fn read_beam_test(path: &Path, columns: &BeamColumns) -> Result<Measured, Vec<String>> {
    let csv = CsvFile::read(path)?;
    let rows = |wanted: &[&str]| {
        let places = wanted.iter().map(|name| csv.column(name)).collect::<Result<Vec<usize>, Vec<String>>>()?;
        csv.numbers(&places, false)
    };
    if columns.cmod.is_none() && columns.load.is_none() && csv.column(STRENGTHS[1]).is_ok() {
        let rows = rows(&STRENGTHS)?;
        let mean = |k: usize| rows.iter().map(|row| row[k]).sum::<f64>() / rows.len() as f64;
        return Ok(Measured::Strengths(Residual { limit: mean(0), residual: [1, 2, 3, 4].map(mean) }));
    }
    let names = [columns.cmod.as_deref().unwrap_or("cmod"), columns.load.as_deref().unwrap_or("load")];
    Ok(Measured::Curve(rows(&names)?.iter().map(|row| [row[0], columns.load_factor * row[1]]).collect()))
}

/// Result of the fit.
#[derive(Clone, Debug)]
pub struct BeamFit {
    /// The test's geometry.
    pub geometry: NotchedBeam,
    /// σ(w) by a rigid hinge.
    pub fast: Polyline,
    /// σ(w), E and f_t by the hinge model.
    pub full: BridgingFit,
    /// σ(w) as the case has it.
    pub predicted: Polyline,
    /// τ, and f where the test tells it; or why they were not sought.
    pub bond: Result<Fitted, String>,
}

impl BeamFit {
    /// Finds it. Geometry, fibre and dosage are those of the case.
    ///
    /// # Errors
    /// Data that are not those of a test, or a case without sense.
    pub fn new(program: &BridgingProgram, test: &Measured) -> Result<Self, Invalid> {
        let geometry = program.beam.unwrap_or_default();
        let fast = fast_inverse(&geometry, test)?;
        let full = full_inverse(&geometry, &program.matrix, test)?;
        let end = program.openings.last().copied().unwrap_or_default();
        let rule = "a fit does not run \"fe\": use the fibres.csv of its run with model \"table\"";
        let composite = match &program.source {
            LoadSource::Simulated(_) => return Err(Invalid { place: "fibre.model".into(), rule: rule.into() }),
            _ => program.composite(&[])?,
        };
        let predicted = composite.law_to(end, POINTS);
        let target: Vec<[f64; 2]> = BOND_OPENINGS
            .iter()
            .map(|&opening| [opening, full.law.at(opening) - composite.matrix_stress(opening)])
            .filter(|row| row[1] > 0.0)
            .collect();
        let bond = match &program.source {
            LoadSource::Bond(Bond::Closed(closed), Inclination::Exp { f }) => bond_from_bridging(
                &program.fibre,
                program.volume_fraction,
                &program.orientation,
                program.sides,
                (closed, f.max(f64::MIN_POSITIVE)),
                &target,
            )
            .map_err(|error| error.to_string()),
            _ => Err("fitted only for model \"closed\" with inclination \"exp\"".into()),
        };
        Ok(Self { geometry, fast, full, predicted, bond })
    }

    /// Warns of data in other units, and of a σ(w) that misses them.
    fn doubts(&self, test: &Measured) -> Vec<String> {
        let greatest = test.greatest_strength(&self.geometry);
        let mut data = vec![("flexural strength at the greatest load", greatest, "MPa", [0.5, 60.0])];
        if let Measured::Curve(rows) = test {
            let last = rows.iter().map(|row| row[0]).fold(0.0, f64::max);
            data.push(("greatest CMOD", last, "mm", [0.1, 50.0]));
        }
        doubts(&data, [("", self.full.fitted.rms)])
    }

    /// The computed test at CMODs.
    fn forces(&self, cmods: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
        let section = [SectionLaw::new(&self.full.matrix, &self.full.law, self.geometry.hinge())];
        let beam = Beam::new(self.geometry, &section, &self.full.matrix);
        cmods.map(|cmod| (cmod, beam.at(cmod).force)).collect()
    }

    /// Name, unit and estimate of each number: E, f_t, σ at openings, τ, f.
    fn numbers(&self) -> Vec<(String, &'static str, Estimate)> {
        let stresses = self.full.openings.iter().map(|opening| (format!("sigma({opening})"), "MPa"));
        let names = [("E".to_owned(), "MPa"), ("f_t".to_owned(), "MPa")].into_iter().chain(stresses);
        let told = names.zip(&self.full.fitted.estimates);
        let bond = self.bond.iter().flat_map(|bond| {
            let names = [("tau".to_owned(), "MPa"), ("f".to_owned(), "")];
            names.into_iter().zip(&bond.estimates)
        });
        told.chain(bond).map(|((name, unit), estimate)| (name, unit, *estimate)).collect()
    }
}

/// The measured points: the curve's, or those of the strengths.
fn measured_points(geometry: &NotchedBeam, test: &Measured) -> Vec<(f64, f64)> {
    match test {
        Measured::Curve(rows) => rows.iter().map(|row| (row[0], row[1])).collect(),
        Measured::Strengths(strengths) => {
            let force = |strength: f64| strength / geometry.flexural_strength(1.0);
            RESIDUAL_CMOD.into_iter().zip(strengths.residual.map(force)).collect()
        }
    }
}
