//! A law in uniaxial tension or compression.

use fe_core::mesh::Mesh;
use fe_core::model::PluginLaw;
use umat_abi::host::CallOutcome;
use umat_abi::law::{Request, StressState};
use umat_abi::metadata::stress_states;

/// Iterations for the lateral strain, and the lateral stress that may be left, as a part of the axial one.
const ITERATIONS: usize = 30;
const LATERAL_TOLERANCE: f64 = 1e-6;

/// A cube that is strained along 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    /// Strain along 1, and across.
    pub strain: [f64; 2],
    /// Stress along 1, MPa.
    pub stress: f64,
}

/// Strains a cube of the law along 1 with free sides, where an isotropic law carries nothing, by equal increments, until no lateral strain
/// is found; `None`: the law cannot be asked.
pub fn states(law: &PluginLaw, mesh: &Mesh, part: usize, step: f64, increments: usize) -> Option<Vec<State>> {
    let description = law.plugin.law.as_ref().filter(|_| law.plugin.frame.is_none())?;
    if description.stress_states & stress_states::THREE_D == 0 {
        return None;
    }
    let mut call = law.plugin.plain_umat(StressState::ThreeD).ok()?;
    let element = (0..mesh.elements().len()).find(|&element| mesh.elements()[element].part() == part)?;
    call.celent = mesh.characteristic_length(element);
    let mut statev = law.statev0.clone().unwrap_or_else(|| vec![0.0; law.plugin.nstatv]);
    let (mut strain, mut stress, mut energies) = ([0.0; 6], [0.0; 6], [0.0; 3]);
    // of the lateral strain to the axial one
    let mut ratio = -0.2;
    let mut states = Vec::with_capacity(increments);
    for _ in 0..increments {
        let mut last: Option<[f64; 2]> = None;
        let mut is_found = false;
        for _ in 0..ITERATIONS {
            let [axial, lateral] = [step, step * ratio];
            let increment = [axial, lateral, lateral, 0.0, 0.0, 0.0];
            call.set_point([&strain, &increment, &stress], &statev, energies);
            let is_done = matches!(call.call(Request::Stress), Ok(CallOutcome::Done));
            let [s11, s22] = [call.stress()[0], call.stress()[1]];
            if !is_done || !s11.is_finite() || !s22.is_finite() {
                return None;
            }
            if s22.abs() <= LATERAL_TOLERANCE * s11.abs() {
                is_found = true;
                break;
            }
            let next = match last {
                Some([before, was]) if s22 != was => ratio - s22 * (ratio - before) / (s22 - was),
                _ => ratio - 0.1,
            };
            last = Some([ratio, s22]);
            ratio = next;
        }
        if !is_found {
            break;
        }
        stress.copy_from_slice(call.stress());
        statev.copy_from_slice(call.statev());
        energies = call.energies;
        strain = [strain[0] + step, strain[1] + step * ratio, strain[2] + step * ratio, 0.0, 0.0, 0.0];
        states.push(State { strain: [strain[0], strain[1]], stress: stress[0] });
    }
    Some(states)
}
