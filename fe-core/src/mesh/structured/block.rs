//! A block of a structured mesh: a mapped grid of cells.

use crate::element::ElementKind;
use crate::mesh::ElementEdge;
use std::ops::Range;

/// A side of a block or of one of its cells, in the block's own coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// η at its smallest.
    Bottom,
    /// ξ at its largest.
    Right,
    /// η at its largest.
    Top,
    /// ξ at its smallest.
    Left,
}

/// Diagonal that cuts a cell into two triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonal {
    /// From bottom left to top right.
    Rising,
    /// From top left to bottom right.
    Falling,
}

/// A block: the product of two divided lines, mapped. The map keeps the orientation: ξ to the right, η upwards.
pub struct MeshBlock<'a> {
    pub(super) part: usize,
    pub(super) kind: ElementKind,
    pub(super) xi: &'a [f64],
    pub(super) eta: &'a [f64],
    pub(super) map: &'a dyn Fn([f64; 2]) -> [f64; 2],
    pub(super) keep: &'a dyn Fn(usize, usize) -> bool,
    pub(super) diagonal: &'a dyn Fn(usize, usize) -> Diagonal,
}

impl<'a> MeshBlock<'a> {
    /// The rectangle of these divisions, all of its cells, triangles with rising diagonals.
    pub fn new(part: usize, kind: ElementKind, xi: &'a [f64], eta: &'a [f64]) -> Self {
        Self { part, kind, xi, eta, map: &|point| point, keep: &|_, _| true, diagonal: &|_, _| Diagonal::Rising }
    }

    /// (x, y) of (ξ, η). Middle nodes are mapped from the middle between their corners' (ξ, η), so they lie on curves.
    pub fn mapped(self, map: &'a dyn Fn([f64; 2]) -> [f64; 2]) -> Self {
        Self { map, ..self }
    }

    /// Only the cells (column, row) for which this is true.
    pub(crate) fn keeping(self, keep: &'a dyn Fn(usize, usize) -> bool) -> Self {
        Self { keep, ..self }
    }

    /// Returns how each cell (column, row) is cut into triangles.
    pub fn cut(self, diagonal: &'a dyn Fn(usize, usize) -> Diagonal) -> Self {
        Self { diagonal, ..self }
    }

    /// The position of a place of the grid; see [`Grid::node`].
    pub(super) fn position(&self, [i, j]: [usize; 2]) -> [f64; 2] {
        let at = |line: &[f64], twice: usize| match twice % 2 {
            0 => line[twice / 2],
            _ => 0.5 * (line[twice / 2] + line[twice / 2 + 1]),
        };
        (self.map)([at(self.xi, i), at(self.eta, j)])
    }

    /// The places of the nodes of a cell's elements, in the elements' order.
    pub(super) fn cell(&self, column: usize, row: usize) -> Vec<Vec<[usize; 2]>> {
        let [a, b, c, d] = [[0, 0], [2, 0], [2, 2], [0, 2]].map(|[i, j]| [2 * column + i, 2 * row + j]);
        let is_triangle = self.kind.corner_count() == 3;
        // origin and the ends of both axes of each element
        let elements = match (is_triangle, (self.diagonal)(column, row)) {
            (true, Diagonal::Rising) => vec![[a, b, c], [a, c, d]],
            (true, Diagonal::Falling) => vec![[a, b, d], [b, c, d]],
            (false, _) => vec![[a, b, d]],
        };
        let place = |corners: &[[usize; 2]; 3], reference: &[f64; 2]| {
            let [xi, eta] = reference.map(|value| if is_triangle { value } else { 0.5 * (value + 1.0) });
            let [origin, first, second] = corners.map(|corner| corner.map(|index| index as f64));
            // whole: corners are two apart
            std::array::from_fn(|k| (origin[k] + xi * (first[k] - origin[k]) + eta * (second[k] - origin[k])) as usize)
        };
        let nodes = self.kind.reference_coordinates();
        elements.iter().map(|corners| nodes.iter().map(|node| place(corners, node)).collect()).collect()
    }
}

/// A block after it became part of a mesh: its nodes and edges by their place.
#[derive(Clone, Debug)]
pub struct Grid {
    pub(super) kind: ElementKind,
    /// Number of cells side by side.
    pub columns: usize,
    /// Number of cells upon each other.
    pub rows: usize,
    /// Nodes by place, row by row.
    pub(super) nodes: Vec<Option<usize>>,
    /// The first element of each cell, row by row, and how it was cut.
    pub(super) cells: Vec<Option<(usize, Diagonal)>>,
}

impl Grid {
    pub(super) fn place(&self, [i, j]: [usize; 2]) -> usize {
        j * (2 * self.columns + 1) + i
    }

    /// The node at a place (i, j), 0 ≤ i ≤ 2 columns, 0 ≤ j ≤ 2 rows: corners at even ones, middles between them.
    /// `None` where the kind has no node, no cell was kept or the grid has ended.
    pub fn node(&self, i: usize, j: usize) -> Option<usize> {
        if i > 2 * self.columns { None } else { self.nodes.get(self.place([i, j])).copied().flatten() }
    }

    /// The edge of a cell (column, row) on one side; `None` where no cell was kept.
    pub fn edge(&self, column: usize, row: usize, side: Side) -> Option<ElementEdge> {
        if column >= self.columns || row >= self.rows {
            return None;
        }
        let (element, diagonal) = self.cells[row * self.columns + column]?;
        let (offset, edge) = match (self.kind.corner_count(), diagonal, side) {
            (3, _, Side::Bottom) => (0, 0),
            (3, Diagonal::Rising, Side::Right) => (0, 1),
            (3, Diagonal::Rising, Side::Top) => (1, 1),
            (3, Diagonal::Rising, Side::Left) => (1, 2),
            (3, Diagonal::Falling, Side::Right) => (1, 0),
            (3, Diagonal::Falling, Side::Top) => (1, 1),
            (3, Diagonal::Falling, Side::Left) => (0, 2),
            (_, _, side) => (0, side as usize),
        };
        Some(ElementEdge { element: element + offset, edge })
    }

    /// The edges of one side of the block in the order of the direction that they have: counter-clockwise around it.
    pub fn side_edges(&self, side: Side) -> Vec<ElementEdge> {
        let (columns, rows) = (0..self.columns, 0..self.rows);
        match side {
            Side::Bottom => self.edges(columns, 0..1, side),
            Side::Right => self.edges(self.columns - 1..self.columns, rows, side),
            Side::Top => self.edges(columns, self.rows - 1..self.rows, side),
            Side::Left => self.edges(0..1, rows, side),
        }
    }

    /// The edges of some cells of one row or column on one side, in the order of the direction that they have.
    pub(crate) fn edges(&self, columns: Range<usize>, rows: Range<usize>, side: Side) -> Vec<ElementEdge> {
        let cells = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
        let mut edges: Vec<ElementEdge> = cells.filter_map(|(column, row)| self.edge(column, row, side)).collect();
        if matches!(side, Side::Top | Side::Left) {
            edges.reverse();
        }
        edges
    }

    /// The nodes of one side of the block, along ascending ξ or η.
    pub(crate) fn side_nodes(&self, side: Side) -> Vec<usize> {
        let (last_column, last_row) = (2 * self.columns, 2 * self.rows);
        match side {
            Side::Bottom => (0..=last_column).filter_map(|i| self.node(i, 0)).collect(),
            Side::Top => (0..=last_column).filter_map(|i| self.node(i, last_row)).collect(),
            Side::Left => (0..=last_row).filter_map(|j| self.node(0, j)).collect(),
            Side::Right => (0..=last_row).filter_map(|j| self.node(last_column, j)).collect(),
        }
    }

    /// All nodes of the block, row by row.
    pub fn nodes(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().copied().flatten()
    }
}
