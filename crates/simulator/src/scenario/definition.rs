//! The parts of a scenario.

use crate::poisson::Magnetism;
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use std::sync::Arc;

/// A complete scenario.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Name of the scenario.
    pub name: String,
    /// Random seed, unless the command line has one.
    pub seed: u64,
    /// Start of a `voyage`.
    pub start: Timestamp,
    /// Length of a `voyage`, days.
    pub days: f64,
    /// Intervals between sentences.
    pub timing: Timing,
    /// Rates of damaged lines.
    pub faults: LineFaults,
    /// Magnetic storms: the same hours for all ships.
    pub storms: Vec<Storm>,
    /// Places where the earth's field differs from the chart.
    pub anomalies: Vec<Anomaly>,
    /// The fleet; at least one ship.
    pub ships: Vec<ShipPlan>,
}

/// Seconds between sentences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Interval between headings under way.
    pub interval_s: f64,
    /// The least interval between positions (RMC, ROT) under way.
    pub position_interval_s: f64,
    /// Interval between groups of all sentences in port.
    pub moored_interval_s: f64,
}

/// Fractions of all sentences that are damaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineFaults {
    /// Sentences with one byte altered.
    pub wrong_checksum: f64,
    /// Lines of noise, per sentence.
    pub garbage: f64,
}

/// A magnetic storm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Storm {
    /// Days from the start.
    pub day: f64,
    /// Duration.
    pub hours: f64,
    /// Standard deviation of the easterly field at low magnetic latitudes, nT;
    /// several times larger near the auroral zones.
    pub strength_nt: f64,
}

/// A local magnetic anomaly with a Gaussian profile.
#[derive(Clone, Debug, PartialEq)]
pub struct Anomaly {
    /// Name in the truth file.
    pub name: String,
    /// Its centre.
    pub position: Position,
    /// Distance at which it has fallen by e, nautical miles.
    pub radius_nm: f64,
    /// Field at the centre, nT: north, east, down.
    pub field_nt: [f64; 3],
}

/// A ship with its route, magnetism and instruments.
#[derive(Clone, Debug)]
pub struct ShipPlan {
    /// Name; unique in the scenario.
    pub name: String,
    /// IMO number.
    pub imo_number: Option<String>,
    /// Call sign.
    pub call_sign: Option<String>,
    /// Flag, ISO 3166.
    pub flag: Option<String>,
    /// Route, sailed to and fro; at least two points, and the ends are ports.
    pub route: Arc<[RoutePoint]>,
    /// Index of the route's point where the ship begins.
    pub start_point: usize,
    /// True if the ship first sails towards the route's end.
    pub outbound: bool,
    /// Service speed, knots.
    pub speed_kn: f64,
    /// Rate of turn, degrees a minute.
    pub turn_deg_min: f64,
    /// Sea state; 1 is usual.
    pub sea: f64,
    /// Steady heel, degrees, starboard down.
    pub list_deg: f64,
    /// Alterations for traffic per day.
    pub traffic_per_day: f64,
    /// Magnetism at the compass before any event.
    pub magnetism: Magnetism,
    /// Lubber-line error, added to every compass reading, degrees.
    pub alignment_deg: f64,
    /// Display of the magnetic compass.
    pub compass: DisplayPlan,
    /// Gaussian error after a sustained turn of 0.3° a second, degrees.
    pub gaussian_error_deg: f64,
    /// The gyro.
    pub gyro: GyroPlan,
    /// The satellite compass, if any.
    pub satellite: Option<SatellitePlan>,
    /// Events of the ship.
    pub events: Vec<Event>,
}

/// A point of a route.
#[derive(Clone, Debug, PartialEq)]
pub struct RoutePoint {
    /// Position, at sea or off a port.
    pub position: Position,
    /// The port's name, if the ship makes fast there.
    pub port: Option<String>,
    /// Hours alongside.
    pub stay_h: f64,
    /// Hours of waiting under way before entering the port.
    pub wait_h: f64,
    /// Waiting distance from the point, nautical miles.
    pub wait_nm: f64,
}

/// A gyro's errors. Degrees, unless the name has another unit; the varying ones
/// grow with 1/cos(latitude).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroPlan {
    /// Constant error.
    pub constant_deg: f64,
    /// Standard deviation of the Schuler swing.
    pub schuler_deg: f64,
    /// Standard deviation of the bias that wanders over three days.
    pub slow_deg: f64,
    /// Fraction of the speed error that remains: 0 perfectly corrected, 1 not
    /// at all.
    pub speed_error_left: f64,
    /// Its display.
    pub display: DisplayPlan,
}

/// A satellite compass's errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SatellitePlan {
    /// Angle between antennas and the ship's axis, degrees.
    pub alignment_deg: f64,
    /// Losses of the satellites per day.
    pub dropouts_per_day: f64,
    /// Talker of its sentences, two letters. With the gyro's, `HE`, two sensors share one
    /// talker.
    pub talker: [u8; 2],
    /// Its display.
    pub display: DisplayPlan,
}

/// Display of an instrument's heading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisplayPlan {
    /// Time constant with which it follows the sensor, seconds.
    pub lag_s: f64,
    /// Steps of the reading, degrees, such as 1; 0 for all digits of the sentence.
    pub resolution_deg: f64,
}

/// An event of a ship. Days count from the start.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// Lightning: the ship's permanent magnetism jumps and partly returns.
    Lightning {
        /// Day of the strike.
        day: f64,
        /// The jump, nT: forward, starboard, down.
        b_nt: [f64; 3],
        /// Fraction of the jump that returns.
        returning: f64,
        /// Time constant of the return, days.
        return_days: f64,
    },
    /// Magnetic cargo from loading to discharge.
    Cargo {
        /// Day of loading.
        from_day: f64,
        /// Day of discharge.
        to_day: f64,
        /// Magnetism that the cargo adds.
        magnetism: Magnetism,
    },
    /// An unreported fault of the gyro.
    GyroFault {
        /// First day.
        from_day: f64,
        /// Last day.
        to_day: f64,
        /// Initial error, degrees.
        offset_deg: f64,
        /// Drift, degrees an hour.
        drift_deg_per_h: f64,
    },
}
