//! Safe calls of UINTER and FRIC.

use super::call::CallOutcome;
use super::exchange::{Integer, Numbers, arguments, inputs, outputs};
use super::library::{Library, LoadError};
use super::manner::Wide;
use super::memory::{NAME_LENGTH, NotFinite, Overrun, fortran_name};
use super::plugin_call::{PNEWDT_ON_ENTRY, PluginCall};
use crate::fric::{FricArguments, FricFunction};
use crate::uinter::{UinterArguments, UinterFunction};
use std::ops::{Deref, DerefMut};

/// MCRD, the coordinates of a point.
const MCRD: i32 = 3;
const IDENTITY_2: [f64; 4] = [1.0, 0.0, 0.0, 1.0];
const IDENTITY_3: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// SLNAME and MSNAME.
const SURFACES: [&str; 2] = ["SLAVE", "MASTER"];

inputs! {
    /// The arguments that UINTER must not change, except for PROPS, PREDEF and DPRED. Those without a meaning for a
    /// mechanical host are 0.
    UinterInputs {
        /// RDISP at the end of the increment: \[0\] > 0 penetration, then slips; mm.
        pub rdisp "RDISP": [f64; 3],
        /// DRDISP, mm.
        pub drdisp "DRDISP": [f64; 3],
        temp "TEMP": [f64; 2],
        dtemp "DTEMP": [f64; 2],
        /// Step and total time at the end of the increment.
        pub time "TIME": [f64; 2],
        /// Time increment.
        pub dtime "DTIME": f64,
        freqr "FREQR": f64,
        /// COORDS, mm.
        pub coords "COORDS": [f64; 3],
        /// ALOCALDIR, column by column: the normal, then the tangents.
        pub local_directions "ALOCALDIR": [f64; 9],
        drot "DROT": [f64; 4],
        /// Tributary area, mm².
        pub area "AREA": f64,
        /// Characteristic length of the contact surface, mm.
        pub chrlngth "CHRLNGTH": f64,
        /// Contact node number, from 1.
        pub node "NODE": i32,
        ndir "NDIR": i32,
        nstatv "NSTATV": i32,
        npred "NPRED": i32,
        nprops "NPROPS": i32,
        mcrd "MCRD": i32,
        /// Step, increment, iteration, from 1.
        pub counters "KSTEP, KINC, KIT": [i32; 3],
        linper "LINPER": i32,
        lprint "LPRINT": i32,
        after_lprint "LPRINT": i32,
        ciname "CINAME": [u8; 80],
        slname "SLNAME": [u8; 80],
        msname "MSNAME": [u8; 80],
    }
}

outputs! {
    UinterOutputs {
        dviscous "DVISCOUS": Numbers<9>,
        dstructural "DSTRUCTURAL": Numbers<9>,
        flux "FLUX": Numbers<2>,
        ddfddt "DDFDDT": Numbers<4>,
        ddsddt "DDSDDT": Numbers<6>,
        ddfddr "DDFDDR": Numbers<6>,
        sed "SED": Numbers<1>,
        sfd "SFD": Numbers<1>,
        spd "SPD": Numbers<1>,
        svd "SVD": Numbers<1>,
        scd "SCD": Numbers<1>,
        pnewdt "PNEWDT": Numbers<1>,
        lopenclose "LOPENCLOSE": Integer,
        lstate "LSTATE": Integer,
        lsdi "LSDI": Integer,
    }
}

inputs! {
    /// The arguments that FRIC must not change, except for PROPS, PREDEF and DPRED. Those without a meaning for a
    /// mechanical host are 0.
    FricInputs {
        /// DGAM, the slip increment, mm.
        pub dgam "DGAM": [f64; 2],
        taulm "TAULM": [f64; 2],
        /// Pressure at the end and its increment, MPa.
        pub pressure "PRESS, DPRESS": [f64; 2],
        ddpddh "DDPDDH": f64,
        /// Accumulated DSLIP at the start of the increment, mm.
        pub slip "SLIP": [f64; 2],
        /// Step and total time at the end of the increment.
        pub time "TIME": [f64; 2],
        /// Time increment.
        pub dtime "DTIME": f64,
        /// COORDS, mm.
        pub coords "COORDS": [f64; 3],
        /// RCOORD: the foot of the point on the master, mm.
        pub rcoord "RCOORD": [f64; 3],
        drot "DROT": [f64; 4],
        temp "TEMP": [f64; 2],
        /// Characteristic length of the contact surface, mm.
        pub chrlngth "CHRLNGTH": f64,
        /// Step and increment, from 1.
        pub counters "KSTEP, KINC": [i32; 2],
        noel "NOEL": i32,
        npt "NPT": i32,
        /// Contact node number, from 1.
        pub node "NODE": i32,
        npatch "NPATCH": i32,
        nfdir "NFDIR": i32,
        mcrd "MCRD": i32,
        npred "NPRED": i32,
        nstatv "NSTATV": i32,
        nprops "NPROPS": i32,
        after_nprops "NPROPS": i32,
        ciname "CINAME": [u8; 80],
        slname "SLNAME": [u8; 80],
        msname "MSNAME": [u8; 80],
    }
}

outputs! {
    FricOutputs {
        ddtddp "DDTDDP": Numbers<2>,
        dslip "DSLIP": Numbers<2>,
        sed "SED": Numbers<1>,
        sfd "SFD": Numbers<1>,
        ddtddt "DDTDDT": Numbers<4>,
        pnewdt "PNEWDT": Numbers<1>,
        lm "LM": Integer,
    }
}

/// Temperature and field variables of slave and master, which are the same there: TEMP(2), DTEMP(2), PREDEF(2,NPRED),
/// DPRED(2,NPRED). There is always one variable that a law may read.
#[derive(Debug)]
pub struct SurfaceFields {
    /// Temperature at the end of the increment.
    temperature: [f64; 2],
    temperature_increment: [f64; 2],
    /// Field variables at the end of the increment.
    variables: Vec<[f64; 2]>,
    variable_increments: Vec<[f64; 2]>,
    /// NPRED.
    count: i32,
}

impl Default for SurfaceFields {
    fn default() -> Self {
        Self {
            temperature: [0.0; 2],
            temperature_increment: [0.0; 2],
            variables: vec![[0.0; 2]],
            variable_increments: vec![[0.0; 2]],
            count: 1,
        }
    }
}

impl SurfaceFields {
    /// Takes over the temperature and the field variables at the start and at the end of an increment.
    ///
    /// # Panics
    /// If there are not as many variables at the end as at the start.
    pub fn set(&mut self, temperature: [f64; 2], variables: [&[f64]; 2]) {
        let Self { variables: ends, variable_increments: increments, count, .. } = self;
        let [from, to] = variables;
        assert_eq!(from.len(), to.len(), "as many field variables as before");
        if !to.is_empty() {
            ends.clear();
            ends.extend(to.iter().map(|end| [*end; 2]));
            increments.clear();
            increments.extend(to.iter().zip(from).map(|(end, start)| [end - start; 2]));
            *count = i32::try_from(to.len()).unwrap_or(i32::MAX);
        }
        let [start, end] = temperature;
        (self.temperature, self.temperature_increment) = ([end; 2], [end - start; 2]);
    }

    /// Replaces increments that are known better than the difference of the ends, which rounds.
    ///
    /// # Panics
    /// If there are not as many variables.
    pub fn set_increments(&mut self, temperature: Option<f64>, variables: Option<&[f64]>) {
        self.temperature_increment = temperature.map_or(self.temperature_increment, |increment| [increment; 2]);
        if let Some(variables) = variables {
            assert_eq!(variables.len(), self.variables.len(), "as many field variables as before");
            self.variable_increments = variables.iter().map(|increment| [*increment; 2]).collect();
        }
    }

    /// TEMP and DTEMP.
    pub fn temperature(&self) -> [f64; 2] {
        [self.temperature[0], self.temperature_increment[0]]
    }

    /// PREDEF and DPRED: of each variable the values at slave and master.
    pub fn predef(&self) -> [&[f64]; 2] {
        [self.variables.as_flattened(), self.variable_increments.as_flattened()]
    }
}

/// One contact point's UINTER arguments and the function that takes them.
#[derive(Debug)]
pub struct UinterCall {
    common: PluginCall<UinterInputs, UinterOutputs>,
    /// Temperatures and field variables of both surfaces.
    pub fields: SurfaceFields,
    calls: u64,
    /// Call with two slip directions that is made instead, of a law that knows no other.
    pub(super) wide: Option<Box<Wide<Self>>>,
    pub(super) function: UinterFunction,
    /// SED, SFD, SPD, SVD, SCD.
    pub energies: [f64; 5],
    /// LOPENCLOSE and LSTATE, kept per point; −1 at the start.
    pub flags: [i32; 2],
}

impl UinterCall {
    /// Prepares calls of `library`'s UINTER in 2 or 3 directions, the normal included.
    ///
    /// # Errors
    /// The library has no such entry point.
    ///
    /// # Panics
    /// With another number of directions.
    pub fn new(
        library: &Library,
        symbol: Option<&str>,
        name: &str,
        directions: usize,
        nstatv: usize,
        props: &[f64],
    ) -> Result<Self, LoadError> {
        assert!((2..=3).contains(&directions), "UINTER has 2 or 3 directions");
        let inputs = |[ndir, nstatv, nprops]: [i32; 3]| {
            let [slname, msname] = SURFACES.map(fortran_name);
            UinterInputs {
                dtime: 1.0,
                local_directions: IDENTITY_3,
                drot: IDENTITY_2,
                area: 1.0,
                chrlngth: 1.0,
                node: 1,
                ndir,
                nstatv,
                npred: 1,
                nprops,
                mcrd: MCRD,
                counters: [1; 3],
                ciname: fortran_name(name),
                slname,
                msname,
                ..UinterInputs::default()
            }
        };
        Ok(Self {
            function: library.uinter(symbol)?,
            common: PluginCall::new(library, symbol, name, (directions, nstatv, props), ["STRESS", "DDSDDR"], inputs),
            fields: SurfaceFields::default(),
            calls: 0,
            wide: None,
            energies: [0.0; 5],
            flags: [-1; 2],
        })
    }

    /// The call itself, with DDSDDR filled before and the arguments as `alter` leaves them.
    ///
    /// # Safety
    /// `alter` may make pointers NULL, or point to counts that live as long as the call and that the arrays can hold.
    pub(super) unsafe fn call_with(
        &mut self,
        filling: f64,
        alter: impl FnOnce(&mut UinterArguments),
    ) -> Result<CallOutcome, Overrun> {
        self.common.tangent.as_mut_slice().fill(filling);
        self.note(true);
        let mut arguments = self.arguments();
        alter(&mut arguments);
        let function = self.function;
        // SAFETY: every pointer is valid for the sizes that the counts give, or NULL where the caller wants that.
        let call = || unsafe { arguments.call(function) };
        let place = |inputs: &UinterInputs| [inputs.counters[0], inputs.counters[1], 0, inputs.node];
        self.calls += 1;
        let result = self.common.run(call, self.fields.predef(), place);
        let UinterOutputs { sed, sfd, spd, svd, scd, lopenclose, lstate, .. } = self.common.exchange.outputs();
        self.energies = [sed, sfd, spd, svd, scd].map(|energy| energy.values[0]);
        self.flags = [lopenclose.values[0], lstate.values[0]];
        result.map(|()| self.outcome())
    }

    /// Takes the inputs of another call, which has a direction less, and what both keep.
    pub(super) fn take_inputs(&mut self, other: &Self) {
        let ndir = self.ndir;
        ***self = UinterInputs { ndir, ..***other };
        (self.energies, self.flags) = (other.energies, other.flags);
    }

    /// Takes what another call has returned besides its arrays.
    pub(super) fn take_outputs(&mut self, other: &Self) {
        (self.energies, self.flags, self.pnewdt) = (other.energies, other.flags, other.pnewdt);
        self.calls = other.calls;
    }

    /// Returns a result of the last call that is not finite, so that a host cannot go on. DDSDDR is not checked, as not
    /// every host needs it.
    pub fn not_finite(&self) -> Option<NotFinite> {
        let energies = ["SED", "SFD", "SPD", "SVD", "SCD"].into_iter().zip(self.energies.chunks(1));
        NotFinite::among([("STRESS", self.stress()), ("STATEV", self.statev())].into_iter().chain(energies))
    }

    /// Returns an entry of DDSDDR of the last call that is not finite.
    pub fn moduli_not_finite(&self) -> Option<NotFinite> {
        let found = NotFinite::among([("DDSDDR", self.common.tangent.as_slice())]);
        found.map(|found| found.of_matrix(self.stress().len()))
    }

    pub(super) fn arguments(&mut self) -> UinterArguments {
        let Self { common, fields, .. } = self;
        let [sed, sfd, spd, svd, scd] = self.energies.map(Numbers::from);
        let [lopenclose, lstate] = self.flags.map(Integer::from);
        let pnewdt = Numbers::from(PNEWDT_ON_ENTRY);
        // the outputs of coupled procedures are zeroed, and ignored
        *common.exchange.outputs_mut() =
            UinterOutputs { sed, sfd, spd, svd, scd, pnewdt, lopenclose, lstate, ..UinterOutputs::default() };
        let inputs = &mut common.exchange.inputs;
        (inputs.temp, inputs.dtemp) = (fields.temperature, fields.temperature_increment);
        inputs.npred = fields.count;
        let [predef, dpred] = common.hand_over_fields(fields.predef());
        let (inputs, outputs) = common.exchange.hand_over();
        arguments! {
            UinterArguments {
                stress: common.stress.as_mut_ptr(),
                ddsddr: common.tangent.as_mut_ptr(),
                statev: common.statev.as_mut_ptr(),
                predef: predef,
                dpred: dpred,
                props: common.props.as_mut_ptr(),
                alocaldir: (&raw const (*inputs).local_directions).cast(),
                kstep: &raw const (*inputs).counters[0],
                kinc: &raw const (*inputs).counters[1],
                kit: &raw const (*inputs).counters[2],
                ciname_length: NAME_LENGTH,
                slname_length: NAME_LENGTH,
                msname_length: NAME_LENGTH,
            }
            inputs: rdisp drdisp temp dtemp time dtime freqr ciname slname msname coords drot area chrlngth node ndir nstatv npred
                nprops mcrd linper lprint;
            outputs: dviscous dstructural flux ddfddt ddsddt ddfddr sed sfd spd svd scd pnewdt lopenclose lstate lsdi;
        }
    }
}

/// Answer of FRIC (LM on return).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FricAnswer {
    /// LM = 0: TAU, DDTDDG, DDTDDP and DSLIP are given.
    Tractions,
    /// LM = 1: the host enforces stick.
    Sticks,
    /// LM = 2: there is no shear.
    NoShear,
}

/// One contact point's FRIC arguments and the function that takes them.
#[derive(Debug)]
pub struct FricCall {
    common: PluginCall<FricInputs, FricOutputs>,
    /// Temperatures and field variables of both surfaces.
    pub fields: SurfaceFields,
    calls: u64,
    /// Call with two slip directions that is made instead, of a law that knows no other.
    pub(super) wide: Option<Box<Wide<Self>>>,
    pub(super) function: FricFunction,
    /// LM: on entry 0 slipping, 1 sticking, 2 open; on return see [`FricCall::answer`].
    pub lm: i32,
    /// DSLIP of the last call, mm.
    pub dslip: [f64; 2],
    /// DDTDDP of the last call.
    pub pressure_tangent: [f64; 2],
    /// SED, SFD.
    pub energies: [f64; 2],
}

impl FricCall {
    /// Prepares calls of `library`'s FRIC in 1 or 2 tangential directions.
    ///
    /// # Errors
    /// The library has no such entry point.
    ///
    /// # Panics
    /// With another number of directions.
    pub fn new(
        library: &Library,
        symbol: Option<&str>,
        name: &str,
        directions: usize,
        nstatv: usize,
        props: &[f64],
    ) -> Result<Self, LoadError> {
        assert!((1..=2).contains(&directions), "FRIC has 1 or 2 directions");
        let inputs = |[nfdir, nstatv, nprops]: [i32; 3]| {
            let [slname, msname] = SURFACES.map(fortran_name);
            FricInputs {
                dtime: 1.0,
                drot: IDENTITY_2,
                chrlngth: 1.0,
                counters: [1; 2],
                noel: 1,
                npt: 1,
                node: 1,
                npatch: 1,
                nfdir,
                mcrd: MCRD,
                npred: 1,
                nstatv,
                nprops,
                ciname: fortran_name(name),
                slname,
                msname,
                ..FricInputs::default()
            }
        };
        Ok(Self {
            function: library.fric(symbol)?,
            common: PluginCall::new(library, symbol, name, (directions, nstatv, props), ["TAU", "DDTDDG"], inputs),
            fields: SurfaceFields::default(),
            calls: 0,
            wide: None,
            lm: Self::STICKING,
            dslip: [0.0; 2],
            pressure_tangent: [0.0; 2],
            energies: [0.0; 2],
        })
    }

    /// LM at the first call of an increment for a point that was open in the one before.
    pub const OPEN: i32 = 2;
    /// LM at the first call of an increment for a point that stuck in the one before, or of the analysis.
    pub const STICKING: i32 = 1;

    /// LM at the first call of the next increment, if the point that was called last stays closed: it stuck, also
    /// elastically (without DSLIP), or it slipped. ABAQUS goes by what the point did in the increment before; a law that
    /// returns LM = 2 has slipped without friction, which is not open.
    pub fn next_lm(&self) -> i32 {
        let sticks = match self.lm {
            0 => self.dslip == [0.0; 2],
            other => other == Self::STICKING,
        };
        i32::from(sticks)
    }

    /// Takes the inputs of another call, which has a direction less, and what both keep.
    pub(super) fn take_inputs(&mut self, other: &Self) {
        let nfdir = self.nfdir;
        ***self = FricInputs { nfdir, ..***other };
        (self.energies, self.lm) = (other.energies, other.lm);
    }

    /// Takes what another call has returned besides its arrays.
    pub(super) fn take_outputs(&mut self, other: &Self) {
        (self.energies, self.lm, self.pnewdt) = (other.energies, other.lm, other.pnewdt);
        (self.dslip, self.pressure_tangent) = ([other.dslip[0], 0.0], [other.pressure_tangent[0], 0.0]);
        self.calls = other.calls;
    }

    /// Returns a result of the last call that a host cannot go on with, DDTDDG and DDTDDP aside, which not every host needs.
    pub fn not_finite(&self) -> Option<NotFinite> {
        let [sed, sfd] = self.energies.each_ref().map(std::slice::from_ref);
        let shear = self.given([("TAU", self.stress()), ("DSLIP", &self.dslip[..self.stress().len()])]);
        NotFinite::among(shear.chain([("STATEV", self.statev()), ("SED", sed), ("SFD", sfd)]))
    }

    /// Returns an entry of DDTDDG or DDTDDP of the last call that is not finite.
    pub fn moduli_not_finite(&self) -> Option<NotFinite> {
        let by_pressure = &self.pressure_tangent[..self.stress().len()];
        let matrix = NotFinite::among(self.given([("DDTDDG", self.common.tangent.as_slice())]));
        let matrix = matrix.map(|found| found.of_matrix(self.stress().len()));
        matrix.or_else(|| NotFinite::among(self.given([("DDTDDP", by_pressure)])))
    }

    /// Returns these results if the answer says that they are given.
    fn given<R, const N: usize>(&self, results: [R; N]) -> impl Iterator<Item = R> {
        let is_given = self.answer() == Ok(FricAnswer::Tractions);
        results.into_iter().filter(move |_| is_given)
    }

    /// Returns the answer of the last call.
    ///
    /// # Errors
    /// A message if LM is not a value that FRIC may return.
    pub fn answer(&self) -> Result<FricAnswer, String> {
        match self.lm {
            0 => Ok(FricAnswer::Tractions),
            1 => Ok(FricAnswer::Sticks),
            2 => Ok(FricAnswer::NoShear),
            lm => Err(format!("it returned LM = {lm}, where FRIC returns 0, 1 or 2")),
        }
    }

    /// The call itself, with DDTDDG, DDTDDP and DSLIP filled before and the arguments as `alter` leaves them.
    ///
    /// # Safety
    /// `alter` may make pointers NULL, or point to counts that live as long as the call and that the arrays can hold.
    pub(super) unsafe fn call_with(
        &mut self,
        filling: f64,
        alter: impl FnOnce(&mut FricArguments),
    ) -> Result<CallOutcome, Overrun> {
        self.common.tangent.as_mut_slice().fill(filling);
        self.dslip = [filling; 2];
        self.pressure_tangent = [filling; 2];
        self.note(true);
        let mut arguments = self.arguments();
        alter(&mut arguments);
        let function = self.function;
        // SAFETY: every pointer is valid for the sizes that the counts give, or NULL where the caller wants that.
        let call = || unsafe { arguments.call(function) };
        let place = |inputs: &FricInputs| [inputs.counters[0], inputs.counters[1], 0, inputs.node];
        self.calls += 1;
        let result = self.common.run(call, self.fields.predef(), place);
        let FricOutputs { ddtddp, dslip, sed, sfd, lm, .. } = self.common.exchange.outputs();
        (self.pressure_tangent, self.dslip) = (ddtddp.values, dslip.values);
        (self.energies, self.lm) = ([sed.values[0], sfd.values[0]], lm.values[0]);
        result.map(|()| self.outcome())
    }

    pub(super) fn arguments(&mut self) -> FricArguments {
        let Self { common, fields, .. } = self;
        let [sed, sfd] = self.energies.map(Numbers::from);
        let [ddtddp, dslip] = [self.pressure_tangent, self.dslip].map(Numbers::from);
        let (pnewdt, lm) = (Numbers::from(PNEWDT_ON_ENTRY), Integer::from(self.lm));
        *common.exchange.outputs_mut() =
            FricOutputs { ddtddp, dslip, sed, sfd, ddtddt: Numbers::default(), pnewdt, lm };
        let inputs = &mut common.exchange.inputs;
        (inputs.temp, inputs.npred) = (fields.temperature, fields.count);
        let [predef, _] = common.hand_over_fields(fields.predef());
        let (inputs, outputs) = common.exchange.hand_over();
        arguments! {
            FricArguments {
                tau: common.stress.as_mut_ptr(),
                ddtddg: common.tangent.as_mut_ptr(),
                statev: common.statev.as_mut_ptr(),
                press: &raw const (*inputs).pressure[0],
                dpress: &raw const (*inputs).pressure[1],
                kstep: &raw const (*inputs).counters[0],
                kinc: &raw const (*inputs).counters[1],
                predef: predef,
                props: common.props.as_mut_ptr(),
                ciname_length: NAME_LENGTH,
                slname_length: NAME_LENGTH,
                msname_length: NAME_LENGTH,
            }
            inputs: dgam taulm ddpddh slip time dtime noel ciname slname msname npt node npatch coords rcoord drot temp nfdir mcrd
                npred nstatv chrlngth nprops;
            outputs: lm ddtddp dslip sed sfd ddtddt pnewdt;
        }
    }
}

/// Makes both calls, which are used through what they share.
macro_rules! contact {
    ($($call:ident: $inputs:ty, $outputs:ty;)+) => {$(
        impl $call {
            /// Calls the plugin; the moduli are zeroed before.
            ///
            /// # Errors
            /// [`Overrun`] if it wrote outside an array.
            pub fn call(&mut self) -> Result<CallOutcome, Overrun> {
                if self.wide.is_some() {
                    return self.call_wide();
                }
                // SAFETY: the arguments stay as they are.
                unsafe { self.call_with(0.0, |_| ()) }
            }

            /// Calls so far.
            pub fn calls(&self) -> u64 {
                self.calls
            }
        }

        impl Deref for $call {
            type Target = PluginCall<$inputs, $outputs>;

            #[inline]
            fn deref(&self) -> &Self::Target {
                &self.common
            }
        }

        impl DerefMut for $call {
            #[inline]
            fn deref_mut(&mut self) -> &mut Self::Target {
                &mut self.common
            }
        }
    )+};
}
contact! {
    UinterCall: UinterInputs, UinterOutputs;
    FricCall: FricInputs, FricOutputs;
}
