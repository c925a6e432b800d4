//! The table of events: how often each kind happens, what it moves, and how it ends.

use crate::state_space::row::Row;
use crate::state_space::states::{ALIGNMENT, ANOMALY, BX, BY, GYRO, SATELLITE, SETTLING};
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::ship::PARAMETERS;

/// Kind of event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
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
    /// Local anomaly of the crust.
    Anomaly,
    /// Card that does not turn.
    StuckCard,
    /// Gyro that says nothing.
    StuckGyro,
    /// Satellite compass that says nothing.
    StuckSatellite,
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
    /// At a port call, with this probability; what it moved returns.
    InPort(f64),
}

/// Row of the table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KindRow {
    pub(crate) kind: Kind,
    /// Events a year at sea.
    pub(crate) a_year: f64,
    /// Events a port call.
    pub(crate) a_call: f64,
    pub(crate) jumps: &'static [Jump],
    pub(crate) ending: Ending,
}

const fn jump(state: usize, sd: f64) -> Jump {
    Jump { state, sd }
}

const HOUR_S: f64 = 3600.0;
const DAY_S: f64 = 86_400.0;

/// All kinds.
pub(crate) const KINDS: [KindRow; 13] = [
    KindRow {
        kind: Kind::Strike,
        a_year: 0.5,
        a_call: 0.002,
        jumps: &[
            jump(BX, 2.0),
            jump(BY, 2.0),
            jump(4, 0.1),
            jump(5, 0.1),
            jump(6, 0.1),
        ],
        ending: Ending::InPort(0.02),
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
        ending: Ending::InPort(0.3),
    },
    KindRow {
        kind: Kind::Alignment,
        a_year: 0.05,
        a_call: 0.002,
        jumps: &[jump(ALIGNMENT, 6.0)],
        ending: Ending::Never,
    },
    KindRow {
        kind: Kind::ShipDrift,
        a_year: 0.2,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(40.0 * DAY_S),
    },
    KindRow {
        kind: Kind::GyroStep,
        a_year: 0.5,
        a_call: 0.005,
        jumps: &[jump(GYRO, 4.0)],
        ending: Ending::After(3.0 * DAY_S),
    },
    KindRow {
        kind: Kind::SatelliteStep,
        a_year: 0.2,
        a_call: 0.005,
        jumps: &[jump(SATELLITE, 4.0)],
        ending: Ending::After(3.0 * DAY_S),
    },
    KindRow {
        kind: Kind::GyroSettling,
        a_year: 0.5,
        a_call: 0.01,
        jumps: &[jump(SETTLING, 3.0)],
        ending: Ending::Never,
    },
    KindRow {
        kind: Kind::GyroRamp,
        a_year: 0.1,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(6.0 * DAY_S),
    },
    KindRow {
        kind: Kind::Storm,
        a_year: 8.0,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(8.0 * HOUR_S),
    },
    KindRow {
        kind: Kind::Anomaly,
        a_year: 10.0,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(2.0 * HOUR_S),
    },
    KindRow {
        kind: Kind::StuckCard,
        a_year: 0.1,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(DAY_S),
    },
    KindRow {
        kind: Kind::StuckGyro,
        a_year: 0.1,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(DAY_S),
    },
    KindRow {
        kind: Kind::StuckSatellite,
        a_year: 0.1,
        a_call: 0.0,
        jumps: &[],
        ending: Ending::After(DAY_S),
    },
];

impl Row {
    /// Returns the reading of the instrument that is stuck in such an event.
    pub(crate) fn shown_deg(&self, kind: Kind) -> Option<f64> {
        match kind {
            Kind::StuckCard => Some(self.compass_deg),
            Kind::StuckGyro => self.gyro_deg.map(|deg| deg + self.variation_deg),
            Kind::StuckSatellite => self.satellite_deg.map(|deg| deg + self.variation_deg),
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
        matches!(self, Kind::Storm | Kind::Anomaly)
    }

    /// Returns true for an instrument that stands still.
    pub(crate) fn is_stuck(self) -> bool {
        matches!(
            self,
            Kind::StuckCard | Kind::StuckGyro | Kind::StuckSatellite
        )
    }

    /// Returns true for an event that leaves another deviation.
    pub(crate) fn changes_deviation(self) -> bool {
        matches!(
            self,
            Kind::Strike | Kind::Cargo | Kind::Alignment | Kind::ShipDrift
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
            Kind::Strike | Kind::Cargo => (0..PARAMETERS).collect(),
            Kind::GyroStep | Kind::GyroRamp => vec![GYRO],
            Kind::SatelliteStep => vec![SATELLITE],
            Kind::Anomaly => vec![ANOMALY, ANOMALY + 1],
            _ => Vec::new(),
        }
    }
}
