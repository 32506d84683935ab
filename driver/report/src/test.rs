//! A result directory from beginning to end, on a curve with a known formula.

use super::compare::compare;
use super::directory::{Access, Kind, ResultDirectory};
use super::history::{History, HistoryWriter};
use super::page::{self, Account};
use super::plots::{self, CaseKind, MeasuredCurve, Spec};
use super::summary::{PeakRecorder, PluginFile, Status, Summary};
use models::damage_law::{DamageLaw, damage, integrity};
use pullout_run::path::Row;
use pullout_run::program::Compare;
use std::path::Path;

const YOUNG: f64 = 31800.0;
/// Model I in compression (reference set I_t51c).
const LAW: DamageLaw = DamageLaw { a: 21.0, b: 1.05, threshold: 4e-4 };
const KARSAN_JIRSA: [(f64, f64); 9] = [
    (0.0, 0.0),
    (0.000301465, 9.679558011),
    (0.0005485, 15.61325967),
    (0.0008709, 21.04972376),
    (0.001364969, 25.88950276),
    (0.001863224, 27.54696133),
    (0.002625262, 26.55248619),
    (0.003621773, 22.60773481),
    (0.004869505, 16.44198895),
];

/// σ = (1 − D) E ε, Y = ½ E ε², with unloading at two strains.
fn rows() -> Vec<[f64; 5]> {
    let mut strain = vec![];
    for (turn, back) in [(-0.0015, -0.0009), (-0.003, -0.0012), (-0.0055, -0.0055)] {
        let start = strain.last().copied().unwrap_or(0.0);
        strain.extend((1..=60).map(|k| start + (turn - start) * f64::from(k) / 60.0));
        strain.extend((1..=40).map(|k| turn + (back - turn) * f64::from(k) / 40.0));
    }
    let mut eta: f64 = 0.0;
    let mut rows = vec![[0.0; 5]];
    for (k, strain) in strain.into_iter().enumerate() {
        eta = eta.max(LAW.eta(0.5 * YOUNG * strain * strain));
        let stress = integrity(eta) * YOUNG * strain;
        rows.push([0.01 * (k + 1) as f64, strain, -0.18 * strain, stress, damage(eta)]);
    }
    rows
}

/// Writes everything a run leaves.
pub(super) fn result_directory(folder: &Path) -> Summary {
    let mut directory = ResultDirectory::open(folder, Kind::Run, Access::default()).unwrap();
    directory.begin(&[]).unwrap();
    let columns = ["step", "increment", "time", "e11", "e22", "s11", "D", "iterations"].map(String::from);
    let mut writer = HistoryWriter::create(&folder.join("history.csv"), &columns, false).unwrap();
    let mut recorder = PeakRecorder::new(&columns);
    for (k, values) in rows().iter().enumerate() {
        let row = Row { step: k.min(1) as u32, increment: k as u32, values, iterations: k.min(1) as u32 };
        writer.write(&row).unwrap();
        recorder.observe(&row);
    }
    let history = History::read(&folder.join("history.csv")).unwrap();
    let measured = Compare {
        file: "data/karsan_jirsa_1969.csv".into(),
        points: KARSAN_JIRSA.to_vec(),
        file_x: "strain".into(),
        file_y: "stress_MPa".into(),
        x: 3,
        y: 5,
        scale_x: -1.0,
        scale_y: -1.0,
        label: "Karsan & Jirsa 1969".into(),
    };
    let points = measured.points.iter().map(|(x, y)| (-x, -y)).collect();
    let spec = Spec {
        title: "Model I, uniaxial compression (Karsan & Jirsa 1969)".into(),
        law: "pure_damage".into(),
        subject: CaseKind::Point { controlled: vec![0] },
        units: Default::default(),
        curves: vec![MeasuredCurve { label: measured.label.clone(), x: "e11".into(), y: "s11".into(), points }],
        inputs: Default::default(),
        captions: Default::default(),
    };
    let drawings = plots::draw(&mut directory, "plots", &history, &spec).unwrap();
    let mut summary = Summary {
        failed_at: None,
        reached: None,
        status: Status::Done,
        message: None,
        title: spec.title.clone(),
        plugin: PluginFile { path: "libpure_damage.so".into(), version: "0.1.0".into(), sha256: "00".repeat(32) },
        plugins: vec![],
        peaks: recorder.peaks(),
        increments: 300,
        iterations: 812,
        plugin_calls: 1112,
        cutbacks: 0,
        wall_time_s: 0.0123,
        cpu_time_s: Some(0.0121),
        compare: vec![compare(&history, &measured).unwrap()],
        specimen: None,
        bridging: None,
        warnings: vec![],
        notes: vec![],
    };
    directory.write(crate::summary::FILE, summary.text().unwrap()).unwrap();
    let account = Account { law: spec.law.clone(), mode: "3-D".into(), ..Account::default() };
    page::write(&mut directory, &account, &mut summary, &drawings, None).unwrap();
    directory.finish().unwrap();
    summary
}

#[test]
fn a_whole_result_directory() {
    let folder = tempfile::tempdir().unwrap();
    let summary = result_directory(folder.path());
    let names = ["history.csv", "summary.json", "report.html", "plots/stress_strain.svg", "plots/damage_strain.svg"];
    for name in names {
        assert!(folder.path().join(name).metadata().unwrap().len() > 100, "{name}");
    }
    // the envelope ends at the first reversal, ε = −0.0015: the first five points
    let comparison = &summary.compare[0];
    assert_eq!((comparison.points, comparison.outside), (5, 4));
    let strain: [f64; 5] = std::array::from_fn(|k| KARSAN_JIRSA[k].0);
    let formula = strain.map(|e| integrity(LAW.eta(0.5 * YOUNG * e * e)) * YOUNG * e);
    let squares: f64 = formula.iter().zip(&KARSAN_JIRSA).map(|(s, point)| (s - point.1).powi(2)).sum();
    let error = comparison.rms.unwrap() - (squares / 5.0).sqrt();
    // linear interpolation between rows: σ'' h²/8 < 0.002 MPa
    assert!(error.abs() < 0.01, "{error}");
    let spec = Spec::read(&folder.path().join("plots").join(plots::SPEC_FILE)).unwrap();
    assert_eq!(spec.curves[0].points[4], (-0.001364969, -25.88950276));
}

/// `cargo test -p driver -- --ignored a_sample_to_look_at`
#[test]
#[ignore = "leaves a result directory in the folder for temporary files, for eyes"]
fn a_sample_to_look_at() {
    let folder = std::env::temp_dir().join("pullout_sample");
    std::fs::create_dir_all(&folder).unwrap();
    result_directory(&folder);
    println!("{}", folder.display());
}
