//! What the agent and the server say to each other.
//!
//! Samples go up as binary [`batch`]es, immutable once sealed, in the frame of
//! [`codec`], with the [`reasons`] why windows were refused and the [`alert`]s that
//! the ship raised herself, cut into [`burst`]s where a link takes no more; enrolment,
//! acknowledgement, models, [`settings`] and reports for the [`logbook`] are the
//! JSON [`messages`].

pub mod alert;
pub mod batch;
pub mod burst;
pub mod codec;
pub mod logbook;
pub mod messages;
pub mod reasons;
pub mod settings;

pub use codec::{DecodeError, EncodeError, decode, encode};
