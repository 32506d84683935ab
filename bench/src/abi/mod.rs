//! Cost of a plugin call: against the linked law, against the host's safeguards, against a recorder, and against the
//! same law in Fortran.

mod fortran;
#[cfg(test)]
mod test;

use super::page::Page;
use super::solid::{Situation, Solid, increment_of, solids};
use super::table::{Cell, Table};
use super::timing::{Times, Way};
use super::{BenchError, Settings};
use fortran::Target;
use pullout_report::plots::figure::{Figure, Line, Scale, Style};
use pullout_report::plots::quantity::Quantity;
use pullout_run::number::significant;
use std::hint::black_box;
use umat_abi::host::{Library, UmatCall, recorder};
use umat_abi::law::{Increment, MAX_STATES, Request};

/// Calls of a way in one unit of work: what surrounds them does not count then.
const CALLS: usize = 100;

/// A law in a situation: nanoseconds, and ratios of times in the same turns.
struct Row {
    solid: usize,
    situation: Situation,
    direct: f64,
    plugin: f64,
    /// Plugin over direct.
    plugin_ratio: f64,
    /// Through the host's safe call.
    host: f64,
    /// Calls whose arguments are noted for a supervisor.
    recorded: Option<f64>,
    /// Fortran's time over the plugin's: portable, native.
    fortran: [Ratio; 2],
}

/// A ratio, or why there is none.
#[derive(Clone, Copy, Debug)]
enum Ratio {
    Measured(f64),
    NotInstalled,
    NotWritten,
}

impl Ratio {
    fn cell(self) -> Cell {
        match self {
            Self::Measured(ratio) => ratio.into(),
            Self::NotInstalled => Cell::Absent("gfortran is not installed"),
            Self::NotWritten => Cell::Absent("–"),
        }
    }
}

/// All laws. Ends with a recorder installed in this process.
pub(super) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let folder = tempfile::tempdir()?;
    let solids = solids();
    let mut rows = Vec::new();
    for (index, solid) in solids.iter().enumerate() {
        let twins = [
            fortran::library(solid.law, Target::Portable, folder.path())?,
            fortran::library(solid.law, Target::Native, folder.path())?,
        ];
        for situation in Situation::ALL {
            rows.push(measure_calls(index, solid, situation, &twins, settings)?);
        }
    }
    let recorder_notes = measure_recorder(&solids, &mut rows, settings)?;
    Ok(page(&solids, &rows, recorder_notes))
}

fn measure_calls(
    index: usize,
    solid: &Solid,
    situation: Situation,
    twins: &[fortran::Library; 2],
    settings: &Settings,
) -> Result<Row, BenchError> {
    let library = solid.library(settings)?;
    let increment = solid.increment(situation);
    let prepared = |library: &Library| -> Result<UmatCall, BenchError> {
        let mut call = solid.call(library, situation)?;
        call.dstran = increment;
        Ok(call)
    };
    let (mut plugin, mut host) = (prepared(&library)?, prepared(&library)?);
    let (start, states) = (increment_of(&plugin), plugin.statev().to_vec());
    let mut fortran_calls = Vec::new();
    let mut fortran = [Ratio::NotWritten; 2];
    for (twin, ratio) in twins.iter().zip(&mut fortran) {
        match twin {
            fortran::Library::None => {}
            fortran::Library::NotInstalled => *ratio = Ratio::NotInstalled,
            fortran::Library::Built(path) => {
                // SAFETY: the twin was built for this comparison: it keeps nothing between calls and no modes.
                let mut call = prepared(&unsafe { Library::open(path)?.vouched_for() })?;
                // from the very state of the plugin
                call.stress_mut().copy_from_slice(&start.stress);
                call.statev_mut().copy_from_slice(&states);
                *ratio = Ratio::Measured(f64::NAN);
                fortran_calls.push(call);
            }
        }
    }
    let mut ways: Vec<Way<'_>> = vec![
        Box::new(|| direct(solid, &start, &states)),
        Box::new(|| repeat(&mut plugin)),
        Box::new(|| {
            for _ in 0..CALLS {
                host.stress_mut().copy_from_slice(&start.stress);
                host.statev_mut().copy_from_slice(&states);
                let _ = black_box(host.call(black_box(Request::StressAndTangent)));
            }
        }),
    ];
    ways.extend(fortran_calls.iter_mut().map(|call| -> Way<'_> { Box::new(|| repeat(call)) }));
    let times: Times = settings.timing().take_turns(ways);
    let measured = fortran.iter_mut().filter(|ratio| matches!(ratio, Ratio::Measured(_)));
    for (k, ratio) in measured.enumerate() {
        *ratio = Ratio::Measured(times.ratio(3 + k, 1));
    }
    let nanoseconds = |way: usize| 1e9 * times.seconds(way) / CALLS as f64;
    Ok(Row {
        solid: index,
        situation,
        direct: nanoseconds(0),
        plugin: nanoseconds(1),
        plugin_ratio: times.ratio(1, 0),
        host: nanoseconds(2),
        recorded: None,
        fortran,
    })
}

/// The law itself, from the same state each time.
fn direct(solid: &Solid, start: &Increment, states: &[f64]) {
    let mut memory = [0.0; MAX_STATES];
    let state = &mut memory[..states.len()];
    for _ in 0..CALLS {
        state.copy_from_slice(states);
        let response =
            (solid.direct)(black_box(&solid.props), black_box(start), state, black_box(Request::StressAndTangent));
        black_box(&response);
        black_box(&mut *state);
    }
}

fn repeat(call: &mut UmatCall) {
    let _ = black_box(call.repeat(CALLS, black_box(Request::StressAndTangent)));
}

/// Calls that were made before and after a recorder was there. Returns why it could not be, if so.
fn measure_recorder(solids: &[Solid], rows: &mut [Row], settings: &Settings) -> Result<Option<String>, BenchError> {
    if recorder::installed().is_some() {
        return Ok(Some("This process has a recorder already: its cost was not measured.".into()));
    }
    let prepare = |row: &Row| -> Result<UmatCall, BenchError> {
        let solid = &solids[row.solid];
        let mut call = solid.call(&solid.library(settings)?, row.situation)?;
        call.dstran = solid.increment(row.situation);
        Ok(call)
    };
    let mut plain = rows.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
    let file = tempfile::tempfile()?;
    let _recording = recorder::Recording::create(&file)?;
    recorder::install(&file)?;
    let mut recorded = rows.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
    for ((row, plain), recorded) in rows.iter_mut().zip(&mut plain).zip(&mut recorded) {
        let (stress, states) = (plain.stress().to_vec(), plain.statev().to_vec());
        let calls = |call: &mut UmatCall| {
            for _ in 0..CALLS {
                call.stress_mut().copy_from_slice(&stress);
                call.statev_mut().copy_from_slice(&states);
                let _ = black_box(call.call(black_box(Request::StressAndTangent)));
            }
        };
        let times = settings.timing().take_turns(vec![Box::new(|| calls(plain)), Box::new(|| calls(recorded))]);
        row.recorded = Some(1e9 * (times.seconds(1) - times.seconds(0)) / CALLS as f64);
    }
    Ok(None)
}

const METHOD: &str = "\
One increment in three dimensions, stress and tangent, repeated from the same state (restored before each call): *elastic*,
a virgin point far below its limit, and *inelastic*, a point beyond it that goes on, with six strain components and three different
principal strains. *Direct*: the linked law with its checks of parameters and results, without the 38 arguments. *Plugin*: `umat_` of the loaded library,
38 arguments, with all checks of the boundary. *Host*: the program's own call of it (arrays cleared, canaries looked at).
*Recorder*: what noting all arguments for a supervising process adds to that (isolated libraries). *Fortran*: the same law
written by hand as a UMAT for three dimensions that checks nothing, gfortran -O3, called like the plugin; the figure is its time
over the plugin's: above 1 the plugin is faster. Native Fortran may use this processor's instructions, the plugin never does.
Medians of turns that alternate between the ways.";

fn page(solids: &[Solid], rows: &[Row], recorder_note: Option<String>) -> Page {
    let mut data = Table::new([
        "law",
        "situation",
        "direct_ns",
        "plugin_ns",
        "overhead_ns",
        "overhead_percent",
        "host_ns",
        "recorder_ns",
        "fortran_portable_over_plugin",
        "fortran_native_over_plugin",
    ]);
    let mut calls = Table::new([
        "law",
        "situation",
        "direct [ns]",
        "plugin [ns]",
        "surcharge [ns]",
        "surcharge [%]",
        "host [ns]",
        "recorder [ns]",
    ]);
    let mut fortran = Table::new(["law", "situation", "Fortran portable / plugin", "Fortran native / plugin"]);
    for row in rows {
        let name = solids[row.solid].law;
        let percent = 100.0 * (row.plugin_ratio - 1.0);
        let numbers: [Cell; 6] = [
            row.direct.into(),
            row.plugin.into(),
            (row.plugin - row.direct).into(),
            percent.into(),
            row.host.into(),
            row.recorded.into(),
        ];
        let [a, b, c, d, e, f] = numbers;
        let [portable, native] = row.fortran.map(Ratio::cell);
        let situation = row.situation.name();
        if !matches!(row.fortran[0], Ratio::NotWritten) {
            fortran.push([name.into(), situation.into(), portable.clone(), native.clone()]);
        }
        calls.push([name.into(), situation.into(), a.clone(), b.clone(), c.clone(), d.clone(), e.clone(), f.clone()]);
        data.push([name.into(), situation.into(), a, b, c, d, e, f, portable, native]);
    }
    Page {
        title: "The cost of a plugin call",
        method: METHOD.into(),
        data,
        summaries: vec![("A call".into(), calls), ("Against Fortran".into(), fortran)],
        notes: notes(solids, rows).into_iter().chain(recorder_note).collect(),
        figures: vec![figure(solids, rows)],
        failed: None,
    }
}

/// Least accepted throughput over Fortran's.
const FORTRAN_TARGET: f64 = 0.95;

fn notes(solids: &[Solid], rows: &[Row]) -> Vec<String> {
    let ratio = |row: &Row| match row.fortran[0] {
        Ratio::Measured(ratio) => Some(ratio),
        _ => None,
    };
    let of_row = |row: &Row, ratio: f64| {
        format!("{} {} ({})", solids[row.solid].law, row.situation.name(), significant(ratio, 3))
    };
    let slower: Vec<String> = rows
        .iter()
        .filter_map(|row| Some(of_row(row, ratio(row)?)).filter(|_| ratio(row).is_some_and(|r| r < FORTRAN_TARGET)))
        .collect();
    if !rows.iter().any(|row| ratio(row).is_some()) {
        return Vec::new();
    }
    vec![if slower.is_empty() {
        format!("Throughput is at least {FORTRAN_TARGET} of portable Fortran's everywhere.")
    } else {
        format!("Throughput below {FORTRAN_TARGET} of portable Fortran's: {}.", slower.join(", "))
    }]
}

fn figure(solids: &[Solid], rows: &[Row]) -> Figure {
    let line = |(k, situation): (usize, Situation)| {
        let of_situation = rows.iter().filter(|row| row.situation == situation);
        Line {
            label: situation.name().into(),
            points: of_situation.map(|row| (row.solid as f64, row.plugin - row.direct)).collect(),
            columns: ("law".into(), "overhead_ns".into()),
            style: Style { color: k, dash: 0 },
            marked: true,
        }
    };
    Figure {
        name: "surcharge".into(),
        title: "Plugin over direct call".into(),
        x: Quantity { name: String::new(), unit: String::new() },
        y: Quantity { name: "surcharge".into(), unit: "ns".into() },
        lines: Situation::ALL.into_iter().enumerate().map(line).collect(),
        marks: Vec::new(),
        scale: Scale::Names(solids.iter().map(|solid| solid.law.split('_').next().unwrap_or("").to_owned()).collect()),
        key: None,
        equal_units: false,
    }
}
