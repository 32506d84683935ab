//! The fibre across the crack: its bond, its angle, its strength.

use crate::bond::{Bridged, ClosedSide, ShearLagSide, Side, one_sided, two_sided};
use crate::inclination::{Inclined, Spalls};
use crate::interpolation::{monotone, monotone_slopes};
use crate::quadrature::Resolution;
use crate::table::{Row, Table};
use crate::{Closed, Fibre, Inclination, Invalid, ShearLag, Sides};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Model of the load of one perpendicular fibre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "model", rename_all = "snake_case")]
pub enum Bond {
    /// Closed forms.
    Closed(Closed),
    /// A bond law.
    ShearLag(ShearLag),
}

#[derive(Clone, Debug)]
enum LoadModel {
    Closed(ClosedSide),
    ShearLag(ShearLagSide),
    /// A table of loads over openings.
    Table(Table),
}

/// Intervals of the spalled length between which the load of a bond law is a monotone cubic: a load takes an equation of
/// two unknowns, and a spall an equation of such loads at every angle.
const SPALLED: usize = 16;

/// One fibre across a crack, at any length and angle.
#[derive(Clone, Debug)]
pub struct BridgingFibre {
    /// The fibre.
    pub fibre: Fibre,
    source: LoadModel,
    inclination: Inclination,
    spalls: Option<Spalls>,
    sides: Sides,
}

/// The part of a fibre's state at an opening that does not depend on its angle.
#[derive(Clone, Debug)]
pub(crate) struct Prepared<'t> {
    opening: f64,
    embedded: f64,
    base: Base<'t>,
}

#[derive(Clone, Debug)]
enum Base<'t> {
    Perpendicular(Bridged),
    /// A bridged fibre with its load over the spalled length: lengths, loads, slopes.
    Spalling(Bridged, [Vec<f64>; 3]),
    Row(Row<'t>),
}

impl Prepared<'_> {
    /// Returns the stage: between two stages the load has a kink.
    pub fn stage(&self) -> usize {
        match &self.base {
            Base::Perpendicular(bridged) | Base::Spalling(bridged, _) => usize::from(bridged.stage),
            Base::Row(row) => row.cell,
        }
    }
}

/// One fibre at an opening.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FibreResponse {
    /// Load along the normal, N; 0 once the fibre has broken.
    pub load: f64,
    /// Whether it has broken.
    pub ruptured: bool,
    /// Length that has spalled, mm.
    pub spalled: f64,
    pub(crate) stage: u8,
}

impl BridgingFibre {
    /// Makes a bridging fibre of a bond; `modular_ratio` is η_E = E V_f/(E_m (1 − V_f)), 0 for a stiff matrix.
    ///
    /// # Errors
    /// Numbers without sense.
    pub fn new(
        fibre: Fibre,
        bond: &Bond,
        inclination: Inclination,
        sides: Sides,
        modular_ratio: f64,
    ) -> Result<Self, Invalid> {
        fibre.check()?;
        inclination.check()?;
        let modulus = (1.0 + modular_ratio) * fibre.modulus;
        let source = match bond {
            Bond::Closed(closed) => {
                closed.check()?;
                closed.hook.as_ref().map_or(Ok(()), |hook| hook.check(&fibre))?;
                LoadModel::Closed(closed.side(&fibre, modulus))
            }
            Bond::ShearLag(law) => {
                law.check()?;
                LoadModel::ShearLag(law.side(&fibre, modulus))
            }
        };
        let mut bridging = Self { fibre, source, inclination, spalls: None, sides };
        bridging.spalls =
            inclination.spalls(&fibre, |opening, embedded, spalled| bridging.perpendicular(opening, embedded, spalled));
        Ok(bridging)
    }

    /// Makes a bridging fibre from curves at angles. The curves include the effect of the angle; curves at 0° alone use
    /// the inclination.
    ///
    /// # Errors
    /// Numbers without sense.
    pub fn of_table(
        fibre: Fibre,
        table: Table,
        inclination: Option<Inclination>,
        sides: Sides,
    ) -> Result<Self, Invalid> {
        fibre.check()?;
        let inclination = inclination.unwrap_or(Inclination::Exp { f: 0.0 });
        inclination.check()?;
        let table = match sides {
            Sides::One => table,
            Sides::Two => table.of_two_sides(),
        };
        let mut bridging = Self { fibre, source: LoadModel::Table(table), inclination, spalls: None, sides };
        bridging.spalls =
            inclination.spalls(&fibre, |opening, embedded, spalled| bridging.perpendicular(opening, embedded, spalled));
        Ok(bridging)
    }

    /// Returns the response at an opening w, of the shorter embedded side L_e, at θ (radians).
    pub fn at(&self, opening: f64, embedded: f64, angle: f64) -> FibreResponse {
        self.respond(&self.prepare(opening, embedded), angle)
    }

    pub(crate) fn prepare(&self, opening: f64, embedded: f64) -> Prepared<'_> {
        let base = match &self.source {
            LoadModel::Table(table) => Base::Row(table.row(opening, embedded, self.fibre.strength.is_some())),
            LoadModel::ShearLag(_) if self.spalls.is_some() => {
                let lengths: Vec<f64> = (0..=SPALLED).map(|k| embedded * k as f64 / SPALLED as f64).collect();
                let at = lengths.iter().map(|&spalled| self.perpendicular(opening, embedded, spalled));
                let at: Vec<Bridged> = at.collect();
                let loads: Vec<f64> = at.iter().map(|bridged| bridged.load).collect();
                let slopes = monotone_slopes(&lengths, &loads);
                Base::Spalling(at[0], [lengths, loads, slopes])
            }
            _ => Base::Perpendicular(self.perpendicular(opening, embedded, 0.0)),
        };
        Prepared { opening, embedded, base }
    }

    /// Returns the state of a perpendicular fibre whose embedded sides are both shorter by the spalled length.
    fn perpendicular(&self, opening: f64, embedded: f64, spalled: f64) -> Bridged {
        let short = embedded - spalled;
        if short <= 0.0 {
            return Bridged { slip: opening, load: 0.0, greatest: 0.0, stage: 3 };
        }
        let long = self.fibre.length - embedded - spalled;
        fn bridged(side: &impl Side, sides: Sides, opening: f64, short: f64, long: f64) -> Bridged {
            match sides {
                Sides::One => one_sided(side, opening, short),
                Sides::Two => two_sided(side, opening, short, long),
            }
        }
        match &self.source {
            LoadModel::Closed(side) => bridged(side, self.sides, opening, short, long),
            LoadModel::ShearLag(side) => bridged(side, self.sides, opening, short, long),
            LoadModel::Table(table) => {
                let (load, greatest) = table.row(opening, short, true).at(0.0);
                Bridged { slip: opening, load, greatest, stage: 0 }
            }
        }
    }

    /// The fibre at an angle as if it could not break.
    pub(crate) fn unbroken(&self, prepared: &Prepared<'_>, angle: f64) -> Inclined {
        match &prepared.base {
            Base::Row(row) => {
                let (load, greatest) = row.at(angle);
                let bridged = Bridged { slip: prepared.opening, load, greatest, stage: 0 };
                self.inclined(prepared, angle, &bridged, |spalled| {
                    self.perpendicular(prepared.opening, prepared.embedded, spalled)
                })
            }
            Base::Perpendicular(bridged) => self.inclined(prepared, angle, bridged, |spalled| {
                self.perpendicular(prepared.opening, prepared.embedded, spalled)
            }),
            Base::Spalling(bridged, [lengths, loads, slopes]) => self.inclined(prepared, angle, bridged, |spalled| {
                Bridged { load: monotone(spalled, lengths, loads, slopes), ..*bridged }
            }),
        }
    }

    fn inclined(
        &self,
        &Prepared { opening, embedded, .. }: &Prepared<'_>,
        angle: f64,
        base: &Bridged,
        at: impl Fn(f64) -> Bridged,
    ) -> Inclined {
        self.inclination.apply(&self.fibre, angle, opening, embedded, base, self.spalls.as_ref(), at)
    }

    pub(crate) fn respond(&self, prepared: &Prepared<'_>, angle: f64) -> FibreResponse {
        let Inclined { load, greatest, spalled, stage } = self.unbroken(prepared, angle);
        let breaks = |strength: f64| greatest > strength * self.fibre.area() * (-self.fibre.rupture_f * angle).exp();
        let ruptured = self.fibre.strength.is_some_and(breaks);
        let gone = u8::from(load <= 0.0);
        let stage = 4 * stage + 2 * u8::from(ruptured) + gone;
        FibreResponse { load: if ruptured { 0.0 } else { load }, ruptured, spalled, stage }
    }

    /// Returns whether the load has kinks over the angle in addition to those of [`Self::angles`].
    pub(crate) fn has_kinks_over_angles(&self) -> bool {
        let simple = matches!(self.inclination, Inclination::Exp { .. } | Inclination::ExpCos { .. });
        self.fibre.strength.is_some() || !simple
    }

    /// Returns how closely averages are worth following.
    pub(crate) fn resolution(&self) -> Resolution {
        match (&self.source, &self.spalls) {
            (LoadModel::Closed(_), None) => Resolution::EXACT,
            (LoadModel::Table(_), _) | (LoadModel::ShearLag(_), Some(_)) => Resolution::TABLE,
            _ => Resolution::LINES,
        }
    }

    /// Angles at which the source has kinks.
    pub(crate) fn angles(&self) -> Vec<f64> {
        match &self.source {
            LoadModel::Table(table) => table.angles().collect(),
            _ => Vec::new(),
        }
    }

    /// Lengths at which the source has kinks.
    pub(crate) fn lengths(&self) -> &[f64] {
        match &self.source {
            LoadModel::Table(table) => &table.lengths,
            LoadModel::Closed(side) => side.bends(),
            LoadModel::ShearLag(_) => &[],
        }
    }

    /// Returns whether the kinks over the length are those of [`Self::lengths`] alone.
    pub(crate) fn has_all_lengths(&self) -> bool {
        matches!(self.source, LoadModel::Table(_))
    }
}
