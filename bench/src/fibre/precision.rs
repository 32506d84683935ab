//! Error of peak and work against run time.

use super::{LARGEST_INCREMENT, Specimen};
use crate::page::Page;
use crate::runs::Ran;
use crate::table::{Cell, Table};
use crate::{BenchError, Settings};
use pullout_report::plots::figure::{Figure, Line, Scale, Style};
use pullout_report::plots::quantity::Quantity;

/// Factors on all sizes of the mesh, the finest last: it is what the others are compared with.
const MESHES: [f64; 5] = [2.0, 1.41, 1.0, 0.71, 0.5];
/// Inclinations, degrees, with largest increments, mm, the finest last. Cracks at the exit of an inclined fibre let no
/// increment grow to more than the first of its own.
const ANGLES: [(u32, [f64; 5]); 2] =
    [(0, [0.08, 0.04, 0.02, 0.01, 0.005]), (45, [5e-3, 2.5e-3, 1.25e-3, 6.25e-4, 3.125e-4])];
/// The mesh while the increment is varied.
const USUAL_MESH: f64 = 1.0;
/// Both peaks lie before it, mm.
const END: f64 = 0.3;
const QUICK_END: f64 = 0.002;

/// Quantity that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Varied {
    Mesh,
    Increment,
}

impl Varied {
    const ALL: [Self; 2] = [Self::Mesh, Self::Increment];

    fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Increment => "increment",
        }
    }
}

struct Level {
    angle: u32,
    varied: Varied,
    value: f64,
    ran: Ran,
    /// Errors of the greatest load and of the work, relative to the finest level, which has none.
    errors: Option<[f64; 2]>,
}

/// All levels.
pub(crate) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let (levels, end) = if settings.quick { (2, QUICK_END) } else { (MESHES.len(), END) };
    let specimen = Specimen::new(settings, end)?;
    let mut rows = Vec::new();
    for (angle, increments) in ANGLES {
        for varied in Varied::ALL {
            let values = if varied == Varied::Mesh { MESHES } else { increments };
            let mut of_series = Vec::new();
            for value in &values[..levels] {
                let (mesh, increment) =
                    if varied == Varied::Mesh { (*value, LARGEST_INCREMENT) } else { (USUAL_MESH, *value) };
                let set = [format!("mesh.specimen.angle_deg={angle}"), format!("mesh.specimen.mesh_size={mesh}")];
                let ran = specimen.run(increment, &set)?;
                of_series.push(Level { angle, varied, value: *value, ran, errors: None });
            }
            compare(&mut of_series);
            rows.extend(of_series);
        }
    }
    Ok(page(&rows, end))
}

/// The greatest load and the work.
fn results(ran: &Ran) -> [f64; 2] {
    [ran.findings.peak_load.as_ref().map_or(f64::NAN, |peak| peak.load), ran.end[2]]
}

fn compare(series: &mut [Level]) {
    let Some((finest, others)) = series.split_last_mut() else { return };
    let reference = results(&finest.ran);
    for level in others {
        let own = results(&level.ran);
        level.errors = Some([0, 1].map(|k| (own[k] / reference[k] - 1.0).abs()));
    }
}

const METHOD: &str = "\
The base case of chapter 7 (`cases/chapter-7/inclined-fibre.json`: bent fibre, `concrete_damage_implex`, crack band, friction) pulled by
{end} mm, behind the peak. *mesh*: a factor on all sizes, with increments up to {increment} mm; *increment*: the largest one, mm, with
the usual mesh. Errors are relative to the finest level of their series. Time is that of the processor, of one run each.
*Where the time goes*: parts of the analysis by the clock; the rest goes to vectors, judgements and output.";

fn page(rows: &[Level], end: f64) -> Page {
    let mut data = Table::new([
        "angle_deg",
        "varied",
        "value",
        "freedoms",
        "increments",
        "iterations",
        "cpu_s",
        "peak_N",
        "peak_error",
        "work_Nmm",
        "work_error",
        "energy_error",
        "solids_s",
        "contact_s",
        "assembly_s",
        "factorisation_s",
        "solution_s",
        "analysis_s",
    ]);
    let mut errors =
        Table::new(["angle [°]", "varied", "value", "freedoms", "increments", "CPU [s]", "peak error", "work error"]);
    let mut split = Table::new([
        "angle [°]",
        "mesh",
        "freedoms",
        "solids [%]",
        "contact [%]",
        "assembly [%]",
        "factorisation [%]",
        "solution [%]",
        "rest [%]",
    ]);
    for Level { angle, varied, value, ran, errors: error } in rows {
        let [peak, work] = results(ran);
        let time = |name: &str| ran.findings.times.get(name).copied().unwrap_or(f64::NAN);
        let parts = ["solids", "contact", "assembly", "factorisation", "solution"]
            .map(|name| time(&format!("analysis_{name}")));
        let [peak_error, work_error] = [0, 1].map(|k| Cell::from(error.map(|error| error[k])));
        let angle = || Cell::from(u64::from(*angle));
        data.push([
            angle(),
            varied.name().into(),
            (*value).into(),
            ran.freedoms.into(),
            ran.statistics.increments.into(),
            ran.statistics.iterations.into(),
            ran.seconds.into(),
            peak.into(),
            peak_error.clone(),
            work.into(),
            work_error.clone(),
            ran.findings.energy_error_max.into(),
            parts[0].into(),
            parts[1].into(),
            parts[2].into(),
            parts[3].into(),
            parts[4].into(),
            time("analysis").into(),
        ]);
        errors.push([
            angle(),
            varied.name().into(),
            (*value).into(),
            ran.freedoms.into(),
            ran.statistics.increments.into(),
            ran.seconds.into(),
            peak_error,
            work_error,
        ]);
        if *varied == Varied::Mesh {
            let whole = time("analysis");
            let share = |part: f64| Cell::from(100.0 * part / whole);
            split.push([
                angle(),
                (*value).into(),
                ran.freedoms.into(),
                share(parts[0]),
                share(parts[1]),
                share(parts[2]),
                share(parts[3]),
                share(parts[4]),
                share(whole - parts.iter().sum::<f64>()),
            ]);
        }
    }
    Page {
        title: "Cost and error of a pull-out",
        method: METHOD.replace("{end}", &end.to_string()).replace("{increment}", &LARGEST_INCREMENT.to_string()),
        data,
        summaries: vec![("Error against time".into(), errors), ("Where the time goes".into(), split)],
        notes: Vec::new(),
        figures: vec![
            figure("peak", "Error of the greatest load", rows, 0),
            figure("work", "Error of the work", rows, 1),
        ],
        failed: None,
    }
}

fn figure(name: &str, title: &str, rows: &[Level], quantity: usize) -> Figure {
    let line = |(color, angle): (usize, u32), (dash, varied): (usize, Varied)| Line {
        label: format!("{angle}°, {}", varied.name()),
        points: rows
            .iter()
            .filter(|level| level.angle == angle && level.varied == varied)
            .filter_map(|level| Some((level.ran.seconds, level.errors?[quantity])))
            .filter(|(_, error)| *error > 0.0)
            .collect(),
        columns: ("cpu_s".into(), format!("{name}_error")),
        style: Style { color, dash },
        marked: true,
    };
    let series = ANGLES.into_iter().enumerate().flat_map(|(number, (angle, _))| {
        Varied::ALL.into_iter().enumerate().map(move |varied| ((number, angle), varied))
    });
    Figure {
        name: name.into(),
        title: format!("{title}, against the finest level"),
        x: Quantity { name: "CPU time".into(), unit: "s".into() },
        y: Quantity { name: "relative error".into(), unit: String::new() },
        lines: series.map(|(angle, varied)| line(angle, varied)).filter(|line| !line.points.is_empty()).collect(),
        marks: Vec::new(),
        scale: Scale::BothDecades,
        key: None,
        equal_units: false,
    }
}
