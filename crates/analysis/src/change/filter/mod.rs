//! Kalman filter of the detector.

mod covariance;
mod kalman;
mod measurement;
mod noise;
mod states;

pub(crate) use kalman::Filter;
pub(crate) use measurement::{Measurement, measurement};
pub(crate) use noise::{NoiseVariances, TransientNoise};
pub(crate) use states::{CONSTANT_STATE, OFFSET, STATES, VARIATION};
