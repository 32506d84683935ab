//! Two bodies whose contact is known.

use super::requirement::Requirements;
use super::{SpecimenError, body, positions, uniform};
use crate::element::ElementKind;
use crate::mesh::MeshDefinition;
use crate::mesh::structured::{Grading, Grid, MeshBlock, Side, capped_through};
use crate::schema::{count, positive, two_counts, two_positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Two rectangles upon each other; values are of the lower and the upper one.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TwoBlocks {
    /// Width of both.
    #[schemars(schema_with = "positive")]
    pub width: f64,
    /// Heights.
    #[schemars(schema_with = "two_positive")]
    pub heights: [f64; 2],
    /// Edges on the contact.
    #[schemars(schema_with = "two_counts")]
    pub edges: [usize; 2],
    /// Rows of elements.
    #[schemars(schema_with = "two_counts")]
    pub rows: [usize; 2],
    /// Kind of elements.
    pub element: ElementKind,
}

impl Default for TwoBlocks {
    fn default() -> Self {
        Self { width: 1.0, heights: [1.0; 2], edges: [4, 3], rows: [2; 2], element: ElementKind::Q8 }
    }
}

/// Two rectangles 0 ≤ x ≤ width, the lower one below y = 0, for contact patch tests.
///
/// Parts `lower`, `upper`; node sets `bottom`, `top`, `lower_left`, `lower_right`, `upper_left`, `upper_right`; edge
/// sets `lower_contact`, `upper_contact`, `top`.
pub fn two_blocks(parameters: &TwoBlocks) -> Result<MeshDefinition, SpecimenError> {
    let TwoBlocks { width, heights, edges, rows, element } = *parameters;
    let mut required = Requirements::default();
    required.positive([("width", width)]);
    required.positive(heights.map(|height| ("heights", height)));
    required.count(edges.map(|count| ("edges", count)));
    required.count(rows.map(|count| ("rows", count)));
    required.check()?;

    let mut mesh = MeshDefinition::default();
    let mut grids = Vec::new();
    for (index, name) in ["lower", "upper"].into_iter().enumerate() {
        let x = uniform(width, edges[index], "edges of a block")?;
        let y = uniform(heights[index], rows[index], "rows of a block")?;
        let part = mesh.add_part(body(name));
        let shift = if index == 0 { -heights[0] } else { 0.0 };
        let map = |[x, y]: [f64; 2]| [x, y + shift];
        grids.push(mesh.block(&MeshBlock::new(part, element, &x, &y).mapped(&map))?);
    }
    mesh.node_set("bottom", grids[0].side_nodes(Side::Bottom));
    mesh.node_set("top", grids[1].side_nodes(Side::Top));
    mesh.edge_set("top", grids[1].side_edges(Side::Top));
    mesh.edge_set("lower_contact", grids[0].side_edges(Side::Top));
    mesh.edge_set("upper_contact", grids[1].side_edges(Side::Bottom));
    for (grid, left, right) in [(&grids[0], "lower_left", "lower_right"), (&grids[1], "upper_left", "upper_right")] {
        mesh.node_set(left, grid.side_nodes(Side::Left));
        mesh.node_set(right, grid.side_nodes(Side::Right));
    }
    Ok(mesh)
}

/// Half of a cylinder that is pressed onto a plane.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Hertz {
    /// Radius of the cylinder.
    #[schemars(schema_with = "positive")]
    pub radius: f64,
    /// Extent of both bodies from the symmetry line.
    #[schemars(schema_with = "positive")]
    pub half_width: f64,
    /// Height of the cylinder's flat top above the contact.
    #[schemars(schema_with = "positive")]
    pub height: f64,
    /// Depth of the base.
    #[schemars(schema_with = "positive")]
    pub depth: f64,
    /// Half width of the zone of small edges.
    #[schemars(schema_with = "positive")]
    pub contact_zone: f64,
    /// Edges in this zone.
    #[schemars(schema_with = "count")]
    pub contact_edges: usize,
    /// Each size over the one before it.
    #[schemars(schema_with = "positive")]
    pub growth: f64,
    /// Kind of elements.
    pub element: ElementKind,
}

impl Default for Hertz {
    fn default() -> Self {
        Self {
            radius: 10.0,
            half_width: 5.0,
            height: 5.0,
            depth: 5.0,
            contact_zone: 0.5,
            contact_edges: 20,
            growth: 1.3,
            element: ElementKind::Q8,
        }
    }
}

/// A cylinder on a plane, for Hertz's solution. They touch at the origin; the base is below y = 0. Node pairs lie above
/// each other.
///
/// Parts `cylinder`, `base`; node sets `symmetry` (x = 0 of both), `top`, `bottom`, `base_side`; edge sets
/// `cylinder_contact` (the arc), `base_contact`, `top`.
pub fn hertz(parameters: &Hertz) -> Result<MeshDefinition, SpecimenError> {
    let Hertz { radius, half_width, height, depth, contact_zone, contact_edges, growth, element } = *parameters;
    let mut required = Requirements::default();
    required.positive([("radius", radius), ("half_width", half_width), ("height", height), ("depth", depth)]);
    required.positive([("contact_zone", contact_zone)]);
    required.that(half_width < radius, "half_width", half_width, format!("less than the radius {radius}"));
    required.that(
        contact_zone < half_width,
        "contact_zone",
        contact_zone,
        format!("less than the half_width {half_width}"),
    );
    required.count([("contact_edges", contact_edges)]);
    required.that(growth >= 1.0 && growth.is_finite(), "growth", growth, "at least 1");
    // R − √(R² − x²) without its cancellation.
    let arc = |x: f64| x * x / (radius + (radius * radius - x * x).sqrt());
    let rise = arc(half_width);
    required.that(
        rise.is_nan() || height > rise,
        "height",
        height,
        format!("more than the arc rises over the half_width, {rise}"),
    );
    required.check()?;

    let size = contact_zone / contact_edges as f64;
    let mut x = uniform(contact_zone, contact_edges, "contact_edges")?;
    x.extend(
        &capped_through(&[contact_zone, half_width], size * growth, growth, half_width)
            .map_err(SpecimenError::along("growth away from the contact"))?[1..],
    );
    let graded = |largest| Grading::Capped { first: size, growth, largest };
    let upwards = positions(height, graded(height), "growth upwards")?;
    let downwards = positions(depth, graded(depth), "growth downwards")?;
    let y: Vec<f64> = downwards.iter().rev().map(|y| 0.0 - y).collect();
    let map = |[x, s]: [f64; 2]| [x, arc(x) + s / height * (height - arc(x))];

    let mut mesh = MeshDefinition::default();
    let parts = ["cylinder", "base"].map(|name| mesh.add_part(body(name)));
    let cylinder = mesh.block(&MeshBlock::new(parts[0], element, &x, &upwards).mapped(&map))?;
    let base = mesh.block(&MeshBlock::new(parts[1], element, &x, &y))?;
    mesh.node_set("symmetry", cylinder.side_nodes(Side::Left));
    mesh.node_set("symmetry", base.side_nodes(Side::Left));
    mesh.node_set("top", cylinder.side_nodes(Side::Top));
    mesh.node_set("bottom", base.side_nodes(Side::Bottom));
    mesh.node_set("base_side", base.side_nodes(Side::Right));
    mesh.edge_set("top", cylinder.side_edges(Side::Top));
    mesh.edge_set("cylinder_contact", cylinder.side_edges(Side::Bottom));
    mesh.edge_set("base_contact", base.side_edges(Side::Top));
    Ok(mesh)
}

/// A strip that is pulled out from under a block.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DragOutStrip {
    /// Length of the strip.
    #[schemars(schema_with = "positive")]
    pub strip_length: f64,
    /// Half of its thickness.
    #[schemars(schema_with = "positive")]
    pub strip_height: f64,
    /// Position on the strip at which the block starts.
    #[schemars(schema_with = "positive")]
    pub block_start: f64,
    /// Length of the block.
    #[schemars(schema_with = "positive")]
    pub block_length: f64,
    /// Height of the block.
    #[schemars(schema_with = "positive")]
    pub block_height: f64,
    /// Edges of the strip.
    #[schemars(schema_with = "count")]
    pub strip_edges: usize,
    /// Elements across the strip.
    #[schemars(schema_with = "count")]
    pub strip_rows: usize,
    /// Edges of the block on the strip.
    #[schemars(schema_with = "count")]
    pub block_edges: usize,
    /// Size of the block's elements at the strip.
    #[schemars(schema_with = "positive")]
    pub block_size: f64,
    /// Each size over the one before it.
    #[schemars(schema_with = "positive")]
    pub growth: f64,
    /// Kind of elements.
    pub element: ElementKind,
}

impl Default for DragOutStrip {
    fn default() -> Self {
        Self {
            strip_length: 12.0,
            strip_height: 0.25,
            block_start: 2.0,
            block_length: 10.0,
            block_height: 5.0,
            strip_edges: 96,
            strip_rows: 2,
            block_edges: 80,
            block_size: 0.125,
            growth: 1.2,
            element: ElementKind::Q4,
        }
    }
}

/// A strip under a block, the upper half of both, for frictional drag-out: pulled along +x by `sliding_end`, the block keeps its whole length on
/// it for `block_start` of sliding.
///
/// Parts `strip`, `block`; node sets `sliding_end`, `tail`, `symmetry` (the strip's lower side), `block_left`,
/// `block_right`, `block_top`; edge sets `strip_contact`, `block_contact`, `pressure` (the block's top).
pub fn drag_out_strip(parameters: &DragOutStrip) -> Result<MeshDefinition, SpecimenError> {
    let DragOutStrip { strip_length, strip_height, block_start, block_length, block_height, growth, .. } = *parameters;
    let mut required = Requirements::default();
    required.positive([
        ("strip_length", strip_length),
        ("strip_height", strip_height),
        ("block_length", block_length),
        ("block_height", block_height),
        ("block_size", parameters.block_size),
    ]);
    let end = block_start + block_length;
    required.that(block_start >= 0.0 && block_start.is_finite(), "block_start", block_start, "0 or positive");
    required.that(
        end <= strip_length,
        "block_start + block_length",
        end,
        format!("not more than the strip_length {strip_length}"),
    );
    required.count([
        ("strip_edges", parameters.strip_edges),
        ("strip_rows", parameters.strip_rows),
        ("block_edges", parameters.block_edges),
    ]);
    required.that(growth >= 1.0 && growth.is_finite(), "growth", growth, "at least 1");
    required.check()?;

    let mut mesh = MeshDefinition::default();
    let parts = ["strip", "block"].map(|name| mesh.add_part(body(name)));
    let x = uniform(strip_length, parameters.strip_edges, "strip_edges")?;
    let y = uniform(strip_height, parameters.strip_rows, "strip_rows")?;
    let strip = mesh.block(&MeshBlock::new(parts[0], parameters.element, &x, &y))?;
    let x = uniform(block_length, parameters.block_edges, "block_edges")?;
    let graded = Grading::Capped { first: parameters.block_size, growth, largest: block_height };
    let y = positions(block_height, graded, "block_size")?;
    let map = |[x, y]: [f64; 2]| [block_start + x, strip_height + y];
    let block = mesh.block(&MeshBlock::new(parts[1], parameters.element, &x, &y).mapped(&map))?;
    name_drag_out_sets(&mut mesh, &strip, &block);
    Ok(mesh)
}

fn name_drag_out_sets(mesh: &mut MeshDefinition, strip: &Grid, block: &Grid) {
    for (name, grid, side) in [
        ("sliding_end", strip, Side::Right),
        ("tail", strip, Side::Left),
        ("symmetry", strip, Side::Bottom),
        ("block_left", block, Side::Left),
        ("block_right", block, Side::Right),
        ("block_top", block, Side::Top),
    ] {
        mesh.node_set(name, grid.side_nodes(side));
    }
    mesh.edge_set("strip_contact", strip.side_edges(Side::Top));
    mesh.edge_set("block_contact", block.side_edges(Side::Bottom));
    mesh.edge_set("pressure", block.side_edges(Side::Top));
}
