//! The laws that are integrated, each with the algorithm of the thesis where it has one.

use super::path::{Components, Extent};
use super::thesis;
use models::{
    biaxial_damage::BiaxialDamage, concrete_damage::ConcreteDamage, drucker_prager::DruckerPrager,
    inelastic_damage::InelasticDamage, j2_plasticity::J2Plasticity, linear_elastic::LinearElastic,
    pure_damage::PureDamage, reverse_cyclic_damage::ReverseCyclicDamage,
};
use umat_abi::law::{Increment, Law, MAX_STATES, Request, StressState, advance_values, parameters_of};

/// Follows strains from the virgin state and keeps every k-th stress.
pub type Follow = fn(props: &[f64], strains: &[Components], every: usize) -> Result<Vec<Components>, String>;

/// Law that is measured, with its parameters.
#[derive(Clone, Debug)]
pub struct MeasuredLaw {
    /// Name in tables.
    pub name: &'static str,
    /// The law.
    pub law: &'static str,
    /// PROPS.
    pub props: Vec<f64>,
    /// Greatest strains that it is taken to.
    pub extent: Extent,
    /// A function of the end strain and of maxima so far: no increment is too large while it hits the maxima.
    pub is_path_exact: bool,
    /// The law itself.
    pub ours: Follow,
    /// The thesis's algorithm for it: its name, and how it goes.
    pub thesis: Option<(&'static str, Follow)>,
}

/// The law's own update, stress only, in three dimensions.
pub fn follow<L: Law>(props: &[f64], strains: &[Components], every: usize) -> Result<Vec<Components>, String> {
    follow_in::<L>(StressState::ThreeD, props, strains, every)
}

/// Returns the stresses of the law's own update in any stress state, stress only.
pub fn follow_in<L: Law>(
    stress_state: StressState,
    props: &[f64],
    strains: &[Components],
    every: usize,
) -> Result<Vec<Components>, String> {
    let parameters = parameters_of::<L>(props).map_err(|error| error.to_string())?;
    let mut states = [0.0; MAX_STATES];
    let state = &mut states[..L::INFO.states.len()];
    let mut increment = Increment::at_rest(stress_state);
    let mut stresses = Vec::with_capacity(strains.len() / every);
    for (i, strain) in strains.iter().enumerate() {
        for k in 0..6 {
            increment.strain_increment[k] = strain[k] - increment.strain[k];
        }
        increment.strain = *strain;
        let response = advance_values::<L>(&parameters, &increment, state, Request::Stress)
            .map_err(|failure| format!("{failure:?}"))?;
        increment.stress = response.stress;
        if (i + 1).is_multiple_of(every) {
            stresses.push(response.stress);
        }
    }
    Ok(stresses)
}

/// PROPS of a law without repeating group, by the defaults of its table.
fn defaults<L: Law>() -> Vec<f64> {
    L::INFO.parameters.iter().map(|parameter| parameter.default_value).collect()
}

/// Returns the default PROPS with some of them changed, by index.
fn changed<L: Law>(changes: &[(usize, f64)]) -> Vec<f64> {
    let mut props = defaults::<L>();
    changes.iter().for_each(|&(index, value)| props[index] = value);
    props
}

/// Concrete: beyond its peaks in tension, compression and at a general strain.
const CONCRETE: Extent = Extent { tension: 6e-4, compression: 4e-3, general: 1e-3, poisson_ratio: 0.18 };
/// Steel: well beyond first yield.
const STEEL: Extent = Extent { tension: 1e-2, compression: 1e-2, general: 1e-2, poisson_ratio: 0.3 };
/// A table that hardens in two pieces.
const HARDENING: [f64; 6] = [347.0, 0.0, 400.0, 0.004, 420.0, 0.02];

/// Returns all measured laws.
pub fn subjects() -> Vec<MeasuredLaw> {
    let subject = |name, law, props, extent, is_path_exact, ours| MeasuredLaw {
        name,
        law,
        props,
        extent,
        is_path_exact,
        ours,
        thesis: None,
    };
    let with_thesis = |subject, name, follow| MeasuredLaw { thesis: Some((name, follow)), ..subject };
    let steel: Vec<f64> = [210_000.0, 0.3].into_iter().chain(HARDENING).collect();
    vec![
        subject(
            "linear_elastic",
            "linear_elastic",
            defaults::<LinearElastic>(),
            CONCRETE,
            true,
            follow::<LinearElastic>,
        ),
        with_thesis(
            subject(
                "pure_damage (I)",
                "pure_damage",
                defaults::<PureDamage>(),
                CONCRETE,
                true,
                follow::<PureDamage> as Follow,
            ),
            "Box 4.1",
            thesis::pure as Follow,
        ),
        with_thesis(
            subject(
                "inelastic_damage (II)",
                "inelastic_damage",
                defaults::<InelasticDamage>(),
                Extent { poisson_ratio: 0.2, ..CONCRETE },
                true,
                follow::<InelasticDamage>,
            ),
            "Box 4.2",
            thesis::inelastic,
        ),
        subject(
            "reverse_cyclic_damage (III, thesis)",
            "reverse_cyclic_damage",
            defaults::<ReverseCyclicDamage>(),
            CONCRETE,
            true,
            follow::<ReverseCyclicDamage>,
        ),
        subject(
            "reverse_cyclic_damage (III, regular)",
            "reverse_cyclic_damage",
            changed::<ReverseCyclicDamage>(&[(8, 1.0)]),
            CONCRETE,
            true,
            follow::<ReverseCyclicDamage>,
        ),
        with_thesis(
            subject(
                "biaxial_damage (IV, implicit)",
                "biaxial_damage",
                defaults::<BiaxialDamage>(),
                CONCRETE,
                false,
                follow::<BiaxialDamage>,
            ),
            "Box 5.1",
            thesis::biaxial,
        ),
        subject(
            "concrete_damage (IV-H)",
            "concrete_damage",
            defaults::<ConcreteDamage>(),
            CONCRETE,
            true,
            follow::<ConcreteDamage>,
        ),
        subject(
            "concrete_damage (IV-HP)",
            "concrete_damage",
            changed::<ConcreteDamage>(&[(10, 0.3), (11, 0.3)]),
            CONCRETE,
            false,
            follow::<ConcreteDamage>,
        ),
        subject("j2_plasticity", "j2_plasticity", steel, STEEL, false, follow::<J2Plasticity>),
        subject(
            "drucker_prager",
            "drucker_prager",
            changed::<DruckerPrager>(&[(2, 3.81), (4, 10.0)]),
            Extent { tension: 2e-3, compression: 4e-3, general: 2e-3, poisson_ratio: 0.15 },
            false,
            follow::<DruckerPrager>,
        ),
    ]
}
