//! *ORIENTATION: local axes by coordinates and a further rotation.

use super::keywords::Keyword;
use nalgebra::{Rotation3, Unit, Vector3};
use serde_json::{Value, json};

/// Local axes of a material.
#[derive(Clone, Debug)]
pub(super) enum Axes {
    /// The first axis, and a vector in the plane of the first two.
    Known([Vector3<f64>; 2]),
    /// They cannot be imported: the reason, with its line.
    Unknown(String),
}

impl Axes {
    /// The axes in the form of a case.
    pub(super) fn for_case(&self) -> Option<Value> {
        match self {
            Self::Known(vectors) => Some(json!(vectors.map(<[f64; 3]>::from))),
            Self::Unknown(_) => None,
        }
    }

    /// Returns whether an axis lies between those of the job.
    pub(super) fn is_oblique(&self) -> bool {
        const SMALL: f64 = 1e-9;
        let Self::Known([first, second]) = self else { return false };
        let axes = [first.normalize(), first.cross(second).normalize()];
        axes.iter().any(|axis| axis.iter().filter(|component| component.abs() > SMALL).count() > 1)
    }
}

/// Reads the axes.
///
/// # Errors
/// A field is no number.
pub(super) fn read(keyword: &Keyword) -> Result<Axes, String> {
    let place = &keyword.place;
    let is_plain = keyword.capitals("DEFINITION").is_none_or(|kind| kind == "COORDINATES")
        && keyword.capitals("SYSTEM").is_none_or(|system| system == "RECTANGULAR")
        && keyword.parameter("LOCAL DIRECTIONS").is_none();
    let Some(line) = keyword.data.first().filter(|_| is_plain) else {
        return Ok(Axes::Unknown(format!("{place}: *ORIENTATION that is not rectangular by coordinates")));
    };
    let points = (0..9).map(|field| line.number(field)).collect::<Result<Vec<_>, _>>()?;
    let from_origin = |first: usize| Vector3::from_fn(|k, _| points[first + k] - points[6 + k]);
    let [a, b] = [from_origin(0), from_origin(3)];
    if a.cross(&b) == Vector3::zeros() {
        return Ok(Axes::Unknown(format!("{place}: *ORIENTATION whose points make no two axes")));
    }
    let Some(line) = keyword.data.get(1) else { return Ok(Axes::Known([a, b])) };
    let degrees = line.number(1)?;
    if degrees == 0.0 {
        return Ok(Axes::Known([a, b]));
    }
    // the axis is 1 unless given
    let axis = match line.text(0) {
        "" | "1" => 0,
        "2" => 1,
        "3" => 2,
        other => {
            let place = &line.place;
            return Ok(Axes::Unknown(format!("{place}: a further rotation of an *ORIENTATION about the axis {other}")));
        }
    };
    let (first, third) = (a.normalize(), a.cross(&b).normalize());
    let axes = [first, third.cross(&first), third];
    let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(axes[axis]), degrees.to_radians());
    Ok(Axes::Known([turn * axes[0], turn * axes[1]]))
}
