//! The viewer of `report.html`: a specimen's deformed mesh with its fields over the run, drawn by the browser.
//!
//! States are kept as the run goes on, evenly over its increments, and those of the first crack, the first yield, the greatest
//! load and both ends in any case. Displacements and fields are given in 65535 steps of their ranges, fields part by part, each
//! state by its difference to the one before, deflated. A crack is a line through an integration point that has torn.

use crate::history::History;
use crate::pictures::{ALONG_HOLE, is_total, walls};
use crate::plots::field::{ALONG_SURFACE, band_color_text};
use crate::plots::quantity::group_of;
use fe_core::mesh::Mesh;
use fe_core::model::Model;
use fe_core::output::{Activity, Fields, FieldsError, Principal, Recovery};
use fe_core::stepping::Snapshot;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use maud::{Markup, PreEscaped, html};
use pullout_run::columns::Group;
use pullout_run::pullout::{self, PulloutProgram};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::iter::once;

#[cfg(feature = "pictures")]
mod animation;
#[cfg(feature = "pictures")]
pub use animation::gif;

/// Refuses to make a GIF.
///
/// # Errors
/// Always: this build lacks the feature `pictures`.
#[cfg(not(feature = "pictures"))]
pub fn gif(
    _run: &std::path::Path,
    _field: Option<&str>,
    _view: Option<[f64; 4]>,
    _frames: usize,
) -> io::Result<Vec<u8>> {
    Err(crate::plots::export::missing())
}

const SCRIPT: &str = include_str!("viewer.js");

/// States that are kept at most: with one more, every second one goes.
const MOST_STATES: usize = 24;
/// Numbers that they hold at most, all together; four states are kept in any case.
const MOST_NUMBERS: usize = 6_000_000;
const FEWEST_STATES: usize = 4;
/// Points of the curve.
const MOST_POINTS: usize = 600;
/// Colours between which the browser goes on linearly.
const COLORS: usize = 16;
/// Steps of a range; one more means no value.
const STEPS: f64 = 65534.0;
const NO_VALUE: u16 = u16::MAX;

/// Fields at integration points: greatest and least principal stress, MPa, and the damage, NaN where there is none.
const VALUES: usize = 3;
/// Fields at nodes: these, and the scalar field.
const SHOWN: usize = VALUES + 1;

/// A point with this damage, or this phase field, has torn: where its strain opens it, it is shown as a crack.
const TORN: f64 = 0.9;

/// States of a specimen over a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ViewerStates {
    kept: Vec<ViewerState>,
    /// Every so many increments one is kept, the binary logarithm.
    doublings: u32,
    seen: u64,
    /// The first increments in which any point cracked, and yielded: they stay.
    firsts: [Option<u64>; 2],
}

/// Names of [`ViewerStates::firsts`].
const FIRSTS: [&str; 2] = ["first crack", "first yield"];

#[derive(Clone, Debug, Serialize, Deserialize)]
struct ViewerState {
    increment: u64,
    /// Total time, s.
    time: f64,
    slip: f64,
    load: f64,
    displacements: Vec<f32>,
    fields: Vec<[f32; VALUES]>,
    spalled: Vec<u32>,
    /// Pair, place, arc length, pressure, bond.
    contact: Vec<[f32; 6]>,
    /// Place in the beginning, displacement, half of the line: x and y of each.
    #[serde(default)]
    cracks: Vec<[f32; 6]>,
    /// The scalar field at the nodes; empty without one.
    #[serde(default)]
    scalar: Vec<f32>,
}

impl ViewerStates {
    /// Takes the state after an increment, if it is its turn, the last, or the first with a crack or yield.
    pub fn observe(&mut self, slip: f64, load: f64, snapshot: &Snapshot<'_>, is_last: bool) {
        let increment = self.seen - u64::from(is_last).min(self.seen);
        self.seen += u64::from(!is_last);
        if self.firsts.contains(&None) {
            let counts = snapshot.solids().counts();
            for (first, count) in self.firsts.iter_mut().zip([counts.damaged, counts.plastic]) {
                *first = first.or((count > 0).then_some(increment));
            }
        }
        let is_kept = self.kept.last().is_some_and(|state| state.increment == increment);
        if is_kept || !(is_last || self.stays(increment)) {
            return;
        }
        let state = ViewerState::of(increment, [slip, load], snapshot.model(), &Fields::of(snapshot));
        let size = VALUES * state.fields.len() + state.displacements.len();
        self.kept.push(state);
        let most = (MOST_NUMBERS / size.max(1)).clamp(FEWEST_STATES, MOST_STATES);
        if self.kept.len() > most && !is_last {
            self.doublings += 1;
            let kept = std::mem::take(&mut self.kept);
            self.kept = kept.into_iter().filter(|state| self.stays(state.increment)).collect();
        }
    }

    /// Returns whether an increment is among those that are kept.
    fn stays(&self, increment: u64) -> bool {
        increment.is_multiple_of(1 << self.doublings) || self.firsts.contains(&Some(increment))
    }

    /// The viewer's part of the page; `peak`: the state at the greatest load, unless that is the last.
    ///
    /// # Errors
    /// States of another mesh.
    pub fn page(
        &self,
        program: &PulloutProgram,
        history: &History,
        peak: Option<&pullout::SavedState>,
    ) -> io::Result<Option<Markup>> {
        if self.kept.is_empty() {
            return Ok(None);
        }
        let peak = peak.map(|peak| {
            let before = self.kept.partition_point(|state| state.time < peak.fields.time);
            // its time distinguishes it from others; a state that was kept anyway comes once
            let is_kept = self.kept.get(before).is_some_and(|state| state.time == peak.fields.time);
            let state = || ViewerState::of(0, [peak.slip, peak.load], &program.model, &peak.fields);
            (before, (!is_kept).then(state))
        });
        let mut states: Vec<&ViewerState> = self.kept.iter().collect();
        if let Some((place, Some(state))) = &peak {
            states.insert(*place, state);
        }
        let curve = ["slip", "load"].map(|name| history.column(name).unwrap_or_default().to_vec());
        let (head, data) = self.encode(&states, program, curve).map_err(io::Error::other)?;
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&data)?;
        let packed = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, encoder.finish()?);
        let has_contact = !program.model.contacts.is_empty();
        // no `</script>` can end the scripts: names are letters, figures and signs of JSON
        let head = head.to_string().replace('<', "\\u003c");
        Ok(Some(html! {
            div #viewer {
                p.none hidden { "This browser has no WebGL 2, which the viewer needs; the pictures below show the peak and the end." }
                div.stage hidden {
                    div.controls {
                        select.field aria-label="field" {}
                        label { "colours " select.parts {} }
                        span.chosen hidden {
                            input.low type="number" step="any" aria-label="least value of the colours"; " to "
                            input.high type="number" step="any" aria-label="greatest value of the colours";
                        }
                        label { "displacements × "
                            select.magnification { @for factor in [1, 2, 5, 10, 50, 200] { option value=(factor) { (factor) } } } }
                        label { input.edges type="checkbox" checked; " elements" }
                        @if states.iter().any(|state| !state.cracks.is_empty()) {
                            label { input.lines type="checkbox" checked; " open cracks" }
                        }
                        button.play type="button" { "play" }
                        span.marks role="group" aria-label="states with a name" {}
                        input.state type="range" min="0" aria-label="state of the run";
                        span.readout {}
                    }
                    canvas.mesh tabindex="0" role="img" aria-label="deformed mesh with the chosen field" aria-describedby="viewer-hint" {}
                    div.key {
                        span.least {} span.bar style=(format!("background: linear-gradient(to right, {})", colors().join(", "))) {}
                        span.most {} span.here {}
                        span role="group" aria-label="zoom" {
                            button.closer type="button" aria-label="zoom in" { "+" } " "
                            button.further type="button" aria-label="zoom out" { "−" } " "
                            button.all type="button" { "all" } " "
                            button.picture type="button" { "PNG" }
                        }
                    }
                    div.plots {
                        canvas.curve tabindex="0" role="img" aria-label="load over slip; the arrow keys go to the next state" {}
                        @if has_contact { canvas.contact role="img" aria-label="pressure and bond along the contact pairs" {} }
                    }
                    p.hint #viewer-hint {
                        "Drag to pan, pinch or Ctrl + wheel to zoom, double-click to reset; on the keyboard arrows, + − and 0. "
                        "A click on the curve goes to the nearest state."
                    }
                }
                script.head type="application/json" { (PreEscaped(head)) }
                script.data type="text/plain" { (packed) }
                script { (PreEscaped(SCRIPT)) }
            }
        }))
    }

    /// Returns the input of the script: the header, and the numbers of all kinds one after the other.
    fn encode(
        &self,
        states: &[&ViewerState],
        program: &PulloutProgram,
        curve: [Vec<f64>; 2],
    ) -> Result<(Value, Vec<u8>), FieldsError> {
        let model = &program.model;
        let mesh = &model.mesh;
        let recovery = Recovery::new(mesh);
        let nodes = recovery.nodes();
        let mut data = Vec::new();
        nodes.iter().flat_map(|&node| mesh.nodes()[node]).for_each(|value| push(&mut data, value as f32));
        let [triangles, edges] = shapes(states, mesh, &recovery, &model.parts_behind());
        triangles.items.iter().chain(&edges.items).for_each(|item| {
            item.nodes.iter().for_each(|node| data.extend_from_slice(&node.to_le_bytes()));
        });
        // along a fibre the walls of the hole have a common coordinate, and a bond that resists the pull is positive
        let (_, walls) = walls(model);
        for &[pair, x, y, arc, pressure, bond] in states.iter().flat_map(|state| &state.contact) {
            let wall = walls.get(pair as usize).and_then(Option::as_ref);
            let [arc, bond] = wall
                .map_or([arc, bond], |wall| [wall.along_fibre(f64::from(arc)) as f32, wall.direction as f32 * bond]);
            [pair, x, y, arc, pressure, bond].into_iter().for_each(|value| push(&mut data, value));
        }
        states.iter().flat_map(|state| &state.cracks).flatten().for_each(|&value| push(&mut data, value));
        recovery.parts().iter().for_each(|&part| data.extend_from_slice(&(part as u16).to_le_bytes()));
        let displacement = range(states.iter().flat_map(|state| &state.displacements).copied());
        let moved = |state: &&ViewerState| -> Vec<u16> {
            let at = |&node: &usize| [state.displacements[2 * node], state.displacements[2 * node + 1]];
            nodes.iter().flat_map(at).map(|value| step(value, displacement)).collect()
        };
        push_series(&mut data, states.iter().map(moved));
        let recovered: Vec<Vec<[f64; SHOWN]>> =
            states.iter().map(|state| state.at_nodes(mesh, &recovery)).collect::<Result<_, _>>()?;
        let scalar = model.field.as_ref().map_or_else(String::new, |field| field.name().replace('_', " "));
        let quantities = [
            ("principal stress, greatest", "MPa"),
            ("principal stress, least", "MPa"),
            ("damage", ""),
            (scalar.as_str(), ""),
        ];
        let mut fields = Vec::new();
        for (k, (name, unit)) in quantities.into_iter().enumerate() {
            // each part has a range of its own: steel is stressed so much more than concrete
            let own = |part: usize| {
                let of_state = |state: &Vec<[f64; SHOWN]>| {
                    let values = recovery.parts().iter().zip(state).filter(|(owner, _)| **owner == part);
                    range(values.map(|(_, values)| values[k] as f32))
                };
                range(recovered.iter().flat_map(of_state))
            };
            let ranges: Vec<[f32; 2]> = (0..mesh.parts().len()).map(own).collect();
            if ranges.iter().any(|[low, _]| low.is_finite()) {
                let shares = |state: &Vec<[f64; SHOWN]>| {
                    let values = recovery.parts().iter().zip(state);
                    values.map(|(&part, values)| step(values[k] as f32, ranges[part])).collect()
                };
                push_series(&mut data, recovered.iter().map(shares));
                fields.push(json!({ "name": name, "unit": unit, "ranges": ranges }));
            }
        }
        let (names, opens_at) = self.names(states);
        let frames = states.iter().zip(&names).enumerate().map(|(k, (state, names))| {
            let left = [&triangles, &edges].map(|shapes| shapes.left(k));
            let names = names.join(", ");
            let (contacts, cracks) = (state.contact.len(), state.cracks.len());
            json!({ "slip": state.slip, "load": state.load, "name": names, "contacts": contacts, "cracks": cracks, "left": left })
        });
        let head = json!({
            "nodes": nodes.len(),
            "triangles": triangles.items.len(),
            "edges": edges.items.len(),
            "behind": [triangles.behind(), edges.behind()],
            "displacement": displacement,
            "fields": fields,
            "parts": mesh.parts().iter().map(|part| &part.name).collect::<Vec<_>>(),
            "frames": frames.collect::<Vec<_>>(),
            "opensAt": opens_at,
            "pairs": model.contacts.iter().map(|pair| &pair.name).collect::<Vec<_>>(),
            "along": if walls.iter().any(Option::is_some) { ALONG_HOLE } else { ALONG_SURFACE },
            "curve": thinned(curve),
            "colors": colors(),
        });
        Ok((head, data))
    }

    /// Returns the names of the states, and the index of the first one shown: the state of the largest load, or the last one if there
    /// is no load.
    fn names(&self, states: &[&ViewerState]) -> (Vec<Vec<&'static str>>, usize) {
        let last = states.len().saturating_sub(1);
        let loaded = (0..states.len()).filter(|&k| states[k].load.abs() > 0.0);
        let peak = loaded.reduce(|best, k| if states[k].load.abs() > states[best].load.abs() { k } else { best });
        let first =
            |first: Option<u64>| first.and_then(|first| states.iter().position(|state| state.increment == first));
        let firsts = FIRSTS.into_iter().zip(self.firsts.map(first));
        let marks = once(("start", Some(0))).chain(firsts).chain([("peak", peak), ("end", Some(last))]);
        let mut names = vec![Vec::new(); states.len()];
        for (name, place) in marks {
            names.get_mut(place.unwrap_or(usize::MAX)).into_iter().for_each(|names| names.push(name));
        }
        (names, peak.unwrap_or(last))
    }
}

/// Triangles and edges of the elements.
fn shapes(states: &[&ViewerState], mesh: &Mesh, recovery: &Recovery, behind: &[usize]) -> [Shapes; 2] {
    let mut gone = vec![states.len(); mesh.elements().len()];
    for (k, state) in states.iter().enumerate() {
        for &element in &state.spalled {
            let first = &mut gone[element as usize];
            *first = k.min(*first);
        }
    }
    let mut triangles = Shapes::default();
    let mut edges: BTreeMap<(bool, [u32; 2]), usize> = BTreeMap::new();
    for (index, element) in mesh.elements().iter().enumerate() {
        let kind = element.kind();
        let is_behind = behind.contains(&element.part());
        let nodes: Vec<u32> = recovery.of_element(index).iter().map(|&place| place as u32).collect();
        let mut outline = Vec::new();
        for edge in 0..kind.corner_count() {
            let ([start, _, middle], count) = kind.edge_nodes(edge);
            outline.push(nodes[start]);
            outline.extend((count == 3).then(|| nodes[middle]));
        }
        let next = outline.iter().cycle().skip(1);
        for (&a, &b) in outline.iter().zip(next) {
            let last = edges.entry((is_behind, [a.min(b), a.max(b)])).or_default();
            *last = gone[index].max(*last);
        }
        // corners are cut off, what is left is a triangle or a quadrangle; all of them are convex
        let inner: Vec<u32> = if outline.len() == kind.corner_count() {
            outline
        } else {
            let count = outline.len();
            let corner = |k: usize| vec![outline[(k + count - 1) % count], outline[k], outline[k + 1]];
            (0..count).step_by(2).for_each(|k| triangles.push(corner(k), is_behind, gone[index]));
            outline.iter().copied().skip(1).step_by(2).collect()
        };
        for k in 1..inner.len() - 1 {
            triangles.push(vec![inner[0], inner[k], inner[k + 1]], is_behind, gone[index]);
        }
    }
    let mut lines = Shapes::default();
    edges.into_iter().for_each(|((is_behind, nodes), gone)| lines.push(nodes.to_vec(), is_behind, gone));
    [triangles, lines].map(Shapes::ordered)
}

impl ViewerState {
    fn of(increment: u64, [slip, load]: [f64; 2], model: &Model, fields: &Fields) -> Self {
        let mesh = &model.mesh;
        let damage: Vec<Option<usize>> = fields.state_names.iter().map(|names| damage_of(names)).collect();
        let is_phase_field = model.field.as_ref().is_some_and(|field| field.is_phase_field());
        let phase_field = fields.scalar.as_ref().filter(|_| is_phase_field).map(|(_, values)| values);
        let (mut values, mut cracks) = (Vec::with_capacity(fields.stresses.len()), Vec::new());
        let (mut points, mut states) = (fields.stresses.iter().zip(&fields.strains), fields.states.as_slice());
        for (index, element) in mesh.elements().iter().enumerate() {
            let count = fields.state_names[element.part()].len();
            let is_spalled = fields.activities[index] == Activity::Spalled;
            let of_element = mesh.integration_points(index);
            // half of a square with a point's area
            let reach = 0.5 * (mesh.element_area(index) / of_element.len() as f64).sqrt();
            for (point, (&stress, &[e11, e22, _, g12])) in of_element.iter().zip(points.by_ref()) {
                let (own, others) = states.split_at(count);
                let damage = damage[element.part()].map_or(f64::NAN, |place| own[place]);
                let principal = Principal::new(stress);
                values.push([principal.maximum as f32, principal.minimum as f32, damage as f32]);
                states = others;
                let shape = element.kind().shape_functions(point.coordinates);
                let at = |of: &dyn Fn(usize) -> f64| -> f64 {
                    element.nodes().iter().zip(shape.values()).map(|(&node, share)| share * of(node)).sum()
                };
                let torn = phase_field.map_or(damage, |values| at(&|node| values[node]));
                let strain = Principal::new([e11, e22, 0.0, 0.5 * g12]);
                if torn >= TORN && strain.in_plane[0] > 0.0 && !is_spalled {
                    let [x, y] = [0, 1].map(|k| at(&|node| mesh.nodes()[node][k]));
                    let [u, v] = [0, 1].map(|k| at(&|node| fields.displacements[2 * node + k]));
                    let (sine, cosine) = strain.angle.sin_cos();
                    cracks.push([x, y, u, v, -reach * sine, reach * cosine].map(|value| value as f32));
                }
            }
        }
        let contact = fields.contact.iter().filter(|point| point.weight > 0.0).map(|point| {
            let [x, y] = point.position;
            [point.pair as f64, x, y, point.arc, point.pressure, point.shear_traction].map(|value| value as f32)
        });
        let elements = 0_u32..;
        let spalled = elements.zip(&fields.activities).filter(|(_, activity)| **activity == Activity::Spalled);
        Self {
            increment,
            time: fields.time,
            slip,
            load,
            displacements: fields.displacements.iter().map(|&value| value as f32).collect(),
            fields: values,
            spalled: spalled.map(|(element, _)| element).collect(),
            contact: contact.collect(),
            cracks,
            scalar: fields.scalar.iter().flat_map(|(_, values)| values).map(|&value| value as f32).collect(),
        }
    }

    /// The fields at the places of the recovery; damages do not leave the range that they have at the points.
    fn at_nodes(&self, mesh: &Mesh, recovery: &Recovery) -> Result<Vec<[f64; SHOWN]>, FieldsError> {
        let values: Vec<[f64; VALUES]> = self.fields.iter().map(|values| values.map(f64::from)).collect();
        let damages: Vec<f64> = values.iter().map(|[.., damage]| *damage).collect();
        let mut nodal = recovery.recover(&values)?;
        let limited = recovery.recover_limited(mesh, &damages)?;
        nodal.iter_mut().zip(limited).for_each(|([.., damage], value)| *damage = value);
        let scalar = |node: usize| self.scalar.get(node).map_or(f64::NAN, |&value| f64::from(value));
        let with_scalar =
            |([greatest, least, damage], &node): ([f64; VALUES], &usize)| [greatest, least, damage, scalar(node)];
        Ok(nodal.into_iter().zip(recovery.nodes()).map(with_scalar).collect())
    }
}

/// The damage among states and derived outputs: the total one, or else the first.
fn damage_of(names: &[String]) -> Option<usize> {
    let total = names.iter().position(|name| is_total(name));
    total.or_else(|| names.iter().position(|name| group_of(name) == Group::Damage))
}

/// Triangles or edges.
#[derive(Default)]
struct Shapes {
    items: Vec<ElementShape>,
}

struct ElementShape {
    nodes: Vec<u32>,
    is_behind: bool,
    /// The first state without it.
    gone: usize,
}

impl Shapes {
    fn push(&mut self, nodes: Vec<u32>, is_behind: bool, gone: usize) {
        self.items.push(ElementShape { nodes, is_behind, gone });
    }

    /// Returns the background first, and in both layers the elements that remain longest, so that those remaining in a state are
    /// always the beginning of a layer.
    fn ordered(mut self) -> Self {
        self.items.sort_by_key(|shape| (!shape.is_behind, std::cmp::Reverse(shape.gone)));
        self
    }

    fn behind(&self) -> usize {
        self.items.iter().filter(|shape| shape.is_behind).count()
    }

    /// Returns how many remain in a state, in the background and in the foreground.
    fn left(&self, state: usize) -> [usize; 2] {
        [true, false]
            .map(|layer| self.items.iter().filter(|shape| shape.is_behind == layer && shape.gone > state).count())
    }
}

fn push(data: &mut Vec<u8>, value: f32) {
    data.extend_from_slice(&value.to_le_bytes());
}

/// Writes states, each but the first as the difference to the one before.
fn push_series(data: &mut Vec<u8>, states: impl Iterator<Item = Vec<u16>>) {
    let mut before: Vec<u16> = Vec::new();
    for state in states {
        for (k, value) in state.iter().enumerate() {
            let difference = value.wrapping_sub(before.get(k).copied().unwrap_or(0));
            data.extend_from_slice(&difference.to_le_bytes());
        }
        before = state;
    }
}

/// Least and greatest of the numbers; both infinite if there are none.
fn range(values: impl Iterator<Item = f32>) -> [f32; 2] {
    values
        .filter(|value| value.is_finite())
        .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

fn step(value: f32, [low, high]: [f32; 2]) -> u16 {
    if !value.is_finite() {
        return NO_VALUE;
    }
    let width = f64::from(high) - f64::from(low);
    let share = if width > 0.0 { (f64::from(value) - f64::from(low)) / width } else { 0.5 };
    (share.clamp(0.0, 1.0) * STEPS).round() as u16
}

/// The curve by every n-th point, and the last.
fn thinned(curve: [Vec<f64>; 2]) -> [Vec<f64>; 2] {
    let stride = curve[0].len().div_ceil(MOST_POINTS).max(1);
    curve.map(|values| {
        let last = values.len().saturating_sub(1);
        let is_kept = |k: usize| k.is_multiple_of(stride) || k == last;
        values.iter().enumerate().filter(|(k, _)| is_kept(*k)).map(|(_, value)| *value).collect()
    })
}

fn colors() -> Vec<String> {
    (0..COLORS).map(|k| band_color_text(k, COLORS)).collect()
}

#[cfg(test)]
mod test;
