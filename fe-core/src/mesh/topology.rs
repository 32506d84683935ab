//! Connections of elements: neighbours across edges, and boundaries.

use std::collections::{HashMap, HashSet};

use super::{EdgeNodes, Element, ElementEdge, Mesh, MeshError};

/// The edge on the other side of each edge of an element.
pub(super) type Neighbours = [Option<ElementEdge>; 4];

/// Finds the neighbours of all elements by the corner nodes of edges.
pub(super) fn neighbours(elements: &[Element]) -> Result<Vec<Neighbours>, MeshError> {
    let mut neighbours: Vec<Neighbours> = vec![[None; 4]; elements.len()];
    let mut first_with: HashMap<[usize; 2], ElementEdge> = HashMap::with_capacity(2 * elements.len());
    for (index, element) in elements.iter().enumerate() {
        for edge in 0..element.kind.corner_count() {
            let this = ElementEdge { element: index, edge };
            let [start, end, _] = element.edge_nodes(edge).nodes;
            let other = *first_with.entry([start.min(end), start.max(end)]).or_insert(this);
            if other == this {
                continue;
            }
            if let Some(second) = neighbours[other.element][other.edge] {
                let [a, b, c] = [other.element, second.element, index].map(|element| element + 1);
                let edge = format!("the edge of nodes {}–{}", start + 1, end + 1);
                return Err(MeshError(format!("elements {a}, {b} and {c} share {edge}; an edge has two sides")));
            }
            check_match(elements, other, this)?;
            neighbours[other.element][other.edge] = Some(this);
            neighbours[this.element][this.edge] = Some(other);
        }
    }
    Ok(neighbours)
}

/// Two edges of the same corners: opposite directions, same middle.
fn check_match(elements: &[Element], first: ElementEdge, second: ElementEdge) -> Result<(), MeshError> {
    let edges = [first, second].map(|edge| elements[edge.element].edge_nodes(edge.edge));
    let pair = || format!("elements {} and {}", first.element + 1, second.element + 1);
    let ends = || format!("edge of nodes {}–{}", edges[0].nodes[0] + 1, edges[0].nodes[1] + 1);
    if edges[0].nodes[0] == edges[1].nodes[0] {
        return Err(MeshError(format!("{} lie on the same side of their {}: they overlap", pair(), ends())));
    }
    let [one, other] = edges.each_ref().map(|edge| edge.nodes().get(2).copied());
    if one != other {
        let name = |middle: Option<usize>| middle.map_or("none".to_owned(), |node| format!("node {}", node + 1));
        let shared = format!("{} share the {} but not its middle node", pair(), ends());
        return Err(MeshError(format!("{shared} ({} against {})", name(one), name(other))));
    }
    Ok(())
}

impl Element {
    /// The nodes of one of its edges; edges are taken modulo their number.
    pub fn edge_nodes(&self, edge: usize) -> EdgeNodes {
        let (local, count) = self.kind.edge_nodes(edge);
        let mut nodes = [0; 3];
        for position in 0..count {
            nodes[position] = self.nodes[local[position]];
        }
        EdgeNodes { kind: self.kind.edge_kind(), nodes }
    }
}

impl Mesh {
    /// The nodes of an element's edge.
    pub fn edge_nodes(&self, edge: ElementEdge) -> EdgeNodes {
        self.elements[edge.element].edge_nodes(edge.edge)
    }

    /// Positions of an edge's nodes, as [`EdgeNodes::nodes`] has them: in the reference, or displaced (two per node).
    pub(crate) fn edge_positions(&self, edge: &EdgeNodes, displacements: Option<&[f64]>) -> [[f64; 2]; 3] {
        let mut positions = [[0.0; 2]; 3];
        for (position, &node) in positions.iter_mut().zip(edge.nodes()) {
            *position = self.nodes[node];
            if let Some(displacements) = displacements {
                (0..2).for_each(|k| position[k] += displacements[2 * node + k]);
            }
        }
        positions
    }

    /// Returns the edge as the element on its other side has it; `None` on the boundary.
    pub fn neighbour(&self, edge: ElementEdge) -> Option<ElementEdge> {
        self.neighbours[edge.element][edge.edge]
    }

    /// All edges of all elements, element by element; inner ones come twice, once from each side.
    pub fn edges(&self) -> impl Iterator<Item = ElementEdge> {
        self.elements.iter().enumerate().flat_map(|(element, definition)| {
            (0..definition.kind.corner_count()).map(move |edge| ElementEdge { element, edge })
        })
    }

    /// The edges that belong to one element only, element by element.
    pub fn boundary_edges(&self) -> impl Iterator<Item = ElementEdge> {
        self.edges().filter(|&edge| self.neighbour(edge).is_none())
    }

    /// Puts edges in rows, in which each starts at the node where the one before it ends. Returns for each row whether
    /// it closes; open rows come first.
    ///
    /// # Errors
    /// An edge that starts where another one starts, or ends where another one ends.
    pub fn rows(&self, edges: &[ElementEdge]) -> Result<Vec<(Vec<ElementEdge>, bool)>, ElementEdge> {
        let ends = |edge: ElementEdge| {
            let [start, end, _] = self.edge_nodes(edge).nodes;
            (start, end)
        };
        let mut starting_at = HashMap::with_capacity(edges.len());
        let mut ended = HashSet::with_capacity(edges.len());
        for &edge in edges {
            let (start, end) = ends(edge);
            if starting_at.insert(start, edge).is_some() || !ended.insert(end) {
                return Err(edge);
            }
        }
        let mut firsts = edges.to_vec();
        firsts.sort_by_key(|&edge| ended.contains(&ends(edge).0));
        let mut rows = Vec::new();
        for first in firsts {
            let (start, _) = ends(first);
            let (mut row, mut at) = (Vec::new(), start);
            while let Some(edge) = starting_at.remove(&at) {
                row.push(edge);
                at = ends(edge).1;
            }
            if !row.is_empty() {
                rows.push((row, at == start));
            }
        }
        Ok(rows)
    }
}
