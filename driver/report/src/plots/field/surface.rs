//! The elements of a picture on its grid: subdivided for fills, edge by edge for lines.

use super::super::axis::drawable;
use super::region::{GridPoint, Region, after};
use super::view::View;
use super::{PictureElement, PictureMesh};
use crate::extremes;
use fe_core::element::{EdgeKind, ElementKind};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Length of a piece of a subdivided element, px.
const PIECE: f64 = 6.0;

/// Elements of a deformed mesh that the view shows.
pub(super) struct Surface<'a> {
    mesh: &'a PictureMesh,
    /// Positions of the nodes as drawn, mm.
    positions: Vec<[f64; 2]>,
    lattices: Vec<Lattice>,
    /// Index and subdivided grid points of each element that is seen.
    patches: Vec<(usize, Vec<GridPoint>)>,
    /// Mean size of an element, px.
    pub element_size: f64,
    /// `Some(true)`: only elements in the background; `Some(false)`: only the others; `None`: all.
    behind: Option<bool>,
}

/// Subdivision of one kind of element.
#[derive(Clone)]
struct Lattice {
    /// Shape functions at each lattice point.
    weights: Vec<Vec<f64>>,
    triangles: Vec<[usize; 3]>,
    /// Lattice points along the edges, in their direction.
    outline: Vec<usize>,
}

impl<'a> Surface<'a> {
    pub fn new(mesh: &'a PictureMesh, positions: Vec<[f64; 2]>, view: &View) -> Self {
        let seen = seen(mesh, &positions, view);
        let sizes: Vec<f64> = seen.iter().map(|&e| view.pixels(extent(&mesh.elements[e], &positions))).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let count = (largest / PIECE).ceil().clamp(2.0, 12.0) as usize;
        let lattices: Vec<Lattice> = ElementKind::ALL.iter().map(|&kind| Lattice::new(kind, count)).collect();
        let element_size = sizes.iter().sum::<f64>() / sizes.len().max(1) as f64;
        let patch = |index: usize| {
            let element = &mesh.elements[index];
            let place = |weights: &Vec<f64>| {
                let sum = |k: usize| weights.iter().zip(&element.nodes).map(|(w, &node)| w * positions[node][k]).sum();
                view.place([sum(0), sum(1)])
            };
            (index, lattices[element.kind as usize].weights.iter().map(place).collect())
        };
        let patches = seen.into_iter().map(patch).collect();
        Self { mesh, positions, lattices, patches, element_size, behind: None }
    }

    /// Splits it into layers, each to be drawn over the previous one: the elements in the background, and the rest.
    pub fn layers(self) -> Vec<Self> {
        if self.mesh.behind.is_empty() {
            return vec![self];
        }
        let layer = |behind: bool| {
            let is_in = |(index, _): &&(usize, Vec<GridPoint>)| self.is_behind(&self.mesh.elements[*index]) == behind;
            let (positions, lattices) = (self.positions.clone(), self.lattices.clone());
            let patches = self.patches.iter().filter(is_in).cloned().collect();
            Self { positions, lattices, patches, behind: Some(behind), ..self }
        };
        vec![layer(true), layer(false)]
    }

    fn is_behind(&self, element: &PictureElement) -> bool {
        self.mesh.behind.contains(&element.part)
    }

    /// The union of some elements, chosen by index and content.
    pub fn area(&self, wanted: impl Fn(usize, &PictureElement) -> bool) -> String {
        let mut region = Region::default();
        let numbered = self.patches.iter().map(|(index, _)| *index).zip(self.subdivided());
        for (_, (_, places, lattice)) in numbered.filter(|(index, (element, ..))| wanted(*index, element)) {
            region.add(&lattice.outline.iter().map(|&index| places[index]).collect::<Vec<_>>());
        }
        region.path()
    }

    /// Returns where a field that is interpolated like the positions is not less than a level. Elements with a value that is
    /// no number are left out.
    pub fn area_above(&self, values: &[f64], level: f64) -> String {
        let mut region = Region::default();
        for (element, places, lattice) in self.subdivided() {
            let nodal: Vec<f64> = element.nodes.iter().map(|&node| values[node]).collect();
            if !nodal.iter().all(|&value| drawable(value)) {
                continue;
            }
            let interpolated = |weights: &Vec<f64>| weights.iter().zip(&nodal).map(|(w, value)| w * value).sum();
            let field: Vec<f64> = lattice.weights.iter().map(interpolated).collect();
            if field.iter().all(|&value| value >= level) {
                region.add(&lattice.outline.iter().map(|&index| places[index]).collect::<Vec<_>>());
            } else if field.iter().any(|&value| value >= level) {
                for triangle in &lattice.triangles {
                    region.add(&clipped(triangle.map(|index| (places[index], field[index])), level));
                }
            }
        }
        region.path()
    }

    fn subdivided(&self) -> impl Iterator<Item = (&'a PictureElement, &[GridPoint], &Lattice)> {
        self.patches.iter().map(|(index, places)| {
            let element = &self.mesh.elements[*index];
            (element, places.as_slice(), &self.lattices[element.kind as usize])
        })
    }

    /// The edges of the elements, each once: those inside a part, and those on its boundary.
    pub fn edges(&self, view: &View) -> [String; 2] {
        let mut counts: BTreeMap<[usize; 2], (usize, [usize; 3], EdgeKind)> = BTreeMap::new();
        let is_in = |element: &&PictureElement| self.behind.is_none_or(|behind| self.is_behind(element) == behind);
        for element in self.mesh.elements.iter().filter(is_in) {
            for edge in 0..element.kind.corner_count() {
                let (local, count) = element.kind.edge_nodes(edge);
                let node = |k: usize| element.nodes[local[if k < count { k } else { 0 }]];
                let nodes = [node(0), node(1), node(2)];
                let key = [nodes[0].min(nodes[1]), nodes[0].max(nodes[1])];
                counts.entry(key).or_insert((0, nodes, element.kind.edge_kind())).0 += 1;
            }
        }
        let mut paths = [String::new(), String::new()];
        for (count, nodes, kind) in counts.into_values() {
            let places = nodes.map(|node| self.positions[node]);
            if view.shows(places.into_iter()) {
                push_edge(&mut paths[usize::from(count == 1)], kind, places, view);
            }
        }
        paths
    }
}

/// An edge as a straight line, or the parabola through its three nodes.
fn push_edge(path: &mut String, kind: EdgeKind, nodes: [[f64; 2]; 3], view: &View) {
    let [start, end, middle] = nodes.map(|node| view.place(node));
    let relative = |(x, y): GridPoint| (x.wrapping_sub(start.0), y.wrapping_sub(start.1));
    let (dx, dy) = relative(end);
    // the control point: 2 × middle − mean of the ends
    let control = [0, 1].map(|k| 2.0 * nodes[2][k] - 0.5 * (nodes[0][k] + nodes[1][k]));
    let (mx, my) = relative(middle);
    let straight = kind == EdgeKind::Linear || (2 * mx - dx).abs() + (2 * my - dy).abs() <= 2;
    // writing to a String cannot fail
    let _ = write!(path, "M{}{}", start.0, after(start.1));
    let _ = if straight {
        write!(path, "l{dx}{}", after(dy))
    } else {
        let (cx, cy) = relative(view.place(control));
        write!(path, "q{cx}{}{}{}", after(cy), after(dx), after(dy))
    };
}

/// Indices of the elements that a view shows.
pub(super) fn seen(mesh: &PictureMesh, positions: &[[f64; 2]], view: &View) -> Vec<usize> {
    (0..mesh.elements.len()).filter(|&index| view.shows(corners(&mesh.elements[index], positions))).collect()
}

/// Positions of an element's nodes.
fn corners<'p>(element: &'p PictureElement, positions: &'p [[f64; 2]]) -> impl Iterator<Item = [f64; 2]> + Clone + 'p {
    element.nodes.iter().map(|&node| positions[node])
}

/// The larger side of an element's bounding box, mm.
pub(super) fn extent(element: &PictureElement, positions: &[[f64; 2]]) -> f64 {
    let side = |k: usize| {
        let (least, greatest) = extremes(corners(element, positions).map(|position| position[k]));
        greatest - least
    };
    side(0).max(side(1))
}

/// Returns the part of a triangle where the value is at least the level.
fn clipped(triangle: [(GridPoint, f64); 3], level: f64) -> Vec<GridPoint> {
    let mut polygon = Vec::with_capacity(4);
    for k in 0..3 {
        let (start, end) = (triangle[k], triangle[(k + 1) % 3]);
        if start.1 >= level {
            polygon.push(start.0);
        }
        if (start.1 >= level) != (end.1 >= level) {
            // from the same end in both triangles of an edge: both get the same place
            let (first, second) = if start.0 <= end.0 { (start, end) } else { (end, start) };
            let share = (level - first.1) / (second.1 - first.1);
            let between = |a: i32, b: i32| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as i32;
            polygon.push((between(first.0.0, second.0.0), between(first.0.1, second.0.1)));
        }
    }
    polygon
}

impl Lattice {
    fn new(kind: ElementKind, count: usize) -> Self {
        let triangular = kind.corner_count() == 3;
        let step = |index: usize| index as f64 / count as f64;
        let mut index_of = BTreeMap::new();
        let mut weights = Vec::new();
        for row in 0..=count {
            for column in 0..=if triangular { count - row } else { count } {
                let (a, b) = (step(column), step(row));
                let reference = if triangular { [a, b] } else { [2.0 * a - 1.0, 2.0 * b - 1.0] };
                index_of.insert((column, row), weights.len());
                weights.push(kind.shape_functions(reference).values().to_vec());
            }
        }
        let mut triangles = Vec::new();
        for &(column, row) in index_of.keys() {
            let corner = |i: usize, j: usize| index_of.get(&(column + i, row + j)).copied();
            for triangle in [[corner(0, 0), corner(1, 0), corner(0, 1)], [corner(1, 0), corner(1, 1), corner(0, 1)]] {
                if let [Some(a), Some(b), Some(c)] = triangle {
                    triangles.push([a, b, c]);
                }
            }
        }
        let along = |from: (usize, usize), to: (usize, usize)| {
            let between = move |a: usize, b: usize, k: usize| (a * (count - k) + b * k) / count;
            (0..count).map(move |k| (between(from.0, to.0, k), between(from.1, to.1, k)))
        };
        let corners: &[(usize, usize)] = if triangular {
            &[(0, 0), (count, 0), (0, count)]
        } else {
            &[(0, 0), (count, 0), (count, count), (0, count)]
        };
        let next = corners.iter().cycle().skip(1);
        let outline = corners.iter().zip(next).flat_map(|(&from, &to)| along(from, to));
        let outline = outline.map(|place| index_of[&place]).collect();
        Self { weights, triangles, outline }
    }
}
