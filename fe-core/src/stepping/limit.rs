//! Limit points of loads: what a run says where a load cannot grow.

use super::control::StepRun;
use super::newton::Committed;
use crate::assembly::{Location, PointFailure};
use crate::model::{Load, LoadKind, Model};

/// Returns why a run ends where a load that the step moves is at a limit point: no equilibrium is near with more of it, and smaller
/// increments find none.
pub(super) fn at_limit_point(model: &Model, state: &Committed, run: &StepRun) -> Option<PointFailure> {
    let direction = run.direction();
    let Load { name, drive, kind } = model.loads.iter().find(|load| direction[load.drive] != 0.0)?;
    let (freedom, ratio) = run.limit_point()?;
    let (size, unit) = match kind {
        LoadKind::Force { force: [x, y], .. } => (x.hypot(*y), "N"),
        LoadKind::Traction { traction: [x, y], .. } => (x.hypot(*y), "MPa"),
        LoadKind::Pressure { pressure, .. } => (*pressure, "MPa"),
    };
    let reached = state.drives[*drive];
    let (node, along) = (freedom / 2, ["x", "y"][freedom % 2]);
    let reason = format!(
        "limit point: the load '{name}' reaches {:.6} {unit} (drive '{}' at {reached:.6}) and finds no equilibrium beyond it; \
         displacements grow {ratio:.0} times as fast with it as before, fastest those of this node along {along}. To follow the \
         specimen further, drive a displacement instead of the load: a support with \"direction\": \"{along}\" and a \
         \"drive\" at the nodes that move, the load then being its reaction",
        size * reached,
        model.drives[*drive],
    );
    let place = Location::Node { node, position: model.mesh.nodes()[node] };
    Some(PointFailure { place, reason, fraction: None, is_limit_point: true })
}
