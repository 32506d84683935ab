#![doc = include_str!("doc.md")]

mod edge;
mod integration;
mod mapping;
mod quadrilateral;
mod triangle;

pub(crate) use edge::gauss_legendre;
pub use edge::{EdgeKind, EdgePoint, LinePoint};
pub use integration::{Integration, IntegrationPoint};
pub use mapping::{MappedPoint, MappingError, area, characteristic_length};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod test;

/// The most nodes that an element has.
pub(crate) const MAX_NODES: usize = 8;

/// Kind of elements.
// the page of this module has the numbering of nodes
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize, JsonSchema)]
pub enum ElementKind {
    /// Triangles of 3 nodes.
    T3,
    /// Triangles of 6 nodes.
    T6,
    /// Quadrilaterals of 4 nodes.
    Q4,
    /// Quadrilaterals of 8 nodes.
    Q8,
}

/// Shape functions of an element at one point, with their derivatives by two coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeFunctions {
    count: usize,
    /// Nᵢ; 0 beyond `count`.
    pub(crate) values: [f64; MAX_NODES],
    derivatives: [[f64; 2]; MAX_NODES],
}

impl ShapeFunctions {
    /// Makes functions of an element with `count` nodes, all zero.
    fn zero(count: usize) -> Self {
        Self { count, values: [0.0; MAX_NODES], derivatives: [[0.0; 2]; MAX_NODES] }
    }

    /// Nᵢ, one for each node.
    pub fn values(&self) -> &[f64] {
        &self.values[..self.count]
    }

    /// The two derivatives of each Nᵢ: by (ξ, η) from [`ElementKind::shape_functions`], by (x, y) in a
    /// [`MappedPoint`].
    pub fn derivatives(&self) -> &[[f64; 2]] {
        &self.derivatives[..self.count]
    }
}

impl ElementKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::T3, Self::T6, Self::Q4, Self::Q8];

    /// Returns how many nodes it has.
    pub const fn node_count(self) -> usize {
        match self {
            Self::T3 => 3,
            Self::Q4 => 4,
            Self::T6 => 6,
            Self::Q8 => 8,
        }
    }

    /// Returns how many corners it has, and edges.
    pub const fn corner_count(self) -> usize {
        match self {
            Self::T3 | Self::T6 => 3,
            Self::Q4 | Self::Q8 => 4,
        }
    }

    /// The kind of its edges.
    pub const fn edge_kind(self) -> EdgeKind {
        match self {
            Self::T3 | Self::Q4 => EdgeKind::Linear,
            Self::T6 | Self::Q8 => EdgeKind::Quadratic,
        }
    }

    /// Local nodes of an edge: start, end, middle; two of them on linear edges. Edges are taken modulo their number.
    pub fn edge_nodes(self, edge: usize) -> ([usize; 3], usize) {
        let corners = self.corner_count();
        let start = edge % corners;
        ([start, (start + 1) % corners, corners + start], self.edge_kind().node_count())
    }

    /// (ξᵢ, ηᵢ) of each node.
    pub(crate) fn reference_coordinates(self) -> &'static [[f64; 2]] {
        match self {
            Self::T3 | Self::T6 => &triangle::COORDINATES[..self.node_count()],
            Self::Q4 | Self::Q8 => &quadrilateral::COORDINATES[..self.node_count()],
        }
    }

    /// Shape functions at (ξ, η) and their derivatives by ξ and η.
    pub fn shape_functions(self, reference: [f64; 2]) -> ShapeFunctions {
        match self {
            Self::T3 => triangle::linear(reference),
            Self::T6 => triangle::quadratic(reference),
            Self::Q4 => quadrilateral::bilinear(reference),
            Self::Q8 => quadrilateral::serendipity(reference),
        }
    }
}

impl std::fmt::Display for ElementKind {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Debug::fmt(self, formatter)
    }
}
