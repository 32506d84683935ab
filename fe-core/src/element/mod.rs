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

/// All that is known of one kind of element: what else computes with elements asks [`ElementKind`].
struct ElementDescription {
    /// (ξᵢ, ηᵢ) of each node: corners, middles of the edges, nodes inside.
    coordinates: &'static [[f64; 2]],
    corner_count: usize,
    edge_kind: EdgeKind,
    shape_functions: fn([f64; 2]) -> ShapeFunctions,
    full: &'static [IntegrationPoint],
    /// The rule of one order less, if there is one: it is the default then.
    reduced: Option<&'static [IntegrationPoint]>,
    /// Width of a band of cracks, relative to the side of the square that the element, or two triangles, make.
    band: f64,
    /// Gmsh's number of the type, VTK's of the cell.
    gmsh: i64,
    vtk: u8,
}

/// Declares the kinds of elements: their names, and where they are described.
macro_rules! element_kinds {
    ($($(#[$doc:meta])* $kind:ident = $description:path),+ $(,)?) => {
        /// Kind of elements.
        // the page of this module has the numbering of nodes
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, Serialize, JsonSchema)]
        pub enum ElementKind {
            $($(#[$doc])* $kind,)+
        }

        impl ElementKind {
            /// All kinds.
            pub const ALL: [Self; [$(stringify!($kind)),+].len()] = [$(Self::$kind),+];

            const fn description(self) -> &'static ElementDescription {
                match self {
                    $(Self::$kind => const { &$description },)+
                }
            }

            /// Does what depends on the number of nodes at compile time.
            pub(crate) fn with_node_count<T>(self, job: impl WithNodeCount<T>) -> T {
                match self {
                    $(Self::$kind => job.run::<{ $description.coordinates.len() }>(),)+
                }
            }
        }
    };
}

element_kinds! {
    /// Triangles of 3 nodes.
    T3 = triangle::T3,
    /// Triangles of 6 nodes.
    T6 = triangle::T6,
    /// Quadrilaterals of 4 nodes.
    Q4 = quadrilateral::Q4,
    /// Quadrilaterals of 8 nodes.
    Q8 = quadrilateral::Q8,
}

/// What is compiled for each number of nodes: see [`ElementKind::with_node_count`].
pub(crate) trait WithNodeCount<T> {
    /// Does it for elements of `N` nodes.
    fn run<const N: usize>(self) -> T;
}

/// The most nodes that an element has.
pub(crate) const MAX_NODES: usize = {
    let (mut most, mut index) = (0, 0);
    while index < ElementKind::ALL.len() {
        let count = ElementKind::ALL[index].node_count();
        most = if count > most { count } else { most };
        index += 1;
    }
    most
};

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
    /// Returns how many nodes it has.
    pub const fn node_count(self) -> usize {
        self.description().coordinates.len()
    }

    /// Returns how many corners it has, and edges.
    pub const fn corner_count(self) -> usize {
        self.description().corner_count
    }

    /// The kind of its edges.
    pub const fn edge_kind(self) -> EdgeKind {
        self.description().edge_kind
    }

    /// Returns how many of these elements make a square: two triangles.
    pub(crate) const fn count_in_square(self) -> f64 {
        if self.corner_count() == 3 { 2.0 } else { 1.0 }
    }

    /// Gmsh's number of the type of element.
    pub(crate) const fn gmsh_type(self) -> i64 {
        self.description().gmsh
    }

    /// VTK's number of the type of cell; the numbering of nodes is the same.
    pub(crate) const fn vtk_type(self) -> u8 {
        self.description().vtk
    }

    /// Local nodes of an edge: start, end, middle; two of them on linear edges. Edges are taken modulo their number.
    pub fn edge_nodes(self, edge: usize) -> ([usize; 3], usize) {
        let corners = self.corner_count();
        let start = edge % corners;
        ([start, (start + 1) % corners, corners + start], self.edge_kind().node_count())
    }

    /// (ξᵢ, ηᵢ) of each node.
    pub(crate) const fn reference_coordinates(self) -> &'static [[f64; 2]] {
        self.description().coordinates
    }

    /// Shape functions at (ξ, η) and their derivatives by ξ and η.
    pub fn shape_functions(self, reference: [f64; 2]) -> ShapeFunctions {
        (self.description().shape_functions)(reference)
    }
}

impl std::fmt::Display for ElementKind {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Debug::fmt(self, formatter)
    }
}
