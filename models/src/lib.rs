//! Constitutive and interface laws after X. Tao (PhD thesis, Glasgow 2000), corrected and extended.
//!
//! Pure functions: no FFI, no I/O, no allocation in an update. Units N, mm, MPa; tension positive.
//! One folder per law; each begins with its equations.

pub mod concrete_damage;
pub mod damage_law;
pub mod linear_elastic;
pub mod tensor;

#[cfg(test)]
mod battery;
