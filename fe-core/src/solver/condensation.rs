//! x
use super::{Pattern, SolverError};
/// x
#[derive(Debug)]
pub struct Superelement {}
impl Superelement {
    /// x
    pub fn new(_p: &Pattern, _v: &[f64], _n: &[usize], _b: &[usize]) -> Result<Self, SolverError> {
        todo!()
    }
    /// x
    pub fn stiffness(&self) -> &[f64] {
        &[]
    }
    /// x
    pub fn expand(&self, _b: &[f64], _i: &mut [f64]) {}
}
