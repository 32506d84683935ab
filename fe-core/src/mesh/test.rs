use super::*;
use crate::element::{ElementKind::*, MappedPoint};
use std::f64::consts::PI;

impl Mesh {
    /// The edges of a part with nothing or with another part on their other side, element by element.
    pub(crate) fn part_boundary_edges(&self, part: usize) -> impl Iterator<Item = ElementEdge> {
        let part_of = |edge: ElementEdge| self.elements[edge.element].part;
        self.edges().filter(move |&edge| {
            part_of(edge) == part && self.neighbour(edge).is_none_or(|other| part_of(other) != part)
        })
    }

    /// The boundary as closed loops of edges, each starting at its first edge: counter-clockwise around bodies,
    /// clockwise around holes. Bodies that touch in a node only stay apart there.
    pub(crate) fn boundary_loops(&self) -> Vec<Vec<ElementEdge>> {
        let mut visited = vec![[false; 4]; self.elements.len()];
        let mut loops = Vec::new();
        for first in self.boundary_edges() {
            let mut chain = Vec::new();
            let mut current = first;
            while !visited[current.element][current.edge] {
                visited[current.element][current.edge] = true;
                chain.push(current);
                current = self.next_boundary_edge(current);
            }
            if !chain.is_empty() {
                loops.push(chain);
            }
        }
        loops
    }

    /// The boundary edge after this one. Turns about its end node through the elements there, one by one: nothing is
    /// ambiguous where bodies touch. It ends, for turning is one-to-one and a boundary edge has nothing before it.
    fn next_boundary_edge(&self, edge: ElementEdge) -> ElementEdge {
        let mut next = self.next_in_element(edge);
        while let Some(other) = self.neighbour(next) {
            next = self.next_in_element(other);
        }
        next
    }

    /// The edge that starts in its element where this one ends.
    fn next_in_element(&self, edge: ElementEdge) -> ElementEdge {
        let count = self.elements[edge.element].kind.corner_count();
        ElementEdge { element: edge.element, edge: (edge.edge + 1) % count }
    }
}

/// A grid of `columns` × `rows` unit cells of one kind, without the cells in `holes`; nodes are shared.
fn grid(kind: ElementKind, columns: usize, rows: usize, holes: &[[usize; 2]]) -> MeshDefinition {
    let mut definition =
        MeshDefinition { parts: vec![Part::new("body", PlaneModel::PlaneStrain, 1.0)], ..MeshDefinition::default() };
    // Positions doubled, so that middle nodes have integers too.
    let mut numbers = std::collections::HashMap::new();
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        if holes.contains(&[column, row]) {
            continue;
        }
        let [a, b, c, d] = [[0, 0], [2, 0], [2, 2], [0, 2]].map(|[x, y]| [2 * column + x, 2 * row + y]);
        let cells = if kind.corner_count() == 3 { vec![vec![a, b, c], vec![a, c, d]] } else { vec![vec![a, b, c, d]] };
        for mut cell in cells {
            if kind.edge_kind() == EdgeKind::Quadratic {
                for i in 0..kind.corner_count() {
                    let (start, end) = (cell[i], cell[(i + 1) % kind.corner_count()]);
                    cell.push([(start[0] + end[0]) / 2, (start[1] + end[1]) / 2]);
                }
            }
            cell.resize(kind.node_count(), [2 * column + 1, 2 * row + 1]);
            let mut nodes = Vec::new();
            for position in cell {
                nodes.push(*numbers.entry(position).or_insert_with(|| {
                    definition.nodes.push(position.map(|x| x as f64 / 2.0));
                    definition.nodes.len() - 1
                }));
            }
            definition.elements.push(ElementDefinition { kind, part: 0, nodes });
        }
    }
    definition
}

fn fault(definition: MeshDefinition) -> String {
    Mesh::new(definition).unwrap_err().to_string()
}

/// The area that a loop of edges encloses, negative if clockwise; edges must follow each other.
fn enclosed_area(mesh: &Mesh, chain: &[ElementEdge]) -> f64 {
    let mut area = 0.0;
    for (position, &edge) in chain.iter().enumerate() {
        let next = mesh.edge_nodes(chain[(position + 1) % chain.len()]);
        let edge = mesh.edge_nodes(edge);
        assert_eq!(edge.nodes()[1], next.nodes()[0], "edges follow each other");
        let [a, b] = [edge.nodes()[0], edge.nodes()[1]].map(|node| mesh.nodes()[node]);
        area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
    area
}

#[test]
fn grids_have_their_area_and_one_boundary() {
    for kind in ElementKind::ALL {
        let mesh = Mesh::new(grid(kind, 4, 3, &[])).unwrap();
        let area: f64 = (0..mesh.elements().len()).map(|element| mesh.element_area(element)).sum();
        approx::assert_abs_diff_eq!(area, 12.0, epsilon = 1e-14);
        let length = if kind == ElementKind::T6 { 2.0 / 3.0 } else { 1.0 };
        approx::assert_abs_diff_eq!(mesh.characteristic_length(5), length, epsilon = 1e-15);
        let loops = mesh.boundary_loops();
        assert_eq!(loops.iter().map(Vec::len).collect::<Vec<_>>(), [14]);
        approx::assert_abs_diff_eq!(enclosed_area(&mesh, &loops[0]), 12.0, epsilon = 1e-14);
    }
}

#[test]
fn neighbours_are_mutual_and_euler_counts_the_edges() {
    for kind in ElementKind::ALL {
        let mesh = Mesh::new(grid(kind, 4, 3, &[])).unwrap();
        let boundary = mesh.boundary_edges().count();
        for edge in mesh.edges() {
            if let Some(other) = mesh.neighbour(edge) {
                assert_eq!(mesh.neighbour(other), Some(edge));
                let (mine, theirs) = (mesh.edge_nodes(edge), mesh.edge_nodes(other));
                assert_eq!(mine.nodes()[..2], [theirs.nodes()[1], theirs.nodes()[0]]);
                assert_eq!(mine.nodes().get(2), theirs.nodes().get(2));
            }
        }
        // Corners − edges + elements = 1 for a disk.
        let edges = (mesh.edges().count() + boundary) / 2;
        assert_eq!(20 + mesh.elements().len(), edges + 1);
    }
}

#[test]
fn a_hole_has_a_clockwise_loop_of_its_own() {
    for kind in ElementKind::ALL {
        let mesh = Mesh::new(grid(kind, 4, 3, &[[1, 1], [2, 1]])).unwrap();
        let mut areas: Vec<f64> = mesh.boundary_loops().iter().map(|chain| enclosed_area(&mesh, chain)).collect();
        areas.sort_by(f64::total_cmp);
        assert_eq!(areas, [-2.0, 12.0]);
    }
}

#[test]
fn bodies_that_touch_in_a_node_keep_loops_of_their_own() {
    // Cells left: (0, 0) and (1, 1), touching in their corner.
    for kind in ElementKind::ALL {
        let mesh = Mesh::new(grid(kind, 2, 2, &[[1, 0], [0, 1]])).unwrap();
        let areas: Vec<f64> = mesh.boundary_loops().iter().map(|chain| enclosed_area(&mesh, chain)).collect();
        assert_eq!(areas, [1.0, 1.0]);
    }
}

#[test]
fn parts_have_boundaries_where_they_meet() {
    let mut definition = grid(Q8, 4, 3, &[]);
    definition.parts.push(Part::new("inlay", PlaneModel::PlaneStress, 0.5));
    definition.elements[5].part = 1;
    let mesh = Mesh::new(definition).unwrap();
    let inlay: Vec<_> = mesh.part_boundary_edges(1).collect();
    assert_eq!(inlay, [0, 1, 2, 3].map(|edge| ElementEdge { element: 5, edge }));
    assert_eq!(mesh.part_boundary_edges(0).count(), 14 + 4);
}

#[test]
fn integration_is_the_parts_or_the_kinds_own() {
    for (integration, count) in [(None, 4), (Some(Integration::Full), 9), (Some(Integration::Reduced), 4)] {
        let mut definition = grid(Q8, 1, 1, &[]);
        definition.parts[0].integration = integration;
        assert_eq!(Mesh::new(definition).unwrap().integration_points(0).len(), count);
    }
    let mut definition = grid(T6, 2, 1, &[]);
    definition.parts[0].integration = Some(Integration::Reduced);
    assert_eq!(fault(definition), "element 1 (T6): part 'body' asks for reduced integration, which T6 does not have");
}

#[test]
fn sets_are_found_by_name_and_free_nodes_reported() {
    let mut definition = grid(Q4, 2, 1, &[]);
    definition.nodes.push([5.0, 5.0]);
    definition.node_sets.insert("grip".into(), vec![6, 0]);
    definition.edge_sets.insert("face".into(), vec![ElementEdge { element: 1, edge: 1 }]);
    let mesh = Mesh::new(definition).unwrap();
    assert_eq!(mesh.node_set("grip"), Some(&[6, 0][..]));
    assert_eq!(mesh.node_set("face"), None);
    let [start, end] = [0, 1].map(|i| mesh.edge_nodes(mesh.edge_set("face").unwrap()[0]).nodes()[i]);
    assert_eq!([mesh.nodes()[start], mesh.nodes()[end]], [[2.0, 0.0], [2.0, 1.0]]);
    assert_eq!(mesh.free_nodes(), [6]);
    assert_eq!(mesh.node_set_names().chain(mesh.edge_set_names()).collect::<Vec<_>>(), ["grip", "face"]);
}

/// One way to spoil a sound mesh, and the message.
type Fault = (fn(&mut MeshDefinition), &'static str);

#[test]
fn faults_are_named_by_number() {
    let faults: &[Fault] = &[
        (|m| m.elements.clear(), "the mesh has no elements"),
        (|m| m.nodes[2][1] = f64::NAN, "node 3: its position (1, NaN) is not finite"),
        (|m| m.parts.push(m.parts[0].clone()), "parts 1 and 2 are both called 'body'"),
        (|m| m.parts[0].thickness = 0.0, "part 'body': its thickness is 0, it must be positive"),
        (|m| m.elements[1].nodes.truncate(3), "element 2 (Q4): it has 3 nodes, Q4 needs 4"),
        (|m| m.elements[1].nodes[0] = 99, "element 2 (Q4): its node 100 does not exist, the mesh has 9"),
        (|m| m.elements[1].nodes[0] = m.elements[1].nodes[2], "element 2 (Q4): it has node 6 twice"),
        (|m| m.elements[1].part = 1, "element 2 (Q4): its part 2 does not exist, the mesh has 1"),
        (|m| m.edge_sets.extend([("top".into(), vec![])]), "edge set 'top' is empty"),
        (|m| m.node_sets.extend([("top".into(), vec![])]), "node set 'top' is empty"),
        (|m| m.node_sets.extend([("top".into(), vec![9])]), "node set 'top': node 10 does not exist, the mesh has 9"),
        (|m| m.node_sets.extend([("top".into(), vec![3, 3])]), "node set 'top' has node 4 twice"),
        (
            |m| m.edge_sets.extend([("top".into(), vec![ElementEdge { element: 3, edge: 4 }])]),
            "edge set 'top': edge 5 of element 4 does not exist",
        ),
        (
            |m| m.edge_sets.extend([("top".into(), vec![ElementEdge { element: 3, edge: 3 }; 2])]),
            "edge set 'top' has edge 4 of element 4 twice",
        ),
        (
            |m| m.elements.push(m.elements[2].clone()),
            "elements 1, 3 and 5 share the edge of nodes 4–3; an edge has two sides",
        ),
        (
            |m| {
                m.elements.truncate(1);
                m.elements.push(m.elements[0].clone());
            },
            "elements 1 and 2 lie on the same side of their edge of nodes 1–2: they overlap",
        ),
        (
            |m| {
                m.parts[0].model = PlaneModel::Axisymmetric;
                m.nodes.iter_mut().for_each(|node| node[0] -= 0.5);
            },
            "element 1 (Q4): node 1 has the radius -0.5, negative in the axisymmetric part 'body'",
        ),
        (
            |m| m.elements[3].nodes.reverse(),
            "element 4 (Q4): at integration point 1 the Jacobian determinant is -2.500e-1 where it must be positive \
             (nodes go counter-clockwise; is it folded?)",
        ),
    ];
    for (spoil, message) in faults {
        let mut definition = grid(Q4, 2, 2, &[]);
        assert!(Mesh::new(definition.clone()).is_ok());
        spoil(&mut definition);
        assert_eq!(fault(definition), *message);
    }
}

#[test]
fn a_linear_edge_cannot_meet_a_quadratic_one() {
    let mut definition = grid(Q8, 2, 1, &[]);
    let second = &mut definition.elements[1];
    (second.kind, second.nodes) = (Q4, second.nodes[..4].to_vec());
    assert_eq!(
        fault(definition),
        "elements 1 and 2 share the edge of nodes 2–3 but not its middle node (node 6 against none)"
    );
}

/// Middle nodes that the reduced rule overlooks and the full rule, which the area takes, does not.
#[test]
fn folds_between_the_reduced_points_are_found() {
    let mut definition = grid(Q8, 1, 1, &[]);
    let middle = definition.elements[0].nodes[4];
    definition.nodes[middle] = [0.93, 0.0];
    let positions: Vec<_> = definition.elements[0].nodes.iter().map(|&node| definition.nodes[node]).collect();
    for point in Q8.integration_points(Integration::Reduced).unwrap() {
        assert!(MappedPoint::new(Q8, &positions, point.coordinates).is_ok());
    }
    assert_eq!(
        fault(definition),
        "element 1 (Q8): at integration point 3 the Jacobian determinant is -4.554e-2 where it must be positive (nodes go \
         counter-clockwise; is it folded?)"
    );
}

/// A middle node nearer to a corner than a quarter of the edge, and a quadrilateral with a corner that points inwards: no integration
/// point sees the fold. A quarter point is the singular element of a crack's tip.
#[test]
fn folds_at_a_corner_are_found() {
    let quadratic = |share: f64| {
        let mut definition = grid(Q8, 1, 1, &[]);
        let middle = definition.elements[0].nodes[4];
        definition.nodes[middle] = [share, 0.0];
        definition
    };
    assert!(Mesh::new(quadratic(0.25)).is_ok());
    assert_eq!(
        fault(quadratic(0.2)),
        "element 1 (Q8): at its corner 1 the Jacobian determinant is -5.000e-2; it is folded there"
    );
    let mut dart = grid(Q4, 1, 1, &[]);
    let corner = dart.elements[0].nodes[2];
    dart.nodes[corner] = [0.45, 0.45];
    assert_eq!(
        fault(dart),
        "element 1 (Q4): at its corner 3 the Jacobian determinant is -2.500e-2; it is folded there"
    );
}

/// Corners and middles on the axis or right of it, but the parabola r = ½ η (η + 1) between them is not.
#[test]
fn edges_that_bulge_across_the_axis_are_found() {
    let positions = [[0.0, 0.0], [0.1, 0.0], [1.1, 2.0], [1.0, 2.0], [0.05, 0.0], [0.1, 1.0], [1.05, 2.0], [0.0, 1.0]];
    let mut definition = grid(Q8, 1, 1, &[]);
    for (&node, position) in definition.elements[0].nodes.iter().zip(positions) {
        definition.nodes[node] = position;
    }
    assert!(Mesh::new(definition.clone()).is_ok());
    definition.parts[0].model = PlaneModel::Axisymmetric;
    let first = Q8.integration_points(Integration::Reduced).unwrap()[0];
    let [radius, _] = MappedPoint::new(Q8, &positions, first.coordinates).unwrap().position;
    assert!(radius < 0.0);
    let place = format!("element 1 (Q8): integration point 1 has the radius {radius}");
    assert_eq!(fault(definition), place + ", not positive in the axisymmetric part 'body'");
}

#[test]
fn slivers_are_refused_only_when_rounding_rules_them() {
    let sliver = |height: f64| {
        let mut definition = grid(Q4, 1, 1, &[]);
        definition.nodes.iter_mut().for_each(|node| node[1] *= height);
        Mesh::new(definition)
    };
    assert_eq!(sliver(1e-8).unwrap().element_area(0), 1e-8);
    assert_eq!(
        sliver(1e-11).unwrap_err().to_string(),
        "element 1 (Q4): at integration point 1 the Jacobian determinant is 2.500e-12, lost in rounding against its diagonal \
         squared, 1.000e0"
    );
}

/// A disk of one ring of Q8 around a square: radius from the boundary's parabolas, of fourth order.
#[test]
fn boundary_of_a_round_body_has_its_length_and_normals() {
    let count = 12;
    let mut definition =
        MeshDefinition { parts: vec![Part::new("disk", PlaneModel::PlaneStress, 1.0)], ..MeshDefinition::default() };
    let point = |radius: f64, step: usize| {
        let angle = 2.0 * PI * step as f64 / (2 * count) as f64;
        [radius * angle.cos(), radius * angle.sin()]
    };
    // Three circles of 24 nodes; the odd ones of the middle circle stay free.
    for radius in [1.0, 1.5, 2.0] {
        definition.nodes.extend((0..2 * count).map(|step| point(radius, step)));
    }
    let node = |circle: usize, step: usize| circle * 2 * count + step % (2 * count);
    for cell in 0..count {
        let (a, m, b) = (2 * cell, 2 * cell + 1, 2 * cell + 2);
        let nodes =
            [(0, a), (2, a), (2, b), (0, b), (1, a), (2, m), (1, b), (0, m)].map(|(circle, step)| node(circle, step));
        definition.elements.push(ElementDefinition { kind: Q8, part: 0, nodes: nodes.to_vec() });
    }
    let mesh = Mesh::new(definition).unwrap();
    assert_eq!(mesh.free_nodes().len(), count);
    let mut lengths = Vec::new();
    for chain in mesh.boundary_loops() {
        let mut length = 0.0;
        for &edge in &chain {
            let edge = mesh.edge_nodes(edge);
            let nodes = [0, 1, 2].map(|i| mesh.nodes()[edge.nodes()[i]]);
            for line_point in crate::element::gauss_legendre(4) {
                let at = edge.kind().point(&nodes, line_point.coordinate);
                let normal = at.outward_normal().unwrap();
                let radial =
                    (at.position[0] * normal[0] + at.position[1] * normal[1]) / at.position[0].hypot(at.position[1]);
                // Outward on the outer circle, towards the centre in the hole.
                assert!(
                    (radial.abs() - 1.0).abs() < 1e-3 && (radial > 0.0) == (at.position[0].hypot(at.position[1]) > 1.5)
                );
                length += line_point.weight * at.stretch();
            }
        }
        lengths.push(length);
    }
    lengths.sort_by(f64::total_cmp);
    for (length, radius) in lengths.iter().zip([1.0, 2.0]) {
        approx::assert_relative_eq!(*length, 2.0 * PI * radius, max_relative = 1e-4);
    }
}
