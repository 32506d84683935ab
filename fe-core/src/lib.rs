//! Two-dimensional finite elements in plane stress, plane strain and axial symmetry.
//!
//! Units N, mm, MPa; tension positive; (x, y), which is (r, z) in axial symmetry. What is here is complete and tested
//! in itself, and knows no constitutive law, no plugin and no case file:
//!
//! - [`element`]: the reference elements T3, T6, Q4 and Q8, their edges, their integration rules, the isoparametric
//!   map and the characteristic length that a UMAT receives as `CELENT`;
//! - [`kinematics`]: small strains from nodal displacements, B-bar for Q4, nodal forces from stresses, the volume of a point;
//! - [`mesh`]: nodes, elements, parts and named sets, checked as a whole; neighbours and boundaries.
//!

//!
//! Everything in code is counted from 0. Messages, the pictures of the elements and the arguments `NOEL` and `NPT` of
//! a UMAT count from 1, as users do.
//!
//! # Example
//!
//! ```
//! use fe_core::element::ElementKind;
//! use fe_core::kinematics::PlaneModel;
//! use fe_core::mesh::{ElementDefinition, Mesh, MeshDefinition, Part};
//!
//! let mesh = Mesh::new(MeshDefinition {
//!     nodes: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]],
//!     parts: vec![Part::new("matrix", PlaneModel::PlaneStrain, 3.26)],
//!     elements: vec![ElementDefinition { kind: ElementKind::Q4, part: 0, nodes: vec![0, 1, 2, 3] }],
//!     ..MeshDefinition::default()
//! })?;
//! assert_eq!(mesh.element_area(0), 2.0);
//! assert_eq!(mesh.boundary_edges().count(), 4);
//! # Ok::<(), fe_core::mesh::MeshError>(())
//! ```

pub mod assembly;
pub mod contact;
pub mod element;
pub mod kinematics;
pub mod mesh;
pub mod model;
pub mod output;
pub mod solver;
pub mod stepping;
