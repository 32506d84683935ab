//! An array between fences.

/// Cells on either side of an array.
const FENCE: usize = 16;
/// Content of the fences: NaN, so that a law that reads them has it in its answer.
const SIGN: u64 = 0x7ff8_0bad_fe9c_e000;

/// Numbers with fences around them.
pub(super) struct Fenced(Vec<f64>);

impl Fenced {
    pub(super) fn new(values: &[f64]) -> Self {
        let fence = |side: usize| (0..FENCE).map(move |k| f64::from_bits(SIGN + (FENCE * side + k) as u64));
        Self(fence(0).chain(values.iter().copied()).chain(fence(1)).collect())
    }

    pub(super) fn pointer(&mut self) -> *mut f64 {
        self.0[FENCE..].as_mut_ptr()
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.0[FENCE..self.0.len() - FENCE]
    }

    pub(super) fn bits(&self) -> Vec<u64> {
        self.values().iter().map(|x| x.to_bits()).collect()
    }

    /// Returns whether the fences still hold their content.
    pub(super) fn is_intact(&self) -> bool {
        let end = self.0.len() - FENCE;
        let cells = self.0[..FENCE].iter().chain(&self.0[end..]);
        cells.enumerate().all(|(k, cell)| cell.to_bits() == SIGN + k as u64)
    }
}
