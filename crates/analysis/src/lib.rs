//! Analysis of a vessel's own headings: estimation, change detection, the whole analysis of
//! a compass, and advice on what to sail next.
//!
//! Pure: no input or output, no clock, no randomness. Everything here is a function of its
//! arguments, so that an analysis can be repeated to the byte. The conventions are those of
//! [`binnacle_compass`].

pub mod gyro_speed_error;
mod observation;
mod robust_scale;

pub mod estimate;
pub mod fit;

pub mod fleet_prior;

pub mod change;

pub mod analyse;

pub mod advice;
