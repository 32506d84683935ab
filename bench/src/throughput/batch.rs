//! Many points in one call, and the same points one by one.

use super::super::solid::{Situation, Solid};
use super::super::timing::Way;
use super::super::{BenchError, Settings};
use battery::BatchCall;
use std::hint::black_box;
use umat_abi::host::{CallOutcome, Library, UmatCall};
use umat_abi::law::{Request, StressState};

/// Number of points of a batch: their arrays fit into the nearest caches.
pub(super) const POINTS: usize = 128;
const NTENS: usize = 6;
/// Increments before the measured one; the same path for all, in directions of their own.
const INCREMENTS: usize = 8;

/// Gain of a batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Batch {
    /// Updates per second in batches.
    pub per_second: f64,
    /// Time of single calls over that of a batch.
    pub gain: f64,
}

/// The points, each with arrays of its own.
struct Points {
    stran: Vec<[f64; NTENS]>,
    dstran: Vec<[f64; NTENS]>,
    stress: Vec<[f64; NTENS]>,
    /// NSTATV values of the first point, then of the second.
    statev: Vec<f64>,
    states: usize,
}

impl Points {
    fn new(solid: &Solid, situation: Situation) -> Self {
        let increment = solid.increment(situation);
        // directions turn from point to point: no two take the same branches in the same order
        let turned = |k: usize| {
            let phase = 0.7 * k as f64;
            std::array::from_fn(|i| increment[i] * (1.0 + 0.4 * (phase + i as f64).sin()))
        };
        Self {
            stran: vec![[0.0; NTENS]; POINTS],
            dstran: (0..POINTS).map(turned).collect(),
            stress: vec![[0.0; NTENS]; POINTS],
            statev: vec![0.0; POINTS * solid.states],
            states: solid.states,
        }
    }

    /// Takes the next increment, one by one.
    fn call(&mut self, call: &mut UmatCall) -> bool {
        let states = self.statev.chunks_exact_mut(self.states);
        let strains = self.stran.iter().zip(&self.dstran);
        let mut done = true;
        for ((state, stress), (stran, dstran)) in states.zip(&mut self.stress).zip(strains) {
            done &= call.call_in_place(stran, dstran, stress, state, Request::Stress) == CallOutcome::Done;
        }
        done
    }

    fn move_on(&mut self) {
        for (total, step) in self.stran.iter_mut().zip(&self.dstran) {
            for i in 0..NTENS {
                total[i] += step[i];
            }
        }
    }

    /// Writes them component by component.
    fn copy_to(&self, batch: &mut BatchCall) {
        transpose(self.stran.as_flattened(), NTENS, &mut batch.strain);
        transpose(self.dstran.as_flattened(), NTENS, &mut batch.dstrain);
        transpose(self.stress.as_flattened(), NTENS, &mut batch.stress);
        transpose(&self.statev, self.states, &mut batch.statev);
    }
}

/// Rearranges values from point by point to component by component.
fn transpose(points: &[f64], size: usize, components: &mut [f64]) {
    for (k, point) in points.chunks_exact(size).enumerate() {
        for (i, value) in point.iter().enumerate() {
            components[i * POINTS + k] = *value;
        }
    }
}

/// Measures, after both ways gave the same bits.
pub(super) fn measure(
    solid: &Solid,
    library: &Library,
    situation: Situation,
    settings: &Settings,
) -> Result<Batch, BenchError> {
    let failed = |what: &str| BenchError::Failed(format!("{}: {what}", solid.law));
    let mut call = UmatCall::new(library, None, solid.law, StressState::ThreeD, solid.states, &solid.props)?;
    let mut batch = BatchCall::new(library, StressState::ThreeD, solid.states, &solid.props, POINTS)
        .ok_or_else(|| failed("the plugin has no batch entry point"))?;
    let mut points = Points::new(solid, situation);
    for _ in 0..INCREMENTS {
        if !points.call(&mut call) {
            return Err(failed("the way to the measured increment fails"));
        }
        points.move_on();
    }
    let (stress, statev) = (points.stress.clone(), points.statev.clone());
    points.copy_to(&mut batch);
    let (batch_stress, batch_statev) = (batch.stress.to_vec(), batch.statev.to_vec());
    batch.call(Request::Stress);
    points.call(&mut call);
    let mut expected = [vec![0.0; batch_stress.len()], vec![0.0; batch_statev.len()]];
    transpose(points.stress.as_flattened(), NTENS, &mut expected[0]);
    transpose(&points.statev, points.states, &mut expected[1]);
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
    if !same(&expected[0], &batch.stress) || !same(&expected[1], &batch.statev) {
        return Err(failed("a batch and single calls differ"));
    }
    let ways: Vec<Way<'_>> = vec![
        Box::new(|| {
            points.stress.copy_from_slice(&stress);
            points.statev.copy_from_slice(&statev);
            black_box(points.call(&mut call));
        }),
        Box::new(|| {
            batch.stress.copy_from_slice(&batch_stress);
            batch.statev.copy_from_slice(&batch_statev);
            batch.call(black_box(Request::Stress));
        }),
    ];
    let times = settings.timing().take_turns(ways);
    Ok(Batch { per_second: POINTS as f64 / times.seconds(1), gain: times.ratio(0, 1) })
}
