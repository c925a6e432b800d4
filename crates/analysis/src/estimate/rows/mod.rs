//! Observations as rows of a linear problem.

mod direction;
mod needle;
mod row;
mod scatter;

pub use direction::Direction;
pub use needle::Needle;
pub(crate) use row::{
    CONSTANT, LinearisationPoint, Row, RowFrame, UNKNOWNS, USUAL_REFERENCE_SHARE, Unknowns, frames,
    plain_residual, row, to_physical_units,
};
pub use scatter::{Scatter, WhiteNoise};
