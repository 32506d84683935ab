//! The checks every law must pass, whatever its equations: consistent tangent against differences,
//! rotation invariance, monotone damage, dissipation, virgin state. One macro call a law.

pub mod energy;
pub mod interface;
pub mod path;
pub mod peak;
pub mod reference;
pub mod stability;
pub mod tangent;
pub mod uniaxial;

pub use path::{PATH_COUNTS, check_path_exactness, check_random_paths};
pub use tangent::{check_tangents, tangent_error};

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
