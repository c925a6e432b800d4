//! What the agent and the server say to each other.
//!
//! Samples go up as binary [`batch`]es, immutable once sealed, in the frame of
//! [`codec`], with the [`reasons`] why windows were refused and the [`alert`]s that
//! the ship raised herself, cut into [`burst`]s where a link takes no more.
//! Acknowledgements and models come down as a compact [`downlink`], or to older agents,
//! like enrolment, [`settings`] and reports for the [`logbook`], as the JSON
//! [`messages`].

pub mod alert;
pub mod batch;
pub mod burst;
pub mod codec;
pub mod downlink;
pub mod logbook;
pub mod messages;
pub mod reasons;
pub mod settings;

pub use codec::{DecodeError, EncodeError, decode, encode};
