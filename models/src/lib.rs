//! Constitutive and interface laws after X. Tao (PhD thesis, Glasgow 2000), corrected and extended.
//!
//! Pure functions: no FFI, no I/O, no allocation in an update. Units N, mm, MPa; tension positive.
//! One folder per law; each begins with its equations.

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
