//! Rows of a linear problem: a frame that does not depend on the parameters, then the
//! residual and its slopes at given parameters.

use super::direction::Direction;
use super::needle::Needle;
use super::scatter::{Scatter, WhiteNoise};
use crate::estimate::noise_process::{STATES, TimeStep, Transition};
use crate::estimate::prior::scales;
use crate::gyro_speed_error::northerly_speed_error_deg;
use crate::observation::Observation;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::deviation::Coefficients;
use binnacle_compass::model::Parameters;
use binnacle_compass::position::Position;
use binnacle_compass::ship::{EarthField, PARAMETERS};
use std::f64::consts::TAU;

/// Number of constant unknowns: seven parameters, the constant, and nuisances.
pub(crate) const UNKNOWNS: usize = PARAMETERS + 1 + NUISANCES;
/// Index of the constant.
pub(crate) const CONSTANT: usize = PARAMETERS;
/// Number of nuisances: the gyro's residual speed error, two of the daily variation, and
/// the residual difference of gyro and satellite compass.
const NUISANCES: usize = 4;
const SPEED_ERROR: usize = CONSTANT + 1;
const OFFSET: usize = UNKNOWNS - 1;

/// Standard deviation of a gyro's residual speed error, as a part of the whole.
const SPEED_ERROR_SD: f64 = 0.15;
/// Standard deviation of the daily variation, degrees at 24 µT.
const DAILY_SD_DEG: f64 = 0.08;
/// Standard deviation of the residual difference of gyro and satellite compass, degrees.
pub(crate) const OFFSET_SD_DEG: f64 = 0.3;
/// Change of heading from which a turn disturbs a gyro.
const TURN_DEG: f64 = 20.0;
/// Horizontal field at which an error of variation has its nominal size.
const NOMINAL_H_NT: f64 = 24_000.0;
/// Share of the reference in the heading at which rows are linearised, while the noise
/// levels are unknown.
pub(crate) const USUAL_REFERENCE_SHARE: f64 = 0.7;
/// Residual beyond which a row says nothing about the heading.
const FUSED_RESIDUAL_LIMIT_DEG: f64 = 3.0;
/// Speed where none is known, knots.
const TYPICAL_SPEED_KN: f64 = 12.0;

/// Part of a row that does not depend on the parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowFrame {
    /// Transition from the previous row.
    pub(crate) transition: Transition,
    /// Magnetic and true heading by the reference.
    magnetic: Direction,
    heading: Direction,
    /// Loads of the states on the residual, without the drift; the Schuler pair's rate has
    /// none.
    gyro_load: f64,
    satellite_load: f64,
    variation_load: f64,
    /// Load of the gyro's states on the references' difference.
    gyro_error: f64,
    /// White noise of the deviation and of the references' difference.
    pub(crate) white: WhiteNoise,
    pub(crate) difference_white: WhiteNoise,
    gyro_share: f64,
    /// Full speed error of a gyro here on a northerly heading, degrees.
    northerly_error: f64,
    /// Columns of the other nuisances in units of their prior's standard deviations: two of
    /// the daily variation, and the residual difference of the references.
    nuisance: [f64; NUISANCES - 1],
    /// Gyro less satellite compass, where both were read.
    difference: Option<f64>,
}

/// A row at given parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Measured less predicted, degrees.
    pub(crate) residual: f64,
    /// Negative slopes of the residual by the unknowns, in population units.
    pub(crate) columns: [f64; UNKNOWNS],
    /// Negative slopes of the residual by bx and by, degrees per nT.
    pub(crate) drift: [f64; 2],
    /// Column of the gyro's residual speed error for a reference of the gyro alone.
    speed_error: f64,
    /// Residual of the references' difference, where both were read.
    pub(crate) difference: Option<f64>,
}

/// Returns the frames of observations in order of time.
pub(crate) fn frames(observations: &[Observation]) -> Vec<RowFrame> {
    let both = observations
        .iter()
        .any(|o| o.gyro_less_satellite_deg.is_some());
    let mut earlier: Option<&Observation> = None;
    let mut step = TimeStep::new(0.0);
    let mut scatter = Scatter::default();
    let mut frames = Vec::with_capacity(observations.len());
    for observation in observations {
        let transition = match earlier {
            Some(earlier) => transition(&mut step, earlier, observation),
            None => step.transition(0.0, false),
        };
        let white = scatter.white(observation);
        frames.push(frame(observation, transition, both, white));
        earlier = Some(observation);
    }
    frames
}

/// Returns the transition between two observations; `step` is the one before.
fn transition(step: &mut TimeStep, earlier: &Observation, later: &Observation) -> Transition {
    let seconds = match (earlier.time, later.time) {
        (Some(earlier), Some(later)) => later.seconds_since(earlier).max(0.0),
        // Rows without times share no memory.
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
    *step = step.for_seconds(seconds);
    step.transition(miles, has_turned(earlier, later))
}

/// Returns true if both compass and reference turned: a wild reading of either is no turn.
fn has_turned(earlier: &Observation, later: &Observation) -> bool {
    let by_compass = wrap_quickly(later.compass.degrees() - earlier.compass.degrees());
    let correction = |o: &Observation| o.deviation.degrees_east() + o.variation.degrees_east();
    let by_reference = wrap_quickly(by_compass + correction(later) - correction(earlier));
    by_compass.abs().min(by_reference.abs()) > TURN_DEG
}

fn frame(o: &Observation, transition: Transition, both: bool, white: WhiteNoise) -> RowFrame {
    // A gyro loses its sense of north towards the poles; the rule holds up to 80°.
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
    // Half of the difference is attributed to each.
    let offset_share = if both { o.gyro_share - 0.5 } else { 0.0 };
    RowFrame {
        transition,
        magnetic,
        heading: magnetic.rotated_by(Direction::from_radians(
            o.variation.degrees_east().to_radians(),
        )),
        gyro_load: o.gyro_share * per_cos_lat,
        satellite_load: 1.0 - o.gyro_share,
        variation_load,
        gyro_error: per_cos_lat,
        white,
        difference_white: WhiteNoise::of_difference(o),
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

/// Unknowns in population units, at which rows are linearised.
pub(crate) type Unknowns = [f64; UNKNOWNS];

/// Returns the parameters and the constant (degrees) of some unknowns.
pub(crate) fn to_physical_units(unknowns: &Unknowns) -> ([f64; PARAMETERS], f64) {
    let scale = scales();
    let mut parameters = [0.0; PARAMETERS];
    for j in 0..PARAMETERS {
        parameters[j] = unknowns[j] * scale[j];
    }
    (parameters, unknowns[CONSTANT] * scale[CONSTANT])
}

fn magnetic_by_reference(o: &Observation) -> Direction {
    let degrees = o.compass.degrees() + o.deviation.degrees_east();
    Direction::from_radians(degrees.to_radians())
}

/// Point of linearisation, with the terms that all rows share.
pub(crate) struct LinearisationPoint {
    unknowns: Unknowns,
    parameters: Parameters,
    constant_deg: f64,
    /// Rotation from a reference's heading to the needle's.
    to_needle: Direction,
    /// Share of the reference in a row's heading.
    reference_share: f64,
}

impl LinearisationPoint {
    pub(crate) fn at(unknowns: &Unknowns, reference_share: f64) -> LinearisationPoint {
        let (parameters, constant_deg) = to_physical_units(unknowns);
        LinearisationPoint {
            unknowns: *unknowns,
            parameters: Parameters::from_array(parameters),
            constant_deg,
            to_needle: Direction::from_radians(-constant_deg.to_radians()),
            reference_share,
        }
    }
}

/// Prediction on the magnetic heading fused from compass and reference.
struct Predicted {
    /// Rotation from the reference's heading to that heading.
    from_reference: Direction,
    /// Deviation as the compass's user sees it.
    deviation_deg: f64,
    needle: Needle,
}

/// Predicts an observation; `reference` is its magnetic heading by the reference.
fn predict(o: &Observation, reference: Direction, point: &LinearisationPoint) -> Predicted {
    let p = &point.parameters;
    let earth = EarthField {
        h_nt: o.h_nt,
        z_nt: o.z_nt,
    };
    let deviation_of =
        |needle: &Needle| wrap_quickly(needle.deviation_rad().to_degrees() + point.constant_deg);
    let needles = reference.rotated_by(point.to_needle);
    let by_reference = deviation_of(&Needle::at(p, needles, earth));
    let disagreement = wrap_quickly(o.deviation.degrees_east() - by_reference)
        .clamp(-FUSED_RESIDUAL_LIMIT_DEG, FUSED_RESIDUAL_LIMIT_DEG);
    let from_reference =
        Direction::from_small_radians(-((1.0 - point.reference_share) * disagreement).to_radians());
    let needle = Needle::at(p, needles.rotated_by(from_reference), earth);
    Predicted {
        from_reference,
        deviation_deg: deviation_of(&needle),
        needle,
    }
}

/// Wraps into (−180°, 180°], where most angles are already.
fn wrap_quickly(degrees: f64) -> f64 {
    if -180.0 < degrees && degrees <= 180.0 {
        degrees
    } else {
        wrap_180(degrees)
    }
}

/// Returns the row of `o` at a point.
pub(crate) fn row(o: &Observation, frame: &RowFrame, point: &LinearisationPoint) -> Row {
    let LinearisationPoint {
        unknowns,
        reference_share,
        ..
    } = point;
    let Predicted {
        from_reference,
        deviation_deg,
        needle,
    } = predict(o, frame.magnetic, point);
    let gradient = needle.gradient();
    let scale = scales();
    // The heading of the row moves with the parameters, too.
    let follows = 1.0 + (1.0 - reference_share) * (1.0 - needle.compass_per_magnetic());
    let mut columns = [0.0; UNKNOWNS];
    for j in 0..PARAMETERS {
        columns[j] = gradient[j].to_degrees() * scale[j] * follows;
    }
    columns[CONSTANT] = needle.compass_per_magnetic() * scale[CONSTANT] * follows;
    // At the heading of the row, like all else: at the reference's own it would depend on
    // the reference's error.
    let northerly = frame.heading.rotated_by(from_reference).cos;
    let speed_error = SPEED_ERROR_SD * frame.northerly_error * northerly;
    columns[SPEED_ERROR] = speed_error * frame.gyro_share;
    columns[SPEED_ERROR + 1..].copy_from_slice(&frame.nuisance);
    let mut residual = wrap_quickly(o.deviation.degrees_east() - deviation_deg);
    for j in CONSTANT + 1..UNKNOWNS {
        residual -= columns[j] * unknowns[j];
    }
    let difference = frame.difference.map(|value| {
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

/// Returns measured less predicted deviation at the compass heading as read, degrees, with
/// the reference's errors still in it.
pub(crate) fn plain_residual(o: &Observation, unknowns: &Unknowns) -> f64 {
    let (parameters, constant) = to_physical_units(unknowns);
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
        predict(
            o,
            reference,
            &LinearisationPoint::at(unknowns, USUAL_REFERENCE_SHARE),
        )
        .deviation_deg
    });
    wrap_180(o.deviation.degrees_east() - predicted)
}

impl RowFrame {
    /// Returns true if a gyro's errors are in the row.
    pub(crate) fn reads_gyro(&self) -> bool {
        self.gyro_load != 0.0 || self.reads_both()
    }

    /// Returns true if a satellite compass's errors are in the row.
    pub(crate) fn reads_satellite(&self) -> bool {
        self.satellite_load != 0.0 || self.reads_both()
    }

    /// Returns true if the references' difference was read, too.
    pub(crate) fn reads_both(&self) -> bool {
        self.difference.is_some()
    }

    /// Returns the loads of the states on the residual of `row`: the filter's measurement
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

    /// Returns columns and loads of the references' difference, in which the vessel has no
    /// part.
    pub(crate) fn difference(&self, row: &Row) -> ([f64; UNKNOWNS], [f64; STATES]) {
        let mut columns = [0.0; UNKNOWNS];
        columns[SPEED_ERROR] = row.speed_error;
        columns[OFFSET] = OFFSET_SD_DEG;
        let gyro = self.gyro_error;
        (columns, [gyro, 0.0, gyro, 0.0, 0.0, -1.0, 0.0, 0.0])
    }
}
