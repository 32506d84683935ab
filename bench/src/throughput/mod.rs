//! Measures updates per second on one core and on all, with and without tangent, one by one and in batches.

mod batch;
mod cores;
#[cfg(test)]
mod test;

use super::page::Page;
use super::solid::{Situation, Solid, solids};
use super::table::{Cell, Table};
use super::{BenchError, Settings};
use batch::Batch;
use cores::Cores;
use pullout_report::plots::figure::{Figure, Line, Scale, Style};
use pullout_report::plots::quantity::Quantity;
use umat_abi::law::Request;

/// A law in a situation.
struct Row {
    solid: usize,
    situation: Situation,
    /// Calls with tangent, and with stress only: updates per second of one core, and the gain by all cores.
    calls: [Cores; 2],
    /// Batches with stress only.
    batch: Batch,
}

/// All laws.
pub(super) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let solids = solids();
    let mut rows = Vec::new();
    for (index, solid) in solids.iter().enumerate() {
        let library = solid.library(settings)?;
        for situation in Situation::ALL {
            let calls = |request| cores::measure(solid, &library, situation, request, settings);
            rows.push(Row {
                solid: index,
                situation,
                calls: [calls(Request::StressAndTangent)?, calls(Request::Stress)?],
                batch: batch::measure(solid, &library, situation, settings)?,
            });
        }
    }
    Ok(page(&solids, &rows))
}

const METHOD: &str = "\
Updates in three dimensions through the plugin's `umat_`: *elastic* points far below their limit, *inelastic* ones beyond it that go on
straining in six components. *All cores*: as many threads as the program may use, each with a point of its own; the figure is
their throughput over that of one thread in the same turns, by the clock. *Batch*: `pullout_umat_batch_v1` on {points} points that differ
(component by component, in the processor's caches), stress only, against calls of `umat_` on the arrays of the same
points one by one; the figure is the time of the calls over that of the batch, and both give the same bits, which is checked
first. Medians of turns that alternate.";

fn page(solids: &[Solid], rows: &[Row]) -> Page {
    let mut data = Table::new([
        "law",
        "situation",
        "updates_per_s_tangent",
        "all_cores_over_one_tangent",
        "updates_per_s_stress",
        "all_cores_over_one_stress",
        "batch_updates_per_s",
        "single_over_batch_time",
    ]);
    let mut throughput = Table::new([
        "law",
        "situation",
        "with tangent [10⁶/s]",
        "all cores / one",
        "stress only [10⁶/s]",
        "all cores / one",
    ]);
    let mut batches = Table::new(["law", "situation", "batch [10⁶/s]", "one by one / batch"]);
    for row in rows {
        let name = solids[row.solid].law;
        let situation = row.situation.name();
        let [tangent, stress] = row.calls;
        let millions = |number: f64| Cell::from(1e-6 * number);
        data.push([
            name.into(),
            situation.into(),
            tangent.per_second.into(),
            tangent.all_over_one.into(),
            stress.per_second.into(),
            stress.all_over_one.into(),
            row.batch.per_second.into(),
            row.batch.gain.into(),
        ]);
        throughput.push([
            name.into(),
            situation.into(),
            millions(tangent.per_second),
            tangent.all_over_one.into(),
            millions(stress.per_second),
            stress.all_over_one.into(),
        ]);
        batches.push([name.into(), situation.into(), millions(row.batch.per_second), row.batch.gain.into()]);
    }
    Page {
        title: "Throughput of the laws",
        method: METHOD.replace("{points}", &batch::POINTS.to_string()),
        data,
        summaries: vec![
            ("Updates per second".into(), throughput),
            ("Batches against single calls, stress only".into(), batches),
        ],
        notes: Vec::new(),
        figures: vec![figure(solids, rows)],
        failed: None,
    }
}

fn figure(solids: &[Solid], rows: &[Row]) -> Figure {
    let line = |(color, situation): (usize, Situation)| Line {
        label: situation.name().into(),
        points: rows
            .iter()
            .filter(|row| row.situation == situation)
            .map(|row| (row.solid as f64, row.batch.gain))
            .collect(),
        columns: ("law".into(), "single_over_batch_time".into()),
        style: Style { color, dash: 0 },
        marked: true,
    };
    Figure {
        name: "batch".into(),
        title: "Single calls over batches, stress only".into(),
        x: Quantity { name: String::new(), unit: String::new() },
        y: Quantity { name: "time ratio".into(), unit: String::new() },
        lines: Situation::ALL.into_iter().enumerate().map(line).collect(),
        marks: Vec::new(),
        scale: Scale::Names(solids.iter().map(|solid| solid.law.split('_').next().unwrap_or("").to_owned()).collect()),
        key: None,
        equal_units: false,
    }
}
