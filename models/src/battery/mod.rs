//! The checks every law must pass, whatever its equations: consistent tangent against differences,
//! rotation invariance, monotone damage, dissipation, virgin state. One macro call a law.

pub mod energy;
pub mod extremes;
pub mod interface;
pub mod peak;
pub mod reference;
pub mod uniaxial;

use crate::tensor::Spectral;
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

/// How far the tangent is from central differences: the best of several steps, relative to the
/// largest tangent entry. Away from kinks this is rounding plus truncation, ~1e-9.
pub fn tangent_error<L: Law>(point: &Point<'_, L>, strain: &[f64; 6]) -> f64 {
    let components = point.stress_state.components();
    let (response, _) = point.trial(strain);
    let scale = components
        .iter()
        .flat_map(|&i| components.iter().map(move |&j| (i, j)))
        .fold(0.0_f64, |m, (i, j)| m.max(response.tangent[i][j].abs()));
    let size = strain.iter().fold(1e-12_f64, |m, x| m.max(x.abs()));
    let mut best = f64::INFINITY;
    for relative_step in [1e-4, 1e-5, 1e-6] {
        let h = relative_step * size;
        let mut worst = 0.0_f64;
        for &j in components {
            let shifted = |factor: f64| {
                let mut shifted = *strain;
                shifted[j] += factor * h;
                point.trial(&shifted).0.stress
            };
            let (far_plus, plus, minus, far_minus) = (shifted(2.0), shifted(1.0), shifted(-1.0), shifted(-2.0));
            for &i in components {
                // fourth-order central difference
                let slope = (8.0 * (plus[i] - minus[i]) - (far_plus[i] - far_minus[i])) / (12.0 * h);
                worst = worst.max((slope - response.tangent[i][j]).abs());
            }
        }
        // a stress that is exactly constant (the apex of a cone) has nothing to scale by
        best = best.min(if worst == 0.0 { 0.0 } else { worst / scale });
    }
    best
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

/// Random two-leg histories; returns (tried, excluded): states whose tangent disagrees with
/// differences at every step *and* whose one-sided differences disagree with each other, that is,
/// kinks. Fails if a smooth state disagrees.
pub fn check_tangent<L: Law>(props: &[f64], stress_state: StressState, size: f64, count: usize) -> (usize, usize) {
    let mut random = Random(0x5EED);
    let mut excluded = 0;
    for number in 0..count {
        let mut point = Point::<L>::virgin(props, stress_state);
        // sizes over two decades, so that elastic, peak and tail states all occur
        let scale = size * 10_f64.powf(2.0 * random.unit() - 1.0);
        let first = random.strain(stress_state, scale);
        if random.unit() < 0.7 {
            point.advance(&first);
        }
        let scale = size * 10_f64.powf(2.0 * random.unit() - 1.0);
        let strain = random.strain(stress_state, scale);
        if tangent_error(&point, &strain) > 1e-6 {
            if near_kink(&point, &strain) {
                excluded += 1;
            } else {
                panic!(
                    "{}: state {number}: tangent error {:e} at {strain:?} from {:?}",
                    L::INFO.name.to_string_lossy(),
                    tangent_error(&point, &strain),
                    point.state
                );
            }
        }
    }
    assert!(excluded * 20 <= count, "{excluded} of {count} states excluded as kinks");
    (count, excluded)
}

/// Whether the tangent itself jumps within the reach of the differences around this strain: then
/// no difference quotient can be compared with it.
fn near_kink<L: Law>(point: &Point<'_, L>, strain: &[f64; 6]) -> bool {
    let size = strain.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let here = point.trial(strain).0.tangent;
    let scale = here.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    point.stress_state.components().iter().any(|&j| {
        [-2e-4, -2e-6, 2e-6, 2e-4].into_iter().any(|step| {
            let mut shifted = *strain;
            shifted[j] += step * size;
            let there = point.trial(&shifted).0.tangent;
            here.iter().flatten().zip(there.iter().flatten()).any(|(a, b)| (a - b).abs() > 2e-2 * scale)
        })
    })
}

/// A rotated history gives the rotated stress, to 1e-12 of the largest stress. (In the plane states
/// the rotation is about axis 3.)
pub fn check_rotation<L: Law>(props: &[f64], stress_state: StressState, size: f64, count: usize) {
    let mut random = Random(0x0707);
    for _ in 0..count {
        let rotation = if stress_state == StressState::ThreeD {
            random.rotation()
        } else {
            let (s, c) = (std::f64::consts::TAU * random.unit()).sin_cos();
            [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
        };
        let mut point = Point::<L>::virgin(props, stress_state);
        let mut turned = Point::<L>::virgin(props, stress_state);
        for _ in 0..3 {
            let scale = size * 10_f64.powf(2.0 * random.unit() - 1.0);
            let strain = random.strain(stress_state, scale);
            let stress = point.advance(&strain).stress;
            let turned_stress = turned.advance(&rotated(&strain, &rotation, 2.0)).stress;
            let expected = rotated(&stress, &rotation, 1.0);
            let largest = stress.iter().fold(1e-300_f64, |m, x| m.max(x.abs()));
            // a stress far below the elastic one is the difference of large numbers
            let elastic = strain.iter().fold(0.0_f64, |m, x| m.max(x.abs())) * props[0];
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
pub fn check_path_exactness<L: Law>(props: &[f64], stress_state: StressState, strain: &[f64; 6], counts: &[u32]) {
    let mut reference: Option<[f64; 6]> = None;
    for &count in counts {
        let mut point = Point::<L>::virgin(props, stress_state);
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

/// On random histories: named states never decrease, dissipation never decreases (if the law
/// guarantees it), a call repeated gives the same bits, zero increments change nothing.
pub fn check_invariants<L: Law>(
    props: &[f64],
    stress_state: StressState,
    size: f64,
    count: usize,
    monotone: &[&str],
    dissipative: bool,
) {
    let mut random = Random(0xD155);
    let index =
        |name: &str| L::INFO.states.iter().position(|s| s.name() == name).unwrap_or_else(|| panic!("no state {name}"));
    let monotone: Vec<usize> = monotone.iter().map(|name| index(name)).collect();
    for _ in 0..count {
        let mut point = Point::<L>::virgin(props, stress_state);
        for _ in 0..6 {
            let scale = size * 10_f64.powf(3.0 * random.unit() - 1.5);
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
