//! A safe call of a UMAT: every argument valid, buffers reused, memory that it must not write checked.

use super::exchange::{Numbers, Outputs, arguments, inputs, outputs};
use super::guard::run;
use super::library::{Library, LoadError};
use super::manner::Detour;
use super::memory::{NAME_LENGTH, NotFinite, Overrun, fortran_name};
use super::plugin_call::{PNEWDT_ON_ENTRY, PluginCall};
use super::thermal::{HeatGeneration, HeatTransfer};
use crate::law::{Heat, Request, StressState};
use crate::metadata::flags;
use crate::umat::{UmatArguments, UmatFunction};
use std::ops::{Deref, DerefMut};

/// Outcome of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CallOutcome {
    /// The arrays hold the new values.
    Done,
    /// PNEWDT is not 1 or more: repeat with this fraction of the increment, or one that the host chooses if it is none (0, negative, NaN).
    CutBack(f64),
}

impl CallOutcome {
    /// Reads PNEWDT on return.
    #[inline]
    pub(super) fn of(pnewdt: f64) -> Self {
        if pnewdt >= 1.0 { Self::Done } else { Self::CutBack(pnewdt) }
    }
}

inputs! {
    /// The arguments that UMAT must not change, except for PROPS, PREDEF and DPRED.
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
    common: PluginCall<UmatInputs, UmatOutputs>,
    pub(super) function: UmatFunction,
    honours_stress_only: bool,
    stress_state: StressState,
    /// Energies: stored, plastic, creep ("SCD").
    pub energies: [f64; 3],
    /// Field variables at the start. A call makes them at least one, and as many as `dpred`, by zeros.
    pub predef: Vec<f64>,
    /// Increments.
    pub dpred: Vec<f64>,
    /// ε33 of plane stress where calls go through six components ([`Self::go_through`]): before a call the value at the
    /// start ([`Self::set_point`]), after it the value at the end.
    pub strain_33: f64,
    /// Way of calls that are not plain: through six components, or with a tangent by differences.
    pub(super) detour: Option<Box<Detour>>,
    /// HETVAL and UMATHT, where they are called.
    pub(super) generation: Option<Box<HeatGeneration>>,
    pub(super) heat_transfer: Option<Box<HeatTransfer>>,
}

impl Deref for UmatCall {
    type Target = PluginCall<UmatInputs, UmatOutputs>;

    #[inline]
    fn deref(&self) -> &Self::Target {
        &self.common
    }
}

impl DerefMut for UmatCall {
    #[inline]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.common
    }
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// JSTEP(2): static stress analysis.
const STATIC_PROCEDURE: i32 = 1;
/// An answer that differs from an initial stress by less than this part of the largest is the same: rounding.
const KEPT_STRESS: f64 = 1e-6;

impl UmatCall {
    /// Prepares calls of `library`'s UMAT with these properties.
    ///
    /// `name` is passed as CMNAME (upper case). A library with metadata is trusted to keep the floating-point
    /// modes and, if it declares so, to understand DDSDDE = NULL as "stress only".
    ///
    /// # Errors
    /// The library has no such entry point.
    pub fn new(
        library: &Library,
        symbol: Option<&str>,
        name: &str,
        stress_state: StressState,
        nstatv: usize,
        props: &[f64],
    ) -> Result<Self, LoadError> {
        let function = library.umat(symbol)?;
        let (_, ndi, nshr) = stress_state.counts();
        let inputs = |[ntens, nstatv, nprops]: [i32; 3]| UmatInputs {
            dtime: 1.0,
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
            nstatv,
            nprops,
            // the only layer and section point
            layer: 1,
            kspt: 1,
            cmname: fortran_name(name),
            ..UmatInputs::default()
        };
        let sizes = (stress_state.components().len(), nstatv, props);
        let described = !library.laws().is_empty();
        Ok(Self {
            common: PluginCall::new(library, symbol, name, sizes, ["STRESS", "DDSDDE"], inputs),
            function,
            honours_stress_only: described && library.laws().iter().all(|law| law.has(flags::STRESS_ONLY)),
            stress_state,
            energies: [0.0; 3],
            predef: vec![0.0],
            dpred: vec![0.0],
            strain_33: 0.0,
            detour: None,
            generation: None,
            heat_transfer: None,
        })
    }

    /// Fences as [`PluginCall::fence`] does, in the call with six components as well.
    pub fn fence(&mut self) {
        self.common.fence();
        if let Some(solid) = self.detour.as_mut().and_then(|detour| detour.solid.as_mut()) {
            solid.fence();
        }
    }

    /// CMNAME as the plugin gets it.
    pub(super) fn cmname(&self) -> [u8; NAME_LENGTH] {
        self.cmname
    }

    /// Number of stress components.
    pub fn ntens(&self) -> usize {
        self.common.stress.as_slice().len()
    }

    /// The stress state it was made for.
    pub fn stress_state(&self) -> StressState {
        self.stress_state
    }

    /// Sets the point before a call: STRAN, DSTRAN, STRESS, STATEV and the energies. The first three are given in the NTENS
    /// components of the call, or in all, 4 in a plane or 6 in space, with the strain 33 of plane stress.
    ///
    /// # Panics
    /// If there are not as many strains and stresses, or not NSTATV states.
    #[inline]
    pub fn set_point(&mut self, [strain, increment, stress]: [&[f64]; 3], statev: &[f64], energies: [f64; 3]) {
        let components = self.stress_state.components();
        let has_all = strain.len() > components.len();
        if has_all {
            self.strain_33 = strain[2];
        }
        for (k, &component) in components.iter().enumerate() {
            let from = if has_all { component } else { k };
            self.common.stran[k] = strain[from];
            self.common.dstran[k] = increment[from];
            self.common.stress.as_mut_slice()[k] = stress[from];
        }
        self.common.statev.as_mut_slice().copy_from_slice(statev);
        self.energies = energies;
    }

    /// Judges the answer to a call without an increment from an initial stress, which is given as [`Self::set_point`] takes it:
    /// a note if it is another stress.
    ///
    /// # Errors
    /// There is nothing left of it: the law is one of the total strain.
    pub fn judge_initial_stress(&self, initial: &[f64]) -> Result<Option<String>, String> {
        let components = self.stress_state.components();
        let has_all = initial.len() > components.len();
        let given = |k: usize| initial[if has_all { components[k] } else { k }];
        let largest =
            |stress: &mut dyn Iterator<Item = f64>| stress.fold(0.0, |most: f64, value| most.max(value.abs()));
        let all = largest(&mut (0..components.len()).map(given));
        if largest(&mut self.stress().iter().copied()) < KEPT_STRESS * all {
            return Err(
                "drops the initial stress: without a strain increment it returns none, as a law of the total strain \
                        does; leave the initial stress out, or take a law that adds to STRESS"
                    .to_owned(),
            );
        }
        let changed =
            self.stress().iter().enumerate().find(|(k, stress)| (*stress - given(*k)).abs() > KEPT_STRESS * all);
        Ok(changed.map(|(k, stress)| {
            format!(
                "changes the initial stress: without a strain increment it returns STRESS({}) = {stress:.6} MPa instead of \
                 {:.6}, from which it begins",
                k + 1,
                given(k)
            )
        }))
    }

    /// DDSDDE, column-major.
    pub fn ddsdde(&self) -> &[f64] {
        self.common.tangent.as_slice()
    }

    /// DDSDDE between all components: 4 in a plane, 6 in space. Those that the call has not are 0.
    #[inline]
    pub fn moduli<const N: usize>(&self) -> [[f64; N]; N] {
        let mut moduli = [[0.0; N]; N];
        let components = self.stress_state.components();
        for (i, &row) in components.iter().enumerate() {
            for (j, &column) in components.iter().enumerate() {
                moduli[row][column] = self.tangent(i, j);
            }
        }
        moduli
    }

    /// Heat and its derivatives after the last call.
    pub fn heat(&self) -> Heat {
        let UmatOutputs { rpl, ddsddt, drplde, drpldt, .. } = self.common.exchange.outputs();
        Heat { rpl: rpl.values[0], ddsddt: ddsddt.values, drplde: drplde.values, drpldt: drpldt.values[0] }
    }

    /// Sets heat and its derivatives as if the last call had returned them.
    #[inline]
    pub fn set_heat(&mut self, heat: Heat) {
        let outputs = self.common.exchange.outputs_mut();
        (outputs.rpl.values, outputs.drpldt.values) = ([heat.rpl], [heat.drpldt]);
        (outputs.ddsddt.values, outputs.drplde.values) = (heat.ddsddt, heat.drplde);
    }

    /// Returns a result of the last call that a host cannot go on with, DDSDDE aside, which not every host needs.
    #[inline]
    pub fn not_finite(&self) -> Option<NotFinite> {
        let [sse, spd, scd] = self.energies.each_ref().map(std::slice::from_ref);
        let states = [("STRESS", self.stress()), ("STATEV", self.statev())];
        NotFinite::among(states.into_iter().chain([("SSE", sse), ("SPD", spd), ("SCD", scd)]))
    }

    /// Returns an entry of DDSDDE of the last call that is not finite.
    #[inline]
    pub fn moduli_not_finite(&self) -> Option<NotFinite> {
        NotFinite::among([("DDSDDE", self.ddsdde())]).map(|found| found.of_matrix(self.ntens()))
    }

    /// Behaves as if the last call had asked for a fraction of the increment.
    pub(super) fn cut_back(&mut self, fraction: f64) -> CallOutcome {
        self.common.pnewdt = fraction;
        self.outcome()
    }

    /// Behaves as if the last call had asked for nothing.
    pub(super) fn restore_outcome(&mut self) {
        self.common.pnewdt = PNEWDT_ON_ENTRY;
    }

    /// Calls the plugin. DDSDDE is zeroed before; a plugin that cannot compute the stress alone computes both.
    ///
    /// # Errors
    /// [`Overrun`] if it wrote past an array. The host's memory is intact, but the point's values must not be used.
    #[inline]
    pub fn call(&mut self, request: Request) -> Result<CallOutcome, Overrun> {
        if self.detour.is_some() {
            return self.call_by_detour(request);
        }
        self.call_with_tangent_filled(request, 0.0)
    }

    /// Calls as [`Self::call`] does, with every entry of DDSDDE set to `filling` before: entries that the plugin leaves unset
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
        start.copy_from_slice(self.common.stress.as_slice());
        let states = self.common.statev.as_slice().to_vec();
        for _ in 0..count {
            self.common.stress.as_mut_slice().copy_from_slice(start);
            self.common.statev.as_mut_slice().copy_from_slice(&states);
            let arguments = self.arguments(stress_only);
            // SAFETY: every pointer is valid for the sizes that the counts give.
            run(self.common.guard.as_ref(), || unsafe { arguments.call(self.function) });
            self.take_back()?;
        }
        self.common.stress.as_mut_slice().copy_from_slice(start);
        self.common.statev.as_mut_slice().copy_from_slice(&states);
        Ok(self.outcome())
    }

    /// Calls the plugin on the caller's own arrays, as a finite element program does: STRAN, DSTRAN and STRESS of NTENS
    /// values, STATEV of NSTATV. DDSDDE is the call's own and is not zeroed. Writes past the arrays are not detected.
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
        assert!(statev.len() == self.common.statev.as_slice().len(), "NSTATV values");
        let stress_only = request == Request::Stress && self.honours_stress_only;
        let arguments = UmatArguments {
            stran: stran.as_ptr(),
            dstran: dstran.as_ptr(),
            stress: stress.as_mut_ptr(),
            statev: statev.as_mut_ptr(),
            ..self.arguments(stress_only)
        };
        // SAFETY: every pointer is valid for the sizes that the counts give.
        run(self.common.guard.as_ref(), || unsafe { arguments.call(self.function) });
        self.common.pnewdt = self.common.exchange.outputs().pnewdt();
        self.take_energies();
        self.outcome()
    }

    #[inline]
    fn take_energies(&mut self) {
        let UmatOutputs { sse, spd, scd, .. } = self.common.exchange.outputs();
        self.energies = [sse, spd, scd].map(|energy| energy.values[0]);
    }

    /// Takes over what the call wrote, and looks at what it must not write.
    #[inline]
    fn take_back(&mut self) -> Result<(), Overrun> {
        let place = |inputs: &UmatInputs| [inputs.jstep[0], inputs.kinc, inputs.noel, inputs.npt];
        let result = self.common.take_back([&self.predef, &self.dpred], place);
        self.take_energies();
        result
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
        self.common.tangent.as_mut_slice().fill(filling);
        if self.common.slot.is_some() {
            self.note(!stress_only);
        }
        let mut arguments = self.arguments(stress_only);
        alter(&mut arguments);
        // SAFETY: every pointer is valid for the sizes that the counts give.
        run(self.common.guard.as_ref(), || unsafe { arguments.call(self.function) });
        if let Some(slot) = &mut self.common.slot {
            slot.leave();
        }
        self.take_back()?;
        Ok(self.outcome())
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
        // what a UMAT does not set is not that of the call before
        self.set_heat(Heat::default());
        let common = &mut self.common;
        let outputs = common.exchange.outputs_mut();
        (outputs.sse, outputs.spd, outputs.scd, outputs.pnewdt) = (sse, spd, scd, pnewdt);
        let [predef, dpred] = common.hand_over_fields([&self.predef, &self.dpred]);
        let (inputs, outputs) = common.exchange.hand_over();
        let ddsdde = if stress_only { std::ptr::null_mut() } else { common.tangent.as_mut_ptr() };
        arguments! {
            UmatArguments {
                stress: common.stress.as_mut_ptr(),
                statev: common.statev.as_mut_ptr(),
                ddsdde: ddsdde,
                predef: predef,
                dpred: dpred,
                props: common.props.as_mut_ptr(),
                cmname_length: NAME_LENGTH,
            }
            inputs: stran dstran time dtime temp dtemp cmname ndi nshr ntens nstatv nprops coords drot celent dfgrd0 dfgrd1 noel
                npt layer kspt jstep kinc;
            outputs: sse spd scd rpl ddsddt drplde drpldt pnewdt;
        }
    }
}
