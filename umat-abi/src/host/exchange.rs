//! What a plugin gets besides its arrays: arguments that are inputs, and numbers that it may write.
//!
//! Rule: a plugin may write into an input (many UMATs use DSTRAN or PROPS as working space), but nobody but itself ever sees
//! it. A library that nobody vouches for gets a copy of the inputs in each call; what it changed there is lost with the call,
//! and remembered, so that the user can be told once ([`super::Library::written_inputs`]). Writing outside an argument is an
//! error always.

use super::memory::{CANARY, Guarded, Overrun};

/// Inputs in one piece, which is copied and compared as a whole.
///
/// # Safety
/// A plain structure without padding, a multiple of eight bytes long.
pub unsafe trait Inputs: Copy {
    /// Names of the arguments with their offsets, bytes, in order; the last one is of characters.
    const PLACES: &'static [(&'static str, usize)];
}

/// Numbers that a plugin writes.
pub trait Outputs: Copy {
    /// Looks behind each.
    fn check(&self) -> Result<(), Overrun>;
}

/// Declares [`Inputs`].
macro_rules! inputs {
    (
        $(#[$doc:meta])* $name:ident
        { $($(#[$field_doc:meta])* $visibility:vis $field:ident $argument:literal: $type:ty,)+ }
    ) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct $name { $($(#[$field_doc])* $visibility $field: $type,)+ }

        const _: () = assert!(size_of::<$name>() == 0 $(+ size_of::<$type>())+, "padding");
        const _: () = assert!(size_of::<$name>() % size_of::<u64>() == 0, "words");

        // SAFETY: as asserted.
        unsafe impl $crate::host::exchange::Inputs for $name {
            const PLACES: &'static [(&'static str, usize)] =
                &[$(($argument, std::mem::offset_of!($name, $field))),+];
        }
    };
}

/// Declares [`Outputs`].
macro_rules! outputs {
    ($name:ident { $($field:ident $argument:literal: $type:ty,)+ }) => {
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $name { $(pub(super) $field: $type,)+ }

        impl $crate::host::exchange::Outputs for $name {
            #[inline]
            fn check(&self) -> Result<(), $crate::host::memory::Overrun> {
                if [$(self.$field.is_intact()),+].iter().all(|intact| *intact) {
                    return Ok(());
                }
                $(self.$field.check($argument)?;)+
                Ok(())
            }
        }
    };
}
pub(super) use {inputs, outputs};

/// Numbers with a canary behind them.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Numbers<const N: usize> {
    pub(super) values: [f64; N],
    canary: u64,
}

impl<const N: usize> Default for Numbers<N> {
    fn default() -> Self {
        Self { values: [0.0; N], canary: CANARY }
    }
}

/// An integer with a canary behind it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Integer {
    pub(super) value: i32,
    canary: i32,
}

impl Integer {
    const CANARY: i32 = CANARY as i32;
}

impl Default for Integer {
    fn default() -> Self {
        Self { value: 0, canary: Self::CANARY }
    }
}

impl From<f64> for Numbers<1> {
    #[inline]
    fn from(value: f64) -> Self {
        Self { values: [value], canary: CANARY }
    }
}

impl From<[f64; 2]> for Numbers<2> {
    #[inline]
    fn from(values: [f64; 2]) -> Self {
        Self { values, canary: CANARY }
    }
}

impl From<i32> for Integer {
    #[inline]
    fn from(value: i32) -> Self {
        Self { value, canary: Self::CANARY }
    }
}

impl<const N: usize> Numbers<N> {
    #[inline]
    pub(super) fn is_intact(&self) -> bool {
        self.canary == CANARY
    }

    pub(super) fn check(&self, array: &'static str) -> Result<(), Overrun> {
        overrun(self.is_intact(), array, N)
    }
}

impl Integer {
    #[inline]
    pub(super) fn is_intact(&self) -> bool {
        self.canary == Self::CANARY
    }

    pub(super) fn check(&self, array: &'static str) -> Result<(), Overrun> {
        overrun(self.is_intact(), array, 1)
    }
}

fn overrun(is_intact: bool, array: &'static str, length: usize) -> Result<(), Overrun> {
    let element = i64::try_from(length + 1).unwrap_or(i64::MAX);
    if is_intact { Ok(()) } else { Err(Overrun { array, element, length }) }
}

/// The arguments of a call object that are no arrays of their own.
#[derive(Debug)]
pub(super) struct Exchange<I, O> {
    /// As the host sets them.
    pub(super) inputs: I,
    /// As the last call left them.
    pub(super) outputs: O,
    /// What a plugin gets in their place that nobody vouches for.
    lent: Option<Guarded>,
}

/// What lies in the memory that is lent.
#[repr(C)]
struct Lent<I, O> {
    outputs: O,
    inputs: I,
}

impl<I: Inputs, O: Outputs + Default> Exchange<I, O> {
    /// `lends`: nobody vouches for the plugin.
    pub(super) fn new(inputs: I, lends: bool) -> Self {
        let lend = || {
            let (last, start) = I::PLACES.last().copied().unwrap_or_default();
            Guarded::ending_with(last, size_of::<I>() - start, size_of::<Lent<I, O>>() / size_of::<u64>())
        };
        Self { inputs, outputs: O::default(), lent: lends.then(lend) }
    }

    /// As [`Guarded::fence`].
    pub(super) fn fence(&mut self) {
        self.lent.iter_mut().for_each(Guarded::fence);
    }

    /// What the plugin gets.
    #[inline]
    pub(super) fn hand_over(&mut self) -> (*const I, *mut O) {
        let Self { inputs, outputs, lent } = self;
        let Some(lent) = lent else { return (inputs, outputs) };
        let lent: *mut Lent<I, O> = lent.as_mut_ptr().cast();
        // SAFETY: there is room for both, aligned like doubles.
        unsafe {
            (*lent).outputs = *outputs;
            (*lent).inputs = *inputs;
            (&raw const (*lent).inputs, &raw mut (*lent).outputs)
        }
    }

    /// Takes over what a call wrote. Returns whether the inputs are as they were.
    ///
    /// # Errors
    /// It wrote behind an output, or behind the inputs.
    #[inline]
    pub(super) fn take_back(&mut self) -> Result<bool, Overrun> {
        let Self { inputs, outputs, lent } = self;
        let Some(lent) = lent else { return Ok(true) };
        lent.check()?;
        // SAFETY: as above; any bits are numbers.
        let lent = unsafe { &*lent.as_mut_ptr().cast::<Lent<I, O>>() };
        lent.outputs.check()?;
        *outputs = lent.outputs;
        Ok(words(inputs) == words(&lent.inputs))
    }

    /// Names of the inputs that the last call changed.
    pub(super) fn written(&mut self) -> Vec<&'static str> {
        let Some(lent) = &mut self.lent else { return Vec::new() };
        // SAFETY: as above.
        let lent = unsafe { &*lent.as_mut_ptr().cast::<Lent<I, O>>() };
        let (before, after) = (bytes(&self.inputs), bytes(&lent.inputs));
        let ends = I::PLACES.iter().skip(1).map(|(_, start)| *start).chain([before.len()]);
        let changed =
            I::PLACES.iter().zip(ends).filter(|((_, start), end)| before[*start..*end] != after[*start..*end]);
        changed.map(|((name, _), _)| *name).collect()
    }
}

fn words<I: Inputs>(inputs: &I) -> &[u64] {
    // SAFETY: plain values without padding, aligned like doubles.
    unsafe { std::slice::from_raw_parts((&raw const *inputs).cast(), size_of::<I>() / size_of::<u64>()) }
}

fn bytes<I: Inputs>(inputs: &I) -> &[u8] {
    // SAFETY: as above.
    unsafe { std::slice::from_raw_parts((&raw const *inputs).cast(), size_of::<I>()) }
}
