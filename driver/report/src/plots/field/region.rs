//! Unions of polygons on the picture's grid, as paths.

use std::collections::HashMap;
use std::fmt::Write as _;

/// Point of the picture's grid, drawing units.
pub(super) type GridPoint = (i32, i32);

/// Greatest distance of a simplified outline from the exact one, drawing units: 1/20 px.
const TOLERANCE: f64 = 1.0;
/// Twice the area below which a piece cannot be seen, square drawing units: ⅛ px².
const INVISIBLE: i64 = 100;

/// A union of polygons that do not overlap and all go round the same way.
#[derive(Debug, Default)]
pub(super) struct Region {
    /// Directed edges of polygons that no neighbour has the other way round, with their number.
    edges: HashMap<(GridPoint, GridPoint), u32>,
}

impl Region {
    /// Adds a polygon; what it shares with a neighbour is no longer outline.
    pub fn add(&mut self, polygon: &[GridPoint]) {
        let next = polygon.iter().cycle().skip(1);
        for (&start, &end) in polygon.iter().zip(next).filter(|(start, end)| start != end) {
            match self.edges.get_mut(&(end, start)) {
                Some(count) if *count > 1 => *count -= 1,
                Some(_) => {
                    self.edges.remove(&(end, start));
                }
                None => *self.edges.entry((start, end)).or_default() += 1,
            }
        }
    }

    /// Returns the outlines and holes, simplified; empty where nothing can be seen.
    pub fn path(self) -> String {
        let mut path = String::new();
        for outline in self.loops() {
            let outline = simplified(&outline);
            if outline.len() > 2 && doubled_area(&outline).abs() > INVISIBLE {
                push_loop(&mut path, &outline);
            }
        }
        path
    }

    /// Joins edges to loops. As many edges end at a place as start there, so a walk can only end where it began.
    fn loops(self) -> Vec<Vec<GridPoint>> {
        let mut edges: Vec<(GridPoint, GridPoint)> =
            self.edges.into_iter().flat_map(|(edge, count)| std::iter::repeat_n(edge, count as usize)).collect();
        edges.sort_unstable();
        let mut used = vec![false; edges.len()];
        let mut loops = Vec::new();
        for first in 0..edges.len() {
            let mut outline = Vec::new();
            let mut next = (!used[first]).then_some(first);
            while let Some(edge) = next {
                used[edge] = true;
                let (start, end) = edges[edge];
                outline.push(start);
                let from = edges.partition_point(|other| other.0 < end);
                next = (from..edges.len()).take_while(|&other| edges[other].0 == end).find(|&other| !used[other]);
            }
            if !outline.is_empty() {
                loops.push(outline);
            }
        }
        loops
    }
}

/// Appends a move and relative lines, as short as the format allows.
fn push_loop(path: &mut String, outline: &[GridPoint]) {
    let (mut x, mut y) = outline[0];
    // writing to a String cannot fail
    let _ = write!(path, "M{x} {y}l");
    for (k, place) in outline[1..].iter().enumerate() {
        let space = if k == 0 || place.0 < x { "" } else { " " };
        let _ = write!(path, "{space}{}{}", place.0.wrapping_sub(x), after(place.1.wrapping_sub(y)));
        (x, y) = *place;
    }
    path.push('z');
}

/// A number after another one: a minus sign needs no space.
pub(super) fn after(number: i32) -> String {
    if number < 0 { number.to_string() } else { format!(" {number}") }
}

fn doubled_area(outline: &[GridPoint]) -> i64 {
    let next = outline.iter().cycle().skip(1);
    outline.iter().zip(next).map(|(a, b)| i64::from(a.0) * i64::from(b.1) - i64::from(b.0) * i64::from(a.1)).sum()
}

/// Drops places that lie on the way (Douglas & Peucker 1973), on a closed outline cut at two places far apart.
fn simplified(outline: &[GridPoint]) -> Vec<GridPoint> {
    let distance = |place: &GridPoint| {
        let (dx, dy) = (f64::from(place.0) - f64::from(outline[0].0), f64::from(place.1) - f64::from(outline[0].1));
        dx.hypot(dy)
    };
    let far = (0..outline.len()).max_by(|&a, &b| distance(&outline[a]).total_cmp(&distance(&outline[b]))).unwrap_or(0);
    let at = |index: usize| outline[index % outline.len()];
    let mut kept = vec![false; outline.len()];
    let mut stretches = vec![(0, far), (far, outline.len())];
    while let Some((start, end)) = stretches.pop() {
        kept[start] = true;
        let away = |index: &usize| distance_from_chord(at(*index), at(start), at(end));
        let Some(farthest) = (start + 1..end).max_by(|a, b| away(a).total_cmp(&away(b))) else { continue };
        if away(&farthest) > TOLERANCE {
            stretches.extend([(start, farthest), (farthest, end)]);
        }
    }
    outline.iter().zip(kept).filter(|(_, kept)| *kept).map(|(&place, _)| place).collect()
}

fn distance_from_chord(place: GridPoint, start: GridPoint, end: GridPoint) -> f64 {
    let difference = |a: GridPoint, b: GridPoint| (f64::from(a.0) - f64::from(b.0), f64::from(a.1) - f64::from(b.1));
    let (along, offset) = (difference(end, start), difference(place, start));
    let length = along.0.hypot(along.1);
    if length > 0.0 { (along.0 * offset.1 - along.1 * offset.0).abs() / length } else { offset.0.hypot(offset.1) }
}
