//! The body of `umat_`.

use super::{Answer, EntryArguments, Refusal, count, finite, guarded, optional, refuse, slice, states, store};
use crate::law::{self, Heat, Increment, Law, Request, Response, StressState, parameters_of};
use crate::metadata::flags;
use crate::table::States;
use crate::umat::UmatArguments;
use std::ffi::{CStr, c_char};
use std::ptr::{null, null_mut};

/// The arguments that a law of a solid uses: less than half of UMAT's. The rest is not even copied.
///
/// No two that are neighbours on the host's stack are neighbours here: a compiler that sees such pairs copies them by
/// one load of 16 bytes, which waits until both of the host's stores of 8 have left the pipeline (7 ns of a call).
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct SolidArguments {
    pub stran: *const f64,
    pub ndi: *const i32,
    pub stress: *mut f64,
    pub ntens: *const i32,
    pub props: *const f64,
    pub statev: *mut f64,
    pub dstran: *const f64,
    pub nshr: *const i32,
    pub ddsdde: *mut f64,
    pub nstatv: *const i32,
    pub drot: *const f64,
    pub sse: *mut f64,
    pub nprops: *const i32,
    pub spd: *mut f64,
    pub celent: *const f64,
    pub scd: *mut f64,
    pub dtime: *const f64,
}

/// The further arguments that a [coupled](Law::COUPLED) law uses.
#[derive(Clone, Copy)]
pub(super) struct HeatArguments {
    temp: *const f64,
    dtemp: *const f64,
    rpl: *mut f64,
    ddsddt: *mut f64,
    drplde: *mut f64,
    drpldt: *mut f64,
}

impl HeatArguments {
    /// A temperature of 0 that nobody gives, and heat that nobody asks for.
    pub(super) const NONE: Self = Self {
        temp: null(),
        dtemp: null(),
        rpl: null_mut(),
        ddsddt: null_mut(),
        drplde: null_mut(),
        drpldt: null_mut(),
    };

    /// Those of a call of `L`; a law that is not coupled does not even copy them.
    #[inline(always)]
    fn of<L: Law>(arguments: &UmatArguments) -> Self {
        if const { !L::COUPLED } {
            return Self::NONE;
        }
        let &UmatArguments { temp, dtemp, rpl, ddsddt, drplde, drpldt, .. } = arguments;
        Self { temp, dtemp, rpl, ddsddt, drplde, drpldt }
    }

    /// TEMP + DTEMP.
    #[inline(always)]
    unsafe fn temperature(&self) -> f64 {
        // SAFETY: TEMP and DTEMP are NULL or valid.
        unsafe { optional(self.temp).unwrap_or(0.0) + optional(self.dtemp).unwrap_or(0.0) }
    }

    /// # Safety
    /// RPL and DRPLDT are NULL or valid, DDSDDT and DRPLDE NULL or have NTENS values.
    unsafe fn write(&self, heat: &Heat, stress_state: StressState) {
        // SAFETY: the caller's promise.
        unsafe {
            store(self.rpl, heat.rpl);
            store(self.drpldt, heat.drpldt);
            for (first, values) in [(self.ddsddt, &heat.ddsddt), (self.drplde, &heat.drplde)] {
                if first.is_null() {
                    continue;
                }
                for (k, &component) in stress_state.components().iter().enumerate() {
                    first.add(k).write(values[component]);
                }
            }
        }
    }
}

/// Runs law `L` as a UMAT.
///
/// # Safety
/// The arguments are those of a UMAT call: every pointer NULL or valid for what ABAQUS defines.
#[inline(always)]
pub unsafe fn umat<L: Law>(arguments: &UmatArguments) {
    let &UmatArguments { stress, statev, ddsdde, sse, spd, scd, stran, dstran, ndi, nshr, ntens, .. } = arguments;
    let &UmatArguments { nstatv, props, nprops, drot, celent, pnewdt, dtime, .. } = arguments;
    let used = SolidArguments {
        stress,
        statev,
        ddsdde,
        sse,
        spd,
        scd,
        stran,
        dstran,
        ndi,
        nshr,
        ntens,
        nstatv,
        props,
        nprops,
        drot,
        celent,
        dtime,
    };
    let heat = HeatArguments::of::<L>(arguments);
    // SAFETY: forwarded to the caller.
    let outcome = guarded(move || unsafe { update::<L>(&used, &heat) });
    if let Err(refusal) = outcome {
        // SAFETY: forwarded to the caller.
        unsafe { refuse_umat(ntens, stress, ddsdde, pnewdt, L::INFO.name, &refusal) };
    }
}

impl EntryArguments for UmatArguments {
    fn name(&self) -> *const c_char {
        self.cmname
    }

    unsafe fn answer(&self) -> Answer {
        let &Self { ntens, stress, ddsdde: tangent, pnewdt, .. } = self;
        // SAFETY: NTENS is NULL or valid.
        Answer { components: unsafe { optional(ntens) }, most_components: 6, stress, tangent, pnewdt }
    }
}

/// Refuses a call. It takes only the arguments that it needs, as all of them would have to be in memory before each
/// call.
///
/// # Safety
/// As for [`umat`].
#[cold]
unsafe fn refuse_umat(
    ntens: *const i32,
    stress: *mut f64,
    tangent: *mut f64,
    pnewdt: *mut f64,
    name: &CStr,
    refusal: &Refusal,
) {
    // SAFETY: STRESS(NTENS), DDSDDE(NTENS,NTENS), PNEWDT: NULL or valid.
    unsafe {
        refuse(name, refusal, &Answer { components: optional(ntens), most_components: 6, stress, tangent, pnewdt })
    }
}

/// # Safety
/// As for [`umat`].
#[inline(always)]
pub(super) unsafe fn update<L: Law>(a: &SolidArguments, heat: &HeatArguments) -> Result<(), Refusal> {
    // SAFETY: the caller of `umat` passes the arguments of a UMAT call: NULL or valid.
    let (ntens, ndi, nshr) = unsafe { (optional(a.ntens), optional(a.ndi), optional(a.nshr)) };
    let counts = (ntens.unwrap_or(0), ndi.unwrap_or(0), nshr.unwrap_or(0));
    let stress_state = StressState::from_counts(counts.0, counts.1, counts.2)
        .filter(|stress_state| stress_state.bits() & L::STRESS_STATES != 0)
        .ok_or(Refusal::Components { first: counts.0, second: counts.1, third: counts.2 })?;
    // constants, for which the compiler unrolls the loops over components
    match stress_state {
        // SAFETY: forwarded to the caller.
        StressState::ThreeD => unsafe { update_in::<L>(a, heat, StressState::ThreeD) },
        // SAFETY: as above.
        StressState::PlaneStrainOrAxisymmetric => unsafe {
            update_in::<L>(a, heat, StressState::PlaneStrainOrAxisymmetric)
        },
        // SAFETY: as above.
        StressState::PlaneStress => unsafe { update_in::<L>(a, heat, StressState::PlaneStress) },
        StressState::OneD | StressState::Beam => {
            Err(Refusal::Components { first: counts.0, second: counts.1, third: counts.2 })
        }
    }
}

#[inline(always)]
unsafe fn update_in<L: Law>(
    a: &SolidArguments,
    heat: &HeatArguments,
    stress_state: StressState,
) -> Result<(), Refusal> {
    // SAFETY (this function): the caller of `umat` passes the arguments of a UMAT call; each is checked for
    // NULL before use, and nothing is read beyond the counts that the host gives.
    // SAFETY: as above.
    let props = unsafe { slice(a.props, count(a.nprops, "NPROPS")?, "PROPS") }?;
    let parameters = parameters_of::<L>(props)?;
    // SAFETY: as above.
    let mut state: L::State = unsafe { states(a.statev, a.nstatv) }?;
    // SAFETY: as above.
    let mut increment = unsafe { read_increment::<L>(a, stress_state) }?;
    if const { has_tensor_state::<L::State>() } {
        // SAFETY: as above.
        if let Some(rotation) = unsafe { incremental_rotation(a.drot) }? {
            state.rotate(&rotation);
        }
    }
    let request = if a.ddsdde.is_null() { Request::Stress } else { Request::StressAndTangent };
    if const { L::COUPLED } {
        // SAFETY: as above.
        increment.temperature = unsafe { heat.temperature() };
        let (response, generated) = law::update_coupled::<L>(&parameters, &increment, &mut state, request)?;
        // SAFETY: as above.
        unsafe {
            write(a, stress_state, &response, &state);
            heat.write(&generated, stress_state);
        }
        return Ok(());
    }
    // nothing fails from a finite response on, so that outputs are written all or not at all
    // on a path of its own, with states of its own: they stay in registers
    let mut early = state;
    if let Some(response) = law::elastic::<L>(&parameters, &increment, &mut early, request)? {
        // SAFETY: as above.
        unsafe { write(a, stress_state, &response, &early) };
        return Ok(());
    }
    // matched in place: a response is not worth a copy
    match &law::update::<L>(&parameters, &increment, &mut state, request) {
        Ok(response) => {
            // SAFETY: as above.
            unsafe { write(a, stress_state, response, &state) };
            Ok(())
        }
        Err(failure) => Err((*failure).into()),
    }
}

#[inline(always)]
unsafe fn read_increment<L: Law>(a: &SolidArguments, stress_state: StressState) -> Result<Increment, Refusal> {
    let components = stress_state.components();
    // SAFETY: STRAN, DSTRAN and STRESS have NTENS values.
    let (stran, dstran, stress) = unsafe {
        (
            slice(a.stran, components.len(), "STRAN")?,
            slice(a.dstran, components.len(), "DSTRAN")?,
            slice(a.stress, components.len(), "STRESS")?,
        )
    };
    let mut increment = Increment::at_rest(stress_state);
    for (k, &i) in components.iter().enumerate() {
        increment.strain[i] = stran[k] + dstran[k];
        increment.strain_increment[i] = dstran[k];
        increment.stress[i] = stress[k];
    }
    if const { L::INFO.flags & flags::USES_CELENT != 0 } {
        // SAFETY: CELENT is NULL or valid.
        increment.characteristic_length =
            unsafe { optional(a.celent) }.filter(|length| length.is_finite() && *length > 0.0);
    }
    // SAFETY: DTIME is NULL or valid.
    let time_increment = unsafe { optional(a.dtime) };
    increment.time_increment = time_increment.filter(|time| time.is_finite() && *time > 0.0).unwrap_or(1.0);
    Ok(increment)
}

#[inline(always)]
unsafe fn write<S: States>(a: &SolidArguments, stress_state: StressState, response: &Response, state: &S) {
    // SAFETY: STRESS(NTENS), DDSDDE(NTENS,NTENS) column-major and STATEV(NSTATV ≥ states) were checked for NULL;
    // DDSDDE and the energies may be NULL.
    unsafe {
        // constant component lists, so that the loops unroll
        match stress_state {
            StressState::ThreeD => write_components(a, response, [0, 1, 2, 3, 4, 5]),
            StressState::PlaneStrainOrAxisymmetric => write_components(a, response, [0, 1, 2, 3]),
            StressState::PlaneStress => write_components(a, response, [0, 1, 3]),
            // no law has them
            StressState::OneD | StressState::Beam => {}
        }
        state.write(std::slice::from_raw_parts_mut(a.statev, S::TABLE.len()));
        store(a.sse, response.stored_energy);
        store(a.spd, response.dissipated_energy);
        store(a.scd, 0.0);
    }
}

/// # Safety
/// As for [`write`].
#[inline(always)]
unsafe fn write_components<const N: usize>(a: &SolidArguments, response: &Response, components: [usize; N]) {
    // SAFETY: forwarded to the caller.
    unsafe {
        for k in 0..N {
            // one by one: a pair that a law has just written as two numbers would have to wait for both
            a.stress.add(k).write_volatile(response.stress[components[k]]);
        }
        if !a.ddsdde.is_null() {
            for column in 0..N {
                for row in 0..N {
                    let value = response.tangent[components[row]][components[column]];
                    a.ddsdde.add(column * N + row).write(value);
                }
            }
        }
    }
}

/// Returns whether there is a tensor among the states.
const fn has_tensor_state<S: States>() -> bool {
    let mut k = 0;
    while k < S::TABLE.len() {
        if S::TABLE[k].tensor_component == 1 {
            return true;
        }
        k += 1;
    }
    false
}

/// DROT if it is there and is no identity.
#[inline(always)]
unsafe fn incremental_rotation(drot: *const f64) -> Result<Option<[[f64; 3]; 3]>, Refusal> {
    if drot.is_null() {
        return Ok(None);
    }
    // SAFETY: DROT(3,3), column-major.
    let columns = unsafe { std::slice::from_raw_parts(drot, 9) };
    const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    // all of them, without an early exit: that vectorises
    if columns.iter().zip(&IDENTITY).fold(true, |same, (a, b)| same & (a == b)) {
        return Ok(None);
    }
    finite(columns, "NaN or infinity in DROT")?;
    Ok(Some(std::array::from_fn(|row| std::array::from_fn(|column| columns[3 * column + row]))))
}
