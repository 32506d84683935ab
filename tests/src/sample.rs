//! The laws that every test of the boundary runs, with parameters that make them interesting.

use umat_abi::law::StressState;

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

/// The shipped laws of solids. A new law is one more row.
pub const LAWS: &[Sample] = &[
    Sample { name: "linear_elastic", props: &[31800.0, 0.18], states: 2, strain: 1e-3, inadmissible: (1, 0.5) },
    Sample {
        name: "pure_damage",
        props: &[31800.0, 0.18, 5000.0, 1.3, 2e-4],
        states: 4,
        strain: 4e-4,
        inadmissible: (2, 0.0),
    },
    Sample {
        name: "inelastic_damage",
        props: &[31800.0, 0.2, 4e-3, 1.2, 3.35e-2, 1000.0, 1.0, 0.0],
        states: 3,
        strain: 0.1,
        inadmissible: (7, 0.5),
    },
    Sample {
        name: "reverse_cyclic_damage",
        props: &[31800.0, 0.18, 5000.0, 1.3, 2e-4, 21.0, 1.05, 4e-4, 0.0],
        states: 6,
        strain: 4e-4,
        inadmissible: (8, 2.0),
    },
    Sample {
        name: "biaxial_damage",
        props: &[31800.0, 0.18, 7000.0, 1.1, 1.9e-4, 29.0, 0.94, 3e-4, 2.0, 0.7, 2.0, 0.0],
        states: 9,
        strain: 4e-4,
        inadmissible: (10, 3.0),
    },
    Sample {
        // crack band off: with it CELENT is an argument that the law needs
        name: "concrete_damage",
        props: &[31800.0, 0.18, 5000.0, 1.3, 1.905_077e-4, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.3, 0.3, 0.0, 0.0],
        states: 13,
        strain: 4e-4,
        inadmissible: (8, 1.5),
    },
    Sample {
        name: "concrete_damage_implex",
        props: &[31800.0, 0.18, 5000.0, 1.3, 1.905_077e-4, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.0, 0.0, 0.0, 0.0],
        states: 14,
        strain: 4e-4,
        inadmissible: (11, 0.3),
    },
    Sample {
        name: "concrete_damage_fixed",
        props: &[31800.0, 0.18, 5000.0, 1.3, 1.905_077e-4, 31.47479, 1.05, 3e-4, 0.17227, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        states: 20,
        strain: 4e-4,
        inadmissible: (11, 0.3),
    },
    Sample {
        name: "concrete_phase_field",
        props: &[31800.0, 0.18, 3.0, 0.09, 5.0, 3.1667, -1.0, 1.9791, 31.47479, 1.05, 3e-4, 0.17227, 0.0],
        states: 7,
        strain: 4e-4,
        inadmissible: (4, 0.0),
    },
    Sample {
        name: "j2_plasticity",
        props: &[210_000.0, 0.3, 347.0, 0.0, 400.0, 0.02, 420.0, 0.1],
        states: 9,
        strain: 1e-2,
        inadmissible: (2, 0.0),
    },
    Sample {
        name: "drucker_prager",
        props: &[23_700.0, 0.15, 3.81, 18.8, 10.0, 0.0],
        states: 9,
        strain: 1e-3,
        inadmissible: (5, 0.5),
    },
];

/// The sample of one law.
///
/// # Panics
/// If [`LAWS`] has no such row.
pub fn sample(name: &str) -> &'static Sample {
    LAWS.iter().find(|law| law.name == name).expect("a law of the table")
}

impl Sample {
    /// The three stress states of a UMAT.
    pub const STRESS_STATES: [StressState; 3] =
        [StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric, StressState::PlaneStress];

    /// Returns whether it takes a temperature and returns heat.
    pub fn is_coupled(&self) -> bool {
        self.name == "concrete_phase_field"
    }
}
