//! The instruments' output as NMEA 0183 sentences.

mod calendar;
mod sentences;
mod talker;

pub use talker::Talker;
