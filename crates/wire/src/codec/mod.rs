//! Batches as bytes: `sr1`, columns of integers with predictors, what they miss range-coded.
//!
//! `FORMAT.md` beside this crate has every byte. What always holds:
//!
//! - [`encode`] of what [`decode`] gave is the same bytes, if `encode` wrote them.
//! - A value comes back within half a step of what was sent.
//! - [`decode`] takes any bytes: it answers or refuses, in time and memory
//!   bounded by [`MAX_BYTES`] and [`MAX_SAMPLES`], and never panics.

pub(crate) mod bits;
mod columns;
mod dense;
mod error;
mod frame;
mod notes;
mod predict;
mod range;
mod rice;
mod stack;
mod step;
mod tally;
#[cfg(test)]
mod tests;

pub use columns::check;
pub use error::{DecodeError, EncodeError};
pub use frame::{MAX_BYTES, MAX_SAMPLES, decode, encode};
