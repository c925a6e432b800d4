//! What is to happen: ships, routes, instruments and events, read from TOML.
//!
//! A [`Scenario`] is right by its type: every number is finite and within what
//! a ship can do, every route is named and at sea long enough to sail, and
//! every compass can be steered by wherever its ship goes.

mod check;
mod error;
mod event;
mod raw;
mod ship;
mod values;

pub use error::ScenarioError;

use crate::poisson::Magnetism;
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use std::path::Path;
use std::sync::Arc;

/// A whole scenario.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// What it is called.
    pub name: String,
    /// Chance begins here, unless the command line says otherwise.
    pub seed: u64,
    /// When a `voyage` begins.
    pub start: Timestamp,
    /// How long a `voyage` lasts, days.
    pub days: f64,
    /// How often instruments speak.
    pub timing: Timing,
    /// How often a line is damaged.
    pub faults: LineFaults,
    /// Magnetic storms: the same hours for all ships.
    pub storms: Vec<Storm>,
    /// Places where the earth's field is not as charted.
    pub anomalies: Vec<Anomaly>,
    /// The fleet; at least one ship.
    pub ships: Vec<ShipPlan>,
}

/// Seconds between sentences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Between headings, under way.
    pub interval_s: f64,
    /// At least so much between positions (RMC, ROT), under way.
    pub position_interval_s: f64,
    /// Between groups of all sentences, made fast in port.
    pub moored_interval_s: f64,
}

/// Shares of all sentences that go wrong on the wire.
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
    /// How long it lasts.
    pub hours: f64,
    /// Standard deviation of the easterly field at low magnetic latitudes, nT;
    /// several times as much near the auroral zones.
    pub strength_nt: f64,
}

/// A local magnetic anomaly, falling off as a Gaussian.
#[derive(Clone, Debug, PartialEq)]
pub struct Anomaly {
    /// For the truth file.
    pub name: String,
    /// Its middle.
    pub position: Position,
    /// Where it is down by e, nautical miles.
    pub radius_nm: f64,
    /// In its middle, nT: north, east, down.
    pub field_nt: [f64; 3],
}

/// A ship, her route, her magnetism and her instruments.
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
    /// Sailed to and fro; at least two points, the ends are ports.
    pub route: Arc<[RoutePoint]>,
    /// Where on the route she begins.
    pub start_point: usize,
    /// Whether she first sails towards the route's end.
    pub outbound: bool,
    /// Service speed, knots.
    pub speed_kn: f64,
    /// Rate of turn, degrees a minute.
    pub turn_deg_min: f64,
    /// How rough her seas are; 1 is usual.
    pub sea: f64,
    /// Steady heel, degrees, starboard down.
    pub list_deg: f64,
    /// Alterations of course for traffic, a day.
    pub traffic_per_day: f64,
    /// Her magnetism at the compass before any event.
    pub magnetism: Magnetism,
    /// What the lubber line adds to every compass reading, degrees.
    pub alignment_deg: f64,
    /// Gaussian error after a turn of 0.3° a second kept up, degrees.
    pub gaussian_error_deg: f64,
    /// The gyro.
    pub gyro: GyroPlan,
    /// The satellite compass, when she has one.
    pub satellite: Option<SatellitePlan>,
    /// What befalls her.
    pub events: Vec<Event>,
}

/// A place on a route.
#[derive(Clone, Debug, PartialEq)]
pub struct RoutePoint {
    /// Where, at sea or off a port.
    pub position: Position,
    /// The port's name, where she makes fast.
    pub port: Option<String>,
    /// Hours made fast.
    pub stay_h: f64,
    /// Hours spent waiting under way before she may come in.
    pub wait_h: f64,
    /// How far from the point she waits, nautical miles.
    pub wait_nm: f64,
}

/// A gyro's errors. Degrees, except where the name says otherwise; those that
/// vary grow with 1/cos(latitude).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroPlan {
    /// Constant error.
    pub constant_deg: f64,
    /// Standard deviation of the Schuler swing.
    pub schuler_deg: f64,
    /// Standard deviation of the bias that wanders over three days.
    pub slow_deg: f64,
    /// Share of the speed error that is left in: 0 perfectly corrected, 1 not at all.
    pub speed_error_left: f64,
}

/// A satellite compass's errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SatellitePlan {
    /// How far the antennas are out of the ship's axis, degrees.
    pub alignment_deg: f64,
    /// Losses of the satellites a day.
    pub dropouts_per_day: f64,
}

/// What befalls a ship. Days count from the start.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The ship's permanent magnetism jumps and partly returns.
    Lightning {
        /// When.
        day: f64,
        /// The jump, nT: forward, starboard, down.
        b_nt: [f64; 3],
        /// The share of the jump that goes back.
        returning: f64,
        /// The time in which that share falls by e, days.
        return_days: f64,
    },
    /// Magnetic cargo from loading to discharge.
    Cargo {
        /// Loaded.
        from_day: f64,
        /// Discharged.
        to_day: f64,
        /// What it adds.
        magnetism: Magnetism,
    },
    /// The gyro is wrong and does not say so.
    GyroFault {
        /// It begins.
        from_day: f64,
        /// It is put right.
        to_day: f64,
        /// At once, degrees.
        offset_deg: f64,
        /// And then, degrees an hour.
        drift_deg_per_h: f64,
    },
}

impl Scenario {
    /// Reads a scenario from a file.
    ///
    /// # Errors
    /// When the file cannot be read or does not hold a scenario: the error
    /// names the file, the line and the field.
    pub fn read(path: &Path) -> Result<Scenario, ScenarioError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| ScenarioError::Unreadable {
            file: file.clone(),
            error: error.to_string(),
        })?;
        Scenario::parse(&file, &text)
    }

    /// Reads a scenario from text; `file` is for the errors.
    ///
    /// # Errors
    /// When the text does not hold a scenario.
    pub fn parse(file: &str, text: &str) -> Result<Scenario, ScenarioError> {
        let source = error::Source { file, text };
        let raw = toml::from_str(text).map_err(|error| source.toml(&error))?;
        check::scenario(&source, &raw)
    }

    /// The ship of this name.
    pub fn ship(&self, name: &str) -> Option<&ShipPlan> {
        self.ships.iter().find(|ship| ship.name == name)
    }
}
