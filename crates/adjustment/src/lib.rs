//! Adjustment of a magnetic compass: correctors, berth readings, plans, and checks of their
//! steps.
//!
//! Pure: no input or output, no clock, no randomness. Every function depends on its
//! arguments alone. The conventions are those of [`binnacle_compass`].

pub mod binnacle;
pub mod corrector;

pub mod berth;

pub mod adjust;

#[cfg(feature = "openapi")]
pub mod openapi;

#[cfg(test)]
use binnacle_compass::ship::{EarthField, ShipMagnetism};
#[cfg(test)]
#[path = "../../compass/src/ship/test_support.rs"]
mod test_support;
