//! The laws of solids as they are called one by one: through their plugins, or the linked law itself.

use super::{BenchError, Settings};
use models::{
    biaxial_damage::BiaxialDamage, concrete_damage::ConcreteDamage, drucker_prager::DruckerPrager,
    inelastic_damage::InelasticDamage, j2_plasticity::J2Plasticity, linear_elastic::LinearElastic,
    pure_damage::PureDamage, reverse_cyclic_damage::ReverseCyclicDamage,
};
use umat_abi::host::{CallOutcome, Found, Library, UmatCall, search_paths};
use umat_abi::law::{Increment, Law, Request, Response, StressState, advance_values, parameters_of};

/// One update of the law itself, without the arguments of a UMAT: PROPS, strains and results are checked as there.
pub type Direct = fn(props: &[f64], increment: &Increment, state: &mut [f64], request: Request) -> Option<Response>;

/// A law with parameters.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    /// The law's name.
    pub law: &'static str,
    /// PROPS.
    pub props: Vec<f64>,
    /// NSTATV.
    pub states: usize,
    /// Size of strains well beyond the elastic limit.
    pub strain: f64,
    /// The linked law.
    pub direct: Direct,
}

fn direct<L: Law>(props: &[f64], increment: &Increment, state: &mut [f64], request: Request) -> Option<Response> {
    let parameters = parameters_of::<L>(props).ok()?;
    advance_values::<L>(&parameters, increment, state, request).ok()
}

fn solid<L: Law>(law: &'static str, strain: f64, props: Option<&[f64]>) -> Solid {
    let defaults = || L::INFO.parameters.iter().map(|parameter| parameter.default_value).collect();
    Solid {
        law,
        props: props.map_or_else(defaults, <[f64]>::to_vec),
        states: L::INFO.states.len(),
        strain,
        direct: direct::<L>,
    }
}

/// The shipped laws of solids with their default parameters; steel hardens.
pub(super) fn solids() -> Vec<Solid> {
    const STEEL: &[f64] = &[210_000.0, 0.3, 347.0, 0.0, 400.0, 0.02, 420.0, 0.1];
    vec![
        solid::<LinearElastic>("linear_elastic", 1e-3, None),
        solid::<PureDamage>("pure_damage", 4e-4, None),
        solid::<InelasticDamage>("inelastic_damage", 4e-4, None),
        solid::<ReverseCyclicDamage>("reverse_cyclic_damage", 4e-4, None),
        solid::<BiaxialDamage>("biaxial_damage", 4e-4, None),
        solid::<ConcreteDamage>("concrete_damage", 4e-4, None),
        solid::<J2Plasticity>("j2_plasticity", 1e-2, Some(STEEL)),
        solid::<DruckerPrager>("drucker_prager", 1e-2, None),
    ]
}

/// State of a point when it is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Situation {
    /// Virgin, far below the elastic limit.
    Elastic,
    /// Beyond it, and going on, all components of the strain at work.
    Inelastic,
}

impl Situation {
    /// Both situations.
    pub const ALL: [Self; 2] = [Self::Elastic, Self::Inelastic];

    /// Returns the name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Elastic => "elastic",
            Self::Inelastic => "inelastic",
        }
    }
}

/// A direction with three different principal strains, none along an axis.
const DIRECTION: [f64; 6] = [1.0, -0.35, 0.1, 0.6, -0.4, 0.25];
/// Increments before the one that is measured.
const INCREMENTS: usize = 8;

impl Solid {
    /// The plugin's library.
    ///
    /// # Errors
    /// The library is missing or cannot be loaded.
    pub fn library(&self, settings: &Settings) -> Result<Library, BenchError> {
        let searched = search_paths(&settings.plugin_paths);
        match Found::by_name(self.law, &searched) {
            Some(found) => Ok(pullout_run::isolation::load(&found.path)?),
            None => Err(BenchError::Missing { plugin: self.law.into(), searched }),
        }
    }

    /// The strain increment that leads through a situation.
    pub fn increment(&self, situation: Situation) -> [f64; 6] {
        let size = match situation {
            Situation::Elastic => 1e-3 * self.strain,
            Situation::Inelastic => self.strain / INCREMENTS as f64,
        };
        DIRECTION.map(|component| size * component)
    }

    /// A call that stands in a situation, ready to take the next increment of `library`'s UMAT.
    ///
    /// # Errors
    /// The library has no UMAT, or it refuses the way there.
    pub fn call(&self, library: &Library, situation: Situation) -> Result<UmatCall, BenchError> {
        let mut call = UmatCall::new(library, None, self.law, StressState::ThreeD, self.states, &self.props)?;
        let increment = self.increment(situation);
        let before = if situation == Situation::Elastic { 1 } else { INCREMENTS };
        for _ in 0..before {
            call.dstran = increment;
            if call.call(Request::StressAndTangent).ok() != Some(CallOutcome::Done) {
                return Err(BenchError::Failed(format!("{}: the way to the measured increment fails", self.law)));
            }
            for i in 0..6 {
                call.stran[i] += increment[i];
            }
        }
        Ok(call)
    }
}

/// The increment that a call is about to take, as the law itself sees it.
pub(super) fn increment_of(call: &UmatCall) -> Increment {
    Increment {
        stress_state: StressState::ThreeD,
        strain: std::array::from_fn(|i| call.stran[i] + call.dstran[i]),
        strain_increment: call.dstran,
        stress: std::array::from_fn(|i| call.stress()[i]),
        characteristic_length: None,
        time_increment: 1.0,
        temperature: call.temp + call.dtemp,
    }
}
