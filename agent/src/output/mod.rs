//! Output to the bridge: the corrected heading and the alarm as NMEA 0183 sentences, over
//! TCP, UDP and serial ports.

mod alarm_sentence;
mod framing;
mod heading_sentences;
mod outputs;

pub(crate) use alarm_sentence::AlarmSentence;
pub(crate) use heading_sentences::{HeadingSentences, Quality};
pub(crate) use outputs::Outputs;
