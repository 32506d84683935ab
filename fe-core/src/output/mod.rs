//! Fields at points and nodes, and the files that hold them.
//!
//! - [`Fields`] is what a model looks like at the end of an increment, plain data; [`Fields::of`] a run's snapshot;
//! - [`Recovery`] brings values from integration points to nodes, part by part;
//! - [`Principal`] are the principal stresses of one point;
//! - [`axial_stress`] is the mean over the cross-sections of a slender part;
//! - [`Series`] writes increments as VTK files, with an index for ParaView.
//!
//! # Equations
//!
//! Recovery. The values v at the n points of an element belong to one polynomial with n terms; its values at the nodes
//! are E v:
//!
//! ```text
//! T3, 1 point         1                                          constant
//! T6, 3 points        1, ξ, η                                    linear
//! Q4 and Q8, 2×2      1, ξ, η, ξη                                bilinear
//! Q8, 3×3             1, ξ, η, ξ², ξη, η², ξ²η, ξη², ξ²η²        biquadratic
//! ```
//!
//! A node's value in a part is the mean over the elements of that part that have the node: never across parts, where
//! stresses jump. A field that is such a polynomial in every element is recovered exactly.
//!
//! Principal stresses in the plane, at the angle θ from x, and the von Mises stress:
//!
//! ```text
//! σ_{1,2} = ½(σ11 + σ22) ± √(¼(σ11 − σ22)² + σ12²)        θ = ½ atan2(2σ12, σ11 − σ22)
//! σ_v = √(½[(σ11 − σ22)² + (σ22 − σ33)² + (σ33 − σ11)²] + 3σ12²)
//! ```
//!
//! # Notes
//!
//! - Extrapolation overshoots where a field has a kink: √3 times the difference of two points. State variables are
//!   therefore limited to the range of their part's points: a damage stays between the least and the greatest one that
//!   the law returned. Stresses and strains are not limited.

mod axial;
mod fields;
mod principal;
mod recovery;
mod series;
mod snapshot;
mod vtu;

pub use axial::axial_stress;
pub use fields::{Activity, ContactPoint, Fields, FieldsError};
pub use principal::Principal;
pub use recovery::Recovery;
pub use series::{Series, SeriesFiles};
pub use snapshot::contact_points;

#[cfg(test)]
mod test;
