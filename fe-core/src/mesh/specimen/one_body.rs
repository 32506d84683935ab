//! Bodies whose stresses are known.

use std::f64::consts::FRAC_PI_2;

use super::requirement::Requirements;
use super::{SpecimenError, body, positions, uniform};
use crate::element::ElementKind;
use crate::kinematics::PlaneModel;
use crate::mesh::structured::{Grading, MeshBlock, Side};
use crate::mesh::{MeshDefinition, Part};
use crate::schema::{count, positive, two_counts};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A quarter of a plate with a hole.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PlateWithHole {
    /// Half of the width.
    #[schemars(schema_with = "positive")]
    pub width: f64,
    /// Half of the height.
    #[schemars(schema_with = "positive")]
    pub height: f64,
    /// Radius of the hole.
    #[schemars(schema_with = "positive")]
    pub radius: f64,
    /// About how many elements: two equal blocks of n × n.
    #[schemars(schema_with = "count")]
    pub cells: usize,
    /// Size at the outside over size at the hole.
    #[schemars(schema_with = "positive")]
    pub grading: f64,
    /// Kind of elements.
    pub element: ElementKind,
}

impl Default for PlateWithHole {
    fn default() -> Self {
        Self { width: 10.0, height: 10.0, radius: 1.0, cells: 200, grading: 10.0, element: ElementKind::Q8 }
    }
}

/// The quarter 0 ≤ x ≤ width, 0 ≤ y ≤ height of a plate whose hole is about the origin.
///
/// Node and edge sets `symmetry_x` (x = 0), `symmetry_y` (y = 0), `right`, `top`, `hole`; part `plate`.
pub fn plate_with_hole(parameters: &PlateWithHole) -> Result<MeshDefinition, SpecimenError> {
    let PlateWithHole { width, height, radius, cells, grading, element } = *parameters;
    let mut required = Requirements::default();
    required.positive([("width", width), ("height", height), ("radius", radius), ("grading", grading)]);
    required.that(
        radius < width.min(height),
        "radius",
        radius,
        format!("less than width and height, {}", width.min(height)),
    );
    required.that(cells >= 2, "cells", cells, "at least 2");
    required.check()?;

    let count = ((cells as f64 / 2.0).sqrt().round() as usize).max(1);
    let outwards = positions(1.0, Grading::Ratio { count, ratio: grading }, "cells from the hole outwards")?;
    let around = uniform(1.0, count, "cells around the hole")?;
    // The blocks meet on the line from the hole to the plate's corner.
    let corner_angle = height.atan2(width);
    let between = |s: f64, angle: f64, outer: [f64; 2]| {
        [(1.0 - s) * radius * angle.cos() + s * outer[0], (1.0 - s) * radius * angle.sin() + s * outer[1]]
    };
    let lower = |[s, t]: [f64; 2]| between(s, t * corner_angle, [width, t * height]);
    let upper = |[s, t]: [f64; 2]| {
        // Both blocks compute the line they share with the same operations.
        let angle = if t == 0.0 { corner_angle } else { corner_angle + t * (FRAC_PI_2 - corner_angle) };
        let [x, y] = between(s, angle, [(1.0 - t) * width, height]);
        // cos 90° is not 0.
        [if t == 1.0 { 0.0 } else { x }, y]
    };
    let mut mesh = MeshDefinition::default();
    let part = mesh.add_part(body("plate"));
    let first = mesh.block(&MeshBlock::new(part, element, &outwards, &around).mapped(&lower))?;
    let second = mesh
        .glued_block(&MeshBlock::new(part, element, &outwards, &around).mapped(&upper), &first.side_nodes(Side::Top))?;
    for (name, sides) in [
        ("symmetry_y", vec![(&first, Side::Bottom)]),
        ("right", vec![(&first, Side::Right)]),
        ("top", vec![(&second, Side::Right)]),
        ("symmetry_x", vec![(&second, Side::Top)]),
        ("hole", vec![(&second, Side::Left), (&first, Side::Left)]),
    ] {
        mesh.edge_set(name, sides.iter().flat_map(|(grid, side)| grid.side_edges(*side)).collect());
        for (grid, side) in sides {
            mesh.node_set(name, grid.side_nodes(side));
        }
    }
    Ok(mesh)
}

/// A thick cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ThickCylinder {
    /// A body of revolution instead of a quarter of the cross-section.
    pub axisymmetric: bool,
    /// Inner radius.
    #[schemars(schema_with = "positive")]
    pub inner_radius: f64,
    /// Outer radius.
    #[schemars(schema_with = "positive")]
    pub outer_radius: f64,
    /// Elements from the inner to the outer radius.
    #[schemars(schema_with = "count")]
    pub radial_cells: usize,
    /// Elements around, or along the height.
    #[schemars(schema_with = "count")]
    pub other_cells: usize,
    /// Height of the body of revolution.
    #[schemars(schema_with = "positive")]
    pub height: f64,
    /// Size at the outer radius over size at the inner one.
    #[schemars(schema_with = "positive")]
    pub grading: f64,
    /// Kind of elements.
    pub element: ElementKind,
}

impl Default for ThickCylinder {
    fn default() -> Self {
        Self {
            axisymmetric: false,
            inner_radius: 1.0,
            outer_radius: 2.0,
            radial_cells: 10,
            other_cells: 10,
            height: 1.0,
            grading: 2.0,
            element: ElementKind::Q8,
        }
    }
}

/// A thick cylinder, for Lamé's solution; part `cylinder`, node and edge sets `inner` and `outer`. Of the body of
/// revolution x is the radius, 0 ≤ y ≤ height, with `bottom` and `top`; of the quarter about the origin `symmetry_y`
/// (y = 0) and `symmetry_x` (x = 0).
pub fn thick_cylinder(parameters: &ThickCylinder) -> Result<MeshDefinition, SpecimenError> {
    let ThickCylinder { axisymmetric, inner_radius, outer_radius, radial_cells, other_cells, height, grading, element } =
        *parameters;
    let mut required = Requirements::default();
    required.positive([("inner_radius", inner_radius), ("grading", grading)]);
    required.that(
        outer_radius > inner_radius && outer_radius.is_finite(),
        "outer_radius",
        outer_radius,
        format!("more than the inner_radius {inner_radius}"),
    );
    required.count([("radial_cells", radial_cells)]);
    required.positive([("height", height)]);
    required.count([("other_cells", other_cells)]);
    required.check()?;
    let (length, part) = match axisymmetric {
        true => (height, Part::new("cylinder", PlaneModel::Axisymmetric, 1.0)),
        false => (FRAC_PI_2, body("cylinder")),
    };

    let outwards = Grading::Ratio { count: radial_cells, ratio: grading };
    let radii = positions(outer_radius - inner_radius, outwards, "radial_cells")?;
    let along = uniform(length, other_cells, "other_cells")?;
    let straight = |[s, y]: [f64; 2]| [inner_radius + s, y];
    let round = |[s, angle]: [f64; 2]| {
        let radius = inner_radius + s;
        // cos 90° is not 0.
        [if angle == FRAC_PI_2 { 0.0 } else { radius * angle.cos() }, radius * angle.sin()]
    };
    let (map, names): (&dyn Fn([f64; 2]) -> [f64; 2], _) = match axisymmetric {
        true => (&straight, ["bottom", "outer", "top", "inner"]),
        false => (&round, ["symmetry_y", "outer", "symmetry_x", "inner"]),
    };
    one_block(part, element, [&radii, &along], map, names)
}

/// Cook's membrane.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CookMembrane {
    /// Elements along each side.
    #[schemars(schema_with = "count")]
    pub cells: usize,
    /// Kind of elements.
    pub element: ElementKind,
}

impl Default for CookMembrane {
    fn default() -> Self {
        Self { cells: 8, element: ElementKind::Q8 }
    }
}

/// Cook's membrane: (0, 0), (48, 44), (48, 60), (0, 44) in `cells` × `cells` cells; node and edge sets `left` (held),
/// `right` (loaded), `bottom`, `top`; part `membrane`.
pub fn cook_membrane(parameters: &CookMembrane) -> Result<MeshDefinition, SpecimenError> {
    let CookMembrane { cells, element } = *parameters;
    let mut required = Requirements::default();
    required.count([("cells", cells)]);
    required.check()?;
    let line = uniform(1.0, cells, "cells")?;
    let map = |[s, t]: [f64; 2]| {
        let (bottom, top) = (44.0 * s, 44.0 + 16.0 * s);
        [48.0 * s, bottom + t * (top - bottom)]
    };
    one_block(body("membrane"), element, [&line, &line], &map, ["bottom", "right", "top", "left"])
}

/// A rectangle about y = 0.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Beam {
    /// Along x.
    #[schemars(schema_with = "positive")]
    pub length: f64,
    /// Along y.
    #[schemars(schema_with = "positive")]
    pub height: f64,
    /// Elements along x and y.
    #[schemars(schema_with = "two_counts")]
    pub cells: [usize; 2],
    /// Kind of elements.
    pub element: ElementKind,
}

impl Default for Beam {
    fn default() -> Self {
        Self { length: 10.0, height: 1.0, cells: [20, 2], element: ElementKind::Q8 }
    }
}

/// The rectangle 0 ≤ x ≤ length, −height/2 ≤ y ≤ height/2, for Timoshenko's beam and for patch tests; node and edge sets `left`, `right`, `bottom`, `top`; part
/// `beam`.
pub fn beam(parameters: &Beam) -> Result<MeshDefinition, SpecimenError> {
    let Beam { length, height, cells, element } = *parameters;
    let mut required = Requirements::default();
    required.positive([("length", length), ("height", height)]);
    required.count(cells.map(|count| ("cells", count)));
    required.check()?;
    let along = uniform(length, cells[0], "cells along the beam")?;
    let across = uniform(height, cells[1], "cells across the beam")?;
    let map = |[x, y]: [f64; 2]| [x, y - 0.5 * height];
    one_block(body("beam"), element, [&along, &across], &map, ["bottom", "right", "top", "left"])
}

/// A single block whose sides are named, from the bottom counter-clockwise.
fn one_block(
    part: Part,
    element: ElementKind,
    lines: [&[f64]; 2],
    map: &dyn Fn([f64; 2]) -> [f64; 2],
    names: [&str; 4],
) -> Result<MeshDefinition, SpecimenError> {
    let mut mesh = MeshDefinition::default();
    let part = mesh.add_part(part);
    let grid = mesh.block(&MeshBlock::new(part, element, lines[0], lines[1]).mapped(map))?;
    for (name, side) in std::iter::zip(names, [Side::Bottom, Side::Right, Side::Top, Side::Left]) {
        mesh.node_set(name, grid.side_nodes(side));
        mesh.edge_set(name, grid.side_edges(side));
    }
    Ok(mesh)
}
