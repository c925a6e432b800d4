//! Batches as bytes, format `sr1`: columns of integers with predictors, and
//! range-coded residuals.
//!
//! `FORMAT.md` in this crate describes every byte. Invariants:
//!
//! - [`encode`] of a batch from [`decode`] gives the same bytes, if `encode`
//!   wrote them.
//! - A decoded value lies within half a step of the one sent.
//! - [`decode`] accepts or refuses any bytes, in time and memory bounded by
//!   [`MAX_BYTES`] and [`MAX_SAMPLES`], and never panics.

pub(crate) mod bits;
mod columns;
mod dense;
mod error;
mod frame;
mod notes;
mod plain;
mod predict;
mod range;
mod rice;
mod step;
mod tally;
#[cfg(test)]
mod tests;

pub use columns::check;
pub use error::{DecodeError, EncodeError};
pub use frame::{MAX_BYTES, MAX_SAMPLES, decode, encode};
