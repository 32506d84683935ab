//! Outcome of a run, as the command line prints it.

use crate::summary::{Status, Summary};
use pullout_case::Case;
use pullout_run::columns;
use pullout_run::number::significant;
use pullout_run::program::{PointKind, STRESS_NAMES};
use std::fmt::Write;
use std::path::Path;

/// Returns in lines how a run ended, what it cost, its greatest and least stresses, MPa, or loads, N, and how far it is from
/// measured curves. `folder`: where its results are.
pub fn of_run(summary: &Summary, case: &Case, folder: &Path) -> String {
    let done = match summary.status {
        Status::Done => "done",
        Status::Failed => "FAILED",
        Status::Interrupted => "interrupted",
    };
    let effort = match case {
        Case::Bridging(_) => String::new(),
        _ => format!("{} increments, {} plugin calls, ", summary.increments, summary.plugin_calls),
    };
    let mut text = format!("{}: {done}, {effort}{:.3} s -> {}\n", case.name(), summary.wall_time_s, folder.display());
    text.push_str(&of_bridging(summary));
    for highlight in &case.about().highlights {
        let _ = writeln!(text, "  {highlight}");
    }
    let interesting = match case {
        Case::Path(program) => match &program.kind {
            PointKind::Point(_) => &STRESS_NAMES[..],
            PointKind::Interface(_) => &["tau", "p"],
        },
        Case::Pullout(_) => &["load", "load_lateral"],
        Case::Bridging(_) => &[],
    };
    let peaks = summary.peaks_without_rounding();
    for name in interesting {
        if let Some(peak) = peaks.get(name)
            && let (Some(max), Some(min)) = (peak.max, peak.min)
            && (max != 0.0 || min != 0.0)
        {
            let unit = columns::shown(name).map_or("", |(_, unit, _)| unit);
            let [max, min] = [max, min].map(|value| significant(value, 8));
            let _ = writeln!(text, "  {name}: max {max} {unit}, min {min} {unit}");
        }
    }
    for comparison in &summary.compare {
        let _ = match comparison.rms {
            Some(rms) => {
                writeln!(text, "  {}: RMS {rms:.4} over {} points", comparison.file, comparison.points)
            }
            None => writeln!(text, "  {}: no point within the path's range", comparison.file),
        };
    }
    text
}

/// Stress, strengths and scatter of the beams of a run of kind "bridging"; nothing for others.
fn of_bridging(summary: &Summary) -> String {
    let mut text = String::new();
    let Some(findings) = &summary.bridging else { return text };
    // writing to a String cannot fail
    let _ = writeln!(
        text,
        "  sigma: max {} MPa at w = {} mm; of the fibres {} MPa at {} mm, eta {}, {} per cm²",
        number(findings.sigma_peak),
        number(findings.w_peak),
        number(findings.sigma_fibre_peak),
        number(findings.w_fibre_peak),
        number(findings.efficiency),
        number(findings.fibres_per_cm2)
    );
    if let Some(beam) = &findings.beam {
        let residual = beam.residual.map(number).join(", ");
        let _ = writeln!(text, "  f_L {} MPa, f_R1–4 {residual} MPa", number(beam.limit));
    }
    if let Some(scatter) = &findings.scatter {
        let residual = scatter.residual.map(|spread| number(spread.characteristic)).join(", ");
        let [class, eurocode] =
            [&scatter.class, &scatter.class_en_1992_2023].map(|class| class.as_deref().unwrap_or("none"));
        let _ = writeln!(
            text,
            "  of {} beams: f_R1k–4k {residual} MPa, class {class} (Model Code 2010), {eurocode} (EN 1992-1-1:2023)",
            scatter.beams
        );
    }
    text
}

fn number(value: f64) -> String {
    significant(value, 4)
}
