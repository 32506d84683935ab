//! Constitutive and interface laws after X. Tao (PhD thesis, Glasgow 2000), corrected and extended.
//!
//! Pure functions: no FFI, no I/O, no allocation in an update. Units N, mm, MPa; tension positive.
//! One folder per law; each begins with its equations.

macro_rules! names {
    (umat: [$($umat:ty => $solid:literal,)+], interface: [$($interface:ty => $name:literal),* $(,)?],) => {
        &[$($solid,)+ $($name),*]
    };
}

pub mod biaxial_damage;
pub mod bond_slip;
pub mod concrete_damage;
pub mod damage_law;
pub mod drucker_prager;
pub mod inelastic_damage;
pub mod j2_plasticity;
pub mod linear_elastic;
pub mod pure_damage;
pub mod reverse_cyclic_damage;
pub mod roots;
pub mod tensor;

/// Passes every shipped law, with the name of its library, to a macro: `models::laws!(umat_abi::export_library);`. A new law is
/// one more row here.
#[macro_export]
macro_rules! laws {
    ($($to:tt)+) => {
        $($to)+! {
            umat: [
                $crate::linear_elastic::LinearElastic => "linear_elastic",
                $crate::pure_damage::PureDamage => "pure_damage",
                $crate::inelastic_damage::InelasticDamage => "inelastic_damage",
                $crate::reverse_cyclic_damage::ReverseCyclicDamage => "reverse_cyclic_damage",
                $crate::biaxial_damage::BiaxialDamage => "biaxial_damage",
                $crate::concrete_damage::ConcreteDamage => "concrete_damage",
                $crate::concrete_damage::ConcreteDamageImplex => "concrete_damage_implex",
                $crate::concrete_damage::ConcreteDamageFixed => "concrete_damage_fixed",
                $crate::concrete_damage::ConcretePhaseField => "concrete_phase_field",
                $crate::j2_plasticity::J2Plasticity => "j2_plasticity",
                $crate::drucker_prager::DruckerPrager => "drucker_prager",
            ],
            interface: [$crate::bond_slip::BondSlip => "bond_slip"],
        }
    };
}

/// Names of the shipped laws: those of solids, then those of interfaces.
pub const NAMES: &[&str] = laws!(names);
