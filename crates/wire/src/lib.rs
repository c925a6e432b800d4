//! What the agent and the server say to each other.
//!
//! Samples go up as binary [`batch`]es, immutable once sealed; enrolment,
//! acknowledgement, models and settings are the JSON [`messages`].

pub mod batch;
pub mod messages;
