//! A law that is called through the plugin interface, with its parameters.

use crate::kinematics::{MAX_COMPONENTS, PlaneModel};
use std::fmt::Display;
use std::ops::Deref;
use umat_abi::host::{InitialStates, InitialStresses, Plugin};
use umat_abi::metadata::{EQUIVALENT_PLASTIC_STRAIN, OVERSTRESS_WORK, flags};

#[cfg(test)]
mod test;

/// The plugin of a part or of a contact pair, with the states and the stress that its points start from; this crate knows no law in
/// particular.
#[derive(Clone, Debug)]
pub struct PluginLaw {
    /// The plugin.
    pub plugin: Plugin,
    /// STATEV of every point of a part at the start, NSTATV values; `None`: what the library's SDVINI sets, or zeros.
    pub statev0: Option<Vec<f64>>,
    /// Stress of every point of a part at the start, MPa: 11, 22, 33, 12, or r, z, θ, rz; `None`: what the library's SIGINI
    /// sets, or 0.
    pub stress0: Option<[f64; MAX_COMPONENTS]>,
}

impl Deref for PluginLaw {
    type Target = Plugin;

    fn deref(&self) -> &Plugin {
        &self.plugin
    }
}

impl From<Plugin> for PluginLaw {
    fn from(plugin: Plugin) -> Self {
        Self { plugin, statev0: None, stress0: None }
    }
}

impl PluginLaw {
    /// A message with the law's name.
    pub(crate) fn error(&self, message: impl Display) -> String {
        format!("{}: {message}", self.name)
    }

    /// Returns the source of the initial stresses of its points in a plane model.
    pub(crate) fn initial_stresses(&self, model: PlaneModel) -> InitialStresses {
        let components = model.stress_state().components();
        let given = self.stress0.map(|stress| components.iter().map(|&k| stress[k]).collect::<Vec<_>>());
        InitialStresses::new(&self.library, given.as_deref(), components.len())
    }

    /// Returns where the states of its points start from.
    pub(crate) fn initial_states(&self) -> InitialStates {
        InitialStates::new(&self.library, self.statev0.as_deref(), self.nstatv)
    }

    /// Returns whether its tangent is symmetric whatever the parameters and the state.
    pub(crate) fn has_symmetric_tangent(&self) -> bool {
        self.law.as_ref().is_some_and(|law| law.has(flags::SYMMETRIC_TANGENT))
    }

    /// Returns which of its states are damage by their names, or by those of outputs that are made of them.
    pub(crate) fn damage_states(&self) -> Vec<usize> {
        let is_damage = |name: &str| {
            name.eq_ignore_ascii_case("d")
                || name.starts_with("D_")
                || name.starts_with("d_")
                || name.contains("damage")
        };
        let Some(law) = &self.law else { return Vec::new() };
        let derived = law.derived.iter().filter(|derived| is_damage(&derived.name)).map(|derived| derived.state);
        let states = law.states.iter().enumerate().filter(|(_, state)| is_damage(&state.name));
        derived.chain(states.map(|(index, _)| index)).collect()
    }

    /// Returns whether it has damage, as far as it says.
    pub fn damages(&self) -> bool {
        !self.damage_states().is_empty()
    }

    /// Returns whether its tangent may be negative: it has damage, or no metadata on that; not if it extrapolates.
    pub(crate) fn softens(&self) -> bool {
        (self.law.is_none() || self.damages()) && self.overstress_work().is_none()
    }

    /// Returns whether equilibrium with it may lose its stability: it softens, or its tangent is unsymmetric, so that bands may
    /// form while it still hardens (Rudnicki and Rice 1975).
    pub fn may_lose_stability(&self) -> bool {
        self.softens() || !self.has_symmetric_tangent()
    }

    /// Returns which of its states is the work of the overstress of a law that extrapolates, if it does.
    pub fn overstress_work(&self) -> Option<usize> {
        self.law.as_ref()?.state_index(OVERSTRESS_WORK)
    }

    /// Returns which of its states is the equivalent plastic strain, if it has one.
    pub fn equivalent_plastic_strain(&self) -> Option<usize> {
        self.law.as_ref()?.state_index(EQUIVALENT_PLASTIC_STRAIN)
    }
}
