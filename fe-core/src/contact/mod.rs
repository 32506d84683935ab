//! Contact between two chains of edges: kinematics, laws, enforcement.
use crate::assembly::{Blocks, IncrementContext, Trouble};
use crate::mesh::Mesh;
use crate::model::ContactPair;
use umat_abi::law::Request;
#[derive(Debug)]
pub struct Contact {}
#[derive(Debug, thiserror::Error)]
#[error("x")]
pub struct ContactError;
pub struct Settlement {
    pub again: bool,
}
#[derive(Default)]
pub struct Energies {
    pub work: f64,
    pub opening: f64,
    pub released: f64,
}
#[derive(Default)]
pub struct Counts {
    pub sticking: usize,
    pub slipping: usize,
    pub open: usize,
    pub released: usize,
}
impl Contact {
    pub fn new(_m: &Mesh, _p: &[ContactPair], _e: &[f64], _s: bool) -> Result<Self, ContactError> {
        Ok(Self {})
    }
    pub fn freedoms(&self) -> &[usize] {
        &[]
    }
    pub fn evaluate(
        &mut self,
        _d: &[f64],
        _c: &IncrementContext,
        _r: Request,
        _f: &mut [f64],
        _b: &mut Blocks,
    ) -> Result<(), Trouble> {
        Ok(())
    }
    pub fn settle(&mut self) -> Settlement {
        Settlement { again: false }
    }
    pub fn commit(&mut self, _d: &[f64]) {}
    pub fn restore(&mut self) {}
    pub fn counts(&self) -> Counts {
        Counts::default()
    }
    pub fn energies(&self) -> Energies {
        Energies::default()
    }
    pub fn mean_slip(&self) -> f64 {
        0.0
    }
    pub fn add_mean_slip_gradient(&self, _r: &mut [f64]) {}
    pub fn largest_slip_growth(&self) -> f64 {
        0.0
    }
    pub fn largest_force(&self) -> f64 {
        0.0
    }
    pub fn greatest_pressure(&self) -> f64 {
        0.0
    }
}
