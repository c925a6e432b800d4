//! Shared vocabulary and physics: angles, time and place, the earth's field, the deviation
//! of a ship's compass, its error by the sun, and the input and result of an analysis.
//!
//! Pure: no input or output, no clock, no randomness. Every function depends on its
//! arguments alone, so an analysis can be repeated to the byte.
//!
//! Conventions, as in the compass adjuster's handbooks:
//! angles run clockwise from north; `true = magnetic + variation` and
//! `magnetic = compass + deviation`, both east-positive; fields are in
//! nanotesla; ship axes are x forward, y starboard, z down.

pub mod number;

pub mod angle;
pub mod position;
pub mod time;

pub mod model;
pub mod sample;
pub mod segment;

pub mod ship;

pub mod deviation;
pub mod field;

pub mod azimuth;

pub mod coverage;
pub mod logbook;
pub mod settings;

pub mod result;

#[cfg(feature = "openapi")]
pub mod openapi;
