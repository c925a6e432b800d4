//! Fits of a vessel's magnetism to her own headings, the fleet's prior, the samples of a compass
//! made ready for tracking, and advice on what to sail next.
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

pub mod readings;

pub mod advice;
