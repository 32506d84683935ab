//! One perpendicular fibre: the load of an embedded side against its slip, and the two sides of a crack together.

mod closed;
mod shear_lag;

pub use closed::{Closed, Debonding, Hook, Sliding};
pub use shear_lag::{BondLaw, ShearLag};

pub(crate) use closed::ClosedSide;
pub(crate) use shear_lag::ShearLagSide;

use crate::quadrature::root;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Sides of the crack from which fibres pull out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sides {
    /// The longer side does not move: w = s.
    One,
    /// Both carry P: w = s_1(P) + s_2(P).
    #[default]
    Two,
}

/// An embedded side: the load at the exit from 0 against the slip there.
pub(crate) trait Side {
    /// The load at a slip, and the greatest so far.
    fn loads(&self, slip: f64, embedded: f64) -> (f64, f64);
    /// Returns the stage: between two stages the load has a kink.
    fn stage(&self, slip: f64, embedded: f64) -> u8;
    /// The slip of the first maximum of the load.
    fn turning_slip(&self, embedded: f64) -> f64;
    /// The least slip at which the load is reached.
    fn loading_slip(&self, load: f64, embedded: f64) -> f64;
}

/// A fibre at an opening of the crack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bridged {
    /// Slip of the short side.
    pub slip: f64,
    /// Load now,
    pub load: f64,
    /// and the greatest so far.
    pub greatest: f64,
    /// See [`Side::stage`].
    pub stage: u8,
}

/// A fibre of which only the short side slips.
pub(crate) fn one_sided(side: &impl Side, opening: f64, embedded: f64) -> Bridged {
    let (load, greatest) = side.loads(opening, embedded);
    Bridged { slip: opening, load, greatest, stage: side.stage(opening, embedded) }
}

/// Two sides that carry the same load, at a slip of the short one: the opening. The long side loads with the greatest
/// load G, of which it slips by `loaded`, and unloads from it by Masing's rule; `loading_slip` is its [`Side::loading_slip`].
pub(crate) fn opening(slip: f64, (load, greatest): (f64, f64), loaded: f64, loading_slip: impl Fn(f64) -> f64) -> f64 {
    let back = if load < greatest { 2.0 * loading_slip(0.5 * (greatest - load)) } else { 0.0 };
    slip + (loaded - back).max(0.0)
}

/// Steps in which the slip of the short side settles while the long one unloads, to this part of the opening.
const FEW_STEPS: usize = 6;
const SETTLED: f64 = 1e-14;

/// The fibre whose two sides carry the same load, on the way of the short side's slip s_1: where the crack would have to
/// close the load falls at once.
pub(crate) fn two_sided(side: &impl Side, w: f64, short: f64, long: f64) -> Bridged {
    let turning = side.turning_slip(short);
    let peak = side.loads(turning.next_up(), short).1;
    let long_at_peak = side.loading_slip(peak, long);
    let gap = |slip: f64| {
        let loads = side.loads(slip, short);
        let loaded = if loads.1 == peak { long_at_peak } else { side.loading_slip(loads.1, long) };
        opening(slip, loads, loaded, |load| side.loading_slip(load, long)) - w
    };
    let slip = if w <= 0.0 {
        0.0
    } else if turning + long_at_peak == w {
        turning
    } else if turning + long_at_peak > w {
        // at the same load the short side mostly slips no less than the long one
        let half = (0.5 * w).min(turning);
        if gap(half) > 0.0 { root(gap, 0.0, half) } else { root(gap, half, w.min(turning)) }
    } else {
        // the long side slips no more than at the peak, unless the load passes that, and hardly moves as it unloads
        let after = (w - long_at_peak).max(turning.next_up());
        let mut slip = after;
        let mut left = gap(slip);
        for _ in 0..FEW_STEPS {
            if left.abs() <= SETTLED * w || slip - left <= turning {
                break;
            }
            slip -= left;
            left = gap(slip);
        }
        if left.abs() <= SETTLED * w {
            slip
        } else {
            let from = if gap(after) < 0.0 { after } else { turning.next_up() };
            if gap(from) >= 0.0 { from } else { root(gap, from, w) }
        }
    };
    let (load, greatest) = side.loads(slip, short);
    let unloads = u8::from(load < greatest);
    let long_slides = u8::from(greatest > peak && side.loading_slip(greatest, long) > side.turning_slip(long));
    Bridged { slip, load, greatest, stage: side.stage(slip, short) + 8 * unloads + 16 * long_slides }
}
