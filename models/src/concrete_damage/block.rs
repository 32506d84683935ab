//! LANES points at once: principal strains are found in registers, the rest of the law follows point by point.

use super::dissipation;
use super::evolution::Evolution;
use super::{
    CRACK_BAND, History, INELASTIC_STRAIN, Parameters, PointResponse, STATES, STRAIN_33_STATE, elastic_response,
};
use crate::tensor::Spectral;
use umat_abi::law::{Block, BlockResponse, Increment, LANES, Lane, StressState};

/// The update of [`super::ConcreteDamage`] for a block; `None` in plane stress, with a crack band, and where a result is
/// no number.
#[inline(always)]
pub(super) fn update(parameters: &Parameters, block: &Block, states: &mut [Lane]) -> Option<BlockResponse> {
    if block.stress_state == StressState::PlaneStress || parameters.wants_crack_band() {
        return None;
    }
    let mut response = BlockResponse { stress: [[0.0; LANES]; 6], stored_energy: [0.0; LANES] };
    let mut trial = [[0.0; LANES]; 6];
    for i in 0..6 {
        for lane in 0..LANES {
            trial[i][lane] = block.strain[i][lane] - states[INELASTIC_STRAIN + i][lane];
        }
    }
    let mut is_elastic = [false; LANES];
    for lane in 0..LANES {
        if states[0][lane] == 0.0
            && states[1][lane] == 0.0
            && let Some(elastic) = elastic_response(parameters, block.stress_state, &of(&trial, lane))
        {
            is_elastic[lane] = true;
            put(&mut response.stress, lane, &elastic.stress);
            response.stored_energy[lane] = elastic.energy;
            states[CRACK_BAND][lane] = 0.0;
            states[STRAIN_33_STATE][lane] = block.strain[2][lane];
        }
    }
    if is_elastic != [true; LANES] {
        damaged(parameters, block, states, &trial, &is_elastic, &mut response)?;
    }
    Some(response)
}

/// The lanes that are not elastic.
#[inline(always)]
fn damaged(
    parameters: &Parameters,
    block: &Block,
    states: &mut [Lane],
    trial: &[Lane; 6],
    is_elastic: &[bool; LANES],
    response: &mut BlockResponse,
) -> Option<()> {
    let softening = parameters.softening(None);
    let axes = Spectral::of_strains(trial);
    // where something grows, what it dissipates depends on the strain at the start
    let mut starts = None;
    for lane in (0..LANES).filter(|&lane| !is_elastic[lane]) {
        let mut state = [0.0; STATES.len()];
        for (value, lanes) in state.iter_mut().zip(&*states) {
            *value = lanes[lane];
        }
        let before = History::of(&state);
        let point = PointResponse {
            trial: of(trial, lane),
            axes: axes[lane],
            normal: None,
            evolution: Evolution::new(parameters, &softening, &before, &axes[lane].values),
        };
        let stress = point.stress(parameters);
        let dissipation = if point.dissipates() {
            let increment = Increment {
                stress_state: block.stress_state,
                strain: of(&block.strain, lane),
                strain_increment: of(&block.strain_increment, lane),
                stress: of(&block.stress, lane),
                characteristic_length: None,
                time_increment: 1.0,
            };
            let start = point.start(&before, &increment, &state);
            // no closure: it would not be compiled for wide registers
            let strains = match starts {
                Some(strains) => strains,
                None => *starts.insert(principal_strains_at_start(block, states)),
            };
            let (end, axes) = (&point.evolution, &point.axes);
            dissipation::increment(parameters, &softening, &start, &strains[lane], end, axes, &stress)
        } else {
            0.0
        };
        let energy = point.evolution.solid.energy();
        if !point.is_finite(energy, dissipation, &stress) {
            return None;
        }
        point.commit(&mut state, dissipation);
        state[CRACK_BAND] = 0.0;
        for (lanes, value) in states.iter_mut().zip(state) {
            lanes[lane] = value;
        }
        put(&mut response.stress, lane, &stress);
        response.stored_energy[lane] = energy;
    }
    Some(())
}

/// Of all lanes; those that have been advanced no longer need theirs.
#[inline(always)]
fn principal_strains_at_start(block: &Block, states: &[Lane]) -> [[f64; 3]; LANES] {
    let mut strain = [[0.0; LANES]; 6];
    for i in 0..6 {
        for lane in 0..LANES {
            let total = block.strain[i][lane] - block.strain_increment[i][lane];
            strain[i][lane] = total - states[INELASTIC_STRAIN + i][lane];
        }
    }
    Spectral::of_strains(&strain).map(|axes| axes.values)
}

/// The components of one point.
#[inline(always)]
fn of(components: &[Lane; 6], lane: usize) -> [f64; 6] {
    std::array::from_fn(|i| components[i][lane])
}

#[inline(always)]
fn put(components: &mut [Lane; 6], lane: usize, values: &[f64; 6]) {
    for i in 0..6 {
        components[i][lane] = values[i];
    }
}
