//! Battery and references here; what the law must show in experiments, energies, crack band and
//! calibration in the files of `test/`.

mod crack_band;
mod energy;
mod extremes;
mod fixed_crack;
mod implex;
mod phase_field;
mod strength;

use super::*;
use battery::pages::{PARAMETERS, STATES};
use battery::samples::concrete_damage::*;
use battery::{PATH_COUNTS, Point, Promises, Random, STRESS_STATES, Sample, battery, check_path_exactness, reference};
use std::sync::LazyLock;
use umat_abi::law::{StressState, parameters_of};

/// Positions in STATEV.
const CRACK_BAND: usize = 4;
const INELASTIC_STRAIN: usize = 5;
const DISSIPATED_ENERGY_STATE: usize = 12;

/// Reference sets (README of `tests/reference`), IV-H.
const B094: [f64; 14] =
    [31800.0, 0.18, 7000.0, 1.1, 1.926098e-4, 31.52083, 0.94, 3e-4, 0.23441, 0.0, 0.0, 0.0, 0.0, 0.0];
const B120: [f64; 14] =
    [31800.0, 0.18, 7000.0, 1.1, 1.926098e-4, 32.25788, 1.2, 3e-4, 0.10988, 0.0, 0.0, 0.0, 0.0, 0.0];

/// A path under free sides: the axial strain is given, the other one follows from a stress ratio.
struct StressRatio<'p> {
    point: Point<'p, ConcreteDamage>,
    /// σ22/σ11: 0 for uniaxial stress.
    ratio: f64,
}

impl<'p> StressRatio<'p> {
    fn virgin(props: &'p [f64; 14], ratio: f64) -> Self {
        Self { point: Point::virgin(props, StressState::PlaneStress), ratio }
    }

    /// Goes to an axial strain; returns the axial stress.
    fn advance(&mut self, axial: f64) -> f64 {
        let mut strain = self.point.strain;
        strain[0] = axial;
        let (mut below, mut above) = (f64::NEG_INFINITY, f64::INFINITY);
        for _ in 0..200 {
            let (response, _) = self.point.trial(&strain);
            let (s, c) = (response.stress, response.tangent);
            let residual = s[1] - self.ratio * s[0];
            if residual < 0.0 {
                below = strain[1]
            } else {
                above = strain[1]
            }
            let newton = strain[1] - residual / (c[1][1] - self.ratio * c[0][1]);
            let leaves = newton <= below || newton >= above;
            let next = if leaves && (above - below).is_finite() { 0.5 * (below + above) } else { newton };
            let step = next - strain[1];
            strain[1] = next;
            if step.abs() <= 1e-16 * axial.abs() {
                break;
            }
        }
        let stress = self.point.advance(&strain).stress;
        assert!((stress[1] - self.ratio * stress[0]).abs() <= 1e-6 * stress[0].abs().max(1e-3), "{stress:?}");
        stress[0]
    }

    /// The largest |σ11| up to an axial strain.
    fn peak(mut self, end: f64, count: u32) -> f64 {
        (1..=count).map(|i| self.advance(end * f64::from(i) / f64::from(count)).abs()).fold(0.0, f64::max)
    }
}

#[test]
fn reproduces_the_forty_digit_references() {
    let plastic = with(B120, &[("b_t", 0.3), ("b_c", 0.3)]);
    for (set, props) in [("IVH_b094", B094), ("IVH_b120", B120), ("IVHP_b120", plastic)] {
        for path in ["bi_c1_052", "bi_c1_1", "bi_t1_055", "bi_t1_1", "cyclic", "shear", "unicomp", "unitens"] {
            let file = format!("{set}_{path}.csv");
            reference::check::<ConcreteDamage>(&file, StressState::ThreeD, &props, &[("D_t", 0), ("D_c", 1)]);
        }
    }
}

static VARIANTS: LazyLock<[([f64; 14], Option<f64>); 5]> = LazyLock::new(variants);

/// Properties that a variant guarantees.
fn promises(number: usize) -> Promises<'static> {
    Promises {
        samples: vec![sample(&VARIANTS[number])],
        histories: 300,
        monotone: &["eta_t", "eta_c", "Y_t_max", "Y_c_max"],
        dissipative: true,
        steady: true,
        history: &["eta_t", "eta_c", "Y_t_max", "Y_c_max"],
        elastic_strain: |_| 3e-5,
        path_ends: &[
            [1.0, -1.0 / 6.0, -2.0 / 15.0, 1.0 / 3.0, 0.0, 0.0],
            [-20.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0, 10.0 / 3.0, 0.0, 0.0],
            [10.0 / 3.0, -10.0 / 3.0, 0.0, 0.0, 0.0, 0.0],
            [-10.0, -20.0 / 3.0, 0.0, 10.0 / 3.0, 0.0, 0.0],
        ],
        random_paths: [20, 2],
        // without inelastic strain and confinement
        path_counts: |sample, _| {
            let props = parameters_of::<ConcreteDamage>(sample.props).expect("parameters");
            if props.b_t == 0.0 && props.b_c == 0.0 && props.zeta_c == 0.0 { &PATH_COUNTS } else { &[] }
        },
    }
}

battery!(hyperelastic: ConcreteDamage, promises(0), pages: ["concrete_damage/doc.md": &[PARAMETERS, STATES]]);
battery!(inelastic: ConcreteDamage, promises(1));
battery!(confined: ConcreteDamage, promises(2));
battery!(banded: ConcreteDamage, promises(3));
battery!(inelastic_banded_and_confined: ConcreteDamage, promises(4));

/// IV-HP splits with K_c(D_c,n): exact where crushing and open cracks do not meet, else of first order.
#[test]
fn increments_with_inelastic_strain_converge() {
    let props = with(defaults(), &[("b_t", 0.3), ("b_c", 0.3)]);
    for path in [[3e-4, -5e-5, -4e-5, 1e-4, 0.0, 0.0], [-3e-3, -2e-3, 0.0, 1e-3, 0.0, 0.0]] {
        let counts = [1, 10, 1000, 20_000];
        check_path_exactness::<ConcreteDamage>(&Sample::new(&props, 1e-3), StressState::ThreeD, &path, &counts);
    }
    let stress_after = |count: u32| {
        let mut point = Point::<ConcreteDamage>::virgin(&props, StressState::ThreeD);
        for i in 1..=count {
            point.advance(&[-2e-3, 4e-4, 1e-4, 1e-3, 0.0, 0.0].map(|x| x * f64::from(i) / f64::from(count)));
        }
        point.stress[0]
    };
    let limit = stress_after(50_000);
    let errors = [10, 100, 1000].map(|count| (stress_after(count) / limit - 1.0).abs());
    assert!(errors[0] < 5e-4 && errors[1] < 0.2 * errors[0] && errors[2] < 0.2 * errors[1], "{errors:?}");
}
