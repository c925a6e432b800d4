//! Output to the bridge: the corrected heading and the alerts as NMEA 0183 sentences, over TCP, UDP,
//! IEC 61162-450 and serial ports, and the heading on NMEA 2000 and to Signal K, over the
//! connections of inputs.
//!
//! Invariants:
//!
//! - While the heading is withheld, no sentence can be read as one.
//! - No receiver can block the sender, and none gets an old heading after a new one.
//! - No clock is read for a sentence: its time is an argument.

pub mod config;

mod framing;
mod line;

mod heading;
mod heading_sentences;

mod alert_sentences;
mod condition;
mod managed_alert;

mod bridge_commands;
mod datagrams;
mod open_error;
mod outputs;
mod serial_line;
mod tcp_clients;

mod n2k;
mod shared_outputs;
mod signalk;

pub use alert_sentences::{AlertConditions, AlertSentences};
pub use condition::AlertCondition;
pub use framing::frame_sentence;
pub use heading::{Heading, Trigger};
pub use heading_sentences::{HeadingSentences, Quality};
pub use line::Line;
pub use n2k::OwnDevice;
pub use open_error::OpenError;
pub use outputs::Outputs;
pub use shared_outputs::SharedOutputs;
