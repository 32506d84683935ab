//! A box-shaped element: which strains the displacements of its nodes prescribe, and which stresses loads on its faces.

/// Tolerance for equal coordinates, in edge lengths.
const SAME: f64 = 1e-6;

/// Shape of an element: its mode, dimensions, corners and nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    /// Name of the mode in cases.
    pub(super) mode: &'static str,
    /// Coordinates that count.
    pub(super) dimensions: usize,
    /// Number of corner nodes, which come first.
    pub(super) corners: usize,
    /// Nodes.
    pub(super) nodes: usize,
}

impl Shape {
    /// Returns the shape of an element's type, with whatever says how it is integrated.
    pub(super) fn of(kind: &str) -> Option<Self> {
        let kind = kind.to_ascii_uppercase();
        let modes = [("C3D", "3d"), ("CPE", "plane_strain"), ("CPS", "plane_stress"), ("CAX", "axisymmetric")];
        let (rest, mode) = modes.into_iter().find_map(|(prefix, mode)| Some((kind.strip_prefix(prefix)?, mode)))?;
        // hybrid, incompatible modes, modified, reduced, coupled temperature
        let (dimensions, corners, nodes) = match (mode, rest.trim_end_matches(|c: char| "HIMRST".contains(c))) {
            ("3d", "8") => (3, 8, 8),
            ("3d", "20") => (3, 8, 20),
            ("3d", _) => return None,
            (_, "4") => (2, 4, 4),
            (_, "8") => (2, 4, 8),
            _ => return None,
        };
        Some(Self { mode, dimensions, corners, nodes })
    }

    /// The corners of a face S1, S2, … or of a load P1, P2, …
    fn face(self, number: usize) -> Option<&'static [usize]> {
        const HEXAHEDRON: [[usize; 4]; 6] =
            [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]];
        const QUADRILATERAL: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];
        let index = number.checked_sub(1)?;
        if self.dimensions == 3 {
            HEXAHEDRON.get(index).map(<[usize; 4]>::as_slice)
        } else {
            QUADRILATERAL.get(index).map(<[usize; 2]>::as_slice)
        }
    }
}

/// A box along the axes.
#[derive(Clone, Debug)]
pub(super) struct Brick {
    pub(super) shape: Shape,
    /// Lengths of the edges along the axes, mm.
    pub(super) edges: [f64; 3],
    /// Least coordinates.
    pub(super) origin: [f64; 3],
    /// Position of each node, in edge lengths.
    pub(super) nodes: Vec<[f64; 3]>,
    /// Thickness of plane elements, mm.
    thickness: f64,
}

impl Brick {
    /// Makes a brick from the nodes of an element; `None` if these do not make a box.
    pub(super) fn new(shape: Shape, coordinates: &[[f64; 3]], thickness: f64) -> Option<Self> {
        let corners = coordinates.get(..shape.corners)?;
        let mut origin = [0.0; 3];
        let mut edges = [1.0; 3];
        for axis in 0..shape.dimensions {
            let values = || corners.iter().map(|corner| corner[axis]);
            origin[axis] = values().fold(f64::INFINITY, f64::min);
            edges[axis] = values().fold(f64::NEG_INFINITY, f64::max) - origin[axis];
        }
        if edges.iter().any(|edge| edge.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater)) {
            return None;
        }
        let place = |node: &[f64; 3]| -> Option<[f64; 3]> {
            let mut place = [0.0; 3];
            for axis in 0..shape.dimensions {
                let share = (node[axis] - origin[axis]) / edges[axis];
                let near = (2.0 * share).round() / 2.0;
                ((share - near).abs() < SAME && (0.0..=1.0).contains(&near)).then_some(())?;
                place[axis] = near;
            }
            Some(place)
        };
        let nodes: Vec<_> = coordinates.iter().map(place).collect::<Option<_>>()?;
        let is_corner = |node: &[f64; 3]| node.iter().all(|share| *share != 0.5);
        let distinct = nodes.iter().enumerate().all(|(k, node)| !nodes[..k].contains(node));
        let neighbours = (1..shape.dimensions + 1).all(|k| differing(&nodes[k - 1], &nodes[k]) == 1);
        (nodes[..shape.corners].iter().all(is_corner) && distinct && neighbours).then_some(())?;
        Some(Self { shape, edges, origin, nodes, thickness })
    }

    /// CELENT: the length of an edge, halved where there are nodes between corners.
    pub(super) fn characteristic_length(&self) -> f64 {
        let dimensions = self.shape.dimensions;
        let size: f64 = self.edges[..dimensions].iter().product();
        let length = if dimensions == 3 { size.cbrt() } else { size.sqrt() };
        if self.shape.nodes > self.shape.corners { length / 2.0 } else { length }
    }

    /// The area of the faces that an axis is normal to.
    pub(super) fn area(&self, axis: usize) -> f64 {
        let others = (0..self.shape.dimensions).filter(|other| *other != axis);
        let area: f64 = others.map(|other| self.edges[other]).product();
        if self.shape.dimensions == 3 { area } else { area * self.thickness }
    }

    /// Returns whether it is axisymmetric.
    pub(super) fn is_axisymmetric(&self) -> bool {
        self.shape.mode == "axisymmetric"
    }

    /// The axis that a face is normal to, and whether it is the far one along it; `None`: there is no such face.
    pub(super) fn normal(&self, face: usize) -> Option<(usize, bool)> {
        let corners = self.shape.face(face)?;
        let first = self.nodes[corners[0]];
        let is_constant = |axis: usize| corners.iter().all(|&corner| self.nodes[corner][axis] == first[axis]);
        (0..self.shape.dimensions).find(|&axis| is_constant(axis)).map(|axis| (axis, first[axis] > 0.5))
    }

    /// The gradient of one displacement from its values at nodes: what they determine of it.
    ///
    /// # Errors
    /// They are not those of any uniform gradient, or determine only a combination of its components.
    pub(super) fn gradient(&self, prescribed: &[(usize, f64)], along: usize) -> Result<[Option<f64>; 3], &'static str> {
        let dimensions = self.shape.dimensions;
        let scale = prescribed.iter().fold(0.0, |most: f64, (_, value)| most.max(value.abs()));
        // u = c + Σ Dⱼ ξⱼ, a row for each node: c, D, u
        let mut rows: Vec<[f64; 5]> = prescribed
            .iter()
            .map(|&(node, value)| {
                let [x, y, z] = self.nodes[node];
                [1.0, x, y, z, value]
            })
            .collect();
        let mut pivots = Vec::new();
        for column in 0..=dimensions {
            let done = pivots.len();
            let largest = |a: &usize, b: &usize| rows[*a][column].abs().total_cmp(&rows[*b][column].abs());
            let Some(best) = (done..rows.len()).max_by(largest).filter(|&row| rows[row][column].abs() > SAME) else {
                continue;
            };
            rows.swap(done, best);
            let pivot = rows[done].map(|entry| entry / rows[done][column]);
            for (k, row) in rows.iter_mut().enumerate() {
                let factor = if k == done { 0.0 } else { row[column] };
                row.iter_mut().zip(pivot).for_each(|(entry, above)| *entry -= factor * above);
            }
            rows[done] = pivot;
            pivots.push(column);
        }
        if rows[pivots.len()..].iter().any(|row| row[4].abs() > SAME * scale) {
            return Err("are those of no uniform strain");
        }
        let mut gradient = [None; 3];
        for (row, &column) in rows.iter().zip(&pivots) {
            let others = (0..=dimensions).filter(|other| *other != column && row[*other].abs() >= SAME);
            let is_alone = others.clone().count() == 0;
            // where all values are 0, a rotation can make up for the strain
            let is_rotation =
                row[4].abs() <= SAME * scale && column != along + 1 && !others.clone().any(|k| k == along + 1);
            if column > 0 && !is_alone && !is_rotation {
                return Err("determine only a combination of strains");
            }
            if column > 0 && is_alone {
                gradient[column - 1] = Some(row[4] / self.edges[column - 1]);
            }
        }
        Ok(gradient)
    }
}

/// Counts the coordinates in which two places differ.
fn differing(a: &[f64; 3], b: &[f64; 3]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}
