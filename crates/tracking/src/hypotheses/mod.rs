//! Hypotheses of what happened to a ship and her instruments.

pub(crate) mod hypothesis;
pub(crate) mod kinds;
pub(crate) mod starts;
