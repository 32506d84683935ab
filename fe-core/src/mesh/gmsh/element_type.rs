//! Gmsh's numbers for the types of element.

use crate::element::ElementKind;

/// A type of element that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ElementType {
    Point,
    /// With its number of nodes, 2 or 3.
    Line(usize),
    Surface(ElementKind),
}

impl ElementType {
    /// Reads Gmsh's number of a type. Gmsh numbers the nodes of all types below as [`crate::element`] does: corners
    /// counter-clockwise, then the middles of the edges, the first one between corners 1 and 2.
    pub(super) fn new(number: i64) -> Result<Self, String> {
        const INCOMPLETE: &str =
            "with Mesh.ElementOrder = 2 also set Mesh.SecondOrderIncomplete = 1 (second-order incomplete: 8 nodes)";
        const LOWER: &str = "set Mesh.ElementOrder to 1 or 2";
        const PLANE: &str = "put only surfaces, curves and points into physical groups";
        if let Some(kind) = ElementKind::ALL.into_iter().find(|kind| kind.gmsh_type() == number) {
            return Ok(Self::Surface(kind));
        }
        let (name, remedy) = match number {
            1 => return Ok(Self::Line(2)),
            8 => return Ok(Self::Line(3)),
            15 => return Ok(Self::Point),
            10 => ("9-node quadrilateral", INCOMPLETE),
            4 | 11 => ("tetrahedron", PLANE),
            5 | 12 | 17 => ("hexahedron", PLANE),
            6 | 13 | 18 => ("prism", PLANE),
            7 | 14 | 19 => ("pyramid", PLANE),
            20..=25 => ("triangle of a higher order", LOWER),
            26..=28 => ("line of a higher order", LOWER),
            _ => ("unknown or of a higher order", LOWER),
        };
        Err(format!("element type {number} ({name}) is not computed; {remedy}"))
    }

    pub(super) fn dimension(self) -> usize {
        match self {
            Self::Point => 0,
            Self::Line(_) => 1,
            Self::Surface(_) => 2,
        }
    }

    pub(super) fn node_count(self) -> usize {
        match self {
            Self::Point => 1,
            Self::Line(count) => count,
            Self::Surface(kind) => kind.node_count(),
        }
    }
}
