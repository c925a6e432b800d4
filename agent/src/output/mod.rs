//! Output to the bridge: the corrected heading and the alerts as NMEA 0183 sentences, over TCP, UDP,
//! IEC 61162-450 and serial ports.

mod alarm_sentence;
mod alert_sentences;
mod framing;
mod heading_sentences;
mod line;
mod managed_alert;

mod bridge_commands;
mod datagrams;
mod outputs;
mod serial_line;
mod tcp_clients;

pub(crate) use alarm_sentence::AlarmSentence;
pub(crate) use alert_sentences::{AlertConditions, AlertSentences};
pub(crate) use heading_sentences::{HeadingSentences, Quality, Trigger};
pub(crate) use line::Line;
pub(crate) use outputs::Outputs;
