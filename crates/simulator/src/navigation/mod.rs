//! Navigation of a ship: its orders, its motion, and rhumb lines.

pub(crate) mod motion;
pub(crate) mod passage;
pub(crate) mod rhumb;
