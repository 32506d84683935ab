//! Arguments of a plugin other than its arrays: inputs, and numbers that it may write.
//!
//! A plugin may write into an input, as many UMATs use DSTRAN or PROPS as working space, but nobody else ever sees it.
//! A library whose metadata do not vouch for it gets a copy of the inputs in each call. What it changes there is lost
//! after the call, and recorded so that the user can be warned once ([`super::Library::written_inputs`]). Writing
//! outside an argument is always an error.

use super::memory::{CANARY, Guarded, Overrun};

/// Inputs in one piece, which is copied and compared as a whole.
///
/// # Safety
/// A plain structure without padding, a multiple of eight bytes long.
pub unsafe trait Inputs: Copy + Default {
    /// Names of the arguments with their offsets, bytes, in order; the last one is of characters.
    const PLACES: &'static [(&'static str, usize)];
}

/// Numbers that a plugin writes.
pub trait Outputs: Copy {
    /// Checks the canaries after each number.
    fn check(&self) -> Result<(), Overrun>;
    /// PNEWDT.
    fn pnewdt(&self) -> f64;
}

/// Declares [`Inputs`].
macro_rules! inputs {
    (
        $(#[$doc:meta])* $name:ident
        { $($(#[$field_doc:meta])* $visibility:vis $field:ident $argument:literal: $type:ty,)+ }
    ) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name { $($(#[$field_doc])* $visibility $field: $type,)+ }

        impl Default for $name {
            /// All are 0.
            fn default() -> Self {
                // SAFETY: plain values, of which any bits are some.
                unsafe { std::mem::zeroed() }
            }
        }

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

            #[inline]
            fn pnewdt(&self) -> f64 {
                self.pnewdt.values[0]
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
                $($output: (&raw mut (*$outputs).$output.values).cast(),)+
            }
        }
    };
}
pub(super) use {arguments, inputs, outputs};

/// Element type of an output.
pub trait Number: Copy + Default {
    /// Pattern in front of and after the numbers.
    const CANARY: Self;
    /// Returns whether it is that, to the last bit.
    fn is_canary(&self) -> bool;
}

impl Number for f64 {
    const CANARY: Self = Self::from_bits(CANARY);

    #[inline]
    fn is_canary(&self) -> bool {
        self.to_bits() == CANARY
    }
}

impl Number for i32 {
    const CANARY: Self = CANARY as Self;

    #[inline]
    fn is_canary(&self) -> bool {
        *self == Self::CANARY
    }
}

/// Numbers between canaries.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Between<T, const N: usize> {
    front: T,
    pub(super) values: [T; N],
    back: T,
}

/// Doubles between canaries.
pub type Numbers<const N: usize> = Between<f64, N>;
/// An integer between canaries.
pub type Integer = Between<i32, 1>;

impl<T: Number, const N: usize> Default for Between<T, N> {
    fn default() -> Self {
        [T::default(); N].into()
    }
}

impl<T: Number> From<T> for Between<T, 1> {
    #[inline]
    fn from(value: T) -> Self {
        [value].into()
    }
}

impl<T: Number, const N: usize> From<[T; N]> for Between<T, N> {
    #[inline]
    fn from(values: [T; N]) -> Self {
        Self { front: T::CANARY, values, back: T::CANARY }
    }
}

impl<T: Number, const N: usize> Between<T, N> {
    #[inline]
    pub(super) fn is_intact(&self) -> bool {
        self.front.is_canary() && self.back.is_canary()
    }

    pub(super) fn check(&self, array: &'static str) -> Result<(), Overrun> {
        overrun([self.front.is_canary(), self.back.is_canary()], array, N)
    }
}

/// Returns the error of a damaged canary: the one in front of the array, or the one after it.
fn overrun([front, back]: [bool; 2], array: &'static str, length: usize) -> Result<(), Overrun> {
    let element = if front { i64::try_from(length + 1).unwrap_or(i64::MAX) } else { 0 };
    if front && back { Ok(()) } else { Err(Overrun { array, element, length }) }
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
    /// A copy of the inputs after the outputs, as [`Lent`]: no metadata vouch for the plugin.
    Lent(Guarded),
}

/// Layout of the memory that is lent.
#[repr(C)]
struct Lent<I, O> {
    outputs: O,
    /// Canary.
    front: u64,
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
                    ((*lent).front, (*lent).inputs) = (CANARY, self.inputs);
                    (&raw const (*lent).inputs, &raw mut (*lent).outputs)
                }
            }
        }
    }

    /// Checks what a call wrote. Returns whether the inputs are unchanged.
    ///
    /// # Errors
    /// The call wrote past an output or past the inputs.
    #[inline]
    pub(super) fn take_back(&mut self) -> Result<bool, Overrun> {
        let Shared::Lent(memory) = &mut self.shared else { return Ok(true) };
        memory.check()?;
        if let Err(overrun) = self.outputs().check() {
            *self.outputs_mut() = O::default();
            return Err(overrun);
        }
        let Some(lent) = self.lent() else { return Ok(true) };
        let first = I::PLACES.first().map_or("", |(name, _)| name);
        let length = I::PLACES.get(1).map_or(0, |(_, end)| end / size_of::<f64>());
        overrun([lent.front == CANARY, true], first, length)?;
        Ok(bytes(&lent.inputs) == bytes(&self.inputs))
    }

    /// Returns the memory that was lent to the plugin.
    #[inline]
    fn lent(&self) -> Option<&Lent<I, O>> {
        let Shared::Lent(memory) = &self.shared else { return None };
        // SAFETY: as in `outputs`.
        Some(unsafe { &*memory.as_slice().as_ptr().cast() })
    }

    /// Names of the inputs that the last call changed, each with its neighbours in memory that it may have meant: the array
    /// before it, if of the input the first element changed, and the one after it, if the last one did. Neither of an array that
    /// changed at both ends, nor an array that changed itself.
    pub(super) fn written(&self) -> Vec<(&'static str, [Option<&'static str>; 2])> {
        const ELEMENT: usize = size_of::<f64>();
        let Some(lent) = self.lent() else { return Vec::new() };
        let (before, after) = (bytes(&self.inputs), bytes(&lent.inputs));
        let end = |k: usize| I::PLACES.get(k + 1).map_or(before.len(), |(_, start)| *start);
        let differs = |start: usize, end: usize| before[start..end] != after[start..end];
        let array = |k: usize| {
            let (name, start) = *I::PLACES.get(k)?;
            (end(k) - start > ELEMENT && !differs(start, end(k))).then_some(name)
        };
        let written = |(k, (name, start)): (usize, &(&'static str, usize))| {
            let (start, end) = (*start, end(k));
            let ends = [differs(start, end.min(start + ELEMENT)), differs(start.max(end.saturating_sub(ELEMENT)), end)];
            let is_array = end - start > ELEMENT;
            let neighbour = |is_near: bool, k: Option<usize>| {
                k.and_then(array).filter(|_| is_near && !(is_array && ends == [true; 2]))
            };
            differs(start, end)
                .then(|| (*name, [neighbour(ends[0], k.checked_sub(1)), neighbour(ends[1], Some(k + 1))]))
        };
        I::PLACES.iter().enumerate().filter_map(written).collect()
    }
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

fn bytes<I: Inputs>(inputs: &I) -> &[u8] {
    // SAFETY: plain values without padding.
    unsafe { std::slice::from_raw_parts((&raw const *inputs).cast(), size_of::<I>()) }
}
