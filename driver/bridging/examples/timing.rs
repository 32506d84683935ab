//! CPU times of what is run most: `cargo run --release -p pullout-bridging --example timing` (Linux).

use pullout_bridging::{
    Beam, Bond, BondLaw, BridgingFibre, Closed, Composite, Curve, Debonding, Fibre, Inclination, Matrix, NotchedBeam,
    Orientation, Scatter, SectionLaw, ShearLag, Sides, Sliding, Softening, Table, averages, scatter,
};
use std::f64::consts::PI;

const OPENINGS: usize = 200;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let fibre = Fibre { diameter: 0.5, length: 30.0, modulus: 210_000.0, strength: Some(1100.0), rupture_f: 0.3 };
    let matrix = Matrix { modulus: 3e4, ft: 3.0, softening: Softening::Exponential, fracture_energy: 0.1, fc: None };
    let openings: Vec<f64> = (0..OPENINGS).map(|k| 3.5 * (k as f64 / (OPENINGS - 1) as f64).powi(2)).collect();
    let friction = Closed {
        tau: 3.0,
        beta: 0.0,
        debonding_energy: 0.0,
        debonding: Debonding::Elastic,
        sliding: Sliding::Shortening,
    };
    let traction = |slip: f64| if slip < 0.02 { 150.0 * slip } else { 3.0 * (slip / 0.02).powf(-0.2) };
    let lag = Bond::ShearLag(ShearLag { law: BondLaw::sampled(traction, &[0.02], 20.0) });
    let spalling = Inclination::Spalling { k: 0.35, k_sp: 20.0, ft: 3.0 };
    let exp = Inclination::default();
    let composite = |fibre: BridgingFibre| Composite::new(fibre, 0.01, &Orientation::Random3d, matrix, 0.0);
    for (name, bond, inclination, sides) in [
        ("closed, one side", Bond::Closed(friction), exp, Sides::One),
        ("closed, two sides", Bond::Closed(friction), exp, Sides::Two),
        ("closed, two sides, spalling", Bond::Closed(friction), spalling, Sides::Two),
        ("shear lag, one side", lag.clone(), exp, Sides::One),
        ("shear lag, two sides", lag.clone(), exp, Sides::Two),
        ("shear lag, two sides, no rupture", lag, exp, Sides::Two),
    ] {
        let strength = fibre.strength.filter(|_| !name.ends_with("no rupture"));
        let fibre = Fibre { strength, ..fibre };
        let start = cpu_time();
        let composite = composite(BridgingFibre::new(fibre, &bond, inclination, sides, 0.0)?)?;
        let prepared = cpu_time() - start;
        report(name, &composite, &openings, prepared, start);
    }
    let curve = |angle_deg: f64, embedded: f64| {
        let slip: Vec<f64> = (0..=400).map(|k| embedded * (f64::from(k) / 400.0).powi(2)).collect();
        let rise = |slip: f64| (slip / 0.02).min(1.0).sqrt();
        let load =
            slip.iter().map(|&s| PI * 0.5 * 3.0 * (embedded - s) * rise(s) * (0.3 * angle_deg.to_radians()).exp());
        Curve { angle_deg, embedded, load: load.collect(), slip }
    };
    let curves: Vec<Curve> = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0]
        .iter()
        .flat_map(|&angle| [1.875, 3.75, 7.5, 11.25, 15.0].map(|length| curve(angle, length)))
        .collect();
    for (name, sides) in [("table, one side", Sides::One), ("table, two sides", Sides::Two)] {
        let start = cpu_time();
        let table = Table::new(&curves, 80.0, 30.0)?;
        let composite = composite(BridgingFibre::of_table(fibre, table, sides)?)?;
        let prepared = cpu_time() - start;
        report(name, &composite, &openings, prepared, start);
    }
    let composite = composite(BridgingFibre::new(fibre, &Bond::Closed(friction), exp, Sides::Two, 0.0)?)?;
    let cmods: Vec<f64> = (0..80).map(|k| 4.0 * (f64::from(k) / 79.0).powi(2)).collect();
    let start = cpu_time();
    let beams = scatter(&composite, &NotchedBeam::default(), &openings, &cmods, &Scatter::default())?;
    println!("{} beams: {:.2} s", beams.residual.len(), (cpu_time() - start));
    let law = composite.law_to(4.0, OPENINGS);
    let start = cpu_time();
    let section = [SectionLaw::new(&matrix, &law, 62.5)];
    let residual = Beam::new(NotchedBeam::default(), &section, &matrix).residual();
    println!("one beam: {:.2} ms, {residual:?}", 1e3 * (cpu_time() - start));
    Ok(())
}

fn report(name: &str, composite: &Composite, openings: &[f64], prepared: f64, start: f64) {
    let results = averages(composite, openings);
    let error = results.iter().map(|average| average.error / average.stress.max(1e-9)).fold(0.0, f64::max);
    let [all, prepared] = [cpu_time() - start, prepared].map(|time| 1e3 * time);
    println!("{name}: {all:.1} ms, of which {prepared:.1} ms once; greatest relative error {error:.1e}");
}

/// Returns the CPU time of all threads, s.
fn cpu_time() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let nanoseconds = tasks.filter_map(|task| {
        let text = std::fs::read_to_string(task.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    });
    1e-9 * nanoseconds.sum::<f64>()
}
