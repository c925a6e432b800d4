//! The heading instruments of a ship.

pub(crate) mod compass;
pub(crate) mod display;
pub(crate) mod gyro;
pub(crate) mod satellite;
