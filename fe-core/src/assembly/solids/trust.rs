//! Trust in the laws of parts: laws with metadata are believed in everything, any other UMAT as long as it does not
//! contradict itself.
//!
//! # Energies
//!
//! Most UMATs leave SSE, SPD and SCD alone, some set them wrong. What a part's law reports is compared with the work of its
//! stresses, ∫σ:dε. A law that reports nothing while its stresses work, and one whose report misses the work by the same
//! part however small the increment is, are not believed: then this work is what the part has stored or dissipated, and the
//! balance of all energies judges the rest.
//!
//! # Tangents
//!
//! DDSDDE that is not the derivative of the stress shows in iterations that converge slowly. Then it is compared with
//! differences; where it is far off, differences take its place.

use super::Solids;
use super::points::{Points, States};
use crate::model::PluginLaw;
use serde::{Deserialize, Serialize};
use umat_abi::host::{TangentDeviation, TangentSource};

/// Relative tolerance within which two deviations of energy over work from 1 count as equal, of increments that differ
/// by [`SHRINKAGE`]: those of trapezoidal sums shrink with the increment.
const SAME: f64 = 0.02;
/// Relative tolerance within which the deviations of three increments count as equal together.
const SIMILAR: f64 = 0.2;
const SHRINKAGE: f64 = 0.3;
/// Share of the imbalance from which on a part is held responsible for it.
const SHARE: f64 = 0.5;
/// Difference of energies from the work at the end of a run from which on it is reported, relative to the largest work so far: that at
/// the end may be what rounding leaves.
const NOTEWORTHY: f64 = 0.1;
/// DDSDDE that is off by more than this part of its largest entry is replaced.
const LARGEST_DEVIATION: f64 = 0.05;
/// Increments between the first comparison that finds nothing and the next; they double each time.
const FIRST_PAUSE: u64 = 2;
const LONGEST_PAUSE: u64 = 128;

/// Treatment of the energies that a law reports.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Reports {
    /// Metadata vouch for them.
    Vouched,
    /// Energies are taken as they are.
    Believed,
    /// The law reports no energies.
    Missing,
    /// Energies are this part of the work.
    Wrong { ratio: f64 },
}

/// Trust in a part's law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Trust {
    reports: Reports,
    /// The largest work of the part's stresses at the end of any increment so far, N·mm.
    largest_work: f64,
    /// Increments of the present attempts and by how much the reported energy missed the work.
    missed: Vec<[f64; 2]>,
    /// Whether slow iterations may lead to another tangent.
    judges_tangent: bool,
    /// Increments until the next comparison, and between comparisons.
    pause: [u64; 2],
    /// Deviation of its tangent when that was replaced.
    tangent_deviation: Option<f64>,
    /// Result, up to the present calls, of the comparisons that the model asks for.
    compared: Option<Compared>,
}

/// A [`TangentDeviation`]: step, increment, element and point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Compared {
    deviation: f64,
    place: [i32; 4],
}

impl From<TangentDeviation> for Compared {
    fn from(found: TangentDeviation) -> Self {
        let TangentDeviation { deviation, step, increment, element, point } = found;
        Self { deviation, place: [step, increment, element, point] }
    }
}

impl From<Compared> for TangentDeviation {
    fn from(Compared { deviation, place: [step, increment, element, point] }: Compared) -> Self {
        Self { deviation, step, increment, element, point }
    }
}

impl Trust {
    pub(super) fn new(law: &PluginLaw) -> Self {
        let is_foreign = law.law.is_none();
        Self {
            reports: if is_foreign { Reports::Believed } else { Reports::Vouched },
            largest_work: 0.0,
            missed: Vec::new(),
            judges_tangent: is_foreign && law.manner.tangent.is_none(),
            pause: [0, FIRST_PAUSE],
            tangent_deviation: None,
            compared: None,
        }
    }

    /// Returns whether reported energies count.
    pub(super) fn believes(&self) -> bool {
        matches!(self.reports, Reports::Vouched | Reports::Believed)
    }

    /// Records the mismatch of a refused increment; returns whether the report is refuted.
    fn misses(&mut self, size: f64, by: f64) -> bool {
        self.missed.push([size, by]);
        let [.., earlier, last] = self.missed[..] else { return false };
        let alike = |a: [f64; 2], b: [f64; 2], within: f64| {
            let far = (a[1] - b[1]).abs();
            b[0] <= SHRINKAGE * a[0] && far <= within * a[1].abs().max(b[1].abs())
        };
        let first = self.missed[0];
        alike(earlier, last, SAME)
            || alike(first, last, SAME)
            || (alike(first, earlier, SIMILAR) && alike(earlier, last, SIMILAR))
    }
}

/// Energies that a part's law has reported, and the work of its stresses, N·mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PartAccount {
    /// SSE.
    pub stored: f64,
    /// SPD + SCD.
    pub dissipated: f64,
    /// Whether the dissipation counts as damage.
    pub damages: bool,
    /// ∫σ:dε; 0 where metadata vouch for the law.
    pub work: f64,
}

impl PartAccount {
    fn total(&self) -> f64 {
        self.stored + self.dissipated
    }
}

/// Adds Σ work dV, point by point.
pub(super) fn add_work(sum: &mut f64, work: &[f64], volumes: &[f64]) {
    work.iter().zip(volumes).for_each(|(work, volume)| *sum += work * volume);
}

impl Solids {
    /// Returns the energies that each part's law has reported of the committed state, and the work of its stresses.
    pub fn accounts(&self) -> Vec<PartAccount> {
        self.accounts_of(|points| &points.committed)
    }

    pub(super) fn accounts_of(&self, states: fn(&Points) -> &States) -> Vec<PartAccount> {
        let mut accounts = vec![PartAccount::default(); self.trust.len()];
        for body in self.bodies() {
            let (states, account) = (states(&body.points), &mut accounts[body.index]);
            account.damages = body.part.damages;
            add_work(&mut account.work, &states.work, &body.volumes);
            for ([stored, plastic, creep], volume) in states.reference_energies.iter().zip(&body.volumes) {
                account.stored += stored * volume;
                account.dissipated += (plastic + creep) * volume;
            }
        }
        accounts
    }

    /// Returns whether some energies are taken as reported although no metadata vouch for them.
    pub(crate) fn has_unproven_energies(&self) -> bool {
        self.trust.iter().any(|trust| trust.reports == Reports::Believed)
    }

    /// Looks for parts whose law reports no energies although its stresses work in the increment of the last evaluation, and
    /// for those whose report contradicts the work: `refused` is the size of the increment and the imbalance of energies
    /// that it would add, N·mm, if it is refused for that. Returns the parts that are not believed from now on.
    pub(crate) fn judge_energies(&mut self, refused: Option<[f64; 2]>) -> Vec<usize> {
        let (before, after) = (self.accounts(), self.accounts_of(|points| &points.trial));
        let mut found = Vec::new();
        for (part, trust) in self.trust.iter_mut().enumerate() {
            let (before, after) = (&before[part], &after[part]);
            if trust.reports != Reports::Believed {
                continue;
            }
            let work = after.work - before.work;
            let reported = after.total() - before.total();
            if work != 0.0 && after.stored == 0.0 && after.dissipated == 0.0 {
                trust.reports = Reports::Missing;
                found.push(part);
            } else if let Some([size, imbalance]) = refused
                && work != 0.0
                && (work - reported).abs() >= SHARE * imbalance.abs()
                && trust.misses(size, 1.0 - reported / work)
            {
                trust.reports = Reports::Wrong { ratio: reported / work };
                found.push(part);
            }
        }
        found
    }

    /// An increment was accepted: the next one is judged anew.
    pub(crate) fn energies_stand(&mut self) {
        if self.has_unproven_energies() {
            for (part, account) in self.accounts().iter().enumerate() {
                let largest = &mut self.trust[part].largest_work;
                *largest = largest.max(account.work.abs());
            }
        }
        for trust in &mut self.trust {
            trust.missed.clear();
            trust.pause[0] = trust.pause[0].saturating_sub(1);
        }
    }

    /// Returns whether slow iterations are a reason to compare a part's tangents with differences.
    pub(crate) fn doubts_tangents(&self) -> bool {
        self.trust.iter().any(Self::is_due)
    }

    fn is_due(trust: &Trust) -> bool {
        trust.judges_tangent && trust.pause[0] == 0
    }

    /// Makes the next evaluation compare the tangents in doubt with differences.
    pub(crate) fn compare_tangents(&mut self) {
        let due: Vec<bool> = self.trust.iter().map(Self::is_due).collect();
        self.set_tangent_sources(|part| due[part].then_some(TangentSource::Compared));
    }

    /// Judges tangents by the comparison of the last evaluation, and returns whether one was replaced.
    pub(crate) fn judge_tangents(&mut self) -> bool {
        let mut deviations: Vec<Option<TangentDeviation>> = vec![None; self.trust.len()];
        for body in self.blocks.iter_mut().map(|block| &mut block.body) {
            if Self::is_due(&self.trust[body.index]) {
                let found = body.points.call.take_largest_deviation();
                deviations[body.index] = TangentDeviation::worse(deviations[body.index], found);
            }
        }
        let mut sources = vec![None; self.trust.len()];
        let mut replaces = false;
        for (part, trust) in self.trust.iter_mut().enumerate().filter(|(_, trust)| Self::is_due(trust)) {
            let deviation = deviations[part].map_or(0.0, |deviation| deviation.deviation);
            if deviation > LARGEST_DEVIATION {
                (trust.judges_tangent, trust.tangent_deviation) = (false, Some(deviation));
                sources[part] = Some(TangentSource::Numerical);
                replaces = true;
            } else {
                let [left, pause] = &mut trust.pause;
                (*left, *pause) = (*pause, (2 * *pause).min(LONGEST_PAUSE));
                sources[part] = Some(TangentSource::Reported);
            }
        }
        self.set_tangent_sources(|part| sources[part]);
        replaces
    }

    /// Sets the source of the tangents of parts from the next evaluation on.
    fn set_tangent_sources(&mut self, source: impl Fn(usize) -> Option<TangentSource>) {
        for block in &mut self.blocks {
            if let Some(source) = source(block.body.index) {
                block.body.points.call.set_tangent_source(source);
                block.records.iter_mut().for_each(|record| record.has_tangent = false);
            }
        }
    }

    /// Takes over what another run came to believe.
    pub(super) fn take_trust(&mut self, trust: &[Trust]) {
        self.trust.clone_from_slice(trust);
        let replaced: Vec<bool> = trust.iter().map(|trust| trust.tangent_deviation.is_some()).collect();
        self.set_tangent_sources(|part| replaced[part].then_some(TangentSource::Numerical));
    }

    /// Returns what users should know of the laws, after a run.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = self.notes.clone();
        let accounts = self.accounts();
        for (part, trust) in self.present_trust().iter().enumerate() {
            let name = self.bodies().find(|body| body.index == part).map_or("", |body| body.part.name.as_str());
            let mut say = |text: String| remarks.push(format!("part '{name}': {text}"));
            match trust.reports {
                Reports::Vouched => {}
                Reports::Believed => {
                    let (work, total, largest) = (accounts[part].work, accounts[part].total(), trust.largest_work);
                    if (total - work).abs() > NOTEWORTHY * largest {
                        say(format!(
                            "the energies that its UMAT reports (SSE + SPD + SCD) are {total:.3e} N·mm at the end, the work of its \
                             stresses {work:.3e} N·mm, at most {largest:.3e}: wrong ones, or coarse increments"
                        ));
                    }
                }
                Reports::Missing => say(
                    "its UMAT reports no energies (SSE, SPD, SCD stay 0): the work of its stresses counts instead, as \
                     unaccounted energy, which may be stored or dissipated"
                        .to_owned(),
                ),
                Reports::Wrong { ratio } => say(format!(
                    "the energies that its UMAT reports (SSE + SPD + SCD) contradict its stresses: {ratio:.3} of their work, \
                     however small the increment; this work counts instead, as unaccounted energy"
                )),
            }
            if let Some(compared) = trust.compared {
                say(TangentDeviation::from(compared).to_string());
            }
            if let Some(deviation) = trust.tangent_deviation {
                say(format!(
                    "DDSDDE of its UMAT is not the derivative of the stress ({}) and iterations converged slowly: \
                     differences took its place, as by \"tangent\": \"numerical\"",
                    if deviation.is_finite() {
                        format!("off by {:.0} % of its largest entry", 1e2 * deviation)
                    } else {
                        "it has entries that are NaN or infinite".to_owned()
                    }
                ));
            }
        }
        remarks
    }

    /// Returns how far the laws are believed, with all that comparisons came to.
    pub(super) fn present_trust(&self) -> Vec<Trust> {
        let mut trust = self.trust.clone();
        for body in self.bodies() {
            let compared = &mut trust[body.index].compared;
            let worse = TangentDeviation::worse(compared.map(Into::into), body.points.call.largest_deviation());
            *compared = worse.map(Into::into);
        }
        trust
    }
}
