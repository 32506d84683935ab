//! Fields along lines: the tractions of contact pairs along their surfaces.

use super::super::figure::{Figure, Line, Style};
use super::super::quantity::Quantity;
use fe_core::output::{ContactPoint, Fields};

/// Coordinate along the slave surface of a pair.
pub(crate) const ALONG_SURFACE: &str = "arc length along the hole";
/// Name of the picture of shear tractions.
pub(crate) const INTERFACE_SHEAR: &str = "interface_shear";

/// Shear traction and pressure of each contact pair along its slave surface.
///
/// The lines stop where a point has left the other surface (weight 0).
pub(crate) fn interface_profiles(fields: &Fields) -> Vec<Figure> {
    type Value = fn(&ContactPoint) -> f64;
    let shear: Value = |point| point.shear_traction;
    let pressure: Value = |point| point.pressure;
    let quantities = [(INTERFACE_SHEAR, "bond traction", shear), ("interface_pressure", "contact pressure", pressure)];
    let figure = |(name, label, value): (&str, &str, Value)| Figure {
        name: name.into(),
        x: Quantity { name: ALONG_SURFACE.into(), unit: "mm".into() },
        y: Quantity { name: label.into(), unit: "MPa".into() },
        lines: (0..fields.pairs.len()).map(|pair| line(fields, pair, name, value)).collect(),
        ..Figure::default()
    };
    if fields.contact.is_empty() { Vec::new() } else { quantities.into_iter().map(figure).collect() }
}

/// One pair's points, by arc length.
fn line(fields: &Fields, pair: usize, name: &str, value: impl Fn(&ContactPoint) -> f64) -> Line {
    let own = fields.contact.iter().filter(|point| point.pair == pair);
    let mut points: Vec<(f64, f64)> =
        own.map(|point| (point.arc, if point.weight > 0.0 { value(point) } else { f64::NAN })).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    Line {
        label: fields.pairs[pair].clone(),
        points,
        columns: ("arc".into(), name.into()),
        style: Style { color: pair, dash: pair % 2 },
        ..Line::default()
    }
}
