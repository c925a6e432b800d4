//! Observations as rows of a linear problem.

mod direction;
mod needle;
mod row;
mod scatter;

pub(crate) use direction::Direction;
pub(crate) use needle::Needle;
pub(crate) use row::{
    CONSTANT, OFFSET_SD_DEG, Point, Row, Station, UNKNOWNS, USUAL_FUSION, Unknowns, in_own_units,
    plain_residual, row, stations,
};
pub(crate) use scatter::White;
