//! Plans of voyages, and the events on them.

use super::habits::Habits;
use super::incidents::Incident;
use super::{Faults, Variety};
use binnacle_compass::time::Timestamp;

/// Event that happens once, after the first weeks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Event {
    Nothing,
    /// A step of (bx, by) of this size in nT in any direction, at sea.
    Step(f64),
    /// A step of this size, this many degrees from the needle's direction at that time.
    StepBy(f64, f64),
    /// A step in any direction, of which a third decays over weeks.
    Lightning(f64),
    /// All seven parameters, from a port call to the one after the next.
    Cargo,
    /// Change like that of cargo, for good and without a logbook entry.
    Refit,
    /// The gyro steps by so many degrees, for some days.
    GyroFault(f64),
    /// A magnet of so many nT comes near the compass at sea, and is taken away again
    /// after an hour and a half to three.
    Magnet(f64),
    /// The variation is off by so many degrees for as long.
    VariationError(f64),
    /// (bx, by) grow by so many nT in any direction, evenly over so many days.
    Ramp(f64, f64),
}

/// Plan of a voyage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    pub(crate) variety: Variety,
    pub(crate) days: f64,
    /// The event is in the week after this day.
    pub(crate) event_day: f64,
    pub(crate) event: Event,
    /// A month.
    pub(crate) anomalies: f64,
    /// A year.
    pub(crate) gyro_faults: f64,
    /// The sun's seed, if ships of one seed are to meet the same storms.
    pub(crate) sun: Option<u64>,
    pub(crate) faults: Faults,
    pub(crate) habits: Habits,
    /// In the week after the event's day, too.
    pub(crate) incident: Incident,
}

impl Plan {
    pub(crate) fn new(event: Event, variety: Variety) -> Plan {
        Plan {
            variety,
            days: 100.0,
            event_day: 60.0,
            event,
            anomalies: 1.0,
            gyro_faults: 1.0,
            sun: None,
            faults: Faults {
                satellite: true,
                ..Faults::USUAL
            },
            habits: Habits::default(),
            incident: Incident::Nothing,
        }
    }
}

/// An event that happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Happened {
    pub(crate) what: Name,
    pub(crate) from: Timestamp,
    pub(crate) to: Option<Timestamp>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Name {
    Step,
    Lightning,
    Cargo,
    Refit,
    GyroFault,
    Brief,
    Ramp,
    Storm,
    Anomaly,
    ZeroMoved,
    Jam,
    Settling,
    GyroRamp,
    DryDock,
}
