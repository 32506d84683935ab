//! A fibre that lies on a curved channel.

use super::requirement::Requirements;
use super::{SpecimenError, body, uniform};
use crate::element::ElementKind;
use crate::mesh::MeshDefinition;
use crate::mesh::structured::{MeshBlock, Side};
use crate::schema::{count, positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A fibre on a curved channel, straight before and after it: a capstan.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CurvedChannel {
    /// Radius of the channel.
    #[schemars(schema_with = "positive")]
    pub radius: f64,
    /// Angle of the arc, degrees.
    #[schemars(schema_with = "positive")]
    pub angle_deg: f64,
    /// Height of the fibre.
    #[schemars(schema_with = "positive")]
    pub fibre_height: f64,
    /// Length of the fibre before and after the arc.
    #[schemars(schema_with = "positive")]
    pub free_length: f64,
    /// Depth of the channel's body.
    #[schemars(schema_with = "positive")]
    pub depth: f64,
    /// Edges around the arc.
    #[schemars(schema_with = "count")]
    pub edges: usize,
    /// Edges along each free length.
    #[schemars(schema_with = "count")]
    pub free_edges: usize,
    /// Elements across the fibre.
    #[schemars(schema_with = "count")]
    pub rows: usize,
    /// Kind of elements.
    pub element: ElementKind,
}

impl Default for CurvedChannel {
    fn default() -> Self {
        Self {
            radius: 10.0,
            angle_deg: 90.0,
            fibre_height: 0.2,
            free_length: 1.0,
            depth: 0.5,
            edges: 40,
            free_edges: 3,
            rows: 1,
            element: ElementKind::Q8,
        }
    }
}

/// A channel about the origin between the angles 0 and `angle_deg` from the x axis, and a fibre on it without stress. The fibre
/// is pulled downwards where it leaves the arc at angle 0.
///
/// Parts `fibre`, `channel`; node sets `grip`, `tail` (the fibre's ends); edge sets `fibre_contact`, `channel_contact`,
/// `tail`.
pub fn curved_channel(parameters: &CurvedChannel) -> Result<MeshDefinition, SpecimenError> {
    let CurvedChannel { radius, angle_deg, fibre_height, free_length, depth, edges, free_edges, rows, element } =
        *parameters;
    let mut required = Requirements::default();
    required.positive([
        ("radius", radius),
        ("angle_deg", angle_deg),
        ("fibre_height", fibre_height),
        ("free_length", free_length),
    ]);
    required.that(angle_deg <= 180.0, "angle_deg", angle_deg, "at most a half turn");
    required.that(depth > 0.0 && depth < radius, "depth", depth, format!("positive and less than the radius {radius}"));
    required.count([("edges", edges), ("free_edges", free_edges), ("rows", rows)]);
    required.check()?;

    let angle = angle_deg.to_radians();
    let arc = radius * angle;
    let around = uniform(arc, edges, "edges around the arc")?;
    let free = uniform(free_length, free_edges, "edges along the free length")?;
    let along: Vec<f64> = (free.iter().map(|s| s - free_length))
        .chain(around[1..].iter().copied())
        .chain(free[1..].iter().map(|s| arc + s))
        .collect();
    let across = uniform(fibre_height, rows, "rows of the fibre")?;
    let below = uniform(depth, 1, "depth of the channel")?;
    // s runs clockwise, from `angle` to 0, and straight on at both ends
    let map = |[s, height]: [f64; 2]| {
        let on_arc = s.clamp(0.0, arc);
        let (sine, cosine) = (angle - on_arc / radius).sin_cos();
        let (distance, beyond) = (radius + height, s - on_arc);
        [distance * cosine + beyond * sine, distance * sine - beyond * cosine]
    };
    let under = |[s, height]: [f64; 2]| map([s, height - depth]);

    let mut mesh = MeshDefinition::default();
    let parts = ["fibre", "channel"].map(|name| mesh.add_part(body(name)));
    let fibre = mesh.block(&MeshBlock::new(parts[0], element, &along, &across).mapped(&map))?;
    let channel = mesh.block(&MeshBlock::new(parts[1], element, &around, &below).mapped(&under))?;
    mesh.node_set("grip", fibre.side_nodes(Side::Right));
    mesh.node_set("tail", fibre.side_nodes(Side::Left));
    mesh.edge_set("tail", fibre.side_edges(Side::Left));
    mesh.edge_set("fibre_contact", fibre.side_edges(Side::Bottom));
    mesh.edge_set("channel_contact", channel.side_edges(Side::Top));
    Ok(mesh)
}
