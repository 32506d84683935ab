//! Arrays that a plugin writes, with canaries behind each: an overrun is reported by name instead of
//! crashing something later.

use std::fmt;

/// A bit pattern no computation produces: a signalling-free NaN with a marked payload.
const CANARY: u64 = 0x7ff8_c0de_ba5e_ba11;
/// Doubles behind each array.
pub(super) const CANARIES: usize = 4;

/// Doubles behind them that are nobody's: what arrays for 6 components are longer than those for 3, 36 − 9.
const SLACK: usize = 27;

/// A plugin wrote behind one of its arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrun {
    /// The argument's name.
    pub array: &'static str,
    /// Its length.
    pub length: usize,
}

impl fmt::Display for Overrun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the plugin wrote behind the end of {} (length {})", self.array, self.length)
    }
}

impl std::error::Error for Overrun {}

/// One array with its canaries.
#[derive(Clone, Debug)]
pub(super) struct Guarded {
    name: &'static str,
    length: usize,
    /// The length as Fortran passes it.
    count: i32,
    memory: Vec<f64>,
}

impl Guarded {
    /// An array of zeros.
    pub(super) fn new(name: &'static str, length: usize) -> Self {
        let mut memory = vec![0.0; length];
        memory.resize(length + CANARIES + SLACK, f64::from_bits(CANARY));
        Self { name, length, count: i32::try_from(length).unwrap_or(i32::MAX), memory }
    }

    pub(super) fn as_slice(&self) -> &[f64] {
        &self.memory[..self.length]
    }

    pub(super) fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.memory[..self.length]
    }

    pub(super) fn as_mut_ptr(&mut self) -> *mut f64 {
        self.memory.as_mut_ptr()
    }

    /// The length as an argument (NSTATV, NPROPS).
    pub(super) fn count(&self) -> *const i32 {
        &raw const self.count
    }

    /// Checks the canaries and restores them.
    #[inline]
    pub(super) fn check(&mut self) -> Result<(), Overrun> {
        let canaries = &mut self.memory[self.length..self.length + CANARIES];
        if canaries.iter().all(|x| x.to_bits() == CANARY) {
            return Ok(());
        }
        canaries.fill(f64::from_bits(CANARY));
        Err(Overrun { array: self.name, length: self.length })
    }
}

/// A Fortran CHARACTER*80: upper case, blank-padded.
pub(super) fn fortran_name(name: &str) -> [u8; 80] {
    let mut padded = [b' '; 80];
    for (target, source) in padded.iter_mut().zip(name.bytes()) {
        *target = source.to_ascii_uppercase();
    }
    padded
}
