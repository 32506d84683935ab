//! Arrays that a plugin writes, with canaries on both sides of each: an overrun is reported by name instead of crashing
//! something later. In a worker's arrays, a write outside ends the process at once.

use super::fence::{Fenced, Outside, Watched, watch};
use super::probe::Alignment;
use crate::table::all_finite;
use std::borrow::Cow;
use std::fmt;

/// A bit pattern no computation produces: a signalling-free NaN with a marked payload.
pub(super) const CANARY: u64 = 0x7ff8_c0de_ba5e_ba11;
/// Doubles after each array.
pub(super) const CANARIES: usize = 4;

/// Unused doubles after them: as many as arrays for 6 components are longer than those for 3, 36 − 9.
const SLACK: usize = 27;

/// A plugin wrote outside one of its arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it wrote {array}({element}), which has {length} elements{}", of_hybrid(array, *element, *length))]
pub struct Overrun {
    /// The argument's name.
    pub array: &'static str,
    /// The element written, as Fortran counts (from 1).
    pub element: i64,
    /// Elements that the array has.
    pub length: usize,
}

/// A result that is NaN or infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotFinite {
    /// The argument's name.
    pub argument: &'static str,
    /// The element, from 1.
    pub element: usize,
    /// Rows of a matrix, column by column.
    pub rows: Option<usize>,
    /// Value of the element: NaN or infinity.
    pub value: f64,
}

impl NotFinite {
    /// The first of some results.
    #[inline]
    pub(super) fn among<'a>(results: impl IntoIterator<Item = (&'static str, &'a [f64])>) -> Option<Self> {
        results.into_iter().find_map(|(argument, values)| {
            if all_finite(values) {
                return None;
            }
            let element = values.iter().position(|value| !value.is_finite())?;
            Some(Self { argument, element: element + 1, rows: None, value: values[element] })
        })
    }

    /// Returns this result as an element of a matrix with so many rows.
    pub(super) fn of_matrix(self, rows: usize) -> Self {
        Self { rows: Some(rows), ..self }
    }
}

impl fmt::Display for NotFinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { argument, element, rows, value } = self;
        match rows {
            None => write!(f, "{argument}({element}) = {value}"),
            Some(rows) => write!(f, "{argument}({},{}) = {value}", (element - 1) % rows + 1, (element - 1) / rows + 1),
        }
    }
}

/// An access outside an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trespass {
    /// The argument's name.
    pub argument: Cow<'static, str>,
    /// The element touched, as Fortran counts (from 1).
    pub element: i64,
    /// Elements that the array has.
    pub length: usize,
    /// Whether it was written; `None` if the processor does not report this.
    pub writes: Option<bool>,
}

impl fmt::Display for Trespass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verb = match self.writes {
            Some(true) => "writes",
            Some(false) => "reads",
            None => "touches",
        };
        let Self { argument, element, length, .. } = self;
        write!(f, "{verb} {argument}({element}), which has {length} elements{}", of_hybrid(argument, *element, *length))
    }
}

/// Returns a note on what follows a stress of six components in hybrid elements; an empty text for all else.
fn of_hybrid(array: &str, element: i64, length: usize) -> &'static str {
    const SOLID: usize = 6;
    match (array, element, length) {
        ("STRESS", 7..=9, SOLID) => {
            " (STRESS(7) to STRESS(9) are there in ABAQUS's hybrid elements with HYBRID FORMULATION=TOTAL, which this program \
             does not have)"
        }
        _ => "",
    }
}

/// One array with a canary in front of it, and canaries or a page that cannot be written after it.
#[derive(Debug)]
pub(super) struct Guarded {
    name: &'static str,
    length: usize,
    /// The length as Fortran passes it.
    count: i32,
    first: *mut f64,
    /// Number of canaries after it.
    canaries: usize,
    /// Pattern of the canaries.
    outside: u64,
    /// Characters at its end that messages count instead of its values.
    characters: Option<usize>,
    memory: Memory,
}

#[derive(Debug)]
enum Memory {
    Canaries(#[allow(dead_code, reason = "owns what is written through a pointer")] Vec<f64>),
    Fenced(Watched),
}

// SAFETY: it owns its memory alone, and gives it out as borrowed slices.
unsafe impl Send for Guarded {}
// SAFETY: as above.
unsafe impl Sync for Guarded {}

impl Guarded {
    /// An array of zeros.
    pub(super) fn new(name: &'static str, length: usize) -> Self {
        let mut memory = vec![f64::from_bits(CANARY); 1 + length + CANARIES + SLACK];
        memory[1..=length].fill(0.0);
        let first = &raw mut memory[1];
        let count = i32::try_from(length).unwrap_or(i32::MAX);
        Self {
            name,
            length,
            count,
            first,
            canaries: CANARIES,
            outside: CANARY,
            characters: None,
            memory: Memory::Canaries(memory),
        }
    }

    /// Room for values of any kind at whose end an argument of characters stands, which messages name.
    pub(super) fn ending_with(name: &'static str, characters: usize, length: usize) -> Self {
        Self { characters: Some(characters), ..Self::new(name, length) }
    }

    /// Moves the array so that it ends where a page begins that cannot be written. Where the system does not give that, the
    /// canaries stay.
    pub(super) fn fence(&mut self) {
        let make = || {
            let shape = [1 + self.length, size_of::<f64>()];
            let mut fenced = Fenced::new(self.name, shape, Alignment::End, Outside::Readable(CANARY)).ok()?;
            match self.characters {
                None => fenced.count_from_second(),
                Some(characters) => fenced.count_characters(characters),
            }
            Some(fenced)
        };
        let Some(watched) = watch(make) else { return };
        let front: *mut f64 = watched.address().cast();
        // SAFETY: there is room for one value in front and for as many as the array has.
        let first = unsafe {
            front.write(f64::from_bits(CANARY));
            std::ptr::copy_nonoverlapping(self.first, front.add(1), self.length);
            front.add(1)
        };
        (self.first, self.canaries, self.memory) = (first, 0, Memory::Fenced(watched));
    }

    /// Puts a pattern in front of the array and after it. As long as it is not [`CANARY`], a write past the end of a fenced
    /// array does not end the process.
    pub(super) fn surround(&mut self, pattern: u64) {
        self.outside = pattern;
        // SAFETY: one value stands in front.
        unsafe { self.first.sub(1).write(f64::from_bits(pattern)) };
        match &self.memory {
            // SAFETY: so many values stand after it.
            Memory::Canaries(_) => unsafe {
                let after = self.first.add(self.length);
                std::slice::from_raw_parts_mut(after, CANARIES + SLACK).fill(f64::from_bits(pattern));
            },
            Memory::Fenced(watched) => watched.fill_after(pattern, pattern != CANARY),
        }
    }

    #[inline]
    pub(super) fn as_slice(&self) -> &[f64] {
        // SAFETY: the array's memory, which it owns.
        unsafe { std::slice::from_raw_parts(self.first, self.length) }
    }

    #[inline]
    pub(super) fn as_mut_slice(&mut self) -> &mut [f64] {
        // SAFETY: as above.
        unsafe { std::slice::from_raw_parts_mut(self.first, self.length) }
    }

    #[inline]
    pub(super) fn as_mut_ptr(&mut self) -> *mut f64 {
        self.first
    }

    /// The argument's name.
    pub(super) fn name(&self) -> &'static str {
        self.name
    }

    /// Takes over values, as many as there are.
    #[inline]
    pub(super) fn hold(&mut self, values: &[f64]) {
        if values.len() != self.length {
            let is_fenced = self.canaries == 0;
            *self = Self::new(self.name, values.len());
            if is_fenced {
                self.fence();
            }
        }
        self.as_mut_slice().copy_from_slice(values);
    }

    /// The length as an argument (NSTATV, NPROPS).
    pub(super) fn count(&self) -> &i32 {
        &self.count
    }

    /// Checks the canaries and restores them.
    #[inline]
    pub(super) fn check(&mut self) -> Result<(), Overrun> {
        // SAFETY: so many values stand around the array.
        let (front, back) = unsafe {
            let back = std::slice::from_raw_parts_mut(self.first.add(self.length), self.canaries);
            (&mut *self.first.sub(1), back)
        };
        let outside = self.outside;
        if front.to_bits() == outside && back.iter().all(|x| x.to_bits() == outside) {
            return Ok(());
        }
        let offset = back.iter().position(|x| x.to_bits() != outside);
        *front = f64::from_bits(outside);
        back.fill(f64::from_bits(outside));
        let length = self.characters.unwrap_or(self.length);
        let size = if self.characters.is_some() { size_of::<f64>() } else { 1 };
        let element = offset.map_or(0, |offset| i64::try_from(length + 1 + size * offset).unwrap_or(i64::MAX));
        Err(Overrun { array: self.name, element, length })
    }
}

/// Returns whether numbers are the same to the last bit.
#[inline]
pub fn same_bits(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// Characters of CMNAME, CINAME and the like.
pub(super) const NAME_LENGTH: usize = 80;

/// A Fortran CHARACTER*80: upper case, blank-padded.
pub(super) fn fortran_name(name: &str) -> [u8; NAME_LENGTH] {
    let mut padded = [b' '; NAME_LENGTH];
    for (target, source) in padded.iter_mut().zip(name.bytes()) {
        *target = source.to_ascii_uppercase();
    }
    padded
}
