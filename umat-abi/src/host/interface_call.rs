//! Safe calls of UINTER and FRIC.

use super::call::CallOutcome;
use super::guard::{Guard, run};
use super::library::{Library, LoadError};
use super::memory::{Guarded, Overrun, fortran_name};
use super::recorder::{Arguments, FricRecord, Slot, UinterRecord};
use crate::fric::{FricArguments, FricFunction};
use crate::uinter::{UinterArguments, UinterFunction};
use std::ops::{Deref, DerefMut};

/// PNEWDT on entry; see [`super::UmatCall`].
const PNEWDT_ON_ENTRY: f64 = 1e36;
/// MCRD, the coordinates of a point.
const MCRD: i32 = 3;
/// Zeros for arguments that a mechanical host has nothing to say about: TAULM, DDPDDH, FREQR.
static ZEROS: [f64; 9] = [0.0; 9];
static ONE: i32 = 1;
static ZERO: i32 = 0;
static COORDINATES: i32 = MCRD;
static IDENTITY_2: [f64; 4] = [1.0, 0.0, 0.0, 1.0];
const IDENTITY_3: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// Temperature and field variables of slave and master, which are the same there: TEMP(2), DTEMP(2), PREDEF(2,NPRED),
/// DPRED(2,NPRED). There is always one variable that a law may read.
#[derive(Debug)]
struct SurfaceFields {
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

/// What both calls share and give access to: the arrays that the plugin writes, and the properties.
#[derive(Debug)]
pub struct ContactArrays {
    /// Keeps the function's code loaded.
    _library: Library,
    guard: Option<Guard>,
    directions: i32,
    traction: Guarded,
    tangent: Guarded,
    statev: Guarded,
    props: Guarded,
    name: [u8; 80],
    surfaces: [[u8; 80]; 2],
    scratch: [f64; 36],
    pnewdt: f64,
    fields: SurfaceFields,
    calls: u64,
    /// Where calls are noted, if they are.
    slot: Option<Slot>,
}

impl ContactArrays {
    fn new(
        library: &Library,
        symbol: Option<&str>,
        name: &str,
        directions: usize,
        nstatv: usize,
        props: &[f64],
        names: [&'static str; 2],
    ) -> Self {
        let mut guarded_props = Guarded::new("PROPS", props.len());
        guarded_props.as_mut_slice().copy_from_slice(props);
        Self {
            _library: library.clone(),
            guard: library.guard(),
            directions: i32::try_from(directions).unwrap_or(i32::MAX),
            traction: Guarded::new(names[0], directions),
            tangent: Guarded::new(names[1], directions * directions),
            statev: Guarded::new("STATEV", nstatv),
            props: guarded_props,
            name: fortran_name(name),
            surfaces: [fortran_name("SLAVE"), fortran_name("MASTER")],
            scratch: [0.0; 36],
            pnewdt: PNEWDT_ON_ENTRY,
            fields: SurfaceFields::default(),
            calls: 0,
            slot: Slot::new(library, symbol, name),
        }
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

    /// Tells the temperature and the field variables at the start and at the end of an increment.
    ///
    /// # Panics
    /// If there are not as many variables at the end as at the start.
    pub fn set_fields(&mut self, temperature: [f64; 2], variables: [&[f64]; 2]) {
        let SurfaceFields { variables: ends, variable_increments: increments, count, .. } = &mut self.fields;
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
        (self.fields.temperature, self.fields.temperature_increment) = ([end; 2], [end - start; 2]);
    }

    /// TEMP and DTEMP.
    pub fn temperature(&self) -> [f64; 2] {
        [self.fields.temperature[0], self.fields.temperature_increment[0]]
    }

    /// PREDEF and DPRED: of each variable the values at slave and master.
    pub fn predef(&self) -> [&[f64]; 2] {
        [self.fields.variables.as_flattened(), self.fields.variable_increments.as_flattened()]
    }

    /// PROPS.
    pub fn props(&self) -> &[f64] {
        self.props.as_slice()
    }

    /// What the last call came back with, also if it wrote behind an array.
    pub fn outcome(&self) -> CallOutcome {
        CallOutcome::of(self.pnewdt)
    }

    /// Calls so far.
    pub fn calls(&self) -> u64 {
        self.calls
    }

    fn run(&mut self, call: impl FnOnce()) -> Result<CallOutcome, Overrun> {
        self.calls += 1;
        run(self.guard.as_ref(), call);
        if let Some(slot) = &mut self.slot {
            slot.leave();
        }
        self.traction.check()?;
        self.tangent.check()?;
        self.statev.check()?;
        self.props.check()?;
        Ok(CallOutcome::of(self.pnewdt))
    }
}

/// One contact point's UINTER arguments and the function that takes them.
#[derive(Debug)]
pub struct UinterCall {
    common: ContactArrays,
    function: UinterFunction,
    /// RDISP at the end of the increment: \[0\] > 0 penetration, then slips; mm.
    pub rdisp: [f64; 3],
    /// DRDISP, mm.
    pub drdisp: [f64; 3],
    /// Step and total time at the end of the increment.
    pub time: [f64; 2],
    /// Time increment.
    pub dtime: f64,
    /// Tributary area, mm².
    pub area: f64,
    /// Characteristic length of the contact surface, mm.
    pub chrlngth: f64,
    /// COORDS, mm.
    pub coords: [f64; 3],
    /// ALOCALDIR, column by column: the normal, then the tangents.
    pub local_directions: [f64; 9],
    /// SED, SFD, SPD, SVD, SCD.
    pub energies: [f64; 5],
    /// LOPENCLOSE and LSTATE, kept per point; −1 at the start.
    pub flags: [i32; 2],
    /// Step, increment, iteration, from 1.
    pub counters: [i32; 3],
    /// Contact node number, from 1.
    pub node: i32,
    lsdi: i32,
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
        Ok(Self {
            function: library.uinter(symbol)?,
            common: ContactArrays::new(library, symbol, name, directions, nstatv, props, ["STRESS", "DDSDDR"]),
            rdisp: [0.0; 3],
            drdisp: [0.0; 3],
            time: [0.0; 2],
            dtime: 1.0,
            area: 1.0,
            chrlngth: 1.0,
            coords: [0.0; 3],
            local_directions: IDENTITY_3,
            energies: [0.0; 5],
            flags: [-1; 2],
            counters: [1; 3],
            node: 1,
            lsdi: 0,
        })
    }

    /// Calls the plugin; DDSDDR and LSDI are zeroed before.
    ///
    /// # Errors
    /// [`Overrun`] if it wrote behind an array.
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
        self.common.scratch.fill(0.0);
        self.common.pnewdt = PNEWDT_ON_ENTRY;
        self.lsdi = 0;
        self.note();
        let mut arguments = self.arguments();
        alter(&mut arguments);
        let function = self.function;
        // SAFETY: every pointer is valid for the sizes that the counts tell, or NULL where the caller wants that.
        self.common.run(|| unsafe { arguments.call(function) })
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
        let scratch = common.scratch.as_mut_ptr();
        let [sed, sfd, spd, svd, scd] = &mut self.energies;
        let [lopenclose, lstate] = &mut self.flags;
        let [kstep, kinc, kit] = &self.counters;
        UinterArguments {
            stress: common.traction.as_mut_ptr(),
            ddsddr: common.tangent.as_mut_ptr(),
            // Outputs of coupled procedures that a mechanical host ignores: DVISCOUS(3,3), DSTRUCTURAL(3,3), FLUX(2),
            // DDFDDT(2,2), DDSDDT(3,2), DDFDDR(2,3), one behind the other.
            dviscous: scratch,
            // SAFETY: this and the following offsets leave room for each array within the 36 values.
            dstructural: unsafe { scratch.add(9) },
            // SAFETY: as above.
            flux: unsafe { scratch.add(18) },
            // SAFETY: as above.
            ddfddt: unsafe { scratch.add(20) },
            // SAFETY: as above.
            ddsddt: unsafe { scratch.add(24) },
            // SAFETY: as above.
            ddfddr: unsafe { scratch.add(30) },
            statev: common.statev.as_mut_ptr(),
            sed,
            sfd,
            spd,
            svd,
            scd,
            pnewdt: &raw mut common.pnewdt,
            rdisp: self.rdisp.as_ptr(),
            drdisp: self.drdisp.as_ptr(),
            temp: common.fields.temperature.as_ptr(),
            dtemp: common.fields.temperature_increment.as_ptr(),
            predef: common.predef()[0].as_ptr(),
            dpred: common.predef()[1].as_ptr(),
            time: self.time.as_ptr(),
            dtime: &raw const self.dtime,
            freqr: ZEROS.as_ptr(),
            ciname: common.name.as_ptr().cast(),
            slname: common.surfaces[0].as_ptr().cast(),
            msname: common.surfaces[1].as_ptr().cast(),
            props: common.props.as_mut_ptr(),
            coords: self.coords.as_ptr(),
            alocaldir: self.local_directions.as_ptr(),
            drot: IDENTITY_2.as_ptr(),
            area: &raw const self.area,
            chrlngth: &raw const self.chrlngth,
            node: &raw const self.node,
            ndir: &raw const common.directions,
            nstatv: common.statev.count(),
            npred: &raw const common.fields.count,
            nprops: common.props.count(),
            mcrd: &raw const COORDINATES,
            kstep,
            kinc,
            kit,
            linper: &raw const ZERO,
            lopenclose,
            lstate,
            lsdi: &raw mut self.lsdi,
            lprint: &raw const ZERO,
            ciname_length: 80,
            slname_length: 80,
            msname_length: 80,
        }
    }
}

/// One contact point's FRIC arguments and the function that takes them.
#[derive(Debug)]
pub struct FricCall {
    common: ContactArrays,
    function: FricFunction,
    /// On entry 0 slipping, 1 sticking, 2 open; on return 0: tractions given, 1: stick, 2: no shear.
    pub lm: i32,
    /// DGAM, the slip increment, mm.
    pub dgam: [f64; 2],
    /// Accumulated DSLIP at the start of the increment, mm.
    pub slip: [f64; 2],
    /// DSLIP of the last call, mm.
    pub dslip: [f64; 2],
    /// DDTDDP of the last call.
    pub pressure_tangent: [f64; 2],
    /// Pressure at the end and its increment, MPa.
    pub pressure: [f64; 2],
    /// Step and total time at the end of the increment.
    pub time: [f64; 2],
    /// Time increment.
    pub dtime: f64,
    /// COORDS, mm.
    pub coords: [f64; 3],
    /// RCOORD: the foot of the point on the master, mm.
    pub rcoord: [f64; 3],
    /// Characteristic length of the contact surface, mm.
    pub chrlngth: f64,
    /// SED, SFD.
    pub energies: [f64; 2],
    /// Step and increment, from 1.
    pub counters: [i32; 2],
    /// Contact node number, from 1.
    pub node: i32,
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
        Ok(Self {
            function: library.fric(symbol)?,
            common: ContactArrays::new(library, symbol, name, directions, nstatv, props, ["TAU", "DDTDDG"]),
            lm: Self::STICKING,
            dgam: [0.0; 2],
            slip: [0.0; 2],
            dslip: [0.0; 2],
            pressure_tangent: [0.0; 2],
            pressure: [0.0; 2],
            time: [0.0; 2],
            dtime: 1.0,
            coords: [0.0; 3],
            rcoord: [0.0; 3],
            chrlngth: 1.0,
            energies: [0.0; 2],
            counters: [1; 2],
            node: 1,
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
    /// [`Overrun`] if it wrote behind an array.
    pub fn call(&mut self) -> Result<CallOutcome, Overrun> {
        // SAFETY: the arguments stay as they are.
        unsafe { self.call_with(0.0, |_| ()) }
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
        self.common.scratch.fill(0.0);
        self.common.pnewdt = PNEWDT_ON_ENTRY;
        self.dslip = [filling; 2];
        self.pressure_tangent = [filling; 2];
        self.note();
        let mut arguments = self.arguments();
        alter(&mut arguments);
        let function = self.function;
        // SAFETY: every pointer is valid for the sizes that the counts tell, or NULL where the caller wants that.
        self.common.run(|| unsafe { arguments.call(function) })
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
        let [sed, sfd] = &mut self.energies;
        let [kstep, kinc] = &self.counters;
        let [press, dpress] = &self.pressure;
        FricArguments {
            lm: &raw mut self.lm,
            tau: common.traction.as_mut_ptr(),
            ddtddg: common.tangent.as_mut_ptr(),
            ddtddp: self.pressure_tangent.as_mut_ptr(),
            dslip: self.dslip.as_mut_ptr(),
            sed,
            sfd,
            ddtddt: common.scratch.as_mut_ptr(),
            pnewdt: &raw mut common.pnewdt,
            statev: common.statev.as_mut_ptr(),
            dgam: self.dgam.as_ptr(),
            taulm: ZEROS.as_ptr(),
            press,
            dpress,
            ddpddh: ZEROS.as_ptr(),
            slip: self.slip.as_ptr(),
            kstep,
            kinc,
            time: self.time.as_ptr(),
            dtime: &raw const self.dtime,
            noel: &raw const ONE,
            ciname: common.name.as_ptr().cast(),
            slname: common.surfaces[0].as_ptr().cast(),
            msname: common.surfaces[1].as_ptr().cast(),
            npt: &raw const ONE,
            node: &raw const self.node,
            npatch: &raw const ONE,
            coords: self.coords.as_ptr(),
            rcoord: self.rcoord.as_ptr(),
            drot: IDENTITY_2.as_ptr(),
            temp: common.fields.temperature.as_ptr(),
            predef: common.predef()[0].as_ptr(),
            nfdir: &raw const common.directions,
            mcrd: &raw const COORDINATES,
            npred: &raw const common.fields.count,
            nstatv: common.statev.count(),
            chrlngth: &raw const self.chrlngth,
            props: common.props.as_mut_ptr(),
            nprops: common.props.count(),
            ciname_length: 80,
            slname_length: 80,
            msname_length: 80,
        }
    }
}

/// Both calls are used through their arrays.
macro_rules! contact_arrays {
    ($($call:ty),+) => {$(
        impl Deref for $call {
            type Target = ContactArrays;

            fn deref(&self) -> &ContactArrays {
                &self.common
            }
        }

        impl DerefMut for $call {
            fn deref_mut(&mut self) -> &mut ContactArrays {
                &mut self.common
            }
        }
    )+};
}
contact_arrays!(UinterCall, FricCall);
