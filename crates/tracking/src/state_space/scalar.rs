//! A row's readings as scalars in the filter's states, for one hypothesis.

use super::levels::{Level, Levels};
use super::retained::Retained;
use super::row::{Course, Row};
use super::states::{
    ALIGNMENT, ANOMALY, BERTH, BX, BY, CRAB, CURRENT, DAILY, FRICTION, GYRO, GYRO_HEADING,
    GYRO_SLOW, HEEL, HEEL_NT_PER_RAD, LAG, LEEWAY, LIST, LIST_NT, REFLECTION, RETENTION, SATELLITE,
    SCHULER, SETTLING, SPEED, STATES, STEADY, SWING, USUAL_H_NT, VARIATION, dot, parameters,
};
use binnacle_analysis::estimate::{Direction, Needle, POPULATION_SD};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::azimuth::Azimuth;
use binnacle_compass::model::Parameters;
use binnacle_compass::ship::PARAMETERS;

/// Gyro's share of the reference heading where both are read. Assumed: a satellite compass has
/// half as much again of the noise that is new in every row, so that this mean has the least.
pub(crate) const GYRO_SHARE: f64 = 0.7;
/// Reference's part of the noise that is new in a row. One part for all rows: where readings are
/// rounded, their errors last, and a part by each row's noise would take them for magnetism.
/// Assumed: a little less than half of the noise is the reference's.
const REFERENCE_PART: f64 = 0.4;
/// Least change of an innovation by that of the compass's reading: no compass is steered by
/// where it is less.
const LEAST_PER_COMPASS: f64 = 0.1;
/// Standard deviation of a reading that says nothing, degrees. Assumed: as large as deviations of
/// ships that were never adjusted.
pub(crate) const SAYS_NOTHING_DEG: f64 = 20.0;

/// Greatest speed across the heading over the speed over ground: beyond 45° of drift angle a ship
/// drifts rather than sails.
const MOST_ACROSS: f64 = 0.7;
/// States that set the ship to the east, and to the north.
const SETS_EAST: [usize; 3] = [CURRENT, LEEWAY, STEADY];
const SETS_NORTH: [usize; 3] = [CURRENT + 2, LEEWAY + 1, STEADY + 1];

/// Linearised reading, degrees.
#[derive(Clone, Debug)]
pub(crate) struct Scalar {
    /// Reading less its prediction by the mean.
    pub(crate) innovation: f64,
    pub(crate) load: [f64; STATES],
    /// Variance of the noise that is new in it.
    pub(crate) variance: f64,
    /// Pair of states that it may not teach, by the first: they are uncertain for ever
    /// (Schmidt–Kalman filter: Schmidt 1966).
    pub(crate) considered: Option<usize>,
}

/// Instruments that a hypothesis holds to say nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Silent {
    pub(crate) compass: bool,
    pub(crate) gyro: bool,
    pub(crate) satellite: bool,
}

/// Returns gyro less satellite compass of a row that has both, at the mean.
pub(crate) fn difference(
    row: &Row,
    mean: &[f64; STATES],
    levels: &Levels,
    silent: Silent,
) -> Option<Scalar> {
    let mut gyro = Reference::gyro(row, row.gyro_deg?);
    let satellite = Reference::satellite(row, row.satellite_deg?);
    let off = wrap_180(gyro.heading_deg - satellite.heading_deg);
    gyro.turn_to(satellite.heading_deg + GYRO_SHARE * off, row);
    let level = levels.at(Level::DifferenceWhite);
    let variance = if silent.gyro || silent.satellite {
        SAYS_NOTHING_DEG.powi(2)
    } else {
        row.difference_white.variance(level * level)
    };
    Some(gyro.less(&satellite, mean, variance))
}

/// Returns reference less compass of a row, at the mean.
pub(crate) fn deviation(
    row: &Row,
    mean: &[f64; STATES],
    levels: &Levels,
    silent: Silent,
) -> Scalar {
    let level = levels.at(Level::White);
    let white = row.white.variance(level * level);
    let share = gyro_share(row, silent);
    let is_reference_silent = (share > 0.0 && silent.gyro) || (share < 1.0 && silent.satellite);
    let variance = if silent.compass || is_reference_silent {
        SAYS_NOTHING_DEG.powi(2)
    } else {
        white
    };
    if let Some(course) = &row.course {
        return deviation_by_course(row, mean, course, variance);
    }
    let reference = Reference::mixed(row, share);
    deviation_by(row, mean, reference, variance, REFERENCE_PART)
}

/// Returns the deviation that an azimuth showed, in the circumstances of a row: no reference
/// has a part in it, so that it alone tells the compass's alignment.
pub(crate) fn sighted_deviation(row: &Row, mean: &[f64; STATES], azimuth: &Azimuth) -> Scalar {
    let compass_deg = azimuth.compass_heading().degrees();
    let result = azimuth.result();
    let row = Row {
        compass_deg,
        ..row.clone()
    };
    let sight = Reference {
        heading_deg: compass_deg + result.deviation_deg.degrees_east(),
        load: [0.0; STATES],
        gyro_share: 0.0,
    };
    // The card is read as often as the bearing.
    deviation_by(&row, mean, sight, result.standard_error_deg.powi(2), 0.5)
}

/// Returns the gyro's error that an azimuth showed; none without the gyro's reading, and on a
/// ship without heading reference.
pub(crate) fn sighted_gyro(row: &Row, mean: &[f64; STATES], azimuth: &Azimuth) -> Option<Scalar> {
    let result = azimuth.result();
    let error_deg = -result.gyro_error_deg?.degrees_east();
    if row.course.is_some() {
        return None;
    }
    let heading_deg = result.true_heading_deg.degrees() - row.variation_deg;
    let load = Reference::gyro(row, heading_deg).load;
    Some(Scalar {
        innovation: wrap_180(error_deg - dot(&load, mean)),
        load,
        variance: result.standard_error_deg.powi(2),
        considered: None,
    })
}

/// Returns the gyro's share of the reference heading.
pub(crate) fn gyro_share(row: &Row, silent: Silent) -> f64 {
    match (row.gyro_deg, row.satellite_deg) {
        (Some(_), Some(_)) if silent.gyro && !silent.satellite => 0.0,
        (Some(_), Some(_)) if silent.satellite && !silent.gyro => 1.0,
        (Some(_), Some(_)) => GYRO_SHARE,
        (_, None) => 1.0,
        (None, _) => 0.0,
    }
}

/// Heading by a reference, less the charted variation, with the loads of its errors.
struct Reference {
    heading_deg: f64,
    load: [f64; STATES],
    gyro_share: f64,
}

impl Reference {
    fn gyro(row: &Row, heading_deg: f64) -> Reference {
        let mut load = [0.0; STATES];
        load[GYRO] = 1.0;
        load[GYRO_SLOW] = 1.0 / row.cos_lat;
        load[SCHULER] = 1.0 / row.cos_lat;
        load[SETTLING] = 1.0;
        load[LAG] = -row.rate_of_turn_deg_min;
        let mut gyro = Reference {
            heading_deg,
            load,
            gyro_share: 1.0,
        };
        gyro.turn_to(heading_deg, row);
        gyro
    }

    /// Takes the loads that depend on the heading at a better one, less the charted variation.
    fn turn_to(&mut self, heading_deg: f64, row: &Row) {
        let (sin, cos) = (heading_deg + row.variation_deg).to_radians().sin_cos();
        self.load[SPEED] = self.gyro_share * row.northerly_deg * cos;
        self.load[GYRO_HEADING] = self.gyro_share * sin;
        self.load[GYRO_HEADING + 1] = self.gyro_share * cos;
    }

    fn satellite(row: &Row, heading_deg: f64) -> Reference {
        let mut load = [0.0; STATES];
        load[SATELLITE] = 1.0;
        load[REFLECTION] = 1.0;
        load[LAG] = -row.rate_of_turn_deg_min;
        Reference {
            heading_deg,
            load,
            gyro_share: 0.0,
        }
    }

    fn mixed(row: &Row, gyro_share: f64) -> Reference {
        let gyro = row.gyro_deg.map(|heading| Reference::gyro(row, heading));
        let satellite = row
            .satellite_deg
            .map(|heading| Reference::satellite(row, heading));
        match (gyro, satellite) {
            (Some(gyro), Some(satellite)) => {
                let off = wrap_180(gyro.heading_deg - satellite.heading_deg);
                Reference {
                    heading_deg: satellite.heading_deg + gyro_share * off,
                    load: std::array::from_fn(|i| {
                        gyro_share * gyro.load[i] + (1.0 - gyro_share) * satellite.load[i]
                    }),
                    gyro_share,
                }
            }
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => Reference {
                heading_deg: row.compass_deg,
                load: [0.0; STATES],
                gyro_share: 0.0,
            },
        }
    }

    fn less(&self, other: &Reference, mean: &[f64; STATES], variance: f64) -> Scalar {
        let load: [f64; STATES] = std::array::from_fn(|i| self.load[i] - other.load[i]);
        Scalar {
            innovation: wrap_180(self.heading_deg - other.heading_deg - dot(&load, mean)),
            load,
            variance,
            considered: None,
        }
    }
}

/// Returns course over ground less compass, at the mean. Its slopes are taken on the run until
/// the row before, where this row's noise has no part in them: correlated with the innovation by
/// a hundredth, they would turn current into deviation, because the two differ in little else
/// than how long they last.
fn deviation_by_course(row: &Row, mean: &[f64; STATES], course: &Course, variance: f64) -> Scalar {
    let mut load = [0.0; STATES];
    load[CRAB] = 1.0;
    load_card_and_variation(row, &mut load);
    let ship = Ship::new(row, mean);
    let of_card = mean[ALIGNMENT] + mean[SWING] + load[FRICTION] * mean[FRICTION];
    let needle_at = |compass_deg: f64| {
        let zero_deg = compass_deg + of_card;
        let magnetic_deg = |needle: &Needle| zero_deg + needle.deviation_rad().to_degrees();
        let rough_deg = magnetic_deg(&ship.needle(zero_deg, row));
        let needle = ship.needle(rough_deg, row);
        (magnetic_deg(&needle) + row.variation_deg, needle)
    };
    let (true_deg, needle) = needle_at(row.compass_deg);
    let innovation = course.deg
        - row.compass_deg
        - dot(&load, mean)
        - needle.deviation_rad().to_degrees()
        - Drift::new(true_deg, course.sog_kn, mean).angle_deg;
    let (true_deg, needle) = needle_at(course.run_deg);
    let drift = Drift::new(true_deg, course.sog_kn, mean);
    ship.load(row, &needle, &mut load);
    // The heading by the compass turns the needle and the drift angle, too.
    let moves = (2.0 - needle.compass_per_magnetic()) * (1.0 + drift.by_heading);
    for state in (0..=HEEL).chain([LIST, ALIGNMENT, SWING, FRICTION, BERTH, BERTH + 1]) {
        load[state] *= moves;
    }
    drift.load(&mut load);
    Scalar {
        innovation: wrap_180(innovation),
        load,
        variance,
        considered: Some(STEADY),
    }
}

/// Drift angle on a heading. Over the ground the ship goes across her heading as fast as current
/// and wind set her there: the angle's sine is that speed over the speed over ground.
struct Drift {
    angle_deg: f64,
    /// Growth of the angle by the heading.
    by_heading: f64,
    /// Growth of the angle by a set to the east and to the north, degrees a knot.
    by_set: [f64; 2],
}

impl Drift {
    fn new(true_deg: f64, sog_kn: f64, mean: &[f64; STATES]) -> Drift {
        let (sin, cos) = true_deg.to_radians().sin_cos();
        let set_kn = |states: [usize; 3]| states.iter().map(|i| mean[*i]).sum::<f64>();
        let [east_kn, north_kn] = [set_kn(SETS_EAST), set_kn(SETS_NORTH)];
        let across = (east_kn * cos - north_kn * sin) / sog_kn;
        let sine = across.clamp(-MOST_ACROSS, MOST_ACROSS);
        let cosine = (1.0 - sine * sine).sqrt();
        let deg_per_kn = (1.0 / (sog_kn * cosine)).to_degrees();
        Drift {
            angle_deg: sine.asin().to_degrees(),
            by_heading: -(east_kn * sin + north_kn * cos) / (sog_kn * cosine),
            by_set: [deg_per_kn * cos, -deg_per_kn * sin],
        }
    }

    fn load(&self, load: &mut [f64; STATES]) {
        for (states, by_set) in [SETS_EAST, SETS_NORTH].into_iter().zip(self.by_set) {
            for state in states {
                load[state] = by_set;
            }
        }
    }
}

/// Adds the slopes by the errors of card and variation.
fn load_card_and_variation(row: &Row, load: &mut [f64; STATES]) {
    let by_h = USUAL_H_NT / row.earth.h_nt;
    load[ALIGNMENT] = 1.0;
    load[SWING] = 1.0;
    load[FRICTION] = by_h;
    load[VARIATION] = by_h;
    load[ANOMALY] = by_h;
    load[DAILY] = by_h * row.daily[0];
    load[DAILY + 1] = by_h * row.daily[1];
}

/// Returns reference less compass, at the mean. Its slopes are taken at the heading that the
/// noise of both readings leaves most certain, which is uncorrelated with the innovation: at
/// either reading's own heading, noise would pass for magnetism or for an error of the reference.
fn deviation_by(
    row: &Row,
    mean: &[f64; STATES],
    mut reference: Reference,
    variance: f64,
    reference_part: f64,
) -> Scalar {
    let ship = Ship::new(row, mean);
    let mut of_card = [0.0; STATES];
    load_card_and_variation(row, &mut of_card);
    let by_card = mean[ALIGNMENT] + mean[SWING] + of_card[FRICTION] * mean[FRICTION];
    let by_variation = dot(&of_card, mean) - by_card;
    // Errors of reference and variation turn the heading; those of the compass do not.
    let magnetic_deg =
        |reference: &Reference| reference.heading_deg - dot(&reference.load, mean) - by_variation;
    let innovation_at = |magnetic_deg: f64, needle: &Needle| {
        let deviation_deg = needle.deviation_rad().to_degrees();
        wrap_180(magnetic_deg - row.compass_deg - deviation_deg - by_card)
    };
    let rough_deg = magnetic_deg(&reference);
    let rough = innovation_at(rough_deg, &ship.needle(rough_deg, row));
    let fused_deg = rough_deg - reference_part * rough;
    reference.turn_to(fused_deg + by_variation, row);
    let needle = ship.needle(fused_deg, row);
    let innovation = innovation_at(magnetic_deg(&reference), &needle);
    let mut load = reference.load;
    for (load, of_card) in load.iter_mut().zip(of_card) {
        *load += of_card;
    }
    ship.load(row, &needle, &mut load);
    Scalar {
        innovation: innovation / per_compass(&needle, reference_part),
        load,
        variance,
        considered: None,
    }
}

/// Returns the change of an innovation by that of the compass's reading, which also moves the
/// heading at which the row is taken. Innovations are given by the compass's reading: a ship
/// so magnetic that her compass hardly turns explains no reading by being blind to it.
fn per_compass(needle: &Needle, reference_part: f64) -> f64 {
    let deviation_slope = 1.0 - needle.compass_per_magnetic();
    (1.0 + reference_part * deviation_slope).max(LEAST_PER_COMPASS)
}

/// Ship's magnetism with the fields of a row's circumstances in it.
struct Ship {
    parameters: Parameters,
    retained: Retained,
}

impl Ship {
    fn new(row: &Row, mean: &[f64; STATES]) -> Ship {
        let mut parameters = parameters(mean);
        let retained = Retained::new(row, mean);
        parameters.bx_nt += retained.field_nt[0];
        parameters.by_nt += retained.field_nt[1];
        parameters.by_nt += mean[LIST] * LIST_NT;
        parameters.by_nt += mean[HEEL] * HEEL_NT_PER_RAD * row.roll_rad.unwrap_or(0.0);
        Ship {
            parameters,
            retained,
        }
    }

    fn needle(&self, magnetic_deg: f64, row: &Row) -> Needle {
        Needle::at(
            &self.parameters,
            Direction::from_radians(magnetic_deg.to_radians()),
            row.earth,
        )
    }

    /// Adds the slopes by the ship's states, in degrees.
    fn load(&self, row: &Row, needle: &Needle, load: &mut [f64; STATES]) {
        let slope = needle.gradient().map(f64::to_degrees);
        for j in 0..PARAMETERS {
            load[j] = slope[j] * POPULATION_SD[j];
        }
        let [sx, sy] = [slope[BX], slope[BY]];
        for (load, by_share) in load[RETENTION..].iter_mut().zip(self.retained.by_share) {
            *load = sx * by_share[0] + sy * by_share[1];
        }
        load[BERTH] = sx * self.retained.by_berth;
        load[BERTH + 1] = sy * self.retained.by_berth;
        load[LIST] = sy * LIST_NT;
        load[HEEL] = sy * HEEL_NT_PER_RAD * row.roll_rad.unwrap_or(0.0);
    }
}
