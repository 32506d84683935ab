//! The laws that every test of the boundary runs, with parameters that make them interesting.

use umat_abi::export::is_named;
use umat_abi::law::{Law, LawInfo, StressState};
use umat_abi::metadata::Parameter;

/// One law as a plugin.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The law's name, also that of its library.
    pub name: &'static str,
    /// PROPS.
    pub props: &'static [f64],
    /// NSTATV.
    pub states: usize,
    /// Size of strains that take the law well beyond its elastic limit.
    pub strain: f64,
    /// Index of PROPS with a bound, and a value beyond it.
    pub inadmissible: (usize, f64),
}

/// A law's name, PROPS, size of strains, and an index of PROPS with a value beyond its bound.
type Chosen = (&'static str, &'static [f64], f64, (usize, f64));

/// Laws whose defaults show too little.
const CHOSEN: &[Chosen] = &[
    ("linear_elastic", &[31800.0, 0.18], 1e-3, (1, 0.5)),
    ("pure_damage", &[31800.0, 0.18, 5000.0, 1.3, 2e-4], 4e-4, (2, 0.0)),
    ("inelastic_damage", &[31800.0, 0.2, 4e-3, 1.2, 3.35e-2, 1000.0, 1.0, 0.0], 0.1, (7, 0.5)),
    ("reverse_cyclic_damage", &[31800.0, 0.18, 5000.0, 1.3, 2e-4, 21.0, 1.05, 4e-4, 0.0], 4e-4, (8, 2.0)),
    ("biaxial_damage", &[31800.0, 0.18, 7000.0, 1.1, 1.9e-4, 29.0, 0.94, 3e-4, 2.0, 0.7, 2.0, 0.0], 4e-4, (10, 3.0)),
    // crack band off: with it CELENT is an argument that the law needs
    (
        "concrete_damage",
        &[31800.0, 0.18, 5000.0, 1.3, 1.905_077e-4, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.3, 0.3, 0.0, 0.0],
        4e-4,
        (8, 1.5),
    ),
    (
        "concrete_damage_implex",
        &[31800.0, 0.18, 5000.0, 1.3, 1.905_077e-4, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.0, 0.0, 0.0, 0.0],
        4e-4,
        (11, 0.3),
    ),
    (
        "concrete_damage_fixed",
        &[31800.0, 0.18, 5000.0, 1.3, 1.905_077e-4, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        4e-4,
        (11, 0.3),
    ),
    (
        "concrete_phase_field",
        &[31800.0, 0.18, 3.0, 0.09, 5.0, 3.1667, -1.0, 1.9791, 31.47479, 1.05, 3e-4, 0.17227, 0.0],
        4e-4,
        (4, 0.0),
    ),
    ("j2_plasticity", &[210_000.0, 0.3, 347.0, 0.0, 400.0, 0.02, 420.0, 0.1], 1e-2, (2, 0.0)),
    ("drucker_prager", &[23_700.0, 0.15, 3.81, 18.8, 10.0, 0.0], 1e-3, (5, 0.5)),
];

macro_rules! samples {
    (umat: [$($law:ty => $name:literal,)+], $($interface:tt)*) => {
        &[$({
            const DEFAULTS: [f64; <$law>::INFO.parameters.len()] = defaults(<$law>::INFO.parameters);
            Sample::of($name, &<$law>::INFO, &DEFAULTS)
        }),+]
    };
}

/// The shipped laws of solids.
pub const LAWS: &[Sample] = models::laws!(samples);

/// The defaults of a table.
const fn defaults<const N: usize>(parameters: &[Parameter]) -> [f64; N] {
    let (mut values, mut k) = ([0.0; N], 0);
    while k < N {
        values[k] = parameters[k].default_value;
        k += 1;
    }
    values
}

/// The first parameter with a least value, and a value below it.
const fn inadmissible(parameters: &[Parameter]) -> (usize, f64) {
    let mut k = 0;
    while !parameters[k].lower.is_finite() {
        k += 1;
    }
    (k, parameters[k].lower - 1.0)
}

/// The sample of one law.
///
/// # Panics
/// If [`LAWS`] has no such row.
pub fn sample(name: &str) -> &'static Sample {
    LAWS.iter().find(|law| law.name == name).expect("a law of the table")
}

impl Sample {
    /// The chosen sample of a law, otherwise one of its defaults.
    const fn of(name: &'static str, law: &LawInfo, defaults: &'static [f64]) -> Self {
        let states = law.states.len();
        let mut k = 0;
        while k < CHOSEN.len() {
            let (chosen, props, strain, inadmissible) = CHOSEN[k];
            if is_named(law, chosen) {
                return Self { name, props, states, strain, inadmissible };
            }
            k += 1;
        }
        Self { name, props: defaults, states, strain: 1e-3, inadmissible: inadmissible(law.parameters) }
    }

    /// The three stress states of a UMAT.
    pub const STRESS_STATES: [StressState; 3] =
        [StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric, StressState::PlaneStress];

    /// Returns whether it takes a temperature and returns heat.
    pub fn is_coupled(&self) -> bool {
        self.name == "concrete_phase_field"
    }
}
