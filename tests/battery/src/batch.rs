//! A safe call of `pullout_umat_batch_v1`.

use umat_abi::batch::UmatBatch;
use umat_abi::host::Library;
use umat_abi::law::{Request, StressState};

/// Many points of one material, component by component: `n` values of the first component, then `n` of the second.
#[derive(Debug)]
pub struct BatchCall {
    function: UmatBatch,
    /// Keeps the function's code loaded.
    _library: Library,
    points: usize,
    stress_state: StressState,
    props: Vec<f64>,
    nstatv: usize,
    /// Total strains at the start.
    pub strain: Box<[f64]>,
    /// Strain increments.
    pub dstrain: Box<[f64]>,
    /// Stresses at the start, and at the end.
    pub stress: Box<[f64]>,
    /// State variables.
    pub statev: Box<[f64]>,
    /// Tangents of the last call with tangents.
    pub ddsdde: Box<[f64]>,
    /// Characteristic lengths, mm; 0: none.
    pub celent: Box<[f64]>,
    /// [`umat_abi::metadata::batch_results`] of each point.
    pub status: Box<[i32]>,
}

impl BatchCall {
    /// Virgin points; `None`: the library has no such function. Arrays are not guarded: the function is one of a library
    /// that describes its law.
    pub fn new(
        library: &Library,
        stress_state: StressState,
        nstatv: usize,
        props: &[f64],
        points: usize,
    ) -> Option<Self> {
        let function = library.batch()?;
        let ntens = stress_state.components().len();
        Some(Self {
            function,
            _library: library.clone(),
            points,
            stress_state,
            props: props.to_vec(),
            nstatv,
            strain: vec![0.0; ntens * points].into(),
            dstrain: vec![0.0; ntens * points].into(),
            stress: vec![0.0; ntens * points].into(),
            statev: vec![0.0; nstatv * points].into(),
            ddsdde: vec![0.0; ntens * ntens * points].into(),
            celent: vec![0.0; points].into(),
            status: vec![0; points].into(),
        })
    }

    /// Calls the plugin.
    #[inline]
    pub fn call(&mut self, request: Request) {
        let (ntens, ndi, _) = self.stress_state.counts();
        let ddsdde = if request.wants_tangent() { self.ddsdde.as_mut_ptr() } else { std::ptr::null_mut() };
        let count = |length: usize| i32::try_from(length).unwrap_or(i32::MAX);
        // SAFETY: every array has as many values as its counts say; the function is that of the contract.
        unsafe {
            (self.function)(
                self.points,
                ntens,
                ndi,
                self.props.as_ptr(),
                count(self.props.len()),
                self.strain.as_ptr(),
                self.dstrain.as_ptr(),
                self.stress.as_mut_ptr(),
                self.statev.as_mut_ptr(),
                count(self.nstatv),
                ddsdde,
                self.celent.as_ptr(),
                self.status.as_mut_ptr(),
            );
        }
    }
}
