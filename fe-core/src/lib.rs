//! Two-dimensional finite elements in plane stress, plane strain and axial symmetry.
//!
//! Units N, mm, MPa; tension positive; (x, y), which is (r, z) in axial symmetry. Materials and interfaces are plugins
//! with the UMAT, UINTER and FRIC interfaces ([`model::PluginLaw`]); no law is built in. In the order of one increment:
//!
//! - [`mesh`]: nodes, elements, parts and named sets, checked as a whole; structured meshes, specimens, Gmsh files,
//!   pre-flight checks;
//! - [`element`]: the reference elements T3, T6, Q4 and Q8, their edges, integration rules and the isoparametric map;
//! - [`kinematics`]: small strains, B-bar, and the updated-Lagrangian increment of large displacements;
//! - [`assembly`]: all material points through their UMATs, loads, constraints, the system of equations, the condensed
//!   far field;
//! - `field`: temperature, or the phase field of a law, on the nodes;
//! - [`contact`]: points of one surface on another, their laws and how these are enforced;
//! - [`solver`]: sparse direct solution with reused analyses and checked residuals;
//! - [`stepping`]: Newton, automatic increments, indirect control, energies ([`stepping::Analysis`] runs a
//!   [`model::Model`]), by one thread or several ([`threads`]);
//! - [`output`]: fields at nodes, VTK files.
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
mod field;
pub mod kinematics;
pub mod mesh;
pub mod model;
pub mod output;
mod plane;
pub mod schema;
pub mod solver;
pub mod stepping;
pub mod threads;
