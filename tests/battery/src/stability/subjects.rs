//! Every law of a solid, in the forms whose promises differ.

use super::{Ledger, TestedLaw, corners, throw};
use crate::samples::{
    biaxial_damage as biaxial, concrete_damage as concrete, drucker_prager as cone, inelastic_damage as inelastic,
    j2_plasticity as mises, pure_damage as pure, reverse_cyclic_damage as reverse,
};
use crate::{STRESS_STATES, Sample};
use models::biaxial_damage::BiaxialDamage;
use models::concrete_damage::{ConcreteDamage, ConcretePhaseField, PhaseFieldParameters};
use models::drucker_prager::DruckerPrager;
use models::inelastic_damage::InelasticDamage;
use models::j2_plasticity::J2Plasticity;
use models::linear_elastic::LinearElastic;
use models::pure_damage::PureDamage;
use models::reverse_cyclic_damage::ReverseCyclicDamage;
use umat_abi::law::StressState;
use umat_abi::table::Parameters as _;

/// A law in one of its forms.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The law's name.
    pub law: &'static str,
    /// Name of the form; empty: the law has one only.
    pub label: &'static str,
    /// Throws the chunk of this number, with so many states, at it.
    pub(super) chunk: fn(StressState, u64, u64) -> Ledger,
}

/// All of them.
pub fn forms() -> Vec<Form> {
    let form = |law, label, chunk| Form { law, label, chunk };
    vec![
        form("linear_elastic", "", linear_elastic),
        form("pure_damage", "", pure_damage),
        form("inelastic_damage", "alpha = 1", |s, k, n| inelastic_damage(true, s, k, n)),
        form("inelastic_damage", "alpha != 1", |s, k, n| inelastic_damage(false, s, k, n)),
        form("reverse_cyclic_damage", "thesis", |s, k, n| reverse_cyclic_damage(false, s, k, n)),
        form("reverse_cyclic_damage", "regular", |s, k, n| reverse_cyclic_damage(true, s, k, n)),
        form("biaxial_damage", "implicit", |s, k, n| biaxial_damage(biaxial::IMPLICIT, s, k, n)),
        form("biaxial_damage", "lagged", |s, k, n| biaxial_damage(biaxial::LAGGED, s, k, n)),
        form("concrete_damage", "IV-H", |s, k, n| concrete_damage([false, false], &[0, 2], s, k, n)),
        form("concrete_damage", "IV-HP", |s, k, n| concrete_damage([true, false], &[1], s, k, n)),
        form("concrete_damage", "IV-H, crack band", |s, k, n| concrete_damage([false, true], &[3], s, k, n)),
        form("concrete_damage", "IV-HP, crack band", |s, k, n| concrete_damage([true, true], &[4], s, k, n)),
        form("concrete_phase_field", "", concrete_phase_field),
        form("j2_plasticity", "", j2_plasticity),
        form("drucker_prager", "", drucker_prager),
    ]
}

const BRANCHES: &[&str] = &["eta_t", "eta_c", "Y_t_max", "Y_c_max"];

/// Promises that most laws make: everything but a stored energy of ½ σ : ε.
const MOST: TestedLaw<'static> = TestedLaw {
    samples: Vec::new(),
    corner: corners::linear,
    monotone: &[],
    dissipative: true,
    continuous: true,
    steady: true,
    quadratic: false,
    path_exact: &STRESS_STATES,
};

fn linear_elastic(stress_state: StressState, chunk: u64, states: u64) -> Ledger {
    let samples = vec![Sample::new(&[31800.0, 0.18], 1e-3)];
    throw::<LinearElastic>(&TestedLaw { samples, quadratic: true, ..MOST }, stress_state, chunk, states)
}

fn pure_damage(stress_state: StressState, chunk: u64, states: u64) -> Ledger {
    let samples = Sample::all(&pure::SETS);
    let monotone = &["eta", "Y_max"];
    let subject = TestedLaw { samples, corner: corners::pure, monotone, quadratic: true, ..MOST };
    throw::<PureDamage>(&subject, stress_state, chunk, states)
}

fn inelastic_damage(closed: bool, stress_state: StressState, chunk: u64, states: u64) -> Ledger {
    let subject = if closed {
        TestedLaw { samples: Sample::all(&inelastic::CLOSED), corner: corners::inelastic_closed, ..MOST }
    } else {
        TestedLaw { samples: Sample::all(&inelastic::MARCHED), corner: corners::inelastic_marched, ..MOST }
    };
    throw::<InelasticDamage>(&TestedLaw { monotone: &["eta"], ..subject }, stress_state, chunk, states)
}

fn reverse_cyclic_damage(regular: bool, stress_state: StressState, chunk: u64, states: u64) -> Ledger {
    let variant = f64::from(u8::from(regular));
    let subject = TestedLaw {
        samples: Sample::all(&reverse::SETS).into_iter().filter(|s| s.props[8] == variant).collect(),
        corner: if regular { |random| corners::reverse(random, 1.0) } else { |random| corners::reverse(random, 0.0) },
        monotone: BRANCHES,
        // the thesis's stress jumps where a principal strain changes its sign, its energy may be negative
        // (models/src/reverse_cyclic_damage/doc.md)
        continuous: regular,
        quadratic: regular,
        ..MOST
    };
    throw::<ReverseCyclicDamage>(&subject, stress_state, chunk, states)
}

fn biaxial_damage(weights: f64, stress_state: StressState, chunk: u64, states: u64) -> Ledger {
    let sets = biaxial::BETA.map(|mode| (biaxial::props(mode, weights), 4e-4));
    let subject = TestedLaw {
        samples: Sample::all(&sets),
        corner: corners::biaxial,
        monotone: BRANCHES,
        // not hyperelastic, several branches (models/src/biaxial_damage/doc.md)
        dissipative: false,
        continuous: false,
        path_exact: &[],
        // lagged weights are those of the stress before
        steady: weights == biaxial::IMPLICIT,
        ..MOST
    };
    throw::<BiaxialDamage>(&subject, stress_state, chunk, states)
}

/// Throws states at the law, with inelastic strain or a crack band, in one of its variants.
fn concrete_damage(
    [inelastic, band]: [bool; 2],
    which: &[usize],
    stress_state: StressState,
    chunk: u64,
    states: u64,
) -> Ledger {
    let variants = concrete::variants();
    let subject = TestedLaw {
        samples: which.iter().map(|&k| concrete::sample(&variants[k])).collect(),
        corner: match (inelastic, band) {
            (false, false) => |random| corners::concrete(random, false, false),
            (true, false) => |random| corners::concrete(random, true, false),
            (false, true) => |random| corners::concrete(random, false, true),
            (true, true) => |random| corners::concrete(random, true, true),
        },
        monotone: BRANCHES,
        quadratic: !inelastic,
        // IV-HP is of first order where crushing and open cracks meet
        path_exact: if inelastic { &[] } else { &STRESS_STATES },
        ..MOST
    };
    throw::<ConcreteDamage>(&subject, stress_state, chunk, states)
}

/// Throws states at the law, whose field grows along each history.
fn concrete_phase_field(stress_state: StressState, chunk: u64, states: u64) -> Ledger {
    let defaults: Vec<f64> = PhaseFieldParameters::TABLE.iter().map(|parameter| parameter.default_value).collect();
    let confined = [&defaults[..defaults.len() - 1], &[2.0]].concat();
    let subject = TestedLaw {
        samples: [&defaults, &confined].map(|props| Sample::new(props, 3e-4)).to_vec(),
        corner: corners::phase_field,
        monotone: &["eta_t", "eta_c", "H", "Y_c_max"],
        // by the trapezoidal rule
        dissipative: false,
        quadratic: true,
        path_exact: &[],
        ..MOST
    };
    throw::<ConcretePhaseField>(&subject, stress_state, chunk, states)
}

fn j2_plasticity(stress_state: StressState, chunk: u64, states: u64) -> Ledger {
    let subject = TestedLaw {
        samples: mises::SETS.map(|props| Sample::new(props, 3e-3)).to_vec(),
        corner: corners::mises,
        monotone: &["peeq"],
        // where the return is radial
        path_exact: &[StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric],
        ..MOST
    };
    throw::<J2Plasticity>(&subject, stress_state, chunk, states)
}

fn drucker_prager(stress_state: StressState, chunk: u64, states: u64) -> Ledger {
    let samples = cone::SETS.each_ref().map(|props| Sample::new(props, 3e-3)).to_vec();
    let subject = TestedLaw { samples, corner: corners::cone, monotone: &["peeq"], path_exact: &[], ..MOST };
    throw::<DruckerPrager>(&subject, stress_state, chunk, states)
}
