//! Results of a run of kind "bridging": its tables, pictures, summary and report.

use crate::directory::ResultDirectory;
use crate::ending;
use crate::history::{BRIDGING_TABLES, History};
use crate::page::Account;
use crate::plots::figure::{Figure, Line, Style};
use crate::plots::quantity::Quantity;
use crate::plots::{self, Drawings, Spec};
use crate::softening::SofteningTable;
use crate::summary::{Status, Summary};
use pullout_bridging::{Average, Composite, Curve, Softening};
use pullout_case::Case;
use pullout_run::bridging::{BridgingProgram, BridgingResults};
use pullout_run::columns::{self, BEAM, BRIDGING, Group, HistoryColumn, SCATTER};
use pullout_run::number;
use pullout_run::signals;
use std::f64::consts::FRAC_PI_2;
use std::io;

/// The family of curves of one fibre: parts of L_f/2, and angles, degrees.
const FAMILY_LENGTHS: [f64; 3] = [0.25, 0.5, 1.0];
const FAMILY_ANGLES: [f64; 3] = [0.0, 30.0, 60.0];
/// Points of each.
const FAMILY_POINTS: usize = 200;
/// Points of the density of directions over the quarter circle.
const DIRECTIONS: usize = 180;

/// A run: the program, its fibres and its results.
pub type Done<'a> = (&'a BridgingProgram, &'a Composite, &'a BridgingResults);

/// Writes tables, summary, pictures and report; of a run that failed its message. The second result is what could not be
/// written. `draws`: whether pictures are wanted.
///
/// # Errors
/// A table cannot be written.
pub fn conclude(
    case: &Case,
    directory: &mut ResultDirectory,
    done: Result<Done<'_>, String>,
    [wall_time_s, cpu_time_s]: [f64; 2],
    draws: bool,
) -> io::Result<(Summary, io::Result<()>)> {
    let mut refused = None;
    if let Ok((program, composite, results)) = &done {
        if !results.curves.is_empty() {
            directory.write("fibres.csv", curves(&results.curves))?;
        }
        let [bridging, beam] = BRIDGING_TABLES;
        write_table(directory, bridging, BRIDGING, program.left_out(), &results.rows)?;
        if !results.beam.is_empty() {
            write_table(directory, beam, BEAM, program.left_out(), &results.beam)?;
        }
        if !results.scatter.is_empty() {
            write_table(directory, "scatter.csv", SCATTER, &[], &results.scatter)?;
        }
        let strength = if program.matrix.softening == Softening::None { program.matrix.ft } else { 0.0 };
        let fibres: Vec<Average> = results.rows.iter().map(|row| row.fibres).collect();
        let last = program.openings.last().copied().unwrap_or_default();
        let table = SofteningTable::new(&composite.law(&fibres), strength, program.matrix.modulus, last);
        refused = table.write(directory, program.tables)?;
    }
    let results = done.as_ref().ok().map(|(.., results)| *results);
    let own = case.about().warnings.iter();
    let summary = Summary {
        status: match (&done, signals::received()) {
            (Ok(_), _) => Status::Done,
            (Err(_), Some(_)) => Status::Interrupted,
            (Err(_), None) => Status::Failed,
        },
        message: done.as_ref().err().cloned(),
        title: case.about().title.clone(),
        wall_time_s,
        cpu_time_s: Some(cpu_time_s),
        bridging: results.map(|results| results.findings.clone()),
        warnings: own
            .chain(results.into_iter().flat_map(|results| &results.warnings))
            .chain(&refused)
            .cloned()
            .collect(),
        notes: case.about().notes.clone(),
        ..Summary::default()
    };
    let (history, compared) = match &done {
        Ok(_) => {
            let history = History::of_run(directory.path(), |table| table.for_pictures())?;
            let compared = ending::compare_all(case, &history);
            (history, compared)
        }
        Err(_) => (History::default(), Ok(Vec::new())),
    };
    ending::write(case, directory, summary, compared, |directory| match &done {
        Ok(done) if draws => Ok((draw(case, directory, &history, done)?, None)),
        _ => Ok(Default::default()),
    })
}

/// Curves of fibres as a case of model "table" reads them.
fn curves(curves: &[Curve]) -> Vec<u8> {
    let mut text = b"theta_deg,embedded,slip,load\n".to_vec();
    for curve in curves {
        for (&slip, &load) in curve.slip.iter().zip(&curve.load) {
            for (value, end) in [(curve.angle_deg, b','), (curve.embedded, b','), (slip, b','), (load, b'\n')] {
                number::push_exact(&mut text, value);
                text.push(end);
            }
        }
    }
    text
}

/// Writes rows as a table with the columns that are not left out.
fn write_table<R>(
    directory: &mut ResultDirectory,
    name: &str,
    table: &'static [HistoryColumn<R>],
    left_out: &[Group],
    rows: &[R],
) -> io::Result<()> {
    let mut text = columns::names_without(table, left_out).join(",").into_bytes();
    text.push(b'\n');
    for row in rows {
        for (k, column) in columns::with(table, left_out).enumerate() {
            if k > 0 {
                text.push(b',');
            }
            number::push_exact(&mut text, (column.value)(row));
        }
        text.push(b'\n');
    }
    directory.write(name, text).map(|_| ())
}

fn draw(
    case: &Case,
    directory: &mut ResultDirectory,
    history: &History,
    (program, composite, _): &Done<'_>,
) -> io::Result<Drawings> {
    let mut drawings = plots::draw(directory, plots::FOLDER, history, &Spec::of(case, Account::of(case).inputs()))?;
    let figures = [family(program, composite), directions(composite)];
    drawings.append(plots::write_all(directory, plots::FOLDER, &figures)?);
    Ok(drawings)
}

/// P(w; L_e, θ): a colour for each angle, a dash for each length.
fn family(program: &BridgingProgram, composite: &Composite) -> Figure {
    let half = 0.5 * program.fibre.length;
    let mut lines = Vec::new();
    for (dash, part) in FAMILY_LENGTHS.iter().rev().enumerate() {
        for (color, angle) in FAMILY_ANGLES.iter().enumerate() {
            let embedded = part * half;
            let end = program.openings.last().copied().unwrap_or(half).min(half);
            let at = |k: usize| {
                let opening = end * (k as f64 / FAMILY_POINTS as f64).powi(2);
                (opening, composite.fibre.at(opening, embedded, angle.to_radians()).load)
            };
            lines.push(Line {
                label: format!("{}°, L_{{e}} = {} mm", number::rounded(*angle), number::significant(embedded, 3)),
                points: (0..=FAMILY_POINTS).map(at).collect(),
                columns: ("w".into(), String::new()),
                style: Style { color, dash },
                ..Line::default()
            });
        }
    }
    Figure {
        name: "load_of_a_fibre".into(),
        title: "One fibre across the crack".into(),
        x: Quantity::of("w", &Default::default()),
        y: Quantity { name: "P".into(), unit: "N".into() },
        lines,
        ..Figure::default()
    }
}

/// p(θ) around the crack's normal, which points up, with that of fibres that are alike in all directions of space.
fn directions(composite: &Composite) -> Figure {
    let polar = |density: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
        let count = DIRECTIONS as i32;
        let at = |k: i32| {
            let angle = FRAC_PI_2 * f64::from(k) / f64::from(count);
            let radius = density(angle.abs());
            (radius * angle.sin(), radius * angle.cos())
        };
        (-count..=count).map(at).collect()
    };
    let quantity = |name: &str| Quantity { name: name.into(), unit: "1/rad".into() };
    Figure {
        name: "orientation".into(),
        title: "Directions of the fibres about the normal of the crack, which points up".into(),
        x: quantity("p sin θ"),
        y: quantity("p cos θ"),
        lines: vec![
            Line::numbered("p(θ)", polar(&|angle| composite.directions.density(angle)), 0),
            Line::numbered("random in space", polar(&f64::sin), 1),
        ],
        equal_units: true,
        ..Figure::default()
    }
}
