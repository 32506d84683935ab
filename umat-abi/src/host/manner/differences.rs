//! DDSDDE by differences of the stress: repeated calls from the start of the increment.
//!
//! ```text
//! ∂σᵢ/∂εⱼ ≈ (σᵢ(Δε + h eⱼ) − σᵢ(Δε − h eⱼ))/2h          h = 10⁻⁵ max(|ε|, 10⁻⁴)
//! ```
//!
//! With large displacements DFGRD1 follows: F₁ → (1 + h sym eⱼ) F₁, DROT stays, so that a law that takes its strain from
//! there is differentiated alike. What comes out is the derivative of the stress itself, ∂σ/∂Δε, which is what this host's
//! stiffnesses are made of.

use super::super::call::{CallOutcome, UmatCall};
use super::super::memory::Overrun;
use super::{Buffers, TangentDeviation, TangentSource};
use crate::law::Request;

/// The difference of strain, relative to the largest strain: rounding and what an inner iteration leaves are divided by it.
const RELATIVE_STEP: f64 = 1e-5;
/// The strain is taken as at least so large.
const LEAST_STRAIN: f64 = 1e-4;
/// Differences that are unsymmetric by less than this part of the largest entry are of a symmetric tangent.
const ASYMMETRY: f64 = 1e-7;
/// Fraction of the increment that is tried next if a strain near its end gives no stress.
const CUT: f64 = 0.5;

/// Derivatives by one component: from below, from above, from both.
struct Column {
    below: Option<[f64; 6]>,
    above: Option<[f64; 6]>,
}

impl Column {
    fn mean(&self) -> Option<[f64; 6]> {
        match (self.below, self.above) {
            (Some(below), Some(above)) => Some(std::array::from_fn(|i| 0.5 * (below[i] + above[i]))),
            (one, other) => one.or(other),
        }
    }

    /// Returns where nothing grows: of the two sides the stiffer one, to which the point unloads.
    fn of_rest(&self, diagonal: usize) -> Option<[f64; 6]> {
        match (self.below, self.above) {
            (Some(below), Some(above)) => Some(if below[diagonal] > above[diagonal] { below } else { above }),
            (one, other) => one.or(other),
        }
    }
}

impl UmatCall {
    /// A call for stress and tangent, the tangent from, or judged by, differences.
    pub(super) fn call_with_differences(
        &mut self,
        source: TangentSource,
        columns: usize,
        largest: &mut Option<TangentDeviation>,
        buffers: &mut Buffers,
    ) -> Result<CallOutcome, Overrun> {
        self.keep(&mut buffers.start);
        let reports = source == TangentSource::Compared;
        let outcome = self.call(if reports { Request::StressAndTangent } else { Request::Stress })?;
        let ntens = self.ntens();
        let at_rest = self.dstran[..ntens].iter().all(|strain| *strain == 0.0);
        // of an increment of nothing the tangent of either side is a true one
        if outcome != CallOutcome::Done || !self.has_finite_stress() || (reports && at_rest) {
            return Ok(outcome);
        }
        self.keep(&mut buffers.end);
        let mut reported = [0.0; 36];
        reported[..ntens * ntens].copy_from_slice(self.ddsdde());
        let found: Vec<Option<Column>> =
            (0..columns).map(|column| self.column(column, buffers)).collect::<Result<_, _>>()?;
        self.put_back(&buffers.end);
        self.restore_outcome();
        self.tangent.as_mut_slice().copy_from_slice(&reported[..ntens * ntens]);
        match source {
            TangentSource::Compared => {
                let deviation = self.deviation(&found);
                if largest.is_none_or(|largest| deviation > largest.deviation) {
                    let (step, increment) = (self.jstep[0], self.kinc);
                    let (element, point) = (self.noel, self.npt);
                    *largest = Some(TangentDeviation { deviation, step, increment, element, point });
                }
            }
            TangentSource::Numerical | TangentSource::Reported => {
                for (j, column) in found.iter().enumerate() {
                    let values = column.as_ref().and_then(|c| if at_rest { c.of_rest(j) } else { c.mean() });
                    let Some(values) = values else { return Ok(self.cut_back(CUT)) };
                    self.tangent.as_mut_slice()[j * ntens..(j + 1) * ntens].copy_from_slice(&values[..ntens]);
                }
                self.remove_asymmetry(columns);
            }
        }
        Ok(outcome)
    }

    /// The derivatives by one component of the strain increment; a side where the plugin gives no stress is missing.
    fn column(&mut self, column: usize, buffers: &Buffers) -> Result<Option<Column>, Overrun> {
        let ntens = self.ntens();
        let strains = self.stran[..ntens].iter().zip(&self.dstran);
        let strain = strains.fold(LEAST_STRAIN, |most, (start, by)| most.max((start + by).abs()).max(by.abs()));
        let (whole, gradient) = (self.dstran[column], self.dfgrd1);
        let mut side = |sign: f64| -> Result<Option<[f64; 6]>, Overrun> {
            self.put_back(&buffers.start);
            self.dstran[column] = whole + sign * RELATIVE_STEP * strain;
            let step = self.dstran[column] - whole;
            if self.jstep[2] != 0 {
                self.stretch(column, step);
            }
            let outcome = self.call(Request::Stress);
            (self.dstran[column], self.dfgrd1) = (whole, gradient);
            let done = outcome? == CallOutcome::Done && self.has_finite_stress();
            let mut values = [0.0; 6];
            for ((value, stress), end) in values.iter_mut().zip(self.stress()).zip(&buffers.end.stress) {
                *value = (stress - end) / step;
            }
            Ok(done.then_some(values))
        };
        let (below, above) = (side(-1.0)?, side(1.0)?);
        Ok((below.is_some() || above.is_some()).then_some(Column { below, above }))
    }

    /// F₁ → (1 + h sym eⱼ) F₁, columns of F₁ one after the other.
    pub(super) fn stretch(&mut self, column: usize, step: f64) {
        const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        let (a, b) = PLACES[self.stress_state().components()[column]];
        for vector in &mut self.dfgrd1 {
            let old = *vector;
            if a == b {
                vector[a] += step * old[a];
            } else {
                vector[a] += 0.5 * step * old[b];
                vector[b] += 0.5 * step * old[a];
            }
        }
    }

    /// Returns how far DDSDDE is from the differences; infinity if it is not finite. At a kink it may be that of either side. With large displacements it may be
    /// ∂σ/∂ε or, as ABAQUS defines it, (1/J) ∂(Jσ)/∂ε = ∂σ/∂ε + σ ⊗ 1.
    fn deviation(&self, found: &[Option<Column>]) -> f64 {
        if self.moduli_not_finite().is_some() {
            return f64::INFINITY;
        }
        let ntens = self.ntens();
        let direct = self.ndi as usize;
        let means = found.iter().flatten().filter_map(Column::mean);
        let scale = means.flatten().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        let far = |with_volume: bool| {
            let entry = |i: usize, j: usize| {
                let volume = if with_volume && j < direct { self.stress()[i] } else { 0.0 };
                self.tangent(i, j) - volume
            };
            let of_side =
                |j: usize, side: &[f64; 6]| (0..ntens).fold(0.0_f64, |m, i| m.max((entry(i, j) - side[i]).abs()));
            let of_column = |(j, column): (usize, &Option<Column>)| {
                let column = column.as_ref()?;
                let sides = [column.mean(), column.below, column.above];
                sides.into_iter().flatten().map(|side| of_side(j, &side)).min_by(f64::total_cmp)
            };
            found.iter().enumerate().filter_map(of_column).fold(0.0, f64::max)
        };
        let least = if self.jstep[2] != 0 { far(false).min(far(true)) } else { far(false) };
        if scale > 0.0 { least / scale } else { 0.0 }
    }

    /// Makes differences exactly symmetric that are symmetric up to rounding.
    fn remove_asymmetry(&mut self, columns: usize) {
        let ntens = self.ntens();
        let entries = self.tangent.as_mut_slice();
        let largest = entries.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        let pairs = || (1..columns).flat_map(move |i| (0..i).map(move |j| (i * ntens + j, j * ntens + i)));
        if pairs().all(|(a, b)| (entries[a] - entries[b]).abs() <= ASYMMETRY * largest) {
            for (a, b) in pairs() {
                let mean = 0.5 * (entries[a] + entries[b]);
                (entries[a], entries[b]) = (mean, mean);
            }
        }
    }
}
