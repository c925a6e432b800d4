//! Ports as orders name them.

use binnacle_platform::time::Time;
use binnacle_schedule::ports::{self, Port};
use binnacle_schedule::time::Instant;
use binnacle_schedule::zone::Zone;
use chrono::NaiveDate;

/// Port that an order names: by its code, alone or behind its name, or by its name.
pub fn named_port(words: &str) -> Option<&'static Port> {
    // A name shared by several ports is ambiguous.
    match ports::named(words)[..] {
        [port] => Some(port),
        _ => None,
    }
}

/// Key of a port, however its name is written: its code if it is known.
pub(super) fn place(words: &str) -> String {
    named_port(words).map_or_else(|| words.trim().to_lowercase(), |port| port.code.to_string())
}

/// Legal time of a port, however its name is written; UTC for an unknown one.
pub(super) fn zone(words: &str) -> Zone {
    named_port(words).map_or_else(Zone::utc, |port| port.zone)
}

/// Day of an instant in a port's time.
pub(super) fn day(words: &str, at: Time) -> NaiveDate {
    Instant(at.0).date(zone(words))
}
