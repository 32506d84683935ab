//! HETVAL and UMATHT: heat that a material generates, stores and conducts, in addition to its UMAT.
//!
//! They are called after UMAT, which has left STATEV for them; what they write there stays. HETVAL sees the end of the
//! increment, UMATHT its start and its increments, as in ABAQUS. Each input is a copy: nobody sees what they write into
//! it.

use super::call::{CallOutcome, UmatCall};
use super::guard::Guard;
use super::library::Library;
use super::memory::{Guarded, NAME_LENGTH, NotFinite, Overrun, same_bits};
use super::plugin_call::PNEWDT_ON_ENTRY;
use super::recorder::{self, RecordedArguments};
use super::routines::Routine;
use crate::law::Heat;
use std::ffi::c_char;

/// CMNAME, TEMP(2), TIME(2), DTIME, STATEV, FLUX(2), PREDEF, DPRED, and the hidden length of CMNAME.
type HetvalFunction = unsafe extern "C" fn(
    *const c_char,
    *const f64,
    *const f64,
    *const f64,
    *mut f64,
    *mut f64,
    *const f64,
    *const f64,
    usize,
);

/// U, DUDT, DUDG, FLUX, DFDT, DFDG, STATEV; TEMP, DTEMP, DTEMDX, TIME, DTIME, PREDEF, DPRED; CMNAME, NTGRD, NSTATV, PROPS, NPROPS,
/// COORDS; PNEWDT; NOEL, NPT, LAYER, KSPT, KSTEP, KINC, and the hidden length of CMNAME.
type UmathtFunction = unsafe extern "C" fn(
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const c_char,
    *const i32,
    *const i32,
    *const f64,
    *const i32,
    *const f64,
    *mut f64,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    *const i32,
    usize,
);

/// The symbols, as [`super::Routine::ALL`] has them.
const HETVAL: &str = "hetval";
const UMATHT: &str = "umatht";

/// Directions of a gradient in a plane: NTGRD.
pub const GRADIENTS: usize = 2;
/// The only layer and section point.
const ONE: i32 = 1;

/// Inputs of which a routine gets copies.
#[derive(Debug)]
struct Loans<const N: usize>([(Guarded, Vec<f64>); N]);

impl<const N: usize> Loans<N> {
    fn new(names: [&'static str; N]) -> Self {
        Self(names.map(|name| (array(name, 1), vec![0.0])))
    }

    /// Copies values, and returns where the copies are.
    fn lend(&mut self, values: [&[f64]; N]) -> [*const f64; N] {
        for ((copy, own), values) in self.0.iter_mut().zip(values) {
            own.clear();
            own.extend_from_slice(values);
            copy.hold(values);
        }
        self.0.each_mut().map(|(copy, _)| copy.as_mut_ptr().cast_const())
    }

    /// Looks at what a call must not write.
    fn take_back(&mut self, guard: Option<&Guard>, place: [i32; 4]) -> Result<(), Overrun> {
        for (copy, _) in &mut self.0 {
            copy.check()?;
        }
        let is_written = |(copy, own): &&(Guarded, Vec<f64>)| !same_bits(copy.as_slice(), own);
        if let Some(guard) = guard
            && self.0.iter().any(|loan| is_written(&loan))
        {
            let written = self.0.iter().filter(is_written).map(|(copy, _)| (copy.name(), [None; 2]));
            guard.note_written(written, place);
        }
        Ok(())
    }
}

/// An array for a routine, fenced where those of calls are.
fn array(name: &'static str, length: usize) -> Guarded {
    let mut array = Guarded::new(name, length);
    if recorder::fences_arrays() {
        array.fence();
    }
    array
}

/// HETVAL of a library.
#[derive(Debug)]
pub(super) struct HeatGeneration {
    routine: Routine<HetvalFunction>,
    flux: Guarded,
    /// TEMP, TIME, DTIME, PREDEF, DPRED.
    inputs: Loans<5>,
}

/// UMATHT of a library, with its parameters.
#[derive(Debug)]
pub(super) struct HeatTransfer {
    routine: Routine<UmathtFunction>,
    /// U, DUDT, DUDG, FLUX, DFDT, DFDG, PNEWDT.
    outputs: [Guarded; 7],
    props: Vec<f64>,
    /// TEMP, DTEMP, DTEMDX, TIME, DTIME, PREDEF, DPRED, PROPS, COORDS.
    inputs: Loans<9>,
}

/// Heat that a material holds and conducts by UMATHT, at the end of an increment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transfer {
    /// U: energy per mass.
    pub energy: f64,
    /// DUDT, and DUDG.
    pub energy_by_temperature: f64,
    /// DUDG.
    pub energy_by_gradient: [f64; GRADIENTS],
    /// FLUX: heat that flows, per area and time.
    pub flux: [f64; GRADIENTS],
    /// DFDT.
    pub flux_by_temperature: [f64; GRADIENTS],
    /// DFDG: rows are those of FLUX.
    pub flux_by_gradient: [[f64; GRADIENTS]; GRADIENTS],
}

impl Transfer {
    /// Returns a result that is not finite.
    pub fn not_finite(&self) -> Option<NotFinite> {
        NotFinite::among([
            ("U", std::slice::from_ref(&self.energy)),
            ("DUDT", std::slice::from_ref(&self.energy_by_temperature)),
            ("DUDG", &self.energy_by_gradient),
            ("FLUX", &self.flux),
            ("DFDT", &self.flux_by_temperature),
            ("DFDG", self.flux_by_gradient.as_flattened()),
        ])
    }
}

impl HeatGeneration {
    fn of(library: &Library) -> Option<Self> {
        // SAFETY: a function of this name has the signature of the manual; no check is possible.
        let routine = unsafe { Routine::find(library, HETVAL) }?;
        let inputs = Loans::new(["TEMP", "TIME", "DTIME", "PREDEF", "DPRED"]);
        Some(Self { routine, flux: array("FLUX", 2), inputs })
    }

    /// FLUX of the point that UMAT was called for last.
    fn call(&mut self, of: &mut UmatCall) -> Result<[f64; 2], Overrun> {
        let time = of.time.map(|start| start + of.dtime);
        let ends: Vec<f64> = of.predef.iter().zip(&of.dpred).map(|(start, increment)| start + increment).collect();
        let [temp, time, dtime, predef, dpred] =
            self.inputs.lend([&[of.temp + of.dtemp, of.dtemp], &time, &[of.dtime], &ends, &of.dpred]);
        self.flux.as_mut_slice().fill(0.0);
        let (flux, cmname, statev) = (self.flux.as_mut_ptr(), of.cmname(), of.statev.as_mut_ptr());
        let place = of.place();
        self.routine.call(RecordedArguments::HEAT_GENERATION, place, |function| {
            let cmname = cmname.as_ptr().cast();
            // SAFETY: every pointer is valid for what the manual says.
            unsafe { function(cmname, temp, time, dtime, statev, flux, predef, dpred, NAME_LENGTH) }
        });
        self.flux.check()?;
        of.statev.check()?;
        self.inputs.take_back(of.guard.as_ref(), place)?;
        let flux = self.flux.as_slice();
        Ok([flux[0], flux[1]])
    }
}

impl HeatTransfer {
    fn of(library: &Library, props: &[f64]) -> Option<Self> {
        const OUTPUTS: [(&str, usize); 7] = [
            ("U", 1),
            ("DUDT", 1),
            ("DUDG", GRADIENTS),
            ("FLUX", GRADIENTS),
            ("DFDT", GRADIENTS),
            ("DFDG", GRADIENTS * GRADIENTS),
            ("PNEWDT", 1),
        ];
        const INPUTS: [&str; 9] = ["TEMP", "DTEMP", "DTEMDX", "TIME", "DTIME", "PREDEF", "DPRED", "PROPS", "COORDS"];
        // SAFETY: a function of this name has the signature of the manual; no check is possible.
        let routine = unsafe { Routine::find(library, UMATHT) }?;
        let outputs = OUTPUTS.map(|(name, length)| array(name, length));
        Some(Self { routine, outputs, props: props.to_vec(), inputs: Loans::new(INPUTS) })
    }

    /// The answer at the point that UMAT was called for last, and PNEWDT.
    fn call(
        &mut self,
        of: &mut UmatCall,
        gradient: [f64; GRADIENTS],
        (energy, flux): (f64, [f64; GRADIENTS]),
    ) -> Result<(Transfer, f64), Overrun> {
        let inputs = self.inputs.lend([
            &[of.temp],
            &[of.dtemp],
            &gradient,
            &of.time,
            &[of.dtime],
            &of.predef,
            &of.dpred,
            &self.props,
            &of.coords,
        ]);
        let [temp, dtemp, dtemdx, time, dtime, predef, dpred, props, coords] = inputs;
        self.outputs.iter_mut().for_each(|output| output.as_mut_slice().fill(0.0));
        self.outputs[0].as_mut_slice()[0] = energy;
        self.outputs[3].as_mut_slice().copy_from_slice(&flux);
        self.outputs[6].as_mut_slice()[0] = PNEWDT_ON_ENTRY;
        let [u, dudt, dudg, flux, dfdt, dfdg, pnewdt] = self.outputs.each_mut().map(Guarded::as_mut_ptr);
        let (cmname, statev, place) = (of.cmname(), of.statev.as_mut_ptr(), of.place());
        let length = |length: usize| i32::try_from(length).unwrap_or(i32::MAX);
        let [ntgrd, nstatv, nprops] = [GRADIENTS, of.statev().len(), self.props.len()].map(length);
        let [noel, npt, layer, kspt, kinc] = [of.noel, of.npt, ONE, ONE, of.kinc];
        // some declare KSTEP as UMAT has it, an array of four
        let kstep = of.jstep;
        self.routine.call(RecordedArguments::HEAT_TRANSFER, place, |function| {
            let cmname = cmname.as_ptr().cast();
            // SAFETY: every pointer is valid for what the manual says, and for the sizes that the counts give.
            unsafe {
                function(
                    u,
                    dudt,
                    dudg,
                    flux,
                    dfdt,
                    dfdg,
                    statev,
                    temp,
                    dtemp,
                    dtemdx,
                    time,
                    dtime,
                    predef,
                    dpred,
                    cmname,
                    &ntgrd,
                    &nstatv,
                    props,
                    &nprops,
                    coords,
                    pnewdt,
                    &noel,
                    &npt,
                    &layer,
                    &kspt,
                    kstep.as_ptr(),
                    &kinc,
                    NAME_LENGTH,
                )
            }
        });
        for output in &mut self.outputs {
            output.check()?;
        }
        of.statev.check()?;
        self.inputs.take_back(of.guard.as_ref(), place)?;
        let values = |k: usize| self.outputs[k].as_slice();
        let pair = |k: usize| std::array::from_fn(|i| values(k)[i]);
        let answer = Transfer {
            energy: values(0)[0],
            energy_by_temperature: values(1)[0],
            energy_by_gradient: pair(2),
            flux: pair(3),
            flux_by_temperature: pair(4),
            // stored by columns
            flux_by_gradient: std::array::from_fn(|i| std::array::from_fn(|j| values(5)[GRADIENTS * j + i])),
        };
        Ok((answer, values(6)[0]))
    }
}

impl UmatCall {
    /// Makes HETVAL of the library, if it has one, a source of heat that [`Self::add_generated_heat`] adds.
    pub fn generate_heat(&mut self) {
        self.generation = HeatGeneration::of(self.library()).map(Box::new);
    }

    /// Makes UMATHT of the library, if it has one, answer to [`Self::transfer`]; `props`: its parameters. Returns whether it has one.
    pub fn transfer_heat(&mut self, props: &[f64]) -> bool {
        self.heat_transfer = HeatTransfer::of(self.library(), props).map(Box::new);
        self.heat_transfer.is_some()
    }

    /// Calls HETVAL after a call of UMAT, and adds FLUX to RPL and DRPLDT. Does nothing without HETVAL.
    ///
    /// # Errors
    /// [`Overrun`] if it wrote past an array.
    #[inline]
    pub fn add_generated_heat(&mut self) -> Result<(), Overrun> {
        let Some(mut generation) = self.generation.take() else { return Ok(()) };
        let flux = generation.call(self);
        self.generation = Some(generation);
        let [rpl, drpldt] = flux?;
        let heat = self.heat();
        self.set_heat(Heat { rpl: heat.rpl + rpl, drpldt: heat.drpldt + drpldt, ..heat });
        Ok(())
    }

    /// Returns heat, or its derivative by the temperature, that is not finite, where HETVAL generates it.
    pub fn heat_not_finite(&self) -> Option<NotFinite> {
        self.generation.as_ref()?;
        let heat = self.heat();
        NotFinite::among([("FLUX", &[heat.rpl, heat.drpldt][..])])
    }

    /// Calls UMATHT after a call of UMAT, with DTEMDX and what it left at the start of the increment: U and FLUX.
    /// `None`: there is no UMATHT.
    ///
    /// # Errors
    /// [`Overrun`] if it wrote past an array.
    pub fn transfer(
        &mut self,
        gradient: [f64; GRADIENTS],
        start: (f64, [f64; GRADIENTS]),
    ) -> Result<Option<(Transfer, CallOutcome)>, Overrun> {
        let Some(mut transfer) = self.heat_transfer.take() else { return Ok(None) };
        let answer = transfer.call(self, gradient, start);
        self.heat_transfer = Some(transfer);
        answer.map(|(answer, pnewdt)| Some((answer, CallOutcome::of(pnewdt))))
    }

    /// Step, increment, element and point.
    fn place(&self) -> [i32; 4] {
        [self.jstep[0], self.kinc, self.noel, self.npt]
    }
}
