//! Structured meshes: blocks of cells from two divided lines, mapped onto what they shall be.
//!
//! Every cell becomes one quadrilateral or two triangles. Blocks do not share nodes, so surfaces in contact can lie upon
//! each other, unless a block is glued to nodes of others ([`MeshDefinition::glued_block`]).
//!
//! # Example
//!
//! A quarter of a ring, radius 1 to 2, in 6 × 8 Q8 that become larger outwards:
//!
//! ```
//! use fe_core::element::ElementKind::Q8;
//! use fe_core::kinematics::PlaneModel::PlaneStrain;
//! use fe_core::mesh::structured::{MeshBlock, Grading, Side};
//! use fe_core::mesh::{Mesh, MeshDefinition, Part};
//!
//! let radii = Grading::Ratio { count: 6, ratio: 2.0 }.positions(1.0)?;
//! let angles = Grading::Uniform { count: 8 }.positions(std::f64::consts::FRAC_PI_2)?;
//! let ring = |[s, angle]: [f64; 2]| [(1.0 + s) * angle.cos(), (1.0 + s) * angle.sin()];
//!
//! let mut mesh = MeshDefinition::default();
//! let part = mesh.add_part(Part::new("ring", PlaneStrain, 1.0));
//! let grid = mesh.block(&MeshBlock::new(part, Q8, &radii, &angles).mapped(&ring))?;
//! mesh.edge_set("inner", grid.side_edges(Side::Left));
//! let mesh = Mesh::new(mesh)?;
//! assert_eq!(mesh.edge_set("inner").unwrap().len(), 8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod block;
mod grading;

#[cfg(test)]
mod test;

pub use block::{Diagonal, Grid, MeshBlock, Side};
pub use grading::{Grading, MOST_DIVISIONS};
pub(crate) use grading::{capped_through, too_many};

use std::collections::HashMap;

use super::{ElementDefinition, ElementEdge, MeshDefinition, MeshError, Part};

/// Most cells of a mesh: beyond what can be solved, within what memory holds.
pub const MOST_CELLS: usize = 1_000_000;

impl MeshDefinition {
    /// Adds a part; returns its index.
    pub fn add_part(&mut self, part: Part) -> usize {
        self.parts.push(part);
        self.parts.len() - 1
    }

    /// Adds a block with nodes of its own.
    ///
    /// # Errors
    ///
    /// Divisions that do not ascend, more cells than [`MOST_CELLS`], a map that is not finite.
    pub fn block(&mut self, block: &MeshBlock<'_>) -> Result<Grid, MeshError> {
        self.glued_block(block, &[])
    }

    /// Adds a block that takes those nodes of `others` that coincide with its own, to the bit.
    pub fn glued_block(&mut self, block: &MeshBlock<'_>, others: &[usize]) -> Result<Grid, MeshError> {
        check_divisions('ξ', block.xi)?;
        check_divisions('η', block.eta)?;
        let (columns, rows) = (block.xi.len() - 1, block.eta.len() - 1);
        if columns.saturating_mul(rows).saturating_add(self.elements.len()) > MOST_CELLS {
            return Err(MeshError(format!(
                "{columns} × {rows} cells are too many, a mesh has at most {MOST_CELLS}; are the sizes too small?"
            )));
        }
        let mut grid = Grid {
            kind: block.kind,
            columns,
            rows,
            nodes: vec![None; (2 * columns + 1) * (2 * rows + 1)],
            cells: vec![None; columns * rows],
        };
        let glue = others.iter().map(|&node| (self.nodes[node].map(f64::to_bits), node)).collect();
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            if !(block.keep)(column, row) {
                continue;
            }
            grid.cells[row * columns + column] = Some((self.elements.len(), (block.diagonal)(column, row)));
            for places in block.cell(column, row) {
                let nodes = places
                    .into_iter()
                    .map(|place| self.node(block, &mut grid, &glue, place))
                    .collect::<Result<_, _>>()?;
                self.elements.push(ElementDefinition { kind: block.kind, part: block.part, nodes });
            }
        }
        Ok(grid)
    }

    /// The node at a place of a block: the grid's, a glued one or a new one.
    fn node(
        &mut self,
        block: &MeshBlock<'_>,
        grid: &mut Grid,
        glue: &HashMap<[u64; 2], usize>,
        place: [usize; 2],
    ) -> Result<usize, MeshError> {
        let index = grid.place(place);
        if let Some(node) = grid.nodes[index] {
            return Ok(node);
        }
        let position = block.position(place);
        if !position.iter().all(|x| x.is_finite()) {
            let ([x, y], [xi, eta]) = (position, [block.xi[place[0] / 2], block.eta[place[1] / 2]]);
            return Err(MeshError(format!("the map of a block gives ({x}, {y}) at ξ = {xi}, η = {eta}")));
        }
        let node = glue.get(&position.map(f64::to_bits)).copied().unwrap_or_else(|| {
            self.nodes.push(position);
            self.nodes.len() - 1
        });
        grid.nodes[index] = Some(node);
        Ok(node)
    }

    /// Adds nodes to a named set, each once.
    pub fn node_set(&mut self, name: &str, nodes: impl IntoIterator<Item = usize>) {
        let set = self.node_sets.entry(name.to_owned()).or_default();
        set.extend(nodes);
        set.sort_unstable();
        set.dedup();
    }

    /// Names a set of edges; it keeps their order.
    pub fn edge_set(&mut self, name: &str, edges: Vec<ElementEdge>) {
        self.edge_sets.insert(name.to_owned(), edges);
    }
}

fn check_divisions(line: char, positions: &[f64]) -> Result<(), MeshError> {
    if positions.len() >= 2 && positions.windows(2).all(|pair| pair[0] < pair[1]) {
        return Ok(());
    }
    let fault = format!("the divisions of a block along {line} must be at least two ascending numbers");
    Err(MeshError(fault))
}
