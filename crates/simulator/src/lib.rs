//! Ships, voyages and instruments that speak NMEA: for the demonstration, the
//! tests and the benchmarks.
//!
//! A ship here is what the estimator is to find out about, so nothing of the
//! estimator is used: Poisson's equations are solved by the simulator's own
//! code, and only angles, places, times and the earth's field are shared.
//! The same scenario and seed give the same bytes.

pub mod scenario;

pub mod ship;
pub mod talk;
pub mod truth;

pub mod poisson;

mod calendar;
mod compass;
mod earth;
mod gyro;
mod motion;
mod passage;
mod process;
mod random;
mod rhumb;
mod satellite;
mod sentences;
mod variation;
