//! The protocol between agent and server.
//!
//! Samples go up as binary [`batch`]es, immutable once sealed, in the frame of
//! [`codec`]. They carry the [`reasons`] why windows were refused and the
//! [`alert`]s raised on board. A link with small messages carries them as
//! [`burst`]s. Acknowledgements and models come down as a compact [`downlink`],
//! or as JSON to older agents. Enrolment, [`settings`], reports for the
//! [`logbook`] and [`azimuth`]s are JSON [`messages`].

pub mod alert;
pub mod azimuth;
pub mod batch;
pub mod burst;
pub mod codec;
pub mod downlink;
pub mod logbook;
pub mod messages;
pub mod reasons;
pub mod settings;

pub use codec::{DecodeError, EncodeError, decode, encode};
