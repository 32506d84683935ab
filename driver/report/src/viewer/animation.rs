//! Animates a specimen: the states of a report's viewer as a looping GIF, next to the curve with the current point.

use super::{NO_VALUE, STEPS};
use flate2::read::DeflateDecoder;
use pullout_run::input::{self, Input};
use serde::Deserialize;
use std::io::{self, Read};
use std::path::Path;

mod frames;

/// Makes a looping GIF of a run from its report: `frames` pictures at equal distances of slip. `field`: part of the name of
/// what is shown, else the viewer's first; `view`: least x, greatest x, least y, greatest y, mm, else all.
///
/// # Errors
/// No report of a specimen there; a field that it does not have; no font.
pub fn gif(run: &Path, field: Option<&str>, view: Option<[f64; 4]>, frames: usize) -> io::Result<Vec<u8>> {
    Scenes::read(run, field, view)?.gif(frames)
}

/// The states of a run that its report shows.
struct Scenes {
    head: AnimationHeader,
    /// Of the nodes in the beginning, mm.
    positions: Vec<f32>,
    /// Nodes.
    triangles: Vec<u32>,
    edges: Vec<u32>,
    /// Of each state.
    displacements: Vec<Vec<u16>>,
    /// Place in the beginning, displacement, half of the line.
    cracks: Vec<Vec<[f32; 6]>>,
    values: Vec<Vec<u16>>,
    /// Place of the field of these values in the head.
    field: usize,
    /// Least x, greatest x, least y, greatest y of what is shown, mm.
    view: [f64; 4],
}

/// The data of a report other than its numbers.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct AnimationHeader {
    nodes: usize,
    triangles: usize,
    edges: usize,
    behind: [usize; 2],
    displacement: [f64; 2],
    fields: Vec<Field>,
    parts: Vec<String>,
    frames: Vec<AnimationFrame>,
    curve: [Vec<Option<f64>>; 2],
}

#[derive(Deserialize)]
struct Field {
    name: String,
    unit: String,
    /// Of each part; none where it has no value.
    ranges: Vec<[Option<f64>; 2]>,
}

#[derive(Deserialize)]
struct AnimationFrame {
    slip: f64,
    load: f64,
    contacts: usize,
    /// None in reports of earlier versions.
    #[serde(default)]
    cracks: usize,
    /// Triangles and edges that remain, in the background and in the foreground.
    left: [[usize; 2]; 2],
}

impl Scenes {
    /// Reads the states of a run from its report.
    fn read(run: &Path, field: Option<&str>, view: Option<[f64; 4]>) -> io::Result<Self> {
        let file = run.join("report.html");
        let page = input::read(&file, Input::Result).map_err(crate::at(&file))?;
        let page = String::from_utf8_lossy(&page);
        let without = || crate::malformed(&file, "has no states: is it the report of a specimen?");
        let head = script(&page, r#"<script class="head" type="application/json">"#).ok_or_else(without)?;
        let packed = script(&page, r#"<script class="data" type="text/plain">"#).ok_or_else(without)?;
        let wrong = |error: &dyn std::fmt::Display| crate::malformed(&file, error);
        let head: AnimationHeader = serde_json::from_str(head).map_err(|error| wrong(&error))?;
        let packed = base64::Engine::decode(&base64::engine::general_purpose::STANDARD, packed.trim());
        let mut data = Vec::new();
        DeflateDecoder::new(&*packed.map_err(|error| wrong(&error))?).read_to_end(&mut data)?;
        let names = || head.fields.iter().map(|field| field.name.as_str()).collect::<Vec<_>>().join("; ");
        let field = match field {
            None => 0,
            Some(part) => {
                let found = head.fields.iter().position(|field| field.name.contains(part));
                found.ok_or_else(|| wrong(&format!("no field `{part}`; there are: {}", names())))?
            }
        };
        Self::decode(head, &data, field, view).ok_or_else(|| wrong(&"its states are cut off"))
    }

    fn decode(head: AnimationHeader, data: &[u8], field: usize, view: Option<[f64; 4]>) -> Option<Self> {
        let mut rest = data;
        let mut take = |count: usize, size: usize| {
            let (front, behind) = rest.split_at_checked(count.checked_mul(size)?)?;
            rest = behind;
            Some(front)
        };
        let floats = |bytes: &[u8]| -> Vec<f32> {
            bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
        };
        let words = |bytes: &[u8]| bytes.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
        let halves = |bytes: &[u8]| bytes.as_chunks::<2>().0.iter().map(|bytes| u16::from_le_bytes(*bytes)).collect();
        let positions = floats(take(2 * head.nodes, 4)?);
        let triangles: Vec<u32> = words(take(3 * head.triangles, 4)?);
        let edges: Vec<u32> = words(take(2 * head.edges, 4)?);
        take(head.frames.iter().map(|frame| 6 * frame.contacts).sum(), 4)?;
        let mut cracks: Vec<Vec<[f32; 6]>> = Vec::new();
        for frame in &head.frames {
            let values = floats(take(frame.cracks.checked_mul(6)?, 4)?);
            cracks.push(values.as_chunks::<6>().0.to_vec());
        }
        // the part of each node
        take(head.nodes, 2)?;
        let states = head.frames.len();
        let mut series = |width: usize| {
            let mut all: Vec<Vec<u16>> = Vec::new();
            for k in 0..states {
                let mut state: Vec<u16> = halves(take(width, 2)?);
                let before = k.checked_sub(1).map(|before| &all[before]);
                state
                    .iter_mut()
                    .zip(before.into_iter().flatten())
                    .for_each(|(value, b)| *value = value.wrapping_add(*b));
                all.push(state);
            }
            Some(all)
        };
        let displacements = series(2 * head.nodes)?;
        let mut values = Vec::new();
        for _ in 0..=field {
            values = series(head.nodes)?;
        }
        let is_sound = |nodes: &[u32]| nodes.iter().all(|&node| (node as usize) < head.nodes);
        if states == 0 || !is_sound(&triangles) || !is_sound(&edges) {
            return None;
        }
        let mut scenes =
            Self { head, positions, triangles, edges, displacements, cracks, values, field, view: [0.0; 4] };
        scenes.view = view.unwrap_or_else(|| scenes.extent());
        Some(scenes)
    }

    /// Returns the number between the ends of a range that one of its steps encodes.
    fn between([low, high]: [f64; 2], step: f64) -> f64 {
        low + (high - low) * step / STEPS
    }

    /// Returns the box around all nodes in the first and the last state, with a margin.
    fn extent(&self) -> [f64; 4] {
        let mut extent = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        let last = &self.displacements[self.displacements.len() - 1];
        for (k, (&start, &moved)) in self.positions.iter().zip(last).enumerate() {
            let start = f64::from(start);
            for value in [start, start + Self::between(self.head.displacement, f64::from(moved))] {
                let ends = &mut extent[2 * (k % 2)..][..2];
                (ends[0], ends[1]) = (ends[0].min(value), ends[1].max(value));
            }
        }
        let [left, right, low, high] = extent;
        let around = 0.02 * (right - left).max(high - low);
        [left - around, right + around, low - around, high + around]
    }

    /// States at equal distances of slip, as they were or between two of them: the earlier state and the share of the next.
    fn moments(&self, count: usize) -> Vec<(usize, f64)> {
        let mut way = vec![0.0];
        for pair in self.head.frames.windows(2) {
            way.push(way[way.len() - 1] + (pair[1].slip - pair[0].slip).abs());
        }
        let last = way.len() - 1;
        let whole = way[last];
        let steps = count.max(2) - 1;
        let at = |k: usize| {
            let share = k as f64 / steps as f64;
            if whole == 0.0 {
                // driven by a load alone
                let place = share * last as f64;
                return (place.floor() as usize, place.fract());
            }
            let target = share * whole;
            let before = way.partition_point(|&way| way <= target).saturating_sub(1).min(last);
            let width = way.get(before + 1).map_or(0.0, |next| next - way[before]);
            (before, if width > 0.0 { ((target - way[before]) / width).clamp(0.0, 1.0) } else { 0.0 })
        };
        (0..=steps).map(at).collect()
    }

    /// Slip and load of a moment.
    fn place(&self, (before, share): (usize, f64)) -> [f64; 2] {
        let frames = &self.head.frames;
        let (from, to) = (&frames[before], &frames[(before + 1).min(frames.len() - 1)]);
        let blend = |from: f64, to: f64| from + share * (to - from);
        [blend(from.slip, to.slip), blend(from.load, to.load)]
    }

    /// Where a node is at a moment.
    fn position(&self, node: usize, (before, share): (usize, f64)) -> [f64; 2] {
        let next = (before + 1).min(self.displacements.len() - 1);
        [2 * node, 2 * node + 1].map(|k| {
            let [from, to] = [before, next].map(|state| f64::from(self.displacements[state][k]));
            f64::from(self.positions[k]) + Self::between(self.head.displacement, from + share * (to - from))
        })
    }

    /// The share of its part's range that a node has at a moment; none without a value.
    fn share(&self, node: usize, (before, share): (usize, f64)) -> Option<f64> {
        let next = (before + 1).min(self.values.len() - 1);
        let [from, to] = [before, next].map(|state| self.values[state][node]);
        let known = |value: u16| (value != NO_VALUE).then_some(f64::from(value) / STEPS);
        match (known(from), known(to)) {
            (Some(from), Some(to)) => Some(from + share * (to - from)),
            (from, to) => from.or(to),
        }
    }
}

/// Returns the text of a script of a page.
fn script<'a>(page: &'a str, tag: &str) -> Option<&'a str> {
    page.split_once(tag)?.1.split_once("</script>").map(|(text, _)| text)
}

#[cfg(test)]
mod test;
