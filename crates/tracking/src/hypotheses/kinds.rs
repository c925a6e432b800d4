//! The table of events: how often each kind happens, what it moves, and how it ends.

use crate::constants::{DAY_S, HOUR_S};
use crate::state_space::row::{Row, USUAL_KN};
use crate::state_space::states::{ALIGNMENT, ANOMALY, BX, BY, GROWTH, GYRO, SATELLITE, SETTLING};
use binnacle_analysis::estimate::POPULATION_SD;
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::ship::PARAMETERS;
use serde::{Deserialize, Serialize};

/// Kind of event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum Kind {
    /// Step of the ship's permanent magnetism.
    Strike,
    /// Step of all of the ship's magnetism in port.
    Cargo,
    /// Moved zero of the compass.
    Alignment,
    /// Steady growth of the ship's permanent magnetism.
    ShipDrift,
    /// Offset of the gyro.
    GyroStep,
    /// Offset of the satellite compass.
    SatelliteStep,
    /// Error of the gyro that dies away within hours.
    GyroSettling,
    /// Steady growth of the gyro's error.
    GyroRamp,
    /// Magnetic storm.
    Storm,
    /// Severe magnetic storm.
    SevereStorm,
    /// Local anomaly of the crust.
    Anomaly,
    /// Card that stands still, or swings by itself.
    FailedCard,
    /// Gyro that stands still, or shows any heading.
    FailedGyro,
    /// Satellite compass that stands still, or shows any heading.
    FailedSatellite,
    /// Step of the field at the compass that is gone within hours: steel or a current near it.
    Deflection,
}

/// State that an event moves, with the standard deviation of its jump.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jump {
    pub(crate) state: usize,
    pub(crate) sd: f64,
}

/// Way in which an event ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ending {
    /// It is for good.
    Never,
    /// After some time, seconds in the mean; what it moved returns.
    After(f64),
    /// After some distance, nautical miles in the mean; what it moved returns.
    AfterMiles(f64),
    /// At a port call, with some probability at the first, and a share of the one before at each
    /// later: what was not discharged may be there to stay. What it moved returns.
    InPort { first: f64, later: f64 },
}

/// Course of what an event moves while it lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Course {
    /// It stays as it is.
    Still,
    /// The ship's permanent magnetism grows steadily.
    Growing,
    /// The gyro's error wanders off, degrees squared a second.
    Wandering(f64),
    /// The variation is disturbed: standard deviation in degrees where H is usual, and memory in
    /// seconds.
    Storming { sd_deg: f64, memory_s: f64 },
    /// The variation changes smoothly as the ship passes: the same.
    Passing { sd_deg: f64, memory_s: f64 },
}

impl Ending {
    /// Returns the logarithm of the probability that an event lasts for longer than a stay, and
    /// the rate at which it ends then. Durations have the Erlang distribution of shape 2: few
    /// events end at once, and few last for many times the mean.
    fn duration(self, lasted: Stay) -> Option<Survival> {
        let (mean, lasted) = match self {
            Ending::After(mean_s) => (mean_s, lasted.seconds),
            Ending::AfterMiles(mean_nm) => (mean_nm, lasted.miles),
            Ending::Never | Ending::InPort { .. } => return None,
        };
        let rate = 2.0 / mean;
        let periods = rate * lasted.max(0.0);
        Some(Survival {
            log_probability: periods.ln_1p() - periods,
            rate: rate * periods / (1.0 + periods),
        })
    }

    /// Returns the logarithm of the probability that an event which has lasted so long goes on
    /// until some later stay.
    pub(crate) fn log_survival(self, before: Stay, after: Stay) -> f64 {
        let at = |stay| self.duration(stay).map_or(0.0, |s| s.log_probability);
        let calls = (before.calls + 1)..=after.calls;
        let stays = calls.map(|call| (1.0 - self.probability_at_call(call)).ln());
        at(after) - at(before) + stays.sum::<f64>()
    }

    /// Returns the probability that an event ends at a port call, counted from its beginning.
    pub(crate) fn probability_at_call(self, call: u32) -> f64 {
        match self {
            Ending::InPort { first, later } => first * later.powi(call.cast_signed() - 1),
            _ => 0.0,
        }
    }

    /// Returns the probability that an event which has lasted so long ended within the step
    /// before.
    pub(crate) fn probability(self, lasted: Stay, step: Stay) -> f64 {
        let within = match self {
            Ending::AfterMiles(_) => step.miles,
            _ => step.seconds,
        };
        let rate = self.duration(lasted).map_or(0.0, |s| s.rate);
        (rate * within).min(0.5)
    }
}

/// Time, distance and port calls since an event began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stay {
    pub(crate) seconds: f64,
    pub(crate) miles: f64,
    pub(crate) calls: u32,
}

/// Share of events that last for longer, and the rate at which they end.
#[derive(Clone, Copy, Debug)]
struct Survival {
    log_probability: f64,
    rate: f64,
}

/// Row of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KindRow {
    pub(crate) kind: Kind,
    /// Events a year at sea.
    pub(crate) a_year: f64,
    /// Events a port call, beside those of its time.
    pub(crate) a_call: f64,
    pub(crate) jumps: &'static [Jump],
    pub(crate) ending: Ending,
    pub(crate) course: Course,
    /// Size of the compass's errors in it, degrees where H is usual: the largest storms on record
    /// come to about eight, a damaged card moves by any number.
    pub(crate) error_deg: f64,
}

const fn jump(state: usize, sd: f64) -> Jump {
    Jump { state, sd }
}

/// Growth of a drifting ship's (bx, by) a day, in units of the population: 2 µT in thirty days.
const GROWTH_SD: f64 = 2000.0 / POPULATION_SD[BX] / 30.0;
const YEAR_S: f64 = 365.25 * DAY_S;

/// Jumps by work that leaves the soft iron, in units of the population.
pub(crate) const WORK: [Jump; PARAMETERS] = [
    jump(BX, 1.0),
    jump(1, 0.4),
    jump(BY, 1.0),
    jump(3, 0.4),
    jump(4, 0.4),
    jump(5, 0.4),
    jump(6, 0.4),
];
/// Jump by work on the compass beside that of all of the ship's magnetism, degrees.
pub(crate) const REALIGNMENT: Jump = jump(ALIGNMENT, 2.0);

/// All kinds. Storms are those of the Kp indices 7 and 9 (ranges in three hours by the K index of
/// Niemegk).
pub(crate) const KINDS: [KindRow; 15] = [
    KindRow {
        kind: Kind::Strike,
        a_year: 1.0,
        a_call: 0.002,
        jumps: &[
            jump(BX, 1.2),
            jump(BY, 1.2),
            jump(4, 0.05),
            jump(5, 0.05),
            jump(6, 0.05),
        ],
        ending: Ending::InPort {
            first: 0.02,
            later: 0.7,
        },
        course: Course::Still,
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::Cargo,
        a_year: 0.0,
        a_call: 0.02,
        jumps: &[
            jump(BX, 0.5),
            jump(1, 0.4),
            jump(BY, 0.5),
            jump(3, 0.4),
            jump(4, 0.4),
            jump(5, 0.4),
            jump(6, 0.4),
        ],
        ending: Ending::InPort {
            first: 0.3,
            later: 0.7,
        },
        course: Course::Still,
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::Alignment,
        a_year: 0.05,
        a_call: 0.002,
        jumps: &[jump(ALIGNMENT, 6.0)],
        ending: Ending::Never,
        course: Course::Still,
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::ShipDrift,
        a_year: 0.2,
        a_call: 0.0,
        jumps: &[jump(GROWTH, GROWTH_SD), jump(GROWTH + 1, GROWTH_SD)],
        ending: Ending::After(40.0 * DAY_S),
        course: Course::Growing,
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::GyroStep,
        a_year: 0.5,
        a_call: 0.005,
        jumps: &[jump(GYRO, 6.0)],
        ending: Ending::After(3.0 * DAY_S),
        course: Course::Still,
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::SatelliteStep,
        a_year: 0.2,
        a_call: 0.005,
        jumps: &[jump(SATELLITE, 6.0)],
        ending: Ending::After(3.0 * DAY_S),
        course: Course::Still,
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::GyroSettling,
        a_year: 0.5,
        a_call: 0.01,
        jumps: &[jump(SETTLING, 3.0)],
        ending: Ending::Never,
        course: Course::Still,
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::GyroRamp,
        a_year: 0.1,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(6.0 * DAY_S),
        course: Course::Wandering(1.0 / DAY_S),
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::Storm,
        a_year: 6.0,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(8.0 * HOUR_S),
        course: Course::Storming {
            sd_deg: 0.9,
            memory_s: HOUR_S,
        },
        error_deg: 5.0,
    },
    KindRow {
        kind: Kind::SevereStorm,
        a_year: 2.0,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(8.0 * HOUR_S),
        course: Course::Storming {
            sd_deg: 2.0,
            memory_s: HOUR_S,
        },
        error_deg: 5.0,
    },
    KindRow {
        kind: Kind::Anomaly,
        a_year: 10.0,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::AfterMiles(25.0),
        course: Course::Passing {
            sd_deg: 2.5,
            memory_s: 4500.0,
        },
        error_deg: 6.0,
    },
    KindRow {
        kind: Kind::FailedCard,
        a_year: 0.1,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(DAY_S),
        course: Course::Still,
        error_deg: 10.0,
    },
    KindRow {
        kind: Kind::FailedGyro,
        a_year: 0.1,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(DAY_S),
        course: Course::Still,
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::FailedSatellite,
        a_year: 0.1,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(DAY_S),
        course: Course::Still,
        error_deg: f64::INFINITY,
    },
    KindRow {
        kind: Kind::Deflection,
        a_year: 0.05,
        a_call: 0.0,
        jumps: &[jump(BX, 1.2), jump(BY, 1.2)],
        ending: Ending::After(3.0 * HOUR_S),
        course: Course::Still,
        error_deg: f64::INFINITY,
    },
];

impl KindRow {
    /// Returns the probability that an event began within some seconds, with a port call or
    /// without, and has not ended since.
    pub(crate) fn probability(&self, seconds: f64, in_port: bool) -> f64 {
        let longest_s = match self.ending {
            Ending::Never | Ending::InPort { .. } => f64::INFINITY,
            Ending::After(mean_s) => mean_s,
            Ending::AfterMiles(mean_nm) => HOUR_S * mean_nm / USUAL_KN,
        };
        let of_time = self.a_year * seconds.min(longest_s) / YEAR_S;
        of_time + if in_port { self.a_call } else { 0.0 }
    }
}

impl Row {
    /// Returns the reading of the instrument that fails in such an event.
    pub(crate) fn shown_deg(&self, kind: Kind) -> Option<f64> {
        match kind {
            Kind::FailedCard => Some(self.compass_deg),
            Kind::FailedGyro => self.gyro_deg.map(|deg| deg + self.variation_deg),
            Kind::FailedSatellite => self.satellite_deg.map(|deg| deg + self.variation_deg),
            _ => None,
        }
    }
}

impl Kind {
    /// Returns the kind's row of the table.
    pub(crate) fn row(self) -> &'static KindRow {
        &KINDS[self as usize]
    }

    /// Returns true for a disturbance of the earth's own field.
    pub(crate) fn passes_by(self) -> bool {
        matches!(self, Kind::Storm | Kind::SevereStorm | Kind::Anomaly)
    }

    /// Returns true for an event that moves something at once.
    pub(crate) fn is_sudden(self) -> bool {
        !self.row().jumps.is_empty() && self != Kind::ShipDrift
    }

    /// Returns the seconds within which such an event can be dated: what grows is seen when it is
    /// large.
    pub(crate) fn dated_within_s(self) -> f64 {
        match self {
            Kind::ShipDrift => 10.0 * DAY_S,
            _ => DAY_S,
        }
    }

    /// Returns true for an event whose end shows in one row: that is looked for after each.
    pub(crate) fn ends_at_once(self) -> bool {
        self.is_sudden() || self.is_failed()
    }

    /// Returns true for an event that moves a reference.
    pub(crate) fn moves_a_reference(self) -> bool {
        let mut jumps = self.row().jumps.iter();
        jumps.any(|jump| [GYRO, SATELLITE, SETTLING].contains(&jump.state))
    }

    /// Returns true for an instrument that says nothing.
    pub(crate) fn is_failed(self) -> bool {
        matches!(
            self,
            Kind::FailedCard | Kind::FailedGyro | Kind::FailedSatellite
        )
    }

    /// Returns true for an event that can happen to a ship with the references of a row. Whatever
    /// passes by within hours is a current to a ship that has her course alone.
    pub(crate) fn can_happen(self, row: &Row) -> bool {
        match self {
            Kind::GyroStep | Kind::GyroSettling | Kind::GyroRamp | Kind::FailedGyro => {
                row.gyro_deg.is_some()
            }
            Kind::SatelliteStep | Kind::FailedSatellite => row.satellite_deg.is_some(),
            Kind::Storm | Kind::SevereStorm | Kind::Anomaly | Kind::Deflection => {
                row.course.is_none()
            }
            Kind::Strike | Kind::Cargo | Kind::Alignment | Kind::ShipDrift | Kind::FailedCard => {
                true
            }
        }
    }

    /// Returns true for an event that leaves another deviation.
    pub(crate) fn changes_deviation(self) -> bool {
        matches!(
            self,
            Kind::Strike | Kind::Cargo | Kind::Alignment | Kind::ShipDrift | Kind::Deflection
        )
    }

    /// Returns the probability that a logbook entry of some kind tells of such an event.
    pub(crate) fn beside(self, entry: LogbookKind) -> Option<f64> {
        match (self, entry) {
            (Kind::Strike, LogbookKind::Lightning | LogbookKind::Shock) => Some(0.3),
            (Kind::Cargo, LogbookKind::MagneticCargo) => Some(0.7),
            (Kind::ShipDrift, entry) if entry.preserves_soft_iron() => Some(0.5),
            _ => None,
        }
    }

    /// Returns the states that the end of such an event sets back.
    pub(crate) fn returning_states(self) -> Vec<usize> {
        match self {
            Kind::Strike | Kind::Cargo | Kind::Deflection => (0..PARAMETERS).collect(),
            Kind::GyroStep | Kind::GyroRamp => vec![GYRO],
            Kind::SatelliteStep => vec![SATELLITE],
            Kind::Anomaly => vec![ANOMALY, ANOMALY + 1],
            Kind::ShipDrift => vec![GROWTH, GROWTH + 1],
            _ => Vec::new(),
        }
    }
}
