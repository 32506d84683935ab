//! Arguments of a plugin besides its arrays: inputs, and numbers that it may write.
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

/// Fills an argument list: what the call has of its own, and the addresses of inputs and outputs of the same names.
macro_rules! arguments {
    (
        $arguments:ident { $($own:ident: $value:expr,)+ }
        $inputs:ident: $($input:ident)+; $outputs:ident: $($output:ident)+;
    ) => {
        // SAFETY: both live as long as the call object, and only addresses are taken.
        unsafe {
            $arguments {
                $($own: $value,)+
                $($input: (&raw const (*$inputs).$input).cast(),)+
                $($output: (&raw mut (*$outputs).$output).cast(),)+
            }
        }
    };
}
pub(super) use {arguments, inputs, outputs};

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
    /// Inputs as the host sets them.
    pub(super) inputs: I,
    shared: Shared<O>,
}

/// Memory that the plugin is given.
#[derive(Debug)]
enum Shared<O> {
    /// Outputs kept here; the inputs are lent themselves.
    Own(O),
    /// A copy of the inputs behind the outputs, as [`Lent`]: nobody vouches for the plugin.
    Lent(Guarded),
}

/// Layout of the memory that is lent.
#[repr(C)]
struct Lent<I, O> {
    outputs: O,
    inputs: I,
}

impl<I: Inputs, O: Outputs + Default> Exchange<I, O> {
    /// `lends`: nobody vouches for the plugin.
    pub(super) fn new(inputs: I, lends: bool) -> Self {
        let mut this = Self { inputs, shared: Shared::Own(O::default()) };
        if lends {
            let (last, start) = I::PLACES.last().copied().unwrap_or_default();
            let words = size_of::<Lent<I, O>>() / size_of::<u64>();
            this.shared = Shared::Lent(Guarded::ending_with(last, size_of::<I>() - start, words));
            *this.outputs_mut() = O::default();
        }
        this
    }

    /// Fences as [`Guarded::fence`] does.
    pub(super) fn fence(&mut self) {
        if let Shared::Lent(memory) = &mut self.shared {
            memory.fence();
        }
    }

    /// Returns the outputs as the last call left them.
    #[inline]
    pub(super) fn outputs(&self) -> &O {
        match &self.shared {
            Shared::Own(outputs) => outputs,
            // SAFETY: there is room for them, aligned like doubles; any bits are numbers.
            Shared::Lent(memory) => unsafe { &*memory.as_slice().as_ptr().cast() },
        }
    }

    /// Outputs, to be set before a call.
    #[inline]
    pub(super) fn outputs_mut(&mut self) -> &mut O {
        match &mut self.shared {
            Shared::Own(outputs) => outputs,
            // SAFETY: as above.
            Shared::Lent(memory) => unsafe { &mut *memory.as_mut_ptr().cast() },
        }
    }

    /// Returns what the plugin gets.
    #[inline]
    pub(super) fn hand_over(&mut self) -> (*const I, *mut O) {
        match &mut self.shared {
            Shared::Own(outputs) => (&raw const self.inputs, outputs),
            Shared::Lent(memory) => {
                let lent: *mut Lent<I, O> = memory.as_mut_ptr().cast();
                // SAFETY: there is room for both, aligned like doubles.
                unsafe {
                    (*lent).inputs = self.inputs;
                    (&raw const (*lent).inputs, &raw mut (*lent).outputs)
                }
            }
        }
    }

    /// Looks at what a call wrote. Returns whether the inputs are as they were.
    ///
    /// # Errors
    /// It wrote behind an output, or behind the inputs.
    #[inline]
    pub(super) fn take_back(&mut self) -> Result<bool, Overrun> {
        let Shared::Lent(memory) = &mut self.shared else { return Ok(true) };
        memory.check()?;
        if let Err(overrun) = self.outputs().check() {
            *self.outputs_mut() = O::default();
            return Err(overrun);
        }
        Ok(self.lent().is_none_or(|lent| words(lent) == words(&self.inputs)))
    }

    /// The copy of the inputs that the plugin got.
    #[inline]
    fn lent(&self) -> Option<&I> {
        let Shared::Lent(memory) = &self.shared else { return None };
        // SAFETY: as in `outputs`.
        Some(unsafe { &(*memory.as_slice().as_ptr().cast::<Lent<I, O>>()).inputs })
    }

    /// Names of the inputs that the last call changed, each with the array in front of it in memory if the change may be one
    /// behind the end of that: if it begins with the first element, and the array in front is as it was.
    pub(super) fn written(&self) -> Vec<(&'static str, Option<&'static str>)> {
        let Some(lent) = self.lent() else { return Vec::new() };
        let (before, after) = (bytes(&self.inputs), bytes(lent));
        let ends = I::PLACES.iter().skip(1).map(|(_, start)| *start).chain([before.len()]);
        let mut written = Vec::new();
        let mut in_front = None;
        for ((name, start), end) in I::PLACES.iter().zip(ends) {
            let differs = |end: usize| before[*start..end] != after[*start..end];
            if differs(end) {
                written.push((*name, in_front.filter(|_| differs(end.min(start + size_of::<f64>())))));
                in_front = None;
            } else {
                in_front = Some(*name).filter(|_| end - start > size_of::<f64>());
            }
        }
        written
    }
}

/// Inputs that are all 0.
pub(super) fn zeros<I: Inputs>() -> I {
    // SAFETY: plain values, of which any bits are some.
    unsafe { std::mem::zeroed() }
}

/// Inputs as the recorder notes them: in one piece.
#[inline]
pub(super) fn noted<I: Inputs>(inputs: &I) -> &[f64] {
    // SAFETY: plain values without padding, aligned like doubles; any bits are a number.
    unsafe { std::slice::from_raw_parts((&raw const *inputs).cast(), size_of::<I>() / size_of::<f64>()) }
}

/// Inputs that were noted; `None` if there are not as many words.
pub(super) fn from_noted<I: Inputs>(noted: &[f64]) -> Option<I> {
    // SAFETY: as many words are there; inputs are plain values, of which any bits are some.
    (noted.len() == size_of::<I>() / size_of::<f64>()).then(|| unsafe { noted.as_ptr().cast::<I>().read() })
}

fn words<I: Inputs>(inputs: &I) -> &[u64] {
    // SAFETY: plain values without padding, aligned like doubles.
    unsafe { std::slice::from_raw_parts((&raw const *inputs).cast(), size_of::<I>() / size_of::<u64>()) }
}

fn bytes<I: Inputs>(inputs: &I) -> &[u8] {
    // SAFETY: as above.
    unsafe { std::slice::from_raw_parts((&raw const *inputs).cast(), size_of::<I>()) }
}
