//! *ORIENTATION: local axes by coordinates and a further rotation.

use super::keywords::Keyword;
use serde_json::{Value, json};

type Vector = [f64; 3];

/// Local axes of a material.
#[derive(Clone, Debug)]
pub(super) enum Axes {
    /// The first axis, and a vector in the plane of the first two.
    Known([Vector; 2]),
    /// They cannot be imported: the reason, with its line.
    Unknown(String),
}

impl Axes {
    /// The axes in the form of a case.
    pub(super) fn for_case(&self) -> Option<Value> {
        match self {
            Self::Known(vectors) => Some(json!(vectors)),
            Self::Unknown(_) => None,
        }
    }

    /// Returns whether an axis lies between those of the job.
    pub(super) fn is_oblique(&self) -> bool {
        const SMALL: f64 = 1e-9;
        let Self::Known([first, second]) = self else { return false };
        let axes = [unit(*first), unit(cross(*first, *second))];
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
    let from_origin = |first: usize| -> Vector { std::array::from_fn(|k| points[first + k] - points[6 + k]) };
    let [a, b] = [from_origin(0), from_origin(3)];
    if cross(a, b) == [0.0; 3] {
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
    let third = unit(cross(a, b));
    let axes = [unit(a), cross(third, unit(a)), third];
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let mut turned = axes;
    for k in 0..3 {
        turned[next][k] = cosine * axes[next][k] + sine * axes[last][k];
        turned[last][k] = cosine * axes[last][k] - sine * axes[next][k];
    }
    Ok(Axes::Known([turned[0], turned[1]]))
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector of length 1; NaN for none.
fn unit(a: Vector) -> Vector {
    let length = a.iter().map(|component| component * component).sum::<f64>().sqrt();
    a.map(|component| component / length)
}
