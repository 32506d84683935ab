//! From points to equations: solids evaluated element by element, constraints eliminated, blocks added to a pattern
//! that is found once.

mod equations;
mod far_field;
pub mod loads;
pub mod solids;
mod system;
mod trouble;

pub use equations::Equations;
pub(crate) use far_field::may_be_condensed;
pub use far_field::touching;
pub(crate) use loads::loaded_freedoms;
pub use solids::{GreatestInPart, Solids};
pub(crate) use system::Factor;
pub use system::{Condensation, System, SystemState};
pub use trouble::{Location, PointFailure};
pub(crate) use trouble::{Setback, USUAL_FRACTION};
