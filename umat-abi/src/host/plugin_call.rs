//! Part that calls of UMAT, UINTER and FRIC share: the arrays that the plugin writes, the properties, the inputs and outputs.

use super::call::CallOutcome;
use super::exchange::{Exchange, Inputs, Outputs};
use super::guard::{self, Guard};
use super::library::Library;
use super::memory::{Guarded, Overrun, same_bits};
use super::recorder::{self, Slot};
use std::ops::{Deref, DerefMut};

/// PNEWDT on entry: large, so that a plugin that takes the minimum or assigns is understood alike.
pub(super) const PNEWDT_ON_ENTRY: f64 = 1e36;

/// A call, which gives access to its inputs by [`Deref`].
#[derive(Debug)]
pub struct PluginCall<I, O> {
    /// Keeps the function's code loaded.
    library: Library,
    plugin: String,
    pub(super) guard: Option<Guard>,
    pub(super) stress: Guarded,
    pub(super) tangent: Guarded,
    pub(super) statev: Guarded,
    /// PROPS as the host has them, and as the plugin gets them.
    own_props: Vec<f64>,
    pub(super) props: Guarded,
    pub(super) exchange: Exchange<I, O>,
    /// PREDEF and DPRED of a plugin that nobody vouches for.
    lent_fields: Option<[Guarded; 2]>,
    pub(super) pnewdt: f64,
    /// Slot in which calls are noted, if they are.
    pub(super) slot: Option<Slot>,
}

impl<I: Inputs, O: Outputs + Default> PluginCall<I, O> {
    /// `names` are those of the stress and the tangent; `inputs` are made of the numbers of components, states and properties as
    /// Fortran passes them.
    pub(super) fn new(
        library: &Library,
        symbol: Option<&str>,
        name: &str,
        (components, nstatv, props): (usize, usize, &[f64]),
        names: [&'static str; 2],
        inputs: impl FnOnce([i32; 3]) -> I,
    ) -> Self {
        let mut guarded_props = Guarded::new("PROPS", props.len());
        guarded_props.as_mut_slice().copy_from_slice(props);
        let (stress, statev) = (Guarded::new(names[0], components), Guarded::new("STATEV", nstatv));
        let guard = library.guard();
        let inputs = inputs([&stress, &statev, &guarded_props].map(|array| *array.count()));
        Self {
            library: library.clone(),
            plugin: library.name_of_law(name),
            exchange: Exchange::new(inputs, guard.is_some()),
            lent_fields: guard.is_some().then(|| ["PREDEF", "DPRED"].map(|name| Guarded::new(name, 1))),
            guard,
            stress,
            tangent: Guarded::new(names[1], components * components),
            statev,
            own_props: props.to_vec(),
            props: guarded_props,
            pnewdt: PNEWDT_ON_ENTRY,
            slot: Slot::new(library, symbol, name),
        }
    }

    /// Makes every array end at a page that cannot be written, if the recorder of this process asks for it
    /// ([`recorder::Recorder::fence_arrays`]). A write past the end of an array then ends the process, and the recorder
    /// names the array.
    pub fn fence(&mut self) {
        if !recorder::fences_arrays() {
            return;
        }
        for array in [&mut self.stress, &mut self.tangent, &mut self.statev, &mut self.props] {
            array.fence();
        }
        self.lent_fields.iter_mut().flatten().for_each(Guarded::fence);
        self.exchange.fence();
    }

    /// Puts a pattern around every array ([`Guarded::surround`]).
    pub(super) fn surround(&mut self, pattern: u64) {
        for array in [&mut self.stress, &mut self.tangent, &mut self.statev, &mut self.props] {
            array.surround(pattern);
        }
        self.lent_fields.iter_mut().flatten().for_each(|array| array.surround(pattern));
    }

    /// PREDEF and DPRED as the plugin gets them.
    #[inline(always)]
    pub(super) fn hand_over_fields(&mut self, own: [&[f64]; 2]) -> [*const f64; 2] {
        let Some(lent) = &mut self.lent_fields else { return own.map(<[f64]>::as_ptr) };
        for (lent, own) in lent.iter_mut().zip(own) {
            lent.hold(own);
        }
        lent.each_mut().map(|lent| lent.as_mut_ptr().cast_const())
    }

    /// Makes a call and takes over its answer, as [`Self::take_back`] does.
    pub(super) fn run(
        &mut self,
        call: impl FnOnce(),
        fields: [&[f64]; 2],
        place: impl Fn(&I) -> [i32; 4],
    ) -> Result<(), Overrun> {
        guard::run(self.guard.as_ref(), call);
        if let Some(slot) = &mut self.slot {
            slot.leave();
        }
        self.take_back(fields, place)
    }

    /// Takes over the answer and checks that the call left the rest unchanged; `place` returns step, increment,
    /// element, point.
    #[inline(always)]
    pub(super) fn take_back(&mut self, fields: [&[f64]; 2], place: impl Fn(&I) -> [i32; 4]) -> Result<(), Overrun> {
        let has_inputs = self.exchange.take_back()?;
        self.pnewdt = self.exchange.outputs().pnewdt();
        self.stress.check()?;
        self.statev.check()?;
        self.tangent.check()?;
        self.props.check()?;
        let Some(lent) = &mut self.lent_fields else { return Ok(()) };
        for array in &mut *lent {
            array.check()?;
        }
        let has_fields = lent.iter().zip(fields).all(|(lent, own)| same_bits(lent.as_slice(), own));
        if !has_inputs || !has_fields || !same_bits(self.props.as_slice(), &self.own_props) {
            self.note_written(fields, place(&self.exchange.inputs));
        }
        Ok(())
    }

    /// The call wrote into inputs.
    #[cold]
    fn note_written(&mut self, fields: [&[f64]; 2], place: [i32; 4]) {
        let mut written = self.exchange.written();
        let arrays = self.lent_fields.iter().flatten().zip(fields).chain([(&self.props, self.own_props.as_slice())]);
        written.extend(
            arrays.filter(|(lent, own)| !same_bits(lent.as_slice(), own)).map(|(lent, _)| (lent.name(), [None; 2])),
        );
        self.props.as_mut_slice().copy_from_slice(&self.own_props);
        if let Some(guard) = &self.guard {
            guard.note_written(written, place);
        }
    }
}

impl<I, O> PluginCall<I, O> {
    /// The library.
    pub(super) fn library(&self) -> &Library {
        &self.library
    }

    /// Makes the calls of a child process, which are no business of those who watch its parent.
    pub fn leave_record(&mut self) {
        std::mem::forget(self.slot.take());
    }

    /// Returns what messages call the plugin.
    pub fn plugin(&self) -> &str {
        &self.plugin
    }

    /// STRESS (UINTER: \[0\] > 0 is compression) or TAU.
    pub fn stress(&self) -> &[f64] {
        self.stress.as_slice()
    }

    /// STRESS or TAU, to be set before a call.
    pub fn stress_mut(&mut self) -> &mut [f64] {
        self.stress.as_mut_slice()
    }

    /// STATEV.
    pub fn statev(&self) -> &[f64] {
        self.statev.as_slice()
    }

    /// STATEV, to be set before a call.
    pub fn statev_mut(&mut self) -> &mut [f64] {
        self.statev.as_mut_slice()
    }

    /// PROPS.
    pub fn props(&self) -> &[f64] {
        &self.own_props
    }

    /// DDSDDE, DDSDDR or DDTDDG (row, column) of the last call, indices from 0.
    #[inline]
    pub fn tangent(&self, row: usize, column: usize) -> f64 {
        self.tangent.as_slice()[column * self.stress.as_slice().len() + row]
    }

    /// Returns what the last call came back with, also if it wrote outside an array.
    #[inline]
    pub fn outcome(&self) -> CallOutcome {
        CallOutcome::of(self.pnewdt)
    }
}

impl<I, O> Deref for PluginCall<I, O> {
    type Target = I;

    #[inline]
    fn deref(&self) -> &I {
        &self.exchange.inputs
    }
}

impl<I, O> DerefMut for PluginCall<I, O> {
    #[inline]
    fn deref_mut(&mut self) -> &mut I {
        &mut self.exchange.inputs
    }
}
