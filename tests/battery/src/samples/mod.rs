//! Parameter sets that the laws are tried at.

pub mod biaxial_damage;
pub mod concrete_damage;
pub mod drucker_prager;
pub mod inelastic_damage;
pub mod j2_plasticity;
pub mod pure_damage;
pub mod reverse_cyclic_damage;
