//! Many planted errors; the parameter `fault` says which. The numbers are those of `driver/tests/conformance.rs`.

use faulty_law::{Damage, Fault, Parts, State};
use std::sync::atomic::{AtomicU64, Ordering};
use umat_abi::law::{Request, Response, StressState};
use umat_abi::metadata::flags;
use umat_abi::umat::UmatArguments;

/// The largest damage of all points and calls; the bits of such numbers are in their order.
static LARGEST: AtomicU64 = AtomicU64::new(0);

/// Errors in the law.
pub struct Selected;

impl Fault for Selected {
    const NAME: &'static std::ffi::CStr = c"selected_fault";
    const FLAGS: u32 = flags::USES_CELENT;

    fn plant(response: &mut Response, state: &mut State, parts: &Parts) {
        match parts.fault as i32 {
            1 => {
                response.stress[0] *= 1.001;
                response.tangent[0] = response.tangent[0].map(|entry| 1.001 * entry);
            }
            2 => response.stored_energy *= 1.5,
            3 => state.r += 1e-9,
            4 => response.tangent[0][1] *= 1.01,
            5 => state.strain_33 = 0.0,
            6 if parts.request == Request::Stress => response.stress = response.stress.map(|s| 1.0001 * s),
            7 => response.stress[1] += 1.0,
            8 => response.tangent = parts.elastic,
            9 if parts.stress_state == StressState::PlaneStrainOrAxisymmetric => {
                response.stress = response.stress.map(|s| 1.01 * s);
            }
            28 => {
                let before = f64::from_bits(LARGEST.fetch_max(parts.damage.to_bits(), Ordering::Relaxed));
                response.stress = response.stress.map(|s| (1.0 - 0.5 * before.max(parts.damage)) * s);
            }
            10 => response.stress[0] *= 1.0 + parts.strain_increment[0].powi(2),
            _ => {}
        }
    }
}

/// Errors in the entry point.
unsafe fn body(a: &UmatArguments) {
    // SAFETY: forwarded to the caller, who passes valid counts; the faults write within the arrays they are given,
    // and DSTRAN and PROPS, the planted errors.
    unsafe {
        let count = usize::try_from(*a.nprops).unwrap_or(0);
        let fault = if count == 5 { a.props.add(4).read() as i32 } else { 0 };
        let mut arguments = *a;
        let defaults = [31800.0, 0.18, 2e-4, 1e-3, f64::from(fault)];
        let states = 3;
        match fault {
            21 => arguments.props = defaults.as_ptr(),
            22 => arguments.nstatv = &raw const states,
            _ => {}
        }
        umat_abi::export::umat::<Damage<Selected>>(&arguments);
        match fault {
            20 if !a.pnewdt.is_null() => a.pnewdt.write(1.0),
            23 if a.temp.is_null() => a.stress.write(1.0 + a.stress.read()),
            24 => a.dstran.cast_mut().write(0.0),
            // little: the calls after it get what it wrote
            27 => a.props.cast_mut().write(a.props.read().next_up()),
            25 if !a.drot.is_null() && a.drot.read() != 1.0 => a.statev.write(1.5 * a.statev.read() + 1e-9),
            26 if !a.celent.is_null() && a.celent.read() == 0.0 => a.stress.write(f64::NAN),
            _ => {}
        }
    }
}

umat_abi::umat_symbol!("umat_", umat_fortran, body);
umat_abi::plugin_symbol!("pullout_plugin_v1", umat_abi::law_plugin!((umat Damage<Selected>)));
