//! Simulated ships, voyages and instruments with NMEA output, for the
//! demonstration, the tests and the benchmarks.
//!
//! The estimator is tested on these ships, so none of its code is used. The
//! simulator solves Poisson's equations with its own code, and shares only
//! angles, places, times and the earth's field. The same scenario and seed give
//! the same bytes.

pub mod scenario;

pub mod nmea;
pub mod ship;
pub mod truth;

pub mod poisson;

mod earth;
mod instruments;
mod local_field;
mod navigation;
mod random;
