//! Conversion of the elements and groups of a file to parts and sets.

use std::borrow::Cow;
use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap, HashSet};

use super::element_type::ElementType;
use super::file::{File, FileElement};
use crate::element::{ElementKind, area};
use crate::mesh::validation::folded_corner;
use crate::mesh::{ElementDefinition, ElementEdge, MeshDefinition, Part};

/// z may differ by this fraction of the largest coordinate: what a rotation of the model in Gmsh leaves.
const RELATIVE_PLANE_TOLERANCE: f64 = 1e-9;

/// A fault, with the byte where its cause stands if it stands anywhere.
type FileFault = (Option<usize>, String);

/// Makes a mesh of a file.
pub(super) fn mesh_definition(file: &File, parts: &[Part]) -> Result<(MeshDefinition, Vec<u64>), FileFault> {
    let surfaces = surface_elements(file)?;
    check_part_names(&surfaces, parts)?;
    let mut conversion = Conversion::new(file, parts);
    for (element, kind, group) in surfaces {
        let part = conversion.definition.parts.partition_point(|part| *part.name < *group);
        conversion.add_surface(element, kind, part)?;
    }
    conversion.add_sets()?;
    conversion.check_plane()?;
    Ok((conversion.definition, conversion.turned))
}

/// A surface element with its kind and the name of its group.
type Surface<'f> = (&'f FileElement, ElementKind, Cow<'f, str>);

/// The surface elements.
fn surface_elements(file: &File) -> Result<Vec<Surface<'_>>, FileFault> {
    let (mut surfaces, mut outside): (Vec<Surface<'_>>, _) = (Vec::new(), Vec::new());
    let mut element_with: HashMap<Vec<usize>, usize> = HashMap::new();
    for element in &file.elements {
        let ElementType::Surface(kind) = element.element_type else { continue };
        let groups: Vec<Cow<'_, str>> = group_names(file, element).into_iter().collect();
        let group = match &groups[..] {
            [] => {
                outside.push(element);
                continue;
            }
            [group] => group.clone(),
            [first, second, ..] => {
                let both = format!("element {} is in the physical surfaces '{first}' and '{second}'", element.tag);
                return Err((Some(element.place), format!("{both}; every surface belongs to one part")));
            }
        };
        let mut nodes = element.nodes.clone();
        nodes.sort_unstable();
        if let Some(index) = element_with.insert(nodes, surfaces.len()) {
            let (earlier, _, earlier_group) = &surfaces[index];
            let fault = format!(
                "elements {} (physical surface '{earlier_group}') and {} ('{group}') have the same nodes; every surface \
                 belongs to one part, once",
                earlier.tag, element.tag
            );
            return Err((Some(element.place), fault));
        }
        surfaces.push((element, kind, group));
    }
    if let Some(first) = outside.first() {
        let others = if outside.len() > 1 { format!(" (the first of {})", outside.len()) } else { String::new() };
        let fault = format!(
            "element {}{others} is in no physical surface; add Physical Surface(\"name\") = {{...}} over all surfaces",
            first.tag
        );
        return Err((Some(first.place), fault));
    }
    if surfaces.is_empty() {
        let remedy = "mesh the surfaces (Mesh > 2D) and put them into physical groups";
        return Err((None, format!("there are no triangles or quadrilaterals; {remedy}")));
    }
    Ok(surfaces)
}

/// The names of the physical groups of an element. A reversed curve has its group with a minus.
fn group_names<'f>(file: &'f File, element: &FileElement) -> BTreeSet<Cow<'f, str>> {
    let dimension = element.element_type.dimension();
    let name = |tag: &i64| {
        let tag = tag.saturating_abs();
        file.names.get(&(dimension, tag)).map_or_else(|| tag.to_string().into(), |name| Cow::Borrowed(&**name))
    };
    file.groups[element.groups].iter().map(name).collect()
}

/// All physical surfaces with elements must have a part, and all parts such a surface.
fn check_part_names(surfaces: &[Surface<'_>], parts: &[Part]) -> Result<(), FileFault> {
    let available: BTreeSet<&str> = surfaces.iter().map(|(_, _, group)| &**group).collect();
    let given: BTreeSet<&str> = parts.iter().map(|part| part.name.as_str()).collect();
    let quoted = |names: &BTreeSet<&str>| names.iter().map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
    let (without_elements, without_properties) = (&given - &available, &available - &given);
    let mut message = String::new();
    if !without_elements.is_empty() {
        message += &format!("no physical surface with elements is called {}; ", quoted(&without_elements));
    }
    if !without_properties.is_empty() {
        message += &format!("no properties are given for the physical surface {}; ", quoted(&without_properties));
    }
    if message.is_empty() {
        return Ok(());
    }
    Err((None, message + "the file's physical surfaces are " + &quoted(&available)))
}

/// A mesh in the making.
struct Conversion<'a> {
    file: &'a File,
    definition: MeshDefinition,
    /// The mesh's index of each node of the file.
    node_index: Vec<Option<usize>>,
    /// The file's index of each node of the mesh.
    file_index: Vec<usize>,
    /// The edges between two corners, by the direction in which their elements have them.
    edge_with: HashMap<[usize; 2], ElementEdge>,
    /// Tags of the elements that went clockwise.
    turned: Vec<u64>,
}

impl<'a> Conversion<'a> {
    /// A mesh with the parts in the order of their names, and nothing else.
    fn new(file: &'a File, parts: &[Part]) -> Self {
        let mut parts = parts.to_vec();
        parts.sort_by(|a, b| a.name.cmp(&b.name));
        Self {
            file,
            definition: MeshDefinition { parts, ..MeshDefinition::default() },
            node_index: vec![None; file.nodes.len()],
            file_index: Vec::new(),
            edge_with: HashMap::new(),
            turned: Vec::new(),
        }
    }

    /// The mesh's index of a node of the file, new if it has none.
    fn node(&mut self, node: usize) -> usize {
        *self.node_index[node].get_or_insert_with(|| {
            let [x, y, _] = self.file.nodes[node].position;
            self.definition.nodes.push([x, y]);
            self.file_index.push(node);
            self.definition.nodes.len() - 1
        })
    }

    fn add_surface(&mut self, element: &FileElement, kind: ElementKind, part: usize) -> Result<(), FileFault> {
        let mut nodes: Vec<usize> = element.nodes.iter().map(|&node| self.node(node)).collect();
        let corners: Vec<[f64; 2]> =
            nodes[..kind.corner_count()].iter().map(|&node| self.definition.nodes[node]).collect();
        if signed_area(&corners) < 0.0 {
            turn_round(kind, &mut nodes);
            self.turned.push(element.tag);
        }
        let positions: Vec<[f64; 2]> = nodes.iter().map(|&node| self.definition.nodes[node]).collect();
        let fault = match area(kind, &positions) {
            Err(error) => Some(format!("{error}; it is folded or collapsed")),
            Ok(_) => folded_corner(kind, &positions),
        };
        if let Some(fault) = fault {
            let what = format!("element {}: {fault}, repair the mesh (Mesh > Inspect shows it)", element.tag);
            return Err((Some(element.place), what));
        }
        for edge in 0..kind.corner_count() {
            let ([start, end, _], _) = kind.edge_nodes(edge);
            // Two elements on one side are for `Mesh::new` to find.
            if let Entry::Vacant(vacant) = self.edge_with.entry([nodes[start], nodes[end]]) {
                vacant.insert(ElementEdge { element: self.definition.elements.len(), edge });
            }
        }
        self.definition.elements.push(ElementDefinition { kind, part, nodes });
        Ok(())
    }

    /// Node sets of points, edge and node sets of curves.
    fn add_sets(&mut self) -> Result<(), FileFault> {
        let mut point_names = BTreeSet::new();
        for element in &self.file.elements {
            let groups = match element.element_type {
                ElementType::Surface(_) => continue,
                ElementType::Point | ElementType::Line(_) => group_names(self.file, element),
            };
            for group in groups.into_iter().map(Cow::into_owned) {
                let added = match element.element_type {
                    ElementType::Line(_) => {
                        let edge = self.edge_of(element, &group)?;
                        self.definition.edge_sets.entry(group.clone()).or_default().push(edge);
                        element.nodes.iter().map(|&node| self.node(node)).collect()
                    }
                    _ => {
                        point_names.insert(group.clone());
                        vec![self.node(element.nodes[0])]
                    }
                };
                self.definition.node_sets.entry(group).or_default().extend(added);
            }
        }
        if let Some(name) = point_names.into_iter().find(|name| self.definition.edge_sets.contains_key(name)) {
            let fault = format!(
                "'{name}' names a physical point and a physical curve; both would become the node set of this name"
            );
            return Err((None, fault));
        }
        for nodes in self.definition.node_sets.values_mut() {
            nodes.sort_unstable();
            nodes.dedup();
        }
        for edges in self.definition.edge_sets.values_mut() {
            // Groups of one name may share a curve. The order along the curve stays.
            let mut seen = HashSet::new();
            edges.retain(|&edge| seen.insert(edge));
        }
        Ok(())
    }

    /// The element edge that a line lies on: of the element on its left, else of the one on its right.
    fn edge_of(&self, line: &FileElement, group: &str) -> Result<ElementEdge, FileFault> {
        let ends = [0, 1].map(|end| self.node_index[line.nodes[end]]);
        let middle = line.nodes.get(2).map(|&node| self.node_index[node]);
        let found = match ends {
            [Some(start), Some(end)] => {
                self.edge_with.get(&[start, end]).or_else(|| self.edge_with.get(&[end, start])).copied()
            }
            _ => None,
        };
        found
            .filter(|&ElementEdge { element, edge }| {
                let nodes = self.definition.elements[element].edge_nodes(edge);
                nodes.get(2).map(|&node| Some(node)) == middle
            })
            .ok_or_else(|| {
                let what = format!("line element {} of the physical curve '{group}'", line.tag);
                let fault = "is no edge of a surface element of its order; the curve must bound a meshed surface";
                (Some(line.place), format!("{what} {fault}"))
            })
    }

    /// All nodes of the mesh have the z of the first.
    fn check_plane(&self) -> Result<(), FileFault> {
        let nodes = || self.file_index.iter().map(|&node| &self.file.nodes[node]);
        let largest = nodes().flat_map(|node| node.position).fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let other = nodes().next().map_or(0.0, |node| node.position[2]);
        match nodes().find(|node| (node.position[2] - other).abs() > RELATIVE_PLANE_TOLERANCE * largest) {
            Some(node) => {
                let z = node.position[2];
                let fault = format!("node {} lies at z = {z}, others at {other}; a plane mesh has one z", node.tag);
                Err((Some(node.place), fault))
            }
            None => Ok(()),
        }
    }
}

/// The area of a polygon, negative if clockwise.
fn signed_area(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

/// Turns an element round: the first corner stays the first.
fn turn_round(kind: ElementKind, nodes: &mut [usize]) {
    let (corners, others) = nodes.split_at_mut(kind.corner_count());
    corners[1..].reverse();
    let middles = others.len().min(corners.len());
    others[..middles].reverse();
}
