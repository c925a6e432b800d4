//! The adjustment of a compass: its correctors, the reading at the berth, the plan and the
//! checks of its steps.
//!
//! Pure: no input or output, no clock, no randomness. Everything here is a
//! function of its arguments. The conventions are those of [`binnacle_compass`].

pub mod binnacle;
pub mod corrector;

pub mod berth;

pub mod adjust;

#[cfg(test)]
use binnacle_compass::ship::{EarthField, ShipMagnetism};
#[cfg(test)]
#[path = "../../compass/src/ship/test_support.rs"]
mod test_support;
