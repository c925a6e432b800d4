//! State-space model of a sound ship, her compass, her references and the field around them.

pub(crate) mod arrays;
pub(crate) mod filter;
pub(crate) mod levels;
pub(crate) mod retained;
pub(crate) mod row;
pub(crate) mod scalar;
pub(crate) mod ship_state;
pub(crate) mod states;
pub(crate) mod transition;
