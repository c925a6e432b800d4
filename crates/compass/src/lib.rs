//! The words and the physics that every part of Binnacle shares: angles, time and place,
//! the earth's field, the deviation of a ship's compass, and what an analysis reads and finds.
//!
//! Pure: no input or output, no clock, no randomness. Everything here is a
//! function of its arguments, so that an analysis can be repeated to the byte.
//!
//! Conventions, everywhere (they are those of the compass adjuster's handbooks):
//! angles run clockwise from north; `true = magnetic + variation` and
//! `magnetic = compass + deviation`, both east-positive; fields are in
//! nanotesla; ship axes are x forward, y starboard, z down.

pub mod number;

pub mod angle;
pub mod position;
pub mod time;

pub mod model;
pub mod sample;

pub mod ship;

pub mod deviation;
pub mod field;

pub mod coverage;
pub mod logbook;
pub mod settings;

pub mod result;
