//! Calls that differ from a plain one: in a local frame, of a UMAT that knows only six components, or with a tangent by
//! differences.
//!
//! Callers do not see the difference: [`UmatCall::call`] follows the settings of [`UmatCall::set_frame`],
//! [`UmatCall::set_tangent_source`] and [`UmatCall::go_through`].

mod components;
mod differences;
mod directions;
mod probing;
mod surroundings;

use super::call::{CallOutcome, UmatCall};
use super::frame::Framed;
use super::memory::Overrun;
use crate::law::{Heat, Request, StressState};
pub(super) use directions::Wide;
pub use probing::{FOLLOWS_GRADIENT, WRITTEN_FOR_SIX};
use std::fmt;

/// Source of a call's DDSDDE.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TangentSource {
    /// The plugin.
    #[default]
    Reported,
    /// Differences of the plugin's stress.
    Numerical,
    /// The plugin; differences judge it ([`UmatCall::largest_deviation`]).
    Compared,
}

/// Way in which a UMAT is called, as far as its user sets it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Manner {
    /// Whether it is called with NTENS 6 in a plane too; `None`: where the plugin needs it.
    pub as_three_d: Option<bool>,
    /// Source of DDSDDE; `None`: the plugin, as long as its tangent can be used.
    pub tangent: Option<TangentSource>,
}

/// A tangent that differs from the differences of the stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentDeviation {
    /// Largest difference of an entry, relative to the largest entry; infinite where an entry of DDSDDE is not finite.
    pub deviation: f64,
    /// Step, from 1.
    pub step: i32,
    /// Increment, from 1.
    pub increment: i32,
    /// NOEL.
    pub element: i32,
    /// NPT.
    pub point: i32,
}

impl fmt::Display for TangentDeviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { deviation, step, increment, element, point } = self;
        if deviation.is_finite() {
            write!(f, "DDSDDE differs from differences of the stress by {deviation:.1e} of its largest entry")?;
        } else {
            f.write_str("DDSDDE has entries that are NaN or infinite")?;
        }
        write!(f, " (step {step}, increment {increment}, element {element}, point {point})")
    }
}

impl TangentDeviation {
    /// The larger of two.
    #[must_use]
    pub fn worse(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        [a, b].into_iter().flatten().max_by(|a, b| a.deviation.total_cmp(&b.deviation))
    }
}

/// Way of calls that are not plain.
#[derive(Debug, Default)]
pub(super) struct Detour {
    /// The frame that the law sees its point in, outside of all else.
    pub(super) framed: Option<Framed>,
    /// The call with six components that is made instead.
    pub(super) solid: Option<Box<UmatCall>>,
    tangent: TangentSource,
    largest: Option<TangentDeviation>,
    /// Number of columns of DDSDDE that are wanted, from the first.
    columns: usize,
    buffers: Buffers,
}

/// Start and end of a call, kept while others are made.
#[derive(Clone, Debug, Default)]
struct Buffers {
    start: Point,
    end: Point,
}

/// Quantities that a call changes.
#[derive(Clone, Debug, Default)]
struct Point {
    stress: [f64; 6],
    statev: Vec<f64>,
    energies: [f64; 3],
    heat: Heat,
}

impl UmatCall {
    /// Sets the source of DDSDDE. Results of earlier comparisons are kept unless DDSDDE comes from the plugin alone.
    pub fn set_tangent_source(&mut self, tangent: TangentSource) {
        if let Some(solid) = self.detour.as_mut().and_then(|detour| detour.solid.as_mut()) {
            solid.set_tangent_source(tangent);
            if let Some(detour) = &mut solid.detour {
                // what the plane does not have is not looked for
                detour.columns = StressState::PlaneStrainOrAxisymmetric.components().len();
            }
            return;
        }
        let largest = self.take_largest_deviation().filter(|_| tangent != TangentSource::Reported);
        let framed = self.take_framed();
        self.detour = Some(Box::new(Detour { framed, tangent, largest, columns: self.ntens(), ..Detour::default() }));
        self.drop_plain_detour();
    }

    /// Forgets a detour that changes nothing: plain calls need not look at it.
    fn drop_plain_detour(&mut self) {
        let is_plain = |detour: &Detour| {
            detour.framed.is_none() && detour.solid.is_none() && detour.tangent == TangentSource::Reported
        };
        if self.detour.as_deref().is_some_and(is_plain) {
            self.detour = None;
        }
    }

    /// Takes the frame off.
    pub(super) fn take_framed(&mut self) -> Option<Framed> {
        let framed = self.detour.as_mut()?.framed.take();
        self.drop_plain_detour();
        framed
    }

    /// Puts a frame on, or none.
    pub(super) fn put_framed(&mut self, framed: Option<Framed>) {
        let columns = self.ntens();
        self.detour.get_or_insert_with(|| Box::new(Detour { columns, ..Detour::default() })).framed = framed;
        self.drop_plain_detour();
    }

    /// Returns where DDSDDE comes from.
    pub fn tangent_source(&self) -> TangentSource {
        let Some(detour) = &self.detour else { return TangentSource::Reported };
        detour.solid.as_ref().map_or(detour.tangent, |solid| solid.tangent_source())
    }

    /// Makes calls through a call of the same plugin with six components. The components that the plane lacks are 0; in
    /// plane stress the ε33 with σ33 = 0 is sought ([`Self::strain_33`]).
    ///
    /// # Panics
    /// If `solid` has not six components, or this call has as many.
    pub fn go_through(&mut self, solid: Self) {
        assert!(solid.ntens() == 6 && self.ntens() < 6, "a plane call goes through a solid one");
        let (tangent, framed) = (self.tangent_source(), self.take_framed());
        self.detour = Some(Box::new(Detour { framed, solid: Some(Box::new(solid)), ..Detour::default() }));
        self.set_tangent_source(tangent);
    }

    /// Returns whether calls go through one with six components.
    pub fn is_through_solid(&self) -> bool {
        self.solid().is_some()
    }

    /// The call with six components that this one goes through, with the arguments of its last call.
    pub fn solid(&self) -> Option<&Self> {
        self.detour.as_ref()?.solid.as_deref()
    }

    /// The largest deviation of the plugin's tangent from differences so far, where these are compared.
    pub fn largest_deviation(&self) -> Option<TangentDeviation> {
        let detour = self.detour.as_ref()?;
        detour.solid.as_ref().map_or(detour.largest, |solid| solid.largest_deviation())
    }

    /// [`Self::largest_deviation`]; forgets it.
    pub fn take_largest_deviation(&mut self) -> Option<TangentDeviation> {
        let detour = self.detour.as_mut()?;
        match &mut detour.solid {
            Some(solid) => solid.take_largest_deviation(),
            None => detour.largest.take(),
        }
    }

    /// Calls the plugin in another way than plainly.
    #[cold]
    pub(super) fn call_by_detour(&mut self, request: Request) -> Result<CallOutcome, Overrun> {
        let Some(mut detour) = self.detour.take() else { return self.call(request) };
        let Detour { framed, solid, tangent, largest, columns, buffers } = &mut *detour;
        let mut call = |this: &mut Self| match solid {
            Some(solid) => this.call_through(solid, request),
            None if request == Request::Stress || *tangent == TangentSource::Reported => this.call(request),
            None => this.call_with_differences(*tangent, *columns, largest, buffers),
        };
        let outcome = match framed {
            Some(framed) => self.in_frame(framed, request, call),
            None => call(self),
        };
        self.detour = Some(detour);
        outcome
    }

    /// STRESS, STATEV, energies and heat into a buffer.
    fn keep(&self, point: &mut Point) {
        point.stress[..self.ntens()].copy_from_slice(self.stress());
        point.statev.clear();
        point.statev.extend_from_slice(self.statev());
        (point.energies, point.heat) = (self.energies, self.heat());
    }

    /// STRESS, STATEV, energies and heat from a buffer.
    fn put_back(&mut self, point: &Point) {
        let ntens = self.ntens();
        self.stress_mut().copy_from_slice(&point.stress[..ntens]);
        self.statev_mut().copy_from_slice(&point.statev);
        self.energies = point.energies;
        self.set_heat(point.heat);
    }

    fn has_finite_stress(&self) -> bool {
        self.stress().iter().all(|stress| stress.is_finite())
    }
}
