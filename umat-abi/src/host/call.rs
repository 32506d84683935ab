//! A safe call of a UMAT: every argument valid, buffers reused, canaries checked.

use super::guard::{Guard, run};
use super::library::{Library, LoadError};
use super::manner::Detour;
use super::memory::{Guarded, Overrun, fortran_name};
use super::recorder::{Arguments, Slot, UmatRecord};
use crate::law::{Request, StressState};
use crate::metadata::flags;
use crate::umat::{UmatArguments, UmatFunction};
use std::ffi::c_char;

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

/// One material point's arguments and the function that takes them.
///
/// Components are those of the stress state (3, 4 or 6). The caller sets the public fields and the
/// slices, calls, and reads the slices back.
#[derive(Debug)]
pub struct UmatCall {
    function: UmatFunction,
    /// Keeps the function's code loaded.
    _library: Library,
    honours_stress_only: bool,
    guard: Option<Guard>,
    stress_state: StressState,
    stress: Guarded,
    statev: Guarded,
    ddsdde: Guarded,
    props: Guarded,
    /// Energies: stored, plastic, creep ("SCD").
    pub energies: [f64; 3],
    thermal: [f64; 14],
    /// Total strain at the start of the increment, engineering shear.
    pub stran: [f64; 6],
    /// Strain increment.
    pub dstran: [f64; 6],
    /// Step time and total time at the start.
    pub time: [f64; 2],
    /// Time increment.
    pub dtime: f64,
    /// Temperature at the start.
    pub temp: f64,
    /// Temperature increment.
    pub dtemp: f64,
    /// Field variables at the start. A call makes them at least one, and as many as `dpred`, by zeros.
    pub predef: Vec<f64>,
    /// Their increments.
    pub dpred: Vec<f64>,
    /// Coordinates of the point.
    pub coords: [f64; 3],
    /// Incremental rotation, column-major (`drot[column][row]`).
    pub drot: [[f64; 3]; 3],
    /// Characteristic length, mm.
    pub celent: f64,
    /// Deformation gradient at the start, column-major.
    pub dfgrd0: [[f64; 3]; 3],
    /// Deformation gradient at the end, column-major.
    pub dfgrd1: [[f64; 3]; 3],
    /// Element number, from 1.
    pub noel: i32,
    /// Integration point, from 1.
    pub npt: i32,
    /// Step number (from 1), procedure, NLGEOM flag, linear-perturbation flag.
    pub jstep: [i32; 4],
    /// Increment number, from 1.
    pub kinc: i32,
    /// ε33 of plane stress where calls go through six components ([`Self::go_through`]): to be set to that of the start
    /// before a call, that of the end behind it.
    pub strain_33: f64,
    cmname: [u8; 80],
    pnewdt: f64,
    /// Where calls are noted, if they are.
    slot: Option<Slot>,
    /// How calls are made that are not plain.
    pub(super) detour: Option<Box<Detour>>,
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
        let ntens = stress_state.components().len();
        let mut guarded_props = Guarded::new("PROPS", props.len());
        guarded_props.as_mut_slice().copy_from_slice(props);
        let described = !library.laws().is_empty();
        Ok(Self {
            function,
            _library: library.clone(),
            honours_stress_only: described && library.laws().iter().all(|law| law.has(flags::STRESS_ONLY)),
            guard: library.guard(),
            stress_state,
            stress: Guarded::new("STRESS", ntens),
            statev: Guarded::new("STATEV", nstatv),
            ddsdde: Guarded::new("DDSDDE", ntens * ntens),
            props: guarded_props,
            energies: [0.0; 3],
            thermal: [0.0; 14],
            stran: [0.0; 6],
            dstran: [0.0; 6],
            time: [0.0; 2],
            dtime: 1.0,
            temp: 0.0,
            dtemp: 0.0,
            predef: vec![0.0],
            dpred: vec![0.0],
            coords: [0.0; 3],
            drot: IDENTITY,
            celent: 1.0,
            dfgrd0: IDENTITY,
            dfgrd1: IDENTITY,
            noel: 1,
            npt: 1,
            jstep: [1, STATIC_PROCEDURE, 0, 0],
            kinc: 1,
            strain_33: 0.0,
            cmname: fortran_name(name),
            pnewdt: PNEWDT_ON_ENTRY,
            slot: Slot::new(library, symbol, name),
            detour: None,
        })
    }

    /// Number of stress components.
    pub fn ntens(&self) -> usize {
        self.stress.as_slice().len()
    }

    /// NTENS, NDI, NSHR. The plugin reads them through pointers that must live as long as the call: constants do.
    fn counts(&self) -> &'static [i32; 3] {
        match self.stress_state {
            StressState::ThreeD => &[6, 3, 3],
            StressState::PlaneStrainOrAxisymmetric => &[4, 3, 1],
            StressState::PlaneStress => &[3, 2, 1],
        }
    }

    /// NDI.
    pub(super) fn ndi(&self) -> i32 {
        self.counts()[1]
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
        self.props.as_slice()
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
    /// before each call and at the end, DDSDDE is not zeroed, canaries are checked once.
    ///
    /// # Errors
    /// As [`Self::call`].
    pub fn repeat(&mut self, count: usize, request: Request) -> Result<CallOutcome, Overrun> {
        let stress_only = request == Request::Stress && self.honours_stress_only;
        self.pnewdt = PNEWDT_ON_ENTRY;
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
        }
        self.check_arrays()?;
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
        self.pnewdt = PNEWDT_ON_ENTRY;
        let arguments = UmatArguments {
            stran: stran.as_ptr(),
            dstran: dstran.as_ptr(),
            stress: stress.as_mut_ptr(),
            statev: statev.as_mut_ptr(),
            ..self.arguments(stress_only)
        };
        // SAFETY: every pointer is valid for the sizes that the counts tell.
        run(self.guard.as_ref(), || unsafe { arguments.call(self.function) });
        self.outcome()
    }

    fn check_arrays(&mut self) -> Result<(), Overrun> {
        self.stress.check()?;
        self.statev.check()?;
        self.ddsdde.check()?;
        self.props.check()
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
        self.pnewdt = PNEWDT_ON_ENTRY;
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
        self.check_arrays()?;
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

    pub(super) fn arguments(&mut self, stress_only: bool) -> UmatArguments {
        if self.predef.len() != self.dpred.len() || self.predef.is_empty() {
            // a UMAT knows by itself how many there are, and reads as many of both
            let count = self.predef.len().max(self.dpred.len()).max(1);
            self.predef.resize(count, 0.0);
            self.dpred.resize(count, 0.0);
        }
        let [ntens, ndi, nshr] = self.counts();
        let [sse, spd, scd] = &mut self.energies;
        let thermal = self.thermal.as_mut_ptr();
        let ddsdde = if stress_only { std::ptr::null_mut() } else { self.ddsdde.as_mut_ptr() };
        UmatArguments {
            stress: self.stress.as_mut_ptr(),
            statev: self.statev.as_mut_ptr(),
            ddsdde,
            sse,
            spd,
            scd,
            rpl: thermal,
            // SAFETY: offsets within the 14 values: DDSDDT(6) at 1, DRPLDE(6) at 7, DRPLDT at 13.
            ddsddt: unsafe { thermal.add(1) },
            // SAFETY: as above.
            drplde: unsafe { thermal.add(7) },
            // SAFETY: as above.
            drpldt: unsafe { thermal.add(13) },
            stran: self.stran.as_ptr(),
            dstran: self.dstran.as_ptr(),
            time: self.time.as_ptr(),
            dtime: &raw const self.dtime,
            temp: &raw const self.temp,
            dtemp: &raw const self.dtemp,
            predef: self.predef.as_ptr(),
            dpred: self.dpred.as_ptr(),
            cmname: self.cmname.as_ptr().cast::<c_char>(),
            ndi,
            nshr,
            ntens,
            nstatv: self.statev.count(),
            props: self.props.as_mut_ptr(),
            nprops: self.props.count(),
            coords: self.coords.as_ptr(),
            drot: self.drot.as_ptr().cast(),
            pnewdt: &raw mut self.pnewdt,
            celent: &raw const self.celent,
            dfgrd0: self.dfgrd0.as_ptr().cast(),
            dfgrd1: self.dfgrd1.as_ptr().cast(),
            noel: &raw const self.noel,
            npt: &raw const self.npt,
            layer: &raw const ONE,
            kspt: &raw const ONE,
            jstep: self.jstep.as_ptr(),
            kinc: &raw const self.kinc,
            cmname_length: self.cmname.len(),
        }
    }
}

/// LAYER and KSPT: the only layer and section point.
static ONE: i32 = 1;
