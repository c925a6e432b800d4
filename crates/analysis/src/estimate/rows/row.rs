//! Observations as rows of a linear problem: once what does not depend on the
//! parameters, then the residual and its slopes at the current ones.

use super::direction::Direction;
use super::needle::Needle;
use super::scatter::{Scatter, White};
use crate::estimate::noise_process::{STATES, Step, Transition};
use crate::estimate::prior::scales;
use crate::gyro_speed_error::northerly_speed_error_deg;
use crate::observation::Observation;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::Parameters;
use binnacle_compass::position::Position;
use binnacle_compass::ship::{EarthField, PARAMETERS};
use std::f64::consts::TAU;

/// Unknowns that do not change: seven parameters, the constant, and nuisances.
pub(crate) const UNKNOWNS: usize = PARAMETERS + 1 + NUISANCES;
/// Where the constant stands.
pub(crate) const CONSTANT: usize = PARAMETERS;
/// The gyro's leftover speed error, two of the daily variation, and what is left
/// of the lasting difference of gyro and satellite compass.
const NUISANCES: usize = 4;
const SPEED_ERROR: usize = CONSTANT + 1;
const OFFSET: usize = UNKNOWNS - 1;

/// Standard deviation of what is left of a gyro's speed error, as a part of it.
const SPEED_ERROR_SD: f64 = 0.15;
/// Standard deviation of the daily swing of variation, degrees at 24 µT.
const DAILY_SD_DEG: f64 = 0.08;
/// Standard deviation of what is left, degrees, of the lasting difference of
/// gyro and satellite compass when their usual difference is taken off.
pub(crate) const OFFSET_SD_DEG: f64 = 0.3;
/// A change of heading beyond this upsets a gyro.
const TURN_DEG: f64 = 20.0;
/// Where H is this, an error of variation has its nominal size.
const NOMINAL_H_NT: f64 = 24_000.0;
/// Share of the reference in the heading at which rows are linearised, as long as
/// the sizes of the noise are not known.
pub(crate) const USUAL_FUSION: f64 = 0.7;
/// A residual beyond this says nothing about the heading.
const FUSION_LIMIT_DEG: f64 = 3.0;
/// Knots taken where speed is not known.
const TYPICAL_SPEED_KN: f64 = 12.0;

/// An observation's part that does not depend on the parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Station {
    /// From the row before.
    pub(crate) transition: Transition,
    /// The magnetic and the true heading that the reference says.
    magnetic: Direction,
    heading: Direction,
    /// How the states but the drift add to the residual; the Schuler pair's
    /// rate does not.
    gyro_load: f64,
    satellite_load: f64,
    variation_load: f64,
    /// The gyro's states' part in a difference of both references.
    gyro_error: f64,
    /// White noise of the deviation and of the references' difference.
    pub(crate) white: White,
    pub(crate) difference_white: White,
    gyro_share: f64,
    /// A gyro's whole speed error here on a northerly heading, degrees.
    northerly_error: f64,
    /// Columns of the other nuisances in units of their prior's standard
    /// deviations: two of the daily swing, and what is left of the lasting
    /// difference of both references.
    nuisance: [f64; NUISANCES - 1],
    /// Gyro less satellite compass, where both were read.
    difference: Option<f64>,
}

/// A row at the current parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Measured less predicted, degrees.
    pub(crate) residual: f64,
    /// Its (negative) slopes by the unknowns, in population units.
    pub(crate) columns: [f64; UNKNOWNS],
    /// Its (negative) slopes by bx and by, degrees per nT.
    pub(crate) drift: [f64; 2],
    /// The gyro's leftover speed error's column, were the reference all gyro's.
    speed_error: f64,
    /// What is left of the difference of both references, where both were read.
    pub(crate) difference: Option<f64>,
}

/// Stations in the order of the observations, which the caller has sorted from
/// the earliest to the latest.
pub(crate) fn stations(observations: &[Observation]) -> Vec<Station> {
    let both = observations
        .iter()
        .any(|o| o.gyro_less_satellite_deg.is_some());
    let mut earlier: Option<&Observation> = None;
    let mut step = Step::over(0.0);
    let mut scatter = Scatter::new();
    let mut stations = Vec::with_capacity(observations.len());
    for observation in observations {
        let transition = match earlier {
            Some(earlier) => transition(&mut step, earlier, observation),
            None => step.sailing(0.0, false),
        };
        let white = scatter.white(observation);
        stations.push(station(observation, transition, both, white));
        earlier = Some(observation);
    }
    stations
}

/// From one observation to the next; `step` is the one before.
fn transition(step: &mut Step, earlier: &Observation, later: &Observation) -> Transition {
    let seconds = match (earlier.time, later.time) {
        (Some(earlier), Some(later)) => later.seconds_since(earlier).max(0.0),
        // Rows without times have no memory in common.
        _ => 1e9,
    };
    let miles = match (earlier.position, later.position) {
        (Some(a), Some(b)) => {
            let dlat = a.lat_deg() - b.lat_deg();
            let mid = (f64::midpoint(a.lat_deg(), b.lat_deg())).to_radians();
            let dlon = wrap_180(a.lon_deg() - b.lon_deg()) * mid.cos();
            60.0 * dlat.hypot(dlon)
        }
        _ => later.sog_kn.unwrap_or(TYPICAL_SPEED_KN).abs() * seconds / 3600.0,
    };
    *step = step.again(seconds);
    step.sailing(miles, has_turned(earlier, later))
}

/// Returns true if both compass and reference say so: a wild reading of either is no turn.
fn has_turned(earlier: &Observation, later: &Observation) -> bool {
    let by_compass = near(later.compass.degrees() - earlier.compass.degrees());
    let correction = |o: &Observation| o.deviation.degrees_east() + o.variation.degrees_east();
    let by_reference = near(by_compass + correction(later) - correction(earlier));
    by_compass.abs().min(by_reference.abs()) > TURN_DEG
}

fn station(o: &Observation, transition: Transition, both: bool, white: White) -> Station {
    // A gyro loses its sense of north towards the poles; 80° is as far as the
    // rule is meant to hold.
    let lat_deg = o.position.map_or(0.0, Position::lat_deg);
    let per_cos_lat = 1.0 / lat_deg.to_radians().cos().max(0.17);
    let variation_load = (NOMINAL_H_NT / o.h_nt).clamp(0.5, 4.0);
    let northerly_error = o
        .sog_kn
        .map_or(0.0, |sog_kn| northerly_speed_error_deg(sog_kn, lat_deg));
    let (sin, cos) = match (o.time, o.position) {
        (Some(time), Some(position)) => {
            let day = time.micros().rem_euclid(86_400_000_000) as f64 / 86_400e6;
            (TAU * (day + position.lon_deg() / 360.0)).sin_cos()
        }
        _ => (0.0, 0.0),
    };
    let magnetic = magnetic_by_reference(o);
    // Half of the difference is put to either.
    let offset_share = if both { o.gyro_share - 0.5 } else { 0.0 };
    Station {
        transition,
        magnetic,
        heading: magnetic.turned(Direction::of(o.variation.degrees_east().to_radians())),
        gyro_load: o.gyro_share * per_cos_lat,
        satellite_load: 1.0 - o.gyro_share,
        variation_load,
        gyro_error: per_cos_lat,
        white,
        difference_white: White::of_difference(o),
        gyro_share: o.gyro_share,
        northerly_error,
        nuisance: [
            DAILY_SD_DEG * variation_load * sin,
            DAILY_SD_DEG * variation_load * cos,
            OFFSET_SD_DEG * offset_share,
        ],
        difference: o.gyro_less_satellite_deg,
    }
}

/// The current unknowns in population units: what the rows are taken at.
pub(crate) type Unknowns = [f64; UNKNOWNS];

/// Parameters and constant (degrees) of a set of unknowns.
pub(crate) fn in_own_units(unknowns: &Unknowns) -> ([f64; PARAMETERS], f64) {
    let scale = scales();
    let mut parameters = [0.0; PARAMETERS];
    for j in 0..PARAMETERS {
        parameters[j] = unknowns[j] * scale[j];
    }
    (parameters, unknowns[CONSTANT] * scale[CONSTANT])
}

fn magnetic_by_reference(o: &Observation) -> Direction {
    let degrees = o.compass.degrees() + o.deviation.degrees_east();
    Direction::of(degrees.to_radians())
}

/// What rows are taken at, with what all of them have need of.
pub(crate) struct Point {
    unknowns: Unknowns,
    parameters: Parameters,
    constant_deg: f64,
    /// From a reference's heading to the needle's.
    to_needle: Direction,
    /// The reference's share in a row's heading.
    fusion: f64,
}

impl Point {
    pub(crate) fn at(unknowns: &Unknowns, fusion: f64) -> Point {
        let (parameters, constant_deg) = in_own_units(unknowns);
        Point {
            unknowns: *unknowns,
            parameters: Parameters::from_array(parameters),
            constant_deg,
            to_needle: Direction::of(-constant_deg.to_radians()),
            fusion,
        }
    }
}

/// What is predicted on the magnetic heading that compass and reference agree on.
struct Predicted {
    /// That heading from the reference's.
    from_reference: Direction,
    /// As the compass's user sees it.
    deviation_deg: f64,
    needle: Needle,
}

/// `reference` is the magnetic heading that it says.
fn predict(o: &Observation, reference: Direction, point: &Point) -> Predicted {
    let p = &point.parameters;
    let earth = EarthField {
        h_nt: o.h_nt,
        z_nt: o.z_nt,
    };
    let deviation_of =
        |needle: &Needle| near(needle.deviation_rad().to_degrees() + point.constant_deg);
    let needles = reference.turned(point.to_needle);
    let by_reference = deviation_of(&Needle::at(p, needles, earth));
    let disagreement =
        near(o.deviation.degrees_east() - by_reference).clamp(-FUSION_LIMIT_DEG, FUSION_LIMIT_DEG);
    let from_reference = Direction::of_small(-((1.0 - point.fusion) * disagreement).to_radians());
    let needle = Needle::at(p, needles.turned(from_reference), earth);
    Predicted {
        from_reference,
        deviation_deg: deviation_of(&needle),
        needle,
    }
}

/// Into (−180°, 180°], where most angles are already.
fn near(degrees: f64) -> f64 {
    if -180.0 < degrees && degrees <= 180.0 {
        degrees
    } else {
        wrap_180(degrees)
    }
}

/// The row of `o` at a point.
pub(crate) fn row(o: &Observation, station: &Station, point: &Point) -> Row {
    let Point {
        unknowns, fusion, ..
    } = point;
    let Predicted {
        from_reference,
        deviation_deg,
        needle,
    } = predict(o, station.magnetic, point);
    let gradient = needle.gradient();
    let scale = scales();
    // The heading of the row moves with the parameters too.
    let follows = 1.0 + (1.0 - fusion) * (1.0 - needle.compass_per_magnetic());
    let mut columns = [0.0; UNKNOWNS];
    for j in 0..PARAMETERS {
        columns[j] = gradient[j].to_degrees() * scale[j] * follows;
    }
    columns[CONSTANT] = needle.compass_per_magnetic() * scale[CONSTANT] * follows;
    // At the heading of the row like all else: at the reference's own it would
    // lean on the reference's error.
    let northerly = station.heading.turned(from_reference).cos;
    let speed_error = SPEED_ERROR_SD * station.northerly_error * northerly;
    columns[SPEED_ERROR] = speed_error * station.gyro_share;
    columns[SPEED_ERROR + 1..].copy_from_slice(&station.nuisance);
    let mut residual = near(o.deviation.degrees_east() - deviation_deg);
    for j in CONSTANT + 1..UNKNOWNS {
        residual -= columns[j] * unknowns[j];
    }
    let difference = station.difference.map(|value| {
        value - speed_error * unknowns[SPEED_ERROR] - OFFSET_SD_DEG * unknowns[OFFSET]
    });
    Row {
        residual,
        columns,
        drift: [gradient[0].to_degrees(), gradient[2].to_degrees()],
        speed_error,
        difference,
    }
}

/// Measured less predicted on the compass heading as read, degrees, with what
/// is put down to the reference still in it.
pub(crate) fn plain_residual(o: &Observation, unknowns: &Unknowns) -> f64 {
    let (parameters, constant) = in_own_units(unknowns);
    let earth = EarthField {
        h_nt: o.h_nt,
        z_nt: o.z_nt,
    };
    let by_compass = Coefficients::new(&Parameters::from_array(parameters), earth)
        .ok()
        .and_then(|coefficients| coefficients.deviation_at_compass_rad(o.compass.radians()))
        .map(|deviation| deviation.to_degrees() + constant);
    let predicted = by_compass.unwrap_or_else(|| {
        let reference = magnetic_by_reference(o);
        predict(o, reference, &Point::at(unknowns, USUAL_FUSION)).deviation_deg
    });
    wrap_180(o.deviation.degrees_east() - predicted)
}

impl Station {
    /// Returns true if a gyro's errors stand in the row.
    pub(crate) fn reads_gyro(&self) -> bool {
        self.gyro_load != 0.0 || self.reads_both()
    }

    /// Returns true if a satellite compass's errors stand in the row.
    pub(crate) fn reads_satellite(&self) -> bool {
        self.satellite_load != 0.0 || self.reads_both()
    }

    /// Returns true if their difference was read beside the row.
    pub(crate) fn reads_both(&self) -> bool {
        self.difference.is_some()
    }

    /// How the states add to the residual of `row`: the filter's measurement
    /// vector.
    pub(crate) fn loads(&self, row: &Row) -> [f64; STATES] {
        [
            self.gyro_load,
            0.0,
            self.gyro_load,
            1.0,
            self.variation_load,
            self.satellite_load,
            row.drift[0],
            row.drift[1],
        ]
    }

    /// Columns and loads of the difference of both references, where both were
    /// read: the ship has no part in it.
    pub(crate) fn difference(&self, row: &Row) -> ([f64; UNKNOWNS], [f64; STATES]) {
        let mut columns = [0.0; UNKNOWNS];
        columns[SPEED_ERROR] = row.speed_error;
        columns[OFFSET] = OFFSET_SD_DEG;
        let gyro = self.gyro_error;
        (columns, [gyro, 0.0, gyro, 0.0, 0.0, -1.0, 0.0, 0.0])
    }
}
