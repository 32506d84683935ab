//! Specimens here and in CalculiX: same mesh, same law, same steps, one thread each.

use super::{Side, calculix, deck};
use crate::runs::{Limit, read, run_program};
use crate::timing::{median, process_time};
use crate::{BenchError, Settings};
use fe_core::model::Model;

const PLATE: &str = include_str!("../../../cases/benchmark/plate-with-hole.json");
const STRIP: &str = include_str!("../../../cases/benchmark/drag-out-strip.json");
/// Elements of the plates.
const CELLS: [usize; 2] = [5_000, 20_000];
const QUICK_CELLS: usize = 200;
/// Number of turns of each side.
const ROUNDS: usize = 3;

/// Relative difference that the reactions of the plates may have.
const REACTION_TOLERANCE: f64 = 1e-3;
/// μ p L of the strip, N, and the relative difference that our drag may have from it.
const EXACT_DRAG: f64 = 15.0;
const DRAG_TOLERANCE: f64 = 5e-3;

/// Comparison of a specimen in both programs.
struct Comparison {
    name: String,
    case: &'static str,
    set: Vec<String>,
    deck: fn(&Model) -> Result<String, BenchError>,
    /// Component of the reaction.
    component: usize,
    /// The exact result, N, where that is known.
    exact: Option<f64>,
}

/// Outcome of a comparison.
pub struct Compared {
    pub name: String,
    pub freedoms: usize,
    pub increments: u64,
    /// Medians.
    pub ours: Side,
    /// Medians; `None`: not installed.
    pub theirs: Option<Side>,
    /// The median of our time over theirs.
    pub share: Option<f64>,
    pub exact: Option<f64>,
}

impl Compared {
    /// Returns what is wrong with the results.
    pub fn trouble(&self) -> Option<String> {
        let (other, tolerance) = match (self.exact, &self.theirs) {
            (Some(exact), _) => (exact, DRAG_TOLERANCE),
            (None, Some(theirs)) => (theirs.result, REACTION_TOLERANCE),
            (None, None) => return None,
        };
        let difference = (self.ours.result / other - 1.0).abs();
        // nor may it be no number
        let is_good = difference < tolerance;
        (!is_good).then(|| format!("{}: {} N instead of {other} N", self.name, self.ours.result))
    }
}

fn comparisons(quick: bool) -> Vec<Comparison> {
    let plate = |cells: usize, nlgeom: bool| Comparison {
        name: format!("plate, {cells} Q8R, {} displacements", if nlgeom { "large" } else { "small" }),
        case: PLATE,
        set: vec![format!("mesh.specimen.cells={cells}"), format!("nlgeom={nlgeom}")],
        deck: deck::plate,
        component: 1,
        exact: None,
    };
    let strip = Comparison {
        name: "drag-out strip, friction".into(),
        case: STRIP,
        set: Vec::new(),
        deck: deck::strip,
        component: 0,
        exact: Some(EXACT_DRAG),
    };
    let cells: &[usize] = if quick { &[QUICK_CELLS] } else { &CELLS };
    let plates = cells.iter().flat_map(|cells| [plate(*cells, false), plate(*cells, true)]);
    plates.chain([strip]).collect()
}

/// All comparisons.
pub fn compare(settings: &Settings) -> Result<Vec<Compared>, BenchError> {
    let rounds = if settings.quick { 1 } else { ROUNDS };
    let program = calculix::installed();
    let compared = |comparison: &Comparison| comparison.run(settings, rounds, program.as_deref());
    comparisons(settings.quick).iter().map(compared).collect()
}

/// One run of our side.
struct Own {
    side: Side,
    freedoms: usize,
    increments: u64,
    deck: String,
}

impl Comparison {
    fn run(&self, settings: &Settings, rounds: usize, program: Option<&str>) -> Result<Compared, BenchError> {
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        let mut last = self.ours(settings)?;
        for round in 0..rounds {
            if round > 0 {
                last = self.ours(settings)?;
            }
            ours.push(last.side.clone());
            if let Some(program) = program {
                theirs.push(calculix::run(program, &last.deck, self.component)?);
            }
        }
        let ratios = ours.iter().zip(&theirs).map(|(ours, theirs)| ours.seconds / theirs.seconds).collect();
        Ok(Compared {
            name: self.name.clone(),
            freedoms: last.freedoms,
            increments: last.increments,
            share: (!theirs.is_empty()).then(|| median(ratios)),
            ours: middle(ours).unwrap_or(last.side),
            theirs: middle(theirs),
            exact: self.exact,
        })
    }

    /// Runs our side: with reading and meshing, as theirs is with reading; nothing but the reaction is kept.
    fn ours(&self, settings: &Settings) -> Result<Own, BenchError> {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("case.json");
        std::fs::write(&file, self.case)?;
        let mut set = self.set.clone();
        set.extend(["output.plots=false".to_owned(), "output.vtu=false".to_owned()]);
        let start = process_time();
        let program = read(&file, &set, &settings.plugin_paths)?;
        let ran = run_program(&program, Limit::NONE, folder.path());
        let seconds = (process_time() - start).as_secs_f64();
        if let Some(message) = ran.stopped {
            return Err(BenchError::Failed(format!("{}: {message}", self.name)));
        }
        let [_, result, _] = ran.end;
        let iterations = ran.statistics.iterations;
        Ok(Own {
            side: Side { program: "pullout".into(), seconds, result, iterations },
            freedoms: ran.freedoms,
            increments: ran.statistics.increments,
            deck: (self.deck)(&program.model)?,
        })
    }
}

/// The last run with the median of the times.
fn middle(mut sides: Vec<Side>) -> Option<Side> {
    let seconds = median(sides.iter().map(|side| side.seconds).collect());
    Some(Side { seconds, ..sides.pop()? })
}
