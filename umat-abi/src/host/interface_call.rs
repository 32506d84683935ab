//! Safe calls of UINTER and FRIC.

use super::call::CallOutcome;
use super::exchange::{Exchange, Inputs, Integer, Numbers, Outputs, inputs, outputs};
use super::guard::{Guard, run};
use super::library::{Library, LoadError};
use super::memory::{Guarded, NotFinite, Overrun, fortran_name, same_bits};
use super::recorder::{self, Arguments, FricRecord, Slot, UinterRecord};
use crate::fric::{FricArguments, FricFunction};
use crate::uinter::{UinterArguments, UinterFunction};
use std::ops::{Deref, DerefMut};

/// PNEWDT on entry; see [`super::UmatCall`].
const PNEWDT_ON_ENTRY: f64 = 1e36;
/// MCRD, the coordinates of a point.
const MCRD: i32 = 3;
const IDENTITY_2: [f64; 4] = [1.0, 0.0, 0.0, 1.0];
const IDENTITY_3: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
/// SLNAME and MSNAME.
const SURFACES: [&str; 2] = ["SLAVE", "MASTER"];

inputs! {
    /// The arguments of UINTER that it must not change, but for PROPS, PREDEF and DPRED. What a mechanical host has nothing to say about is 0.
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
        behind_lprint "LPRINT": i32,
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
    /// The arguments of FRIC that it must not change, but for PROPS, PREDEF and DPRED. What a mechanical host has nothing to say about is 0.
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
        behind_nprops "NPROPS": i32,
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
    /// At the end of the increment.
    temperature: [f64; 2],
    temperature_increment: [f64; 2],
    /// At the end of the increment.
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

/// What both calls share and give access to: the arrays that the plugin writes, the properties, and by [`Deref`] the inputs.
#[derive(Debug)]
pub struct Contact<I, O> {
    /// Keeps the function's code loaded.
    _library: Library,
    plugin: String,
    guard: Option<Guard>,
    traction: Guarded,
    tangent: Guarded,
    statev: Guarded,
    /// PROPS as the host has them, and as the plugin gets them.
    own_props: Vec<f64>,
    props: Guarded,
    exchange: Exchange<I, O>,
    /// What both surfaces have.
    pub fields: SurfaceFields,
    /// PREDEF and DPRED of a plugin that nobody vouches for.
    lent_fields: Option<[Guarded; 2]>,
    pnewdt: f64,
    calls: u64,
    /// Where calls are noted, if they are.
    slot: Option<Slot>,
}

impl<I: Inputs, O: Outputs + Default> Contact<I, O> {
    /// `inputs` are made of the numbers of states and properties as Fortran passes them.
    fn new(
        library: &Library,
        symbol: Option<&str>,
        name: &str,
        (directions, nstatv, props): (usize, usize, &[f64]),
        names: [&'static str; 2],
        inputs: impl FnOnce([i32; 3]) -> I,
    ) -> Self {
        let mut guarded_props = Guarded::new("PROPS", props.len());
        guarded_props.as_mut_slice().copy_from_slice(props);
        let (traction, statev) = (Guarded::new(names[0], directions), Guarded::new("STATEV", nstatv));
        let guard = library.guard();
        let inputs = inputs([&traction, &statev, &guarded_props].map(|array| *array.count()));
        Self {
            _library: library.clone(),
            plugin: library.name_of_law(name),
            exchange: Exchange::new(inputs, guard.is_some()),
            fields: SurfaceFields::default(),
            lent_fields: guard.is_some().then(|| ["PREDEF", "DPRED"].map(|name| Guarded::new(name, 2))),
            guard,
            traction,
            tangent: Guarded::new(names[1], directions * directions),
            statev,
            own_props: props.to_vec(),
            props: guarded_props,
            pnewdt: PNEWDT_ON_ENTRY,
            calls: 0,
            slot: Slot::new(library, symbol, name),
        }
    }

    /// As [`super::UmatCall::fence`].
    pub fn fence(&mut self) {
        if !recorder::fences_arrays() {
            return;
        }
        for array in [&mut self.traction, &mut self.tangent, &mut self.statev, &mut self.props] {
            array.fence();
        }
        self.lent_fields.iter_mut().flatten().for_each(Guarded::fence);
        self.exchange.fence();
    }

    /// PREDEF and DPRED as the plugin gets them.
    fn hand_over_fields(&mut self) -> [*const f64; 2] {
        let own = self.fields.predef();
        let Some(lent) = &mut self.lent_fields else { return own.map(<[f64]>::as_ptr) };
        for (lent, own) in lent.iter_mut().zip(own) {
            lent.hold(own);
        }
        lent.each_mut().map(|lent| lent.as_mut_ptr().cast_const())
    }

    /// TEMP and DTEMP.
    pub fn temperature(&self) -> [f64; 2] {
        self.fields.temperature()
    }

    /// PREDEF and DPRED: of each variable the values at slave and master.
    pub fn predef(&self) -> [&[f64]; 2] {
        self.fields.predef()
    }

    /// What messages call the plugin.
    pub fn plugin(&self) -> &str {
        &self.plugin
    }

    /// STRESS (UINTER: \[0\] > 0 is compression) or TAU (FRIC).
    pub fn traction(&self) -> &[f64] {
        self.traction.as_slice()
    }

    /// The traction, to be set before a call.
    pub fn traction_mut(&mut self) -> &mut [f64] {
        self.traction.as_mut_slice()
    }

    /// STATEV.
    pub fn statev(&self) -> &[f64] {
        self.statev.as_slice()
    }

    /// STATEV, to be set before a call.
    pub fn statev_mut(&mut self) -> &mut [f64] {
        self.statev.as_mut_slice()
    }

    /// DDSDDR or DDTDDG (row, column), indices from 0.
    pub fn tangent(&self, row: usize, column: usize) -> f64 {
        self.tangent.as_slice()[column * self.traction.as_slice().len() + row]
    }

    /// PROPS.
    pub fn props(&self) -> &[f64] {
        &self.own_props
    }

    /// What the last call came back with, also if it wrote outside an array.
    pub fn outcome(&self) -> CallOutcome {
        CallOutcome::of(self.pnewdt)
    }

    /// Calls so far.
    pub fn calls(&self) -> u64 {
        self.calls
    }

    /// Makes a call; `pnewdt` finds its answer among the outputs, `place` step, increment and point.
    fn run(&mut self, call: impl FnOnce(), pnewdt: fn(&O) -> f64, place: fn(&I) -> [i32; 4]) -> Result<(), Overrun> {
        self.calls += 1;
        run(self.guard.as_ref(), call);
        if let Some(slot) = &mut self.slot {
            slot.leave();
        }
        let has_inputs = self.exchange.take_back()?;
        self.pnewdt = pnewdt(self.exchange.outputs());
        self.traction.check()?;
        self.tangent.check()?;
        self.statev.check()?;
        self.props.check()?;
        for array in self.lent_fields.iter_mut().flatten() {
            array.check()?;
        }
        let lent = || {
            let fields = self.lent_fields.iter().flatten().zip(self.fields.predef());
            fields.chain([(&self.props, self.own_props.as_slice())])
        };
        let is_written = |(lent, own): &(&Guarded, &[f64])| !same_bits(lent.as_slice(), own);
        if let Some(guard) = &self.guard
            && (!has_inputs || lent().any(|array| is_written(&array)))
        {
            let arrays: Vec<_> = lent().filter(is_written).map(|(lent, _)| lent.name()).collect();
            guard.note_written(self.exchange.written().into_iter().chain(arrays), place(&self.exchange.inputs));
            self.props.as_mut_slice().copy_from_slice(&self.own_props);
        }
        Ok(())
    }
}

impl<I, O> Deref for Contact<I, O> {
    type Target = I;

    #[inline]
    fn deref(&self) -> &I {
        &self.exchange.inputs
    }
}

impl<I, O> DerefMut for Contact<I, O> {
    #[inline]
    fn deref_mut(&mut self) -> &mut I {
        &mut self.exchange.inputs
    }
}

/// One contact point's UINTER arguments and the function that takes them.
#[derive(Debug)]
pub struct UinterCall {
    common: Contact<UinterInputs, UinterOutputs>,
    function: UinterFunction,
    /// SED, SFD, SPD, SVD, SCD.
    pub energies: [f64; 5],
    /// LOPENCLOSE and LSTATE, kept per point; −1 at the start.
    pub flags: [i32; 2],
}

impl UinterCall {
    /// Prepares calls of `library`'s UINTER in 2 or 3 directions, the normal included.
    ///
    /// # Errors
    /// [`LoadError::Symbol`] if the library has no such entry point.
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
                rdisp: [0.0; 3],
                drdisp: [0.0; 3],
                temp: [0.0; 2],
                dtemp: [0.0; 2],
                time: [0.0; 2],
                dtime: 1.0,
                freqr: 0.0,
                coords: [0.0; 3],
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
                linper: 0,
                lprint: 0,
                behind_lprint: 0,
                ciname: fortran_name(name),
                slname,
                msname,
            }
        };
        Ok(Self {
            function: library.uinter(symbol)?,
            common: Contact::new(library, symbol, name, (directions, nstatv, props), ["STRESS", "DDSDDR"], inputs),
            energies: [0.0; 5],
            flags: [-1; 2],
        })
    }

    /// Calls the plugin; DDSDDR and LSDI are zeroed before.
    ///
    /// # Errors
    /// [`Overrun`] if it wrote outside an array.
    pub fn call(&mut self) -> Result<CallOutcome, Overrun> {
        // SAFETY: the arguments stay as they are.
        unsafe { self.call_with(0.0, |_| ()) }
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
        self.note();
        let mut arguments = self.arguments();
        alter(&mut arguments);
        let function = self.function;
        // SAFETY: every pointer is valid for the sizes that the counts tell, or NULL where the caller wants that.
        let call = || unsafe { arguments.call(function) };
        let place = |inputs: &UinterInputs| [inputs.counters[0], inputs.counters[1], 0, inputs.node];
        let result = self.common.run(call, |outputs| outputs.pnewdt.values[0], place);
        let UinterOutputs { sed, sfd, spd, svd, scd, lopenclose, lstate, .. } = self.common.exchange.outputs();
        self.energies = [sed, sfd, spd, svd, scd].map(|energy| energy.values[0]);
        self.flags = [lopenclose.value, lstate.value];
        result.map(|()| self.common.outcome())
    }

    /// Returns a result of the last call that a host cannot go on with, DDSDDR aside, which not every host needs.
    pub fn not_finite(&self) -> Option<NotFinite> {
        let energies = ["SED", "SFD", "SPD", "SVD", "SCD"].into_iter().zip(self.energies.chunks(1));
        NotFinite::among([("STRESS", self.traction()), ("STATEV", self.statev())].into_iter().chain(energies))
    }

    /// Returns an entry of DDSDDR of the last call that is no number.
    pub fn moduli_not_finite(&self) -> Option<NotFinite> {
        NotFinite::among([("DDSDDR", self.tangent.as_slice())])
    }

    /// Notes the arguments for whoever finds that the plugin ended the process.
    fn note(&mut self) {
        if let Some(mut slot) = self.common.slot.take() {
            slot.enter(|to| {
                to.put_integers([Arguments::UINTER, 1]);
                UinterRecord::write(self, to);
            });
            self.common.slot = Some(slot);
        }
    }

    /// The plugin's function.
    pub(super) fn function(&self) -> UinterFunction {
        self.function
    }

    pub(super) fn arguments(&mut self) -> UinterArguments {
        let common = &mut self.common;
        let [sed, sfd, spd, svd, scd] = self.energies.map(Numbers::from);
        let [lopenclose, lstate] = self.flags.map(Integer::from);
        let pnewdt = Numbers::from(PNEWDT_ON_ENTRY);
        // the outputs of coupled procedures are zeroed, and ignored
        *common.exchange.outputs_mut() =
            UinterOutputs { sed, sfd, spd, svd, scd, pnewdt, lopenclose, lstate, ..UinterOutputs::default() };
        let inputs = &mut common.exchange.inputs;
        (inputs.temp, inputs.dtemp) = (common.fields.temperature, common.fields.temperature_increment);
        inputs.npred = common.fields.count;
        let [predef, dpred] = common.hand_over_fields();
        let (inputs, outputs) = common.exchange.hand_over();
        // SAFETY: both live as long as the call object, and only addresses are taken.
        unsafe {
            UinterArguments {
                stress: common.traction.as_mut_ptr(),
                ddsddr: common.tangent.as_mut_ptr(),
                dviscous: (&raw mut (*outputs).dviscous).cast(),
                dstructural: (&raw mut (*outputs).dstructural).cast(),
                flux: (&raw mut (*outputs).flux).cast(),
                ddfddt: (&raw mut (*outputs).ddfddt).cast(),
                ddsddt: (&raw mut (*outputs).ddsddt).cast(),
                ddfddr: (&raw mut (*outputs).ddfddr).cast(),
                statev: common.statev.as_mut_ptr(),
                sed: (&raw mut (*outputs).sed).cast(),
                sfd: (&raw mut (*outputs).sfd).cast(),
                spd: (&raw mut (*outputs).spd).cast(),
                svd: (&raw mut (*outputs).svd).cast(),
                scd: (&raw mut (*outputs).scd).cast(),
                pnewdt: (&raw mut (*outputs).pnewdt).cast(),
                rdisp: (&raw const (*inputs).rdisp).cast(),
                drdisp: (&raw const (*inputs).drdisp).cast(),
                temp: (&raw const (*inputs).temp).cast(),
                dtemp: (&raw const (*inputs).dtemp).cast(),
                predef,
                dpred,
                time: (&raw const (*inputs).time).cast(),
                dtime: &raw const (*inputs).dtime,
                freqr: &raw const (*inputs).freqr,
                ciname: (&raw const (*inputs).ciname).cast(),
                slname: (&raw const (*inputs).slname).cast(),
                msname: (&raw const (*inputs).msname).cast(),
                props: common.props.as_mut_ptr(),
                coords: (&raw const (*inputs).coords).cast(),
                alocaldir: (&raw const (*inputs).local_directions).cast(),
                drot: (&raw const (*inputs).drot).cast(),
                area: &raw const (*inputs).area,
                chrlngth: &raw const (*inputs).chrlngth,
                node: &raw const (*inputs).node,
                ndir: &raw const (*inputs).ndir,
                nstatv: &raw const (*inputs).nstatv,
                npred: &raw const (*inputs).npred,
                nprops: &raw const (*inputs).nprops,
                mcrd: &raw const (*inputs).mcrd,
                kstep: &raw const (*inputs).counters[0],
                kinc: &raw const (*inputs).counters[1],
                kit: &raw const (*inputs).counters[2],
                linper: &raw const (*inputs).linper,
                lopenclose: (&raw mut (*outputs).lopenclose).cast(),
                lstate: (&raw mut (*outputs).lstate).cast(),
                lsdi: (&raw mut (*outputs).lsdi).cast(),
                lprint: &raw const (*inputs).lprint,
                ciname_length: 80,
                slname_length: 80,
                msname_length: 80,
            }
        }
    }
}

/// What FRIC answers.
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
    common: Contact<FricInputs, FricOutputs>,
    function: FricFunction,
    /// On entry 0 slipping, 1 sticking, 2 open; on return see [`FricCall::answer`].
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
    /// [`LoadError::Symbol`] if the library has no such entry point.
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
                dgam: [0.0; 2],
                taulm: [0.0; 2],
                pressure: [0.0; 2],
                ddpddh: 0.0,
                slip: [0.0; 2],
                time: [0.0; 2],
                dtime: 1.0,
                coords: [0.0; 3],
                rcoord: [0.0; 3],
                drot: IDENTITY_2,
                temp: [0.0; 2],
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
                behind_nprops: 0,
                ciname: fortran_name(name),
                slname,
                msname,
            }
        };
        Ok(Self {
            function: library.fric(symbol)?,
            common: Contact::new(library, symbol, name, (directions, nstatv, props), ["TAU", "DDTDDG"], inputs),
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

    /// Calls the plugin; DDTDDG is zeroed before.
    ///
    /// # Errors
    /// [`Overrun`] if it wrote outside an array.
    pub fn call(&mut self) -> Result<CallOutcome, Overrun> {
        // SAFETY: the arguments stay as they are.
        unsafe { self.call_with(0.0, |_| ()) }
    }

    /// Returns a result of the last call that a host cannot go on with, DDTDDG and DDTDDP aside, which not every host needs.
    pub fn not_finite(&self) -> Option<NotFinite> {
        let [sed, sfd] = self.energies.each_ref().map(std::slice::from_ref);
        let shear = self.given([("TAU", self.traction()), ("DSLIP", &self.dslip[..self.traction().len()])]);
        NotFinite::among(shear.chain([("STATEV", self.statev()), ("SED", sed), ("SFD", sfd)]))
    }

    /// Returns an entry of DDTDDG or DDTDDP of the last call that is no number.
    pub fn moduli_not_finite(&self) -> Option<NotFinite> {
        let by_pressure = &self.pressure_tangent[..self.traction().len()];
        NotFinite::among(self.given([("DDTDDG", self.tangent.as_slice()), ("DDTDDP", by_pressure)]))
    }

    /// These results if the answer says that they are given.
    fn given<R, const N: usize>(&self, results: [R; N]) -> impl Iterator<Item = R> {
        let is_given = self.answer() == Ok(FricAnswer::Tractions);
        results.into_iter().filter(move |_| is_given)
    }

    /// The answer of the last call.
    ///
    /// # Errors
    /// In words, if LM is none that FRIC may return.
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
        self.note();
        let mut arguments = self.arguments();
        alter(&mut arguments);
        let function = self.function;
        // SAFETY: every pointer is valid for the sizes that the counts tell, or NULL where the caller wants that.
        let call = || unsafe { arguments.call(function) };
        let place = |inputs: &FricInputs| [inputs.counters[0], inputs.counters[1], 0, inputs.node];
        let result = self.common.run(call, |outputs| outputs.pnewdt.values[0], place);
        let FricOutputs { ddtddp, dslip, sed, sfd, lm, .. } = self.common.exchange.outputs();
        (self.pressure_tangent, self.dslip) = (ddtddp.values, dslip.values);
        (self.energies, self.lm) = ([sed.values[0], sfd.values[0]], lm.value);
        result.map(|()| self.common.outcome())
    }

    /// As [`UinterCall`]'s.
    fn note(&mut self) {
        if let Some(mut slot) = self.common.slot.take() {
            slot.enter(|to| {
                to.put_integers([Arguments::FRIC, 1]);
                FricRecord::write(self, to);
            });
            self.common.slot = Some(slot);
        }
    }

    /// The plugin's function.
    pub(super) fn function(&self) -> FricFunction {
        self.function
    }

    pub(super) fn arguments(&mut self) -> FricArguments {
        let common = &mut self.common;
        let [sed, sfd] = self.energies.map(Numbers::from);
        let [ddtddp, dslip] = [self.pressure_tangent, self.dslip].map(Numbers::from);
        let (pnewdt, lm) = (Numbers::from(PNEWDT_ON_ENTRY), Integer::from(self.lm));
        *common.exchange.outputs_mut() =
            FricOutputs { ddtddp, dslip, sed, sfd, ddtddt: Numbers::default(), pnewdt, lm };
        let inputs = &mut common.exchange.inputs;
        (inputs.temp, inputs.npred) = (common.fields.temperature, common.fields.count);
        let [predef, _] = common.hand_over_fields();
        let (inputs, outputs) = common.exchange.hand_over();
        // SAFETY: both live as long as the call object, and only addresses are taken.
        unsafe {
            FricArguments {
                lm: (&raw mut (*outputs).lm).cast(),
                tau: common.traction.as_mut_ptr(),
                ddtddg: common.tangent.as_mut_ptr(),
                ddtddp: (&raw mut (*outputs).ddtddp).cast(),
                dslip: (&raw mut (*outputs).dslip).cast(),
                sed: (&raw mut (*outputs).sed).cast(),
                sfd: (&raw mut (*outputs).sfd).cast(),
                ddtddt: (&raw mut (*outputs).ddtddt).cast(),
                pnewdt: (&raw mut (*outputs).pnewdt).cast(),
                statev: common.statev.as_mut_ptr(),
                dgam: (&raw const (*inputs).dgam).cast(),
                taulm: (&raw const (*inputs).taulm).cast(),
                press: &raw const (*inputs).pressure[0],
                dpress: &raw const (*inputs).pressure[1],
                ddpddh: &raw const (*inputs).ddpddh,
                slip: (&raw const (*inputs).slip).cast(),
                kstep: &raw const (*inputs).counters[0],
                kinc: &raw const (*inputs).counters[1],
                time: (&raw const (*inputs).time).cast(),
                dtime: &raw const (*inputs).dtime,
                noel: &raw const (*inputs).noel,
                ciname: (&raw const (*inputs).ciname).cast(),
                slname: (&raw const (*inputs).slname).cast(),
                msname: (&raw const (*inputs).msname).cast(),
                npt: &raw const (*inputs).npt,
                node: &raw const (*inputs).node,
                npatch: &raw const (*inputs).npatch,
                coords: (&raw const (*inputs).coords).cast(),
                rcoord: (&raw const (*inputs).rcoord).cast(),
                drot: (&raw const (*inputs).drot).cast(),
                temp: (&raw const (*inputs).temp).cast(),
                predef,
                nfdir: &raw const (*inputs).nfdir,
                mcrd: &raw const (*inputs).mcrd,
                npred: &raw const (*inputs).npred,
                nstatv: &raw const (*inputs).nstatv,
                chrlngth: &raw const (*inputs).chrlngth,
                props: common.props.as_mut_ptr(),
                nprops: &raw const (*inputs).nprops,
                ciname_length: 80,
                slname_length: 80,
                msname_length: 80,
            }
        }
    }
}

/// Both calls are used through what they share.
macro_rules! contact {
    ($($call:ty => $inputs:ty, $outputs:ty;)+) => {$(
        impl Deref for $call {
            type Target = Contact<$inputs, $outputs>;

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
    UinterCall => UinterInputs, UinterOutputs;
    FricCall => FricInputs, FricOutputs;
}
