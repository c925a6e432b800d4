//! The magnetism of ships: the earth's field, deviation, and what a ship's own
//! headings tell about her magnetism.
//!
//! Pure: no input or output, no clock, no randomness. Everything here is a
//! function of its arguments, so that an analysis can be repeated to the byte.
//!
//! Conventions, everywhere (they are those of the compass adjuster's handbooks):
//! angles run clockwise from north; `true = magnetic + variation` and
//! `magnetic = compass + deviation`, both east-positive; fields are in
//! nanotesla; ship axes are x forward, y starboard, z down.

pub mod angle;
pub mod position;
pub mod time;

pub mod model;
pub mod sample;

pub mod field;

pub mod deviation;
pub mod handbook;
pub mod ship;

pub mod binnacle;
pub mod corrector;

pub mod adjust;
pub mod advice;
pub mod analyse;
pub mod berth;
pub mod change;
pub mod coverage;
pub mod estimate;
pub mod fit;
