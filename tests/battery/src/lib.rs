//! Checks that every law must pass, whatever its equations: the consistent tangent against differences, rotation,
//! states that never decrease, dissipation, the virgin state, proportional paths. A law calls [`battery!`] with its
//! promises ([`Promises`]); [`stability`] throws extremes at all of them, for `pullout-bench stability` too.

mod batch;
mod differences;
pub mod energy;
pub mod interface;
mod invariants;
pub mod pages;
mod path;
pub mod peak;
mod promises;
mod proportional;
pub mod reference;
mod rotation;
#[allow(missing_docs, reason = "sets of parameters, next to their names")]
pub mod samples;
pub mod stability;
mod tangent;
pub mod uniaxial;

pub use batch::BatchCall;
pub use invariants::{check_invariants, check_no_second_flow, check_rotation, check_virgin};
pub use path::{PATH_COUNTS, check_path_exactness, check_random_paths};
pub use promises::Promises;
pub use tangent::{check_tangents, tangent_error};
pub use umat_abi::table::rotated;

use models::tensor::Spectral;
use umat_abi::law::{Failure, Increment, Law, Request, Response, StressState, advance_values, parameters_of};

/// Random numbers that are reproducible from a seed, so that a failing state can be named.
#[derive(Clone, Debug)]
pub struct Random(pub fastrand::Rng);

impl Random {
    /// Starts a stream of numbers of its own for each seed.
    pub fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0.f64()
    }

    /// Uniform in [−1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns as many numbers as asked for, uniform in [−1, 1).
    pub fn vector(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.signed()).collect()
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
    /// PROPS.
    pub props: &'p [f64],
    /// About the strain at the peak or at first yield.
    pub size: f64,
    /// CELENT, mm.
    pub characteristic_length: Option<f64>,
}

impl<'p> Sample<'p> {
    /// Makes a sample without a characteristic length.
    pub fn new(props: &'p [f64], size: f64) -> Self {
        Self { props, size, characteristic_length: None }
    }

    /// Makes samples of a table of parameter sets.
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
    /// Parameters from PROPS.
    pub parameters: L::Parameters<'p>,
    /// Stress state: the components that exist.
    pub stress_state: StressState,
    /// The committed strain.
    pub strain: [f64; 6],
    /// The committed stress, MPa.
    pub stress: [f64; 6],
    /// The committed STATEV.
    pub state: Vec<f64>,
    /// CELENT, mm.
    pub characteristic_length: Option<f64>,
    /// DTIME, s.
    pub time_increment: f64,
    /// TEMP + DTEMP of a coupled law.
    pub temperature: f64,
}

impl<'p, L: Law> Point<'p, L> {
    /// Makes a point that was never strained.
    ///
    /// # Panics
    /// If the parameters are out of bounds.
    pub fn virgin(props: &'p [f64], stress_state: StressState) -> Self {
        Self {
            parameters: parameters_of::<L>(props).expect("properties within bounds, consistent"),
            stress_state,
            strain: [0.0; 6],
            stress: [0.0; 6],
            state: vec![0.0; L::INFO.states.len()],
            characteristic_length: None,
            time_increment: 1.0,
            temperature: 0.0,
        }
    }

    /// The response at a strain from the committed state, which stays as it is, and the states there.
    pub fn respond(&self, strain: &[f64; 6], request: Request) -> (Result<Response, Failure>, Vec<f64>) {
        let mut state = self.state.clone();
        (advance_values::<L>(&self.parameters, &self.increment(strain), &mut state, request), state)
    }

    /// The increment to a strain.
    pub fn increment(&self, strain: &[f64; 6]) -> Increment {
        Increment {
            stress_state: self.stress_state,
            strain: *strain,
            strain_increment: std::array::from_fn(|i| strain[i] - self.strain[i]),
            stress: self.stress,
            characteristic_length: self.characteristic_length,
            time_increment: self.time_increment,
            temperature: self.temperature,
        }
    }

    /// Returns the response and states of a law that must answer.
    pub fn trial(&self, strain: &[f64; 6]) -> (Response, Vec<f64>) {
        let (outcome, state) = self.respond(strain, Request::StressAndTangent);
        let response = outcome.unwrap_or_else(|failure| panic!("{failure:?} at {strain:?} from {:?}", self.state));
        (response, state)
    }

    /// Goes to a strain and commits.
    pub fn advance(&mut self, strain: &[f64; 6]) -> Response {
        let (response, state) = self.trial(strain);
        self.commit(strain, &response, state);
        response
    }

    /// Makes a response and its states those of the point.
    pub fn commit(&mut self, strain: &[f64; 6], response: &Response, state: Vec<f64>) {
        self.strain = *strain;
        self.stress = response.stress;
        self.state = state;
    }
}

/// Returns the largest of errors ≥ 0; NaN counts as infinite (`f64::max` forgets it).
pub fn worst(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors.into_iter().fold(0.0, |worst, error| {
        if error <= worst {
            worst
        } else if error.is_nan() {
            f64::INFINITY
        } else {
            error
        }
    })
}

/// [`rotated`] about axis 3, of the components 11, 22, 33, 12.
pub fn rotated_in_plane([a, b, c, d]: [f64; 4], angle: f64, shear: f64) -> [f64; 4] {
    let (sine, cosine) = angle.sin_cos();
    let rotation = [[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]];
    let [a, b, c, d, ..] = rotated(&[a, b, c, d, 0.0, 0.0], &rotation, shear);
    [a, b, c, d]
}

/// The three stress states.
pub const STRESS_STATES: [StressState; 3] =
    [StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric, StressState::PlaneStress];
