//! Readings of one time as the tracker takes them, whatever the hypothesis.

use super::states::RETENTION_S;
use binnacle_analysis::estimate::{Scatter, WhiteNoise};
use binnacle_analysis::fit::Observation;
use binnacle_analysis::gyro_speed_error::northerly_speed_error_deg;
use binnacle_analysis::readings::steady_course::LEAST_SOG_KN;
use binnacle_compass::angle::{CompassHeading, Deviation, TrueHeading, Variation, wrap_180};
use binnacle_compass::position::Position;
use binnacle_compass::sample::{Sample, SourceId};
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

const DAY_S: f64 = 86_400.0;
/// Time between rows, beyond that of sailing from one to the other, that counts as a port
/// call, seconds. Assumed: a call takes that long with its pilotage. Where the speed is not known
/// the ship sails at the usual one, knots.
pub(crate) const PORT_GAP_S: f64 = 2.5 * 3600.0;
pub(crate) const USUAL_KN: f64 = 10.0;
/// Noise of the velocity over the ground across it in a mean of minutes, knots: receiver and
/// seaway. Assumed: it is a degree at 6 knots.
const COURSE_NOISE_KN: f64 = 0.1;
/// Greatest change of heading in a straight run, degrees, greatest time between its rows,
/// seconds, and number of rows over which its mean is taken. Assumed: an hour on one course.
const RUN_DEG: f64 = 5.0;
const RUN_GAP_S: f64 = 3600.0;
const RUN_ROWS: f64 = 6.0;
/// Readings before the step of an instrument is judged, share of them that lie on it, and the
/// distance within which one does. Assumed: instruments give tenths of a degree, or whole and half
/// ones, without exception but for a mean's rounding.
const FEWEST_READINGS: u32 = 10;
const COARSE_SHARE: f64 = 0.95;
const SAME_DIGIT: f64 = 1e-3;

/// Row of readings.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) time: Timestamp,
    /// Time since the row before.
    pub(crate) seconds: f64,
    /// Distance since the row before, and since the first, nautical miles.
    pub(crate) miles: f64,
    pub(crate) sailed_nm: f64,
    /// Turn since the row before, degrees.
    pub(crate) turned_deg: f64,
    /// True if another instrument gives the gyro's heading, or the satellite compass's, than in
    /// the last row that had one.
    pub(crate) new_gyro: bool,
    pub(crate) new_satellite: bool,
    /// True if the ship was in port since the row before.
    pub(crate) after_port: bool,
    /// Port calls until then.
    pub(crate) calls: u32,
    pub(crate) compass_deg: f64,
    /// Heading by gyro and by satellite compass, less the charted variation.
    pub(crate) gyro_deg: Option<f64>,
    pub(crate) satellite_deg: Option<f64>,
    /// Motion over the ground of a ship without either.
    pub(crate) course: Option<Course>,
    pub(crate) variation_deg: f64,
    pub(crate) earth: EarthField,
    pub(crate) cos_lat: f64,
    /// Gyro's speed error on north, degrees.
    pub(crate) northerly_deg: f64,
    /// Local time as an angle.
    pub(crate) daily: [f64; 2],
    /// Lagged horizontal field in ship axes for each memory, nT.
    pub(crate) lagged_nt: [[f64; 2]; 2],
    /// Horizontal field at the last berth that is left in each memory, nT.
    pub(crate) berth_nt: [f64; 2],
    pub(crate) roll_rad: Option<f64>,
    pub(crate) rate_of_turn_deg_min: f64,
    /// Card's motion of late over the usual.
    pub(crate) sea: f64,
    pub(crate) white: WhiteNoise,
    pub(crate) difference_white: WhiteNoise,
}

/// Motion over the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Course {
    /// Course over ground, less the charted variation.
    pub(crate) deg: f64,
    pub(crate) sog_kn: f64,
    /// Mean compass heading of the straight run until the row before; the row's own on a new one.
    pub(crate) run_deg: f64,
}

/// Straight run so far.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Run {
    until: Timestamp,
    /// Mean compass heading over the last rows.
    mean_deg: f64,
    rows: f64,
}

impl Run {
    /// Returns the run with one more row; none if the row is of another run.
    fn with(self, row: Run) -> Option<Run> {
        let off_deg = wrap_180(row.mean_deg - self.mean_deg);
        if off_deg.abs() > RUN_DEG || row.until.seconds_since(self.until) > RUN_GAP_S {
            return None;
        }
        let rows = (self.rows + 1.0).min(RUN_ROWS);
        Some(Run {
            until: row.until,
            mean_deg: self.mean_deg + off_deg / rows,
            rows,
        })
    }
}

/// Maker of rows from samples in order of time: what a row needs of those before it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RowMaker {
    scatter: Scatter,
    /// Steps in which compass, gyro and satellite compass are read.
    digits: [Digits; 3],
    /// Instruments that gave the headings of gyro and satellite compass last.
    sources: [Option<SourceId>; 2],
    last: Option<Last>,
    /// Distance since the first row, nautical miles.
    sailed_nm: f64,
    /// Port calls since the first row.
    calls: u32,
    run: Option<Run>,
    /// Horizontal field in ship axes with each memory, nT.
    lagged_nt: [[f64; 2]; 2],
    berth_nt: [f64; 2],
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Last {
    time: Timestamp,
    position: Position,
    sog_kn: Option<f64>,
    heading_deg: f64,
    field_nt: [f64; 2],
}

/// Sample with what is known of its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    pub(crate) sample: &'a Sample,
    pub(crate) gyro: Option<TrueHeading>,
    pub(crate) variation: Variation,
    pub(crate) earth: EarthField,
}

impl RowMaker {
    pub(crate) fn new() -> RowMaker {
        RowMaker {
            scatter: Scatter::default(),
            digits: [Digits::default(); 3],
            sources: [None; 2],
            last: None,
            sailed_nm: 0.0,
            calls: 0,
            run: None,
            lagged_nt: [[0.0; 2]; 2],
            berth_nt: [0.0; 2],
        }
    }

    /// Returns the row of a sample that has a reference, or a course over ground.
    pub(crate) fn row(&mut self, placed: &Placed<'_>) -> Option<Row> {
        let Placed {
            sample,
            gyro,
            variation,
            earth,
        } = *placed;
        let variation_deg = variation.degrees_east();
        let less = |heading: TrueHeading| wrap_180(heading.degrees() - variation_deg);
        let gyro_deg = gyro.map(less);
        let satellite_deg = sample.satellite.map(less);
        let reference_deg = satellite_deg.or(gyro_deg);
        let course = match reference_deg {
            Some(_) => None,
            None => self.course(sample, variation_deg),
        };
        let heading_deg = reference_deg.or(course.map(|course| course.deg))?;
        let last = self.last;
        let sailed_nm = last.map_or(0.0, |last| miles(last.position, sample.position));
        self.sailed_nm += sailed_nm;
        let seconds = last.map_or(0.0, |last| sample.time.seconds_since(last.time));
        let after_port = last.is_some_and(|last| {
            let speed_kn = last.sog_kn.or(sample.sog_kn).unwrap_or(USUAL_KN);
            let sailing_s = 3600.0 * sailed_nm / speed_kn.max(1.0);
            seconds - sailing_s > PORT_GAP_S
        });
        self.calls += u32::from(after_port);
        let [forward, starboard, _] = earth.in_ship_axes(heading_deg.to_radians());
        let field_nt = [forward, starboard];
        if after_port {
            self.lie_in_port(seconds, earth.h_nt);
        } else {
            self.lag(last, seconds, field_nt);
        }
        self.last = Some(Last {
            time: sample.time,
            position: sample.position,
            sog_kn: sample.sog_kn,
            heading_deg,
            field_nt,
        });
        let observation = observation(placed, gyro_deg.unwrap_or(heading_deg));
        let new_gyro = is_new(&mut self.sources[0], sample.gyro_source);
        let new_satellite = is_new(&mut self.sources[1], sample.satellite_source);
        let [white, difference_white] = self.white(sample, &observation, course);
        let phase = sample.time.micros() as f64 / 1e6 / DAY_S + sample.position.lon_deg() / 360.0;
        let (sin, cos) = (TAU * phase.rem_euclid(1.0)).sin_cos();
        Some(Row {
            time: sample.time,
            seconds,
            miles: sailed_nm,
            sailed_nm: self.sailed_nm,
            turned_deg: last.map_or(0.0, |last| wrap_180(heading_deg - last.heading_deg)),
            new_gyro,
            new_satellite,
            after_port,
            calls: self.calls,
            compass_deg: sample.compass.degrees(),
            gyro_deg,
            satellite_deg,
            course,
            variation_deg,
            earth,
            cos_lat: sample.position.lat_deg().to_radians().cos().max(0.05),
            northerly_deg: northerly_speed_error_deg(
                sample.sog_kn.unwrap_or(0.0),
                sample.position.lat_deg(),
            ),
            daily: [sin, cos],
            lagged_nt: self.lagged_nt,
            berth_nt: self.berth_nt,
            roll_rad: sample.roll_deg.map(f64::to_radians),
            rate_of_turn_deg_min: sample.rate_of_turn_deg_min.unwrap_or(0.0),
            sea: self.scatter.sea(),
            white,
            difference_white,
        })
    }

    fn course(&mut self, sample: &Sample, variation_deg: f64) -> Option<Course> {
        let (cog, sog_kn) = sample.cog.zip(sample.sog_kn)?;
        let own = Run {
            until: sample.time,
            mean_deg: sample.compass.degrees(),
            rows: 1.0,
        };
        let last = self.run;
        let longer = last.and_then(|last| last.with(own));
        self.run = longer.or(Some(own));
        Some(Course {
            deg: wrap_180(cog.degrees() - variation_deg),
            sog_kn: sog_kn.max(LEAST_SOG_KN),
            run_deg: last.filter(|_| longer.is_some()).unwrap_or(own).mean_deg,
        })
    }

    /// Returns the noise that is new in the deviation and in the references' difference, the
    /// instruments' digits in it.
    fn white(
        &mut self,
        sample: &Sample,
        observation: &Observation,
        course: Option<Course>,
    ) -> [WhiteNoise; 2] {
        let headings = [
            Some(sample.compass.degrees()),
            sample.gyro.map(TrueHeading::degrees),
            sample.satellite.map(TrueHeading::degrees),
        ];
        for (digits, heading) in self.digits.iter_mut().zip(headings) {
            digits.note(heading);
        }
        let [compass, gyro, satellite] = self.digits.map(Digits::variance);
        let mut white = self.scatter.white(observation);
        white.scatter += compass + gyro.max(satellite);
        if let Some(course) = course {
            white.scatter += (COURSE_NOISE_KN / course.sog_kn).to_degrees().powi(2);
        }
        let mut difference = WhiteNoise::of_difference(observation);
        difference.scatter += gyro + satellite;
        [white, difference]
    }

    /// Lets the retained field follow the induced one, on the mean of both headings.
    fn lag(&mut self, last: Option<Last>, seconds: f64, field_nt: [f64; 2]) {
        let before = last.map_or(field_nt, |last| last.field_nt);
        let memories = self.lagged_nt.iter_mut().zip(&mut self.berth_nt);
        for ((lagged, of_berth), memory_s) in memories.zip(RETENTION_S) {
            let keep = (-seconds / memory_s).exp();
            *of_berth *= keep;
            for axis in 0..2 {
                let mean = f64::midpoint(before[axis], field_nt[axis]);
                lagged[axis] = mean + (lagged[axis] - mean) * keep;
            }
        }
    }

    /// Lets the retained field follow that of a berth on some heading.
    fn lie_in_port(&mut self, seconds: f64, h_nt: f64) {
        let memories = self.lagged_nt.iter_mut().zip(&mut self.berth_nt);
        for ((lagged, of_berth), memory_s) in memories.zip(RETENTION_S) {
            let keep = (-seconds / memory_s).exp();
            *lagged = lagged.map(|field_nt| keep * field_nt);
            *of_berth = (1.0 - keep) * h_nt;
        }
    }
}

/// Steps in which an instrument's headings are read, found from the readings.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Digits {
    readings: u32,
    /// Readings in whole degrees, and in halves.
    whole: u32,
    halves: u32,
}

impl Digits {
    fn note(&mut self, heading_deg: Option<f64>) {
        let Some(heading_deg) = heading_deg else {
            return;
        };
        let is_multiple = |x: f64| u32::from((x - x.round()).abs() < SAME_DIGIT);
        self.readings += 1;
        self.whole += is_multiple(heading_deg);
        self.halves += is_multiple(2.0 * heading_deg);
    }

    /// Returns the variance of the rounding, degrees squared: even over a step.
    fn variance(self) -> f64 {
        let most = f64::from(self.readings) * COARSE_SHARE;
        let step_deg = if self.readings < FEWEST_READINGS {
            0.0
        } else if f64::from(self.whole) >= most {
            1.0
        } else if f64::from(self.halves) >= most {
            0.5
        } else {
            0.0
        };
        step_deg * step_deg / 12.0
    }
}

/// Returns true if a source is named that is not the last one, and keeps it.
fn is_new(last: &mut Option<SourceId>, now: Option<SourceId>) -> bool {
    let Some(now) = now else {
        return false;
    };
    last.replace(now).is_some_and(|last| last != now)
}

/// Returns the sample as the scatter takes it.
fn observation(placed: &Placed<'_>, heading_deg: f64) -> Observation {
    let sample = placed.sample;
    let off = wrap_180(heading_deg - sample.compass.degrees());
    Observation {
        time: Some(sample.time),
        position: Some(sample.position),
        compass: CompassHeading::new(sample.compass.degrees()).unwrap_or(sample.compass),
        deviation: Deviation::new(off).unwrap_or(Deviation::ZERO),
        variation: placed.variation,
        h_nt: placed.earth.h_nt,
        z_nt: placed.earth.z_nt,
        gyro_share: 1.0,
        gyro_less_satellite_deg: None,
        sog_kn: sample.sog_kn,
        windows: sample.windows,
        spread_deg: sample.spread_deg,
        weight: 1.0,
    }
}

/// Returns the distance in nautical miles, nearly.
fn miles(a: Position, b: Position) -> f64 {
    let north = a.lat_deg() - b.lat_deg();
    let east = wrap_180(a.lon_deg() - b.lon_deg()) * a.lat_deg().to_radians().cos();
    60.0 * north.hypot(east)
}
