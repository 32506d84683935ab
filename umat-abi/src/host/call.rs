//! A safe call of a UMAT: every argument valid, buffers reused, what it must not write looked at.

use super::exchange::{Exchange, Numbers, inputs, outputs};
use super::guard::{Guard, run};
use super::library::{Library, LoadError};
use super::manner::Detour;
use super::memory::{Guarded, NotFinite, Overrun, fortran_name, same_bits};
use super::recorder::{self, Arguments, Slot, UmatRecord};
use crate::law::{Request, StressState};
use crate::metadata::flags;
use crate::umat::{UmatArguments, UmatFunction};
use std::ffi::c_char;
use std::ops::{Deref, DerefMut};

/// PNEWDT on entry: large, so that a plugin that takes the minimum or assigns is understood alike.
const PNEWDT_ON_ENTRY: f64 = 1e36;

/// What a call came back with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CallOutcome {
    /// The arrays hold the new values.
    Done,
    /// 0 < PNEWDT < 1: repeat with this fraction of the increment.
    CutBack(f64),
}

impl CallOutcome {
    /// From PNEWDT on return.
    #[inline]
    pub(super) fn of(pnewdt: f64) -> Self {
        if pnewdt > 0.0 && pnewdt < 1.0 { Self::CutBack(pnewdt) } else { Self::Done }
    }
}

inputs! {
    /// The arguments of UMAT that it must not change, but for PROPS, PREDEF and DPRED.
    UmatInputs {
        /// Total strain at the start of the increment, engineering shear.
        pub stran "STRAN": [f64; 6],
        /// Strain increment.
        pub dstran "DSTRAN": [f64; 6],
        /// Step time and total time at the start.
        pub time "TIME": [f64; 2],
        /// Time increment.
        pub dtime "DTIME": f64,
        /// Temperature at the start.
        pub temp "TEMP": f64,
        /// Temperature increment.
        pub dtemp "DTEMP": f64,
        /// Coordinates of the point.
        pub coords "COORDS": [f64; 3],
        /// Incremental rotation, column-major (`drot[column][row]`).
        pub drot "DROT": [[f64; 3]; 3],
        /// Characteristic length, mm.
        pub celent "CELENT": f64,
        /// Deformation gradient at the start, column-major.
        pub dfgrd0 "DFGRD0": [[f64; 3]; 3],
        /// Deformation gradient at the end, column-major.
        pub dfgrd1 "DFGRD1": [[f64; 3]; 3],
        /// Element number, from 1.
        pub noel "NOEL": i32,
        /// Integration point, from 1.
        pub npt "NPT": i32,
        /// Step number (from 1), procedure, NLGEOM flag, linear-perturbation flag.
        pub jstep "JSTEP": [i32; 4],
        /// Increment number, from 1.
        pub kinc "KINC": i32,
        ntens "NTENS": i32,
        pub(super) ndi "NDI": i32,
        nshr "NSHR": i32,
        nstatv "NSTATV": i32,
        nprops "NPROPS": i32,
        layer "LAYER": i32,
        kspt "KSPT": i32,
        cmname "CMNAME": [u8; 80],
    }
}

outputs! {
    UmatOutputs {
        sse "SSE": Numbers<1>,
        spd "SPD": Numbers<1>,
        scd "SCD": Numbers<1>,
        rpl "RPL": Numbers<1>,
        ddsddt "DDSDDT": Numbers<6>,
        drplde "DRPLDE": Numbers<6>,
        drpldt "DRPLDT": Numbers<1>,
        pnewdt "PNEWDT": Numbers<1>,
    }
}

/// One material point's arguments and the function that takes them.
///
/// Components are those of the stress state (3, 4 or 6). The caller sets the public fields (those of [`UmatInputs`] among
/// them) and the slices, calls, and reads the slices back.
#[derive(Debug)]
pub struct UmatCall {
    function: UmatFunction,
    /// Keeps the function's code loaded.
    _library: Library,
    plugin: String,
    honours_stress_only: bool,
    guard: Option<Guard>,
    stress_state: StressState,
    stress: Guarded,
    statev: Guarded,
    ddsdde: Guarded,
    /// PROPS as the host has them, and as the plugin gets them.
    own_props: Vec<f64>,
    props: Guarded,
    exchange: Exchange<UmatInputs, UmatOutputs>,
    /// PREDEF and DPRED of a plugin that nobody vouches for.
    lent_fields: Option<[Guarded; 2]>,
    /// Energies: stored, plastic, creep ("SCD").
    pub energies: [f64; 3],
    /// Field variables at the start. A call makes them at least one, and as many as `dpred`, by zeros.
    pub predef: Vec<f64>,
    /// Their increments.
    pub dpred: Vec<f64>,
    /// ε33 of plane stress where calls go through six components ([`Self::go_through`]): to be set to that of the start
    /// before a call, that of the end behind it.
    pub strain_33: f64,
    pnewdt: f64,
    /// Where calls are noted, if they are.
    slot: Option<Slot>,
    /// How calls are made that are not plain.
    pub(super) detour: Option<Box<Detour>>,
}

impl Deref for UmatCall {
    type Target = UmatInputs;

    #[inline]
    fn deref(&self) -> &UmatInputs {
        &self.exchange.inputs
    }
}

impl DerefMut for UmatCall {
    #[inline]
    fn deref_mut(&mut self) -> &mut UmatInputs {
        &mut self.exchange.inputs
    }
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// JSTEP(2): static stress analysis.
const STATIC_PROCEDURE: i32 = 1;

impl UmatCall {
    /// Prepares calls of `library`'s UMAT with these properties.
    ///
    /// `name` is passed as CMNAME (upper case). A library with metadata is trusted to keep the floating-point
    /// modes and, if it says so, to understand DDSDDE = NULL as "stress only".
    ///
    /// # Errors
    /// [`LoadError::Symbol`] if the library has no such entry point.
    pub fn new(
        library: &Library,
        symbol: Option<&str>,
        name: &str,
        stress_state: StressState,
        nstatv: usize,
        props: &[f64],
    ) -> Result<Self, LoadError> {
        let function = library.umat(symbol)?;
        let (ntens, ndi, nshr) = stress_state.counts();
        let components = stress_state.components().len();
        let mut guarded_props = Guarded::new("PROPS", props.len());
        guarded_props.as_mut_slice().copy_from_slice(props);
        let statev = Guarded::new("STATEV", nstatv);
        let described = !library.laws().is_empty();
        let guard = library.guard();
        let inputs = UmatInputs {
            stran: [0.0; 6],
            dstran: [0.0; 6],
            time: [0.0; 2],
            dtime: 1.0,
            temp: 0.0,
            dtemp: 0.0,
            coords: [0.0; 3],
            drot: IDENTITY,
            celent: 1.0,
            dfgrd0: IDENTITY,
            dfgrd1: IDENTITY,
            noel: 1,
            npt: 1,
            jstep: [1, STATIC_PROCEDURE, 0, 0],
            kinc: 1,
            ntens,
            ndi,
            nshr,
            nstatv: *statev.count(),
            nprops: *guarded_props.count(),
            // the only layer and section point
            layer: 1,
            kspt: 1,
            cmname: fortran_name(name),
        };
        let lends = guard.is_some();
        Ok(Self {
            function,
            _library: library.clone(),
            plugin: library.name_of_law(name),
            honours_stress_only: described && library.laws().iter().all(|law| law.has(flags::STRESS_ONLY)),
            guard,
            stress_state,
            stress: Guarded::new("STRESS", components),
            statev,
            ddsdde: Guarded::new("DDSDDE", components * components),
            own_props: props.to_vec(),
            props: guarded_props,
            exchange: Exchange::new(inputs, lends),
            lent_fields: lends.then(|| ["PREDEF", "DPRED"].map(|name| Guarded::new(name, 1))),
            energies: [0.0; 3],
            predef: vec![0.0],
            dpred: vec![0.0],
            strain_33: 0.0,
            pnewdt: PNEWDT_ON_ENTRY,
            slot: Slot::new(library, symbol, name),
            detour: None,
        })
    }

    /// Lets every array end where a page begins that cannot be written, where the recorder of this process wants that
    /// ([`recorder::Recorder::fence_arrays`]): a store behind one ends the process, and the recorder tells which.
    pub fn fence(&mut self) {
        if !recorder::fences_arrays() {
            return;
        }
        for array in [&mut self.stress, &mut self.statev, &mut self.ddsdde, &mut self.props] {
            array.fence();
        }
        self.lent_fields.iter_mut().flatten().for_each(Guarded::fence);
        self.exchange.fence();
        if let Some(solid) = self.detour.as_mut().and_then(|detour| detour.solid_mut()) {
            solid.fence();
        }
    }

    /// What messages call the plugin.
    pub fn plugin(&self) -> &str {
        &self.plugin
    }

    /// Number of stress components.
    pub fn ntens(&self) -> usize {
        self.stress.as_slice().len()
    }

    /// NDI.
    pub(super) fn ndi(&self) -> i32 {
        self.exchange.inputs.ndi
    }

    /// The stress state it was made for.
    pub fn stress_state(&self) -> StressState {
        self.stress_state
    }

    /// STRESS.
    pub fn stress(&self) -> &[f64] {
        self.stress.as_slice()
    }

    /// STRESS, to be set before a call.
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

    /// DDSDDE(row, column) of the last call, indices from 0.
    #[inline]
    pub fn tangent(&self, row: usize, column: usize) -> f64 {
        self.ddsdde.as_slice()[column * self.ntens() + row]
    }

    /// DDSDDE, column-major.
    pub fn ddsdde(&self) -> &[f64] {
        self.ddsdde.as_slice()
    }

    /// Returns a result of the last call that a host cannot go on with, DDSDDE aside, which not every host needs.
    #[inline]
    pub fn not_finite(&self) -> Option<NotFinite> {
        let [sse, spd, scd] = self.energies.each_ref().map(std::slice::from_ref);
        let states = [("STRESS", self.stress()), ("STATEV", self.statev())];
        NotFinite::among(states.into_iter().chain([("SSE", sse), ("SPD", spd), ("SCD", scd)]))
    }

    /// Returns an entry of DDSDDE of the last call that is no number.
    #[inline]
    pub fn moduli_not_finite(&self) -> Option<NotFinite> {
        NotFinite::among([("DDSDDE", self.ddsdde())])
    }

    /// DDSDDE, to be set behind a call.
    pub(super) fn ddsdde_mut(&mut self) -> &mut [f64] {
        self.ddsdde.as_mut_slice()
    }

    /// As if the last call had asked for a fraction of the increment.
    pub(super) fn cut_back(&mut self, fraction: f64) -> CallOutcome {
        self.pnewdt = fraction;
        self.outcome()
    }

    /// As if the last call had asked for nothing.
    pub(super) fn restore_outcome(&mut self) {
        self.pnewdt = PNEWDT_ON_ENTRY;
    }

    /// Whether DDSDDE = NULL is understood.
    pub fn honours_stress_only(&self) -> bool {
        self.honours_stress_only
    }

    /// Calls the plugin. DDSDDE is zeroed before; a plugin that cannot compute the stress alone computes both.
    ///
    /// # Errors
    /// [`Overrun`] if it wrote behind an array; the host's memory is intact, the point's values are not to be used.
    #[inline]
    pub fn call(&mut self, request: Request) -> Result<CallOutcome, Overrun> {
        if self.detour.is_some() {
            return self.call_by_detour(request);
        }
        self.call_with_tangent_filled(request, 0.0)
    }

    /// As [`Self::call`], with every entry of DDSDDE set to `filling` before: entries that the plugin leaves unset
    /// show.
    ///
    /// # Errors
    /// As [`Self::call`].
    pub fn call_with_tangent_filled(&mut self, request: Request, filling: f64) -> Result<CallOutcome, Overrun> {
        let stress_only = request == Request::Stress && self.honours_stress_only;
        // SAFETY: the arguments stay as they are.
        unsafe { self.call_with(stress_only, filling, |_| ()) }
    }

    /// Calls the plugin `count` times with the same arguments, for measurements: STRESS and STATEV are as they are now
    /// before each call and at the end, DDSDDE is not zeroed.
    ///
    /// # Errors
    /// As [`Self::call`].
    pub fn repeat(&mut self, count: usize, request: Request) -> Result<CallOutcome, Overrun> {
        let stress_only = request == Request::Stress && self.honours_stress_only;
        let mut start = [0.0; 6];
        let start = &mut start[..self.ntens()];
        start.copy_from_slice(self.stress.as_slice());
        let states = self.statev.as_slice().to_vec();
        for _ in 0..count {
            self.stress.as_mut_slice().copy_from_slice(start);
            self.statev.as_mut_slice().copy_from_slice(&states);
            let arguments = self.arguments(stress_only);
            // SAFETY: every pointer is valid for the sizes that the counts tell.
            run(self.guard.as_ref(), || unsafe { arguments.call(self.function) });
            self.take_back()?;
        }
        self.stress.as_mut_slice().copy_from_slice(start);
        self.statev.as_mut_slice().copy_from_slice(&states);
        Ok(self.outcome())
    }

    /// Calls the plugin on arrays of the caller's own, as a finite element program does: STRAN, DSTRAN and STRESS of NTENS
    /// values, STATEV of NSTATV. DDSDDE is the call's own, not zeroed. Nothing is made sure of behind the arrays.
    ///
    /// # Panics
    /// If an array has another length.
    #[inline]
    pub fn call_in_place(
        &mut self,
        stran: &[f64],
        dstran: &[f64],
        stress: &mut [f64],
        statev: &mut [f64],
        request: Request,
    ) -> CallOutcome {
        let ntens = self.ntens();
        assert!(stran.len() == ntens && dstran.len() == ntens && stress.len() == ntens, "NTENS values");
        assert!(statev.len() == self.statev.as_slice().len(), "NSTATV values");
        let stress_only = request == Request::Stress && self.honours_stress_only;
        let arguments = UmatArguments {
            stran: stran.as_ptr(),
            dstran: dstran.as_ptr(),
            stress: stress.as_mut_ptr(),
            statev: statev.as_mut_ptr(),
            ..self.arguments(stress_only)
        };
        // SAFETY: every pointer is valid for the sizes that the counts tell.
        run(self.guard.as_ref(), || unsafe { arguments.call(self.function) });
        self.take_outputs();
        self.outcome()
    }

    /// Takes over what the call wrote besides its arrays.
    #[inline]
    fn take_outputs(&mut self) {
        let UmatOutputs { sse, spd, scd, pnewdt, .. } = self.exchange.outputs();
        (self.energies, self.pnewdt) = ([sse, spd, scd].map(|energy| energy.values[0]), pnewdt.values[0]);
    }

    /// Takes over what the call wrote, and looks at what it must not write.
    #[inline]
    fn take_back(&mut self) -> Result<(), Overrun> {
        let has_inputs = self.exchange.take_back()?;
        self.take_outputs();
        self.stress.check()?;
        self.statev.check()?;
        self.ddsdde.check()?;
        self.props.check()?;
        let Some([predef, dpred]) = &mut self.lent_fields else { return Ok(()) };
        predef.check()?;
        dpred.check()?;
        let has_fields = same_bits(predef.as_slice(), &self.predef) && same_bits(dpred.as_slice(), &self.dpred);
        if !has_inputs || !has_fields || !same_bits(self.props.as_slice(), &self.own_props) {
            self.note_written();
        }
        Ok(())
    }

    /// The call wrote into inputs.
    #[cold]
    fn note_written(&mut self) {
        let mut written = self.exchange.written();
        let lent = self.lent_fields.iter().flatten().zip([("PREDEF", &self.predef), ("DPRED", &self.dpred)]);
        let arrays = lent.chain([(&self.props, ("PROPS", &self.own_props))]);
        written.extend(arrays.filter(|(lent, (_, own))| !same_bits(lent.as_slice(), own)).map(|(_, (name, _))| name));
        self.props.as_mut_slice().copy_from_slice(&self.own_props);
        if let Some(guard) = &self.guard {
            guard.note_written(written, [self.jstep[0], self.kinc, self.noel, self.npt]);
        }
    }

    /// What the last call came back with, also if it wrote behind an array.
    #[inline]
    pub fn outcome(&self) -> CallOutcome {
        CallOutcome::of(self.pnewdt)
    }

    /// The call itself, with the arguments as `alter` leaves them.
    ///
    /// # Safety
    /// `alter` may make pointers NULL, or point to counts that live as long as the call and that the arrays can hold.
    #[inline]
    pub(super) unsafe fn call_with(
        &mut self,
        stress_only: bool,
        filling: f64,
        alter: impl FnOnce(&mut UmatArguments),
    ) -> Result<CallOutcome, Overrun> {
        self.ddsdde.as_mut_slice().fill(filling);
        if self.slot.is_some() {
            self.note(stress_only);
        }
        let mut arguments = self.arguments(stress_only);
        alter(&mut arguments);
        // SAFETY: every pointer is valid for the sizes that the counts tell.
        run(self.guard.as_ref(), || unsafe { arguments.call(self.function) });
        if let Some(slot) = &mut self.slot {
            slot.leave();
        }
        self.take_back()?;
        Ok(self.outcome())
    }

    /// Notes the arguments for whoever finds that the plugin ended the process.
    fn note(&mut self, stress_only: bool) {
        if let Some(mut slot) = self.slot.take() {
            slot.enter(|to| {
                to.put_integers([Arguments::UMAT, i32::from(!stress_only)]);
                UmatRecord::write(self, to);
            });
            self.slot = Some(slot);
        }
    }

    /// The plugin's function.
    pub(super) fn function(&self) -> UmatFunction {
        self.function
    }

    // as a call of its own it would write the 38 addresses down, to be read again in wider pieces: 12 ns
    #[inline(always)]
    pub(super) fn arguments(&mut self, stress_only: bool) -> UmatArguments {
        if self.predef.len() != self.dpred.len() || self.predef.is_empty() {
            // a UMAT knows by itself how many there are, and reads as many of both
            let count = self.predef.len().max(self.dpred.len()).max(1);
            self.predef.resize(count, 0.0);
            self.dpred.resize(count, 0.0);
        }
        let [sse, spd, scd] = self.energies.map(Numbers::from);
        let pnewdt = Numbers::from(PNEWDT_ON_ENTRY);
        let outputs = self.exchange.outputs_mut();
        (outputs.sse, outputs.spd, outputs.scd, outputs.pnewdt) = (sse, spd, scd, pnewdt);
        let (inputs, outputs) = self.exchange.hand_over();
        let mut fields = [self.predef.as_ptr(), self.dpred.as_ptr()];
        if let Some(lent) = &mut self.lent_fields {
            for ((lent, own), field) in lent.iter_mut().zip([&self.predef, &self.dpred]).zip(&mut fields) {
                lent.hold(own);
                *field = lent.as_mut_ptr();
            }
        }
        let ddsdde = if stress_only { std::ptr::null_mut() } else { self.ddsdde.as_mut_ptr() };
        // SAFETY: both live as long as the call object, and only addresses are taken.
        unsafe {
            UmatArguments {
                stress: self.stress.as_mut_ptr(),
                statev: self.statev.as_mut_ptr(),
                ddsdde,
                sse: (&raw mut (*outputs).sse).cast(),
                spd: (&raw mut (*outputs).spd).cast(),
                scd: (&raw mut (*outputs).scd).cast(),
                rpl: (&raw mut (*outputs).rpl).cast(),
                ddsddt: (&raw mut (*outputs).ddsddt).cast(),
                drplde: (&raw mut (*outputs).drplde).cast(),
                drpldt: (&raw mut (*outputs).drpldt).cast(),
                stran: (&raw const (*inputs).stran).cast(),
                dstran: (&raw const (*inputs).dstran).cast(),
                time: (&raw const (*inputs).time).cast(),
                dtime: &raw const (*inputs).dtime,
                temp: &raw const (*inputs).temp,
                dtemp: &raw const (*inputs).dtemp,
                predef: fields[0],
                dpred: fields[1],
                cmname: (&raw const (*inputs).cmname).cast::<c_char>(),
                ndi: &raw const (*inputs).ndi,
                nshr: &raw const (*inputs).nshr,
                ntens: &raw const (*inputs).ntens,
                nstatv: &raw const (*inputs).nstatv,
                props: self.props.as_mut_ptr(),
                nprops: &raw const (*inputs).nprops,
                coords: (&raw const (*inputs).coords).cast(),
                drot: (&raw const (*inputs).drot).cast(),
                pnewdt: (&raw mut (*outputs).pnewdt).cast(),
                celent: &raw const (*inputs).celent,
                dfgrd0: (&raw const (*inputs).dfgrd0).cast(),
                dfgrd1: (&raw const (*inputs).dfgrd1).cast(),
                noel: &raw const (*inputs).noel,
                npt: &raw const (*inputs).npt,
                layer: &raw const (*inputs).layer,
                kspt: &raw const (*inputs).kspt,
                jstep: (&raw const (*inputs).jstep).cast(),
                kinc: &raw const (*inputs).kinc,
                cmname_length: self.exchange.inputs.cmname.len(),
            }
        }
    }
}
