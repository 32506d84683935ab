//! The checks every law must pass, whatever its equations: consistent tangent against differences,
//! rotation invariance, monotone damage, dissipation, virgin state. One macro call a law.

pub mod energy;
pub mod interface;
pub mod peak;
pub mod reference;
pub mod stability;
pub mod uniaxial;

use crate::linear_elastic::LinearElastic;
use crate::tensor::{Elasticity, Spectral};
use umat_abi::law::{Increment, Law, Request, Response, StressState, check_properties};

/// Deterministic pseudo-random numbers (splitmix64), so that a failing state can be named.
pub struct Random(pub u64);

impl Random {
    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in [−1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// A strain of the given size with all components of the stress state.
    pub fn strain(&mut self, stress_state: StressState, size: f64) -> [f64; 6] {
        let mut strain = [0.0; 6];
        for &i in stress_state.components() {
            strain[i] = size * self.signed() * if i < 3 { 1.0 } else { 1.4 };
        }
        strain
    }

    /// A proper rotation.
    pub fn rotation(&mut self) -> [[f64; 3]; 3] {
        let symmetric: [f64; 6] = std::array::from_fn(|_| self.signed());
        let mut axes = Spectral::of_stress(&symmetric).directions;
        let [a, b, c] = axes;
        let determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        if determinant < 0.0 {
            axes[2] = axes[2].map(|x| -x);
        }
        axes
    }

    /// A rotation that the stress state can show: in the plane states about axis 3.
    pub fn rotation_in(&mut self, stress_state: StressState) -> [[f64; 3]; 3] {
        if stress_state == StressState::ThreeD {
            return self.rotation();
        }
        let (s, c) = (std::f64::consts::TAU * self.unit()).sin_cos();
        [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
    }
}

/// A parameter set and what it is tried at.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'p> {
    pub props: &'p [f64],
    /// About the strain at the peak or at first yield.
    pub size: f64,
    pub characteristic_length: Option<f64>,
}

impl<'p> Sample<'p> {
    pub fn new(props: &'p [f64], size: f64) -> Self {
        Self { props, size, characteristic_length: None }
    }

    /// From a table of parameter sets.
    pub fn all<const N: usize>(sets: &'p [([f64; N], f64)]) -> Vec<Self> {
        sets.iter().map(|(props, size)| Self::new(props, *size)).collect()
    }

    /// A virgin point.
    pub fn point<L: Law>(&self, stress_state: StressState) -> Point<'p, L> {
        let mut point = Point::virgin(self.props, stress_state);
        point.characteristic_length = self.characteristic_length;
        point
    }

    /// A strain of a decade less to a decade more than the size, so that elastic, peak and tail states all occur.
    pub fn strain(&self, random: &mut Random, stress_state: StressState) -> [f64; 6] {
        let scale = self.size * 10_f64.powf(2.0 * random.unit() - 1.0);
        random.strain(stress_state, scale)
    }
}

/// A material point of law `L`, driven directly.
pub struct Point<'p, L: Law> {
    pub parameters: L::Parameters<'p>,
    pub stress_state: StressState,
    pub strain: [f64; 6],
    pub stress: [f64; 6],
    pub state: Vec<f64>,
    pub characteristic_length: Option<f64>,
}

impl<'p, L: Law> Point<'p, L> {
    pub fn virgin(props: &'p [f64], stress_state: StressState) -> Self {
        check_properties(&L::INFO, props).expect("properties within bounds");
        Self {
            parameters: L::parameters(props).expect("consistent properties"),
            stress_state,
            strain: [0.0; 6],
            stress: [0.0; 6],
            state: vec![0.0; L::INFO.states.len()],
            characteristic_length: None,
        }
    }

    /// The response at a strain from the committed state, which stays as it is.
    pub fn trial(&self, strain: &[f64; 6]) -> (Response, Vec<f64>) {
        let mut state = self.state.clone();
        let increment = Increment {
            stress_state: self.stress_state,
            strain: *strain,
            strain_increment: std::array::from_fn(|i| strain[i] - self.strain[i]),
            stress: self.stress,
            characteristic_length: self.characteristic_length,
        };
        let response = L::update(&self.parameters, &increment, &mut state, Request::StressAndTangent)
            .unwrap_or_else(|failure| panic!("{failure:?} at {strain:?} from {:?}", self.state));
        (response, state)
    }

    /// Goes to a strain and commits.
    pub fn advance(&mut self, strain: &[f64; 6]) -> Response {
        let (response, state) = self.trial(strain);
        self.strain = *strain;
        self.stress = response.stress;
        self.state = state;
        response
    }
}

/// Relative errors below this are those of the differences, not of the tangent: no other step is tried.
const GOOD_DIFFERENCE: f64 = 1e-8;

/// How far C·d is from central differences of the stress along each of the directions d: the best of several
/// steps, relative to the largest tangent entry. Away from kinks this is rounding plus truncation.
pub fn directional_error<L: Law>(point: &Point<'_, L>, strain: &[f64; 6], directions: &[[f64; 6]]) -> f64 {
    let components = point.stress_state.components();
    let tangent = point.trial(strain).0.tangent;
    let scale = tangent.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let size = strain.iter().fold(1e-30_f64, |m, x| m.max(x.abs()));
    let mut best = f64::INFINITY;
    for relative_step in [1e-5, 1e-4, 1e-6, 1e-7] {
        let h = relative_step * size;
        let mut worst = 0.0_f64;
        for direction in directions {
            let stress_at =
                |factor: f64| point.trial(&std::array::from_fn(|i| strain[i] + factor * h * direction[i])).0.stress;
            let (far_plus, plus, minus, far_minus) = (stress_at(2.0), stress_at(1.0), stress_at(-1.0), stress_at(-2.0));
            for &i in components {
                // fourth-order central difference
                let slope = (8.0 * (plus[i] - minus[i]) - (far_plus[i] - far_minus[i])) / (12.0 * h);
                let expected: f64 = components.iter().map(|&j| tangent[i][j] * direction[j]).sum();
                worst = worst.max((slope - expected).abs());
            }
        }
        // a stress that is exactly constant (the apex of a cone) has nothing to scale by
        best = best.min(if worst == 0.0 { 0.0 } else { worst / scale });
        if best <= GOOD_DIFFERENCE {
            break;
        }
    }
    best
}

/// How far C·d is from the one-sided differences along d: the better side and the best of several steps. At a
/// kink the tangent must be that of one side.
pub fn one_sided_error<L: Law>(point: &Point<'_, L>, strain: &[f64; 6], direction: &[f64; 6]) -> f64 {
    let components = point.stress_state.components();
    let (response, _) = point.trial(strain);
    let scale = response.tangent.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let size = strain.iter().fold(1e-30_f64, |m, x| m.max(x.abs()));
    let mut best = f64::INFINITY;
    for h in [1e-5, 1e-4, 1e-6, -1e-5, -1e-4, -1e-6].map(|step| step * size) {
        let stress_at =
            |factor: f64| point.trial(&std::array::from_fn(|i| strain[i] + factor * h * direction[i])).0.stress;
        let (one, two, three) = (stress_at(1.0), stress_at(2.0), stress_at(3.0));
        let worst = components.iter().fold(0.0_f64, |worst, &i| {
            // third-order forward difference
            let slope = (-11.0 * response.stress[i] + 18.0 * one[i] - 9.0 * two[i] + 2.0 * three[i]) / (6.0 * h);
            let expected: f64 = components.iter().map(|&j| response.tangent[i][j] * direction[j]).sum();
            worst.max((slope - expected).abs())
        });
        best = best.min(if worst == 0.0 { 0.0 } else { worst / scale });
    }
    best
}

/// [`directional_error`] of every column of the tangent.
pub fn tangent_error<L: Law>(point: &Point<'_, L>, strain: &[f64; 6]) -> f64 {
    let unit = |j: usize| std::array::from_fn(|i| if i == j { 1.0 } else { 0.0 });
    let columns: [[f64; 6]; 6] = std::array::from_fn(|k| unit(*point.stress_state.components().get(k).unwrap_or(&0)));
    directional_error(point, strain, &columns[..point.stress_state.components().len()])
}

/// R ε Rᵀ for a strain (engineering shear) or, with `shear = 1`, a stress.
pub fn rotated(tensor: &[f64; 6], rotation: &[[f64; 3]; 3], shear: f64) -> [f64; 6] {
    let [a, b, c, d, e, f] = *tensor;
    let m = [[a, d / shear, e / shear], [d / shear, b, f / shear], [e / shear, f / shear, c]];
    let entry = |i: usize, j: usize| -> f64 {
        (0..3).map(|k| (0..3).map(|l| rotation[i][k] * m[k][l] * rotation[j][l]).sum::<f64>()).sum()
    };
    [entry(0, 0), entry(1, 1), entry(2, 2), shear * entry(0, 1), shear * entry(0, 2), shear * entry(1, 2)]
}

/// The three stress states.
pub const STRESS_STATES: [StressState; 3] =
    [StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric, StressState::PlaneStress];

/// What differences say about the tangents of random states.
#[derive(Clone, Copy, Debug, Default)]
pub struct TangentSummary {
    pub tried: usize,
    /// At kinks: the tangent itself jumps within the reach of the differences.
    pub excluded: usize,
    /// Of the others.
    pub worst: f64,
}

/// States of each stress state whose tangent is compared: the acceptance asks for 10 000.
const TANGENT_STATES: usize = 10_000;

/// Tangents of [`TANGENT_STATES`] random states of each stress state, spread over the samples; prints a row each.
pub fn check_tangents<L: Law>(label: &str, samples: &[Sample<'_>]) {
    for stress_state in STRESS_STATES {
        let mut sum = TangentSummary::default();
        for sample in samples {
            let one = check_tangent::<L>(sample, stress_state, TANGENT_STATES.div_ceil(samples.len()));
            sum.tried += one.tried;
            sum.excluded += one.excluded;
            sum.worst = sum.worst.max(one.worst);
        }
        let name = format!("{} {label}", L::INFO.name.to_string_lossy());
        println!(
            "tangent | {name:<38} | {:<25} | {:>6} states | {:>3} at kinks | worst {:.1e}",
            format!("{stress_state:?}"),
            sum.tried,
            sum.excluded,
            sum.worst
        );
    }
}

/// Random two-leg histories. Fails if a smooth state's tangent disagrees with differences, or if more than 5 % are
/// excluded.
pub fn check_tangent<L: Law>(sample: &Sample<'_>, stress_state: StressState, count: usize) -> TangentSummary {
    let mut random = Random(0x5EED);
    let mut summary = TangentSummary { tried: count, ..TangentSummary::default() };
    for number in 0..count {
        let mut point = sample.point::<L>(stress_state);
        let first = sample.strain(&mut random, stress_state);
        if random.unit() < 0.7 {
            point.advance(&first);
        }
        let strain = sample.strain(&mut random, stress_state);
        let error = tangent_error(&point, &strain);
        if error <= 1e-6 {
            summary.worst = summary.worst.max(error);
        } else if near_kink(&point, &strain, error) {
            summary.excluded += 1;
        } else {
            panic!(
                "{}: state {number}: tangent error {error:e} at {strain:?} from {:?}",
                L::INFO.name.to_string_lossy(),
                point.state
            );
        }
    }
    assert!(summary.excluded * 20 <= count, "{} of {count} states excluded as kinks", summary.excluded);
    summary
}

/// Whether the tangent itself jumps within the reach of the differences around this strain, so that no difference
/// quotient can be compared with it: by 2 % within that of the longest, or within that of the shorter ones by a
/// quarter of what the best of them is off. (Smooth tangents vary there by some 1e-5, and their differences are right to 1e-6.)
fn near_kink<L: Law>(point: &Point<'_, L>, strain: &[f64; 6], error: f64) -> bool {
    let size = strain.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let Response { tangent: here, stress, .. } = point.trial(strain).0;
    let scale = here.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let largest_stress = stress.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let close = (0.25 * error).min(2e-2);
    point.stress_state.components().iter().any(|&j| {
        [(-2e-4, 2e-2), (-2e-6, close), (2e-6, close), (2e-4, 2e-2)].into_iter().any(|(step, jump)| {
            let mut shifted = *strain;
            shifted[j] += step * size;
            let there = point.trial(&shifted).0.tangent;
            // where the stress itself jumps (model III of the thesis) the tangent has no scale
            let mut neighbour = *strain;
            neighbour[j] += 1e-12 * step.signum() * size;
            let beyond = point.trial(&neighbour).0.stress;
            stress.iter().zip(&beyond).any(|(a, b)| (a - b).abs() > 1e-10 * largest_stress)
                || here.iter().flatten().zip(there.iter().flatten()).any(|(a, b)| (a - b).abs() > jump * scale)
        })
    })
}

/// A rotated history gives the rotated stress, to 1e-12 of the largest stress. (In the plane states
/// the rotation is about axis 3.)
pub fn check_rotation<L: Law>(sample: &Sample<'_>, stress_state: StressState, count: usize) {
    let mut random = Random(0x0707);
    for _ in 0..count {
        let rotation = random.rotation_in(stress_state);
        let mut point = sample.point::<L>(stress_state);
        let mut turned = sample.point::<L>(stress_state);
        for _ in 0..3 {
            let strain = sample.strain(&mut random, stress_state);
            let stress = point.advance(&strain).stress;
            let turned_stress = turned.advance(&rotated(&strain, &rotation, 2.0)).stress;
            let expected = rotated(&stress, &rotation, 1.0);
            let largest = stress.iter().fold(1e-300_f64, |m, x| m.max(x.abs()));
            // a stress far below the elastic one is the difference of large numbers
            let elastic = strain.iter().fold(0.0_f64, |m, x| m.max(x.abs())) * sample.props[0];
            let tolerance = 1e-12 * largest + 1e-15 * elastic;
            for i in 0..6 {
                assert!(
                    (turned_stress[i] - expected[i]).abs() <= tolerance,
                    "{}: component {i}: {} against {} at {strain:?}",
                    L::INFO.name.to_string_lossy(),
                    turned_stress[i],
                    expected[i]
                );
            }
        }
    }
}

/// One, ten, … increments of a proportional path end at the same stress to 1e-12.
pub fn check_path_exactness<L: Law>(sample: &Sample<'_>, stress_state: StressState, strain: &[f64; 6], counts: &[u32]) {
    let mut reference: Option<[f64; 6]> = None;
    for &count in counts {
        let mut point = sample.point::<L>(stress_state);
        for step in 1..=count {
            let fraction = f64::from(step) / f64::from(count);
            point.advance(&strain.map(|x| fraction * x));
        }
        let expected = *reference.get_or_insert(point.stress);
        let largest = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for i in 0..6 {
            assert!(
                (point.stress[i] - expected[i]).abs() <= 1e-12 * largest,
                "{}: {count} increments: {:?} against {expected:?}",
                L::INFO.name.to_string_lossy(),
                point.stress
            );
        }
    }
}

/// Increments of a proportional path whose end stress must be the same.
pub const PATH_COUNTS: [u32; 4] = [1, 10, 1000, 100_000];

/// [`check_path_exactness`] in random directions to strains of a third of the size to ten times it: `many` with up
/// to 1000 increments, `few` with 100 000 as well.
pub fn check_random_paths<L: Law>(sample: &Sample<'_>, stress_state: StressState, many: usize, few: usize) {
    let mut random = Random(0x9A7B);
    for number in 0..many {
        let scale = sample.size * 10_f64.powf(1.5 * random.unit() - 0.5);
        let strain = random.strain(stress_state, scale);
        let counts = &PATH_COUNTS[..if number < few { 4 } else { 3 }];
        check_path_exactness::<L>(sample, stress_state, &strain, counts);
    }
}

/// All-zero STATEV is virgin: zero strain gives zero stress, zero states and the elastic tangent, bit for bit; a
/// strain below every threshold gives the elastic stress to a few units of the last digit and no damage.
pub fn check_virgin<L: Law>(sample: &Sample<'_>, stress_state: StressState, elastic_size: f64, history: &[&str]) {
    let elastic = Point::<LinearElastic>::virgin(&sample.props[..2], stress_state);
    let point = sample.point::<L>(stress_state);
    let (response, state) = point.trial(&[0.0; 6]);
    assert_eq!(response.stress, [0.0; 6]);
    assert!(state.iter().zip(L::INFO.states).all(|(x, variable)| *x == 0.0 || variable.name() == "crack_band"));
    let stiffness = elastic.trial(&[0.0; 6]).0.tangent;
    // of space: the linear law itself condenses plane stress out of it
    let modulus = Elasticity::new(sample.props[0], sample.props[1]).stiffness()[0][0];
    // ulps of the products that a stress or a tangent is the sum of
    let close = |a: &[f64], b: &[f64], scale: f64, ulps: f64| {
        a.iter().zip(b).all(|(x, y)| (x - y).abs() <= ulps * f64::EPSILON * scale)
    };
    assert!(close(response.tangent.as_flattened(), stiffness.as_flattened(), modulus, 4.0), "{:?}", response.tangent);
    let mut random = Random(0xE1A5);
    for _ in 0..100 {
        let scale = elastic_size * random.unit();
        let strain = random.strain(stress_state, scale);
        let ((response, state), (expected, _)) = (point.trial(&strain), elastic.trial(&strain));
        let (stress, linear) = (response.stress, expected.stress);
        assert!(close(&stress, &linear, modulus * scale, 4.0), "{stress:?} {linear:?} at {strain:?}");
        let tangent = response.tangent;
        assert!(close(tangent.as_flattened(), stiffness.as_flattened(), modulus, 16.0), "{tangent:?} {stiffness:?}");
        for (value, variable) in state.iter().zip(L::INFO.states) {
            assert!(*value == 0.0 || !history.contains(&variable.name()), "{} = {value}", variable.name());
        }
    }
}

/// On random histories: named states never decrease, dissipation never decreases (if the law
/// guarantees it), a call repeated gives the same bits, zero increments change nothing.
pub fn check_invariants<L: Law>(
    sample: &Sample<'_>,
    stress_state: StressState,
    count: usize,
    monotone: &[&str],
    dissipative: bool,
) {
    let mut random = Random(0xD155);
    let index =
        |name: &str| L::INFO.states.iter().position(|s| s.name() == name).unwrap_or_else(|| panic!("no state {name}"));
    let monotone: Vec<usize> = monotone.iter().map(|name| index(name)).collect();
    for _ in 0..count {
        let mut point = sample.point::<L>(stress_state);
        for _ in 0..6 {
            let scale = sample.size * 10_f64.powf(3.0 * random.unit() - 1.5);
            let strain = random.strain(stress_state, scale);
            let before = point.state.clone();
            let (first, first_state) = point.trial(&strain);
            let (again, again_state) = point.trial(&strain);
            assert_eq!(first.stress, again.stress);
            assert_eq!(first_state, again_state);
            let response = point.advance(&strain);
            assert!(response.stress.iter().chain(response.tangent.iter().flatten()).all(|x| x.is_finite()));
            for &k in &monotone {
                assert!(point.state[k] >= before[k], "{} decreased", L::INFO.states[k].name());
            }
            if dissipative {
                let last = point.state.len() - 1;
                assert!(point.state[last] >= before[last], "dissipation decreased at {strain:?} from {before:?}");
                assert_eq!(response.dissipated_energy, point.state[last]);
            }
            let (still, still_state) = point.trial(&strain);
            let largest = response.stress.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for i in 0..6 {
                assert!((still.stress[i] - response.stress[i]).abs() <= 1e-13 * largest);
            }
            for &k in &monotone {
                assert!((still_state[k] - point.state[k]).abs() <= 1e-13 * point.state[k].abs());
            }
        }
    }
}
