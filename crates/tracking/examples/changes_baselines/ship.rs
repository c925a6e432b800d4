//! A simulated ship as a detector sees her: residuals of the deviation from the
//! product's own fit.
//!
//! A residual of a watched row is from a fit of earlier rows
//! only, renewed every thirty days.

use crate::score::median;
use crate::voyages::fleet::{Event, Log, Name, Plan, sail_log};
use crate::voyages::{Variety, lorden, predicted};
use binnacle_analysis::fit::{
    HeadingReading, Observation, RobustOptions, fit_robust, observe_readings,
};
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::model::Model;
use binnacle_compass::result::Change;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::{AnalysisSettings, REFERENCE_CONSTANT_SD_DEG};
use binnacle_compass::time::Timestamp;

const DAY_S: f64 = 86_400.0;
/// Days that all detectors learn from before they are watched.
pub(crate) const LEARN_DAYS: f64 = 60.0;
/// Days after which residuals are taken from a new fit.
const RENEW_DAYS: f64 = 30.0;
/// Days that a ship sails to which nothing happens, and one to which something does.
const QUIET_DAYS: f64 = 365.0;
const EVENT_DAYS: f64 = 82.0;
/// After a pause longer than this the noise of the row before is forgotten.
const GAP_S: f64 = 1800.0;
/// Noise over hours: of the instruments, and as much of the variation where H is 24 µT.
/// Residuals count for less in waters with more noise, and at magnetic latitudes that the ship
/// has not met, for the fit does not know the deviation there.
const NOISE_DEG: f64 = 0.2;
const HOUR_MICROS: i64 = 3_600_000_000;
/// Distance from an hour's median, in standard deviations, from which a residual is wild.
const WILD: f64 = 3.0;

/// Deviation of a sample against the fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) time: Timestamp,
    pub(crate) residual_deg: f64,
    pub(crate) compass_deg: f64,
    /// Slopes of the deviation by bx and by, degrees per microtesla.
    pub(crate) deg_per_ut: [f64; 2],
    /// True if it follows directly on the previous row.
    pub(crate) follows: bool,
}

/// The rows of an hour.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hour {
    /// Its last row: it is known from then on.
    pub(crate) last: usize,
    /// Mean residual, wild ones left out.
    pub(crate) mean_deg: f64,
    pub(crate) deg_per_ut: [f64; 2],
}

#[derive(Debug)]
pub(crate) struct Ship {
    pub(crate) rows: Vec<Row>,
    pub(crate) hours: Vec<Hour>,
    /// The first row that is watched.
    pub(crate) watched: usize,
    /// Time of the event, and the number of rows that Lorden's bound requires to detect it.
    pub(crate) event: Option<Timestamp>,
    pub(crate) bound_rows: Option<usize>,
    samples: Vec<Sample>,
}

impl Ship {
    /// One year without an event, but with storms, anomalies, faults and wild readings.
    pub(crate) fn quiet(seed: u64) -> Ship {
        Ship::from_log(&sail_log(
            seed,
            &Plan {
                days: QUIET_DAYS,
                ..Plan::new(Event::Nothing, variety(seed))
            },
        ))
    }

    /// One whose magnetism changes when the learning is over.
    pub(crate) fn that_changes(seed: u64, event: Event) -> Ship {
        Ship::from_log(&sail_log(
            seed,
            &Plan {
                days: EVENT_DAYS,
                ..Plan::new(event, variety(seed))
            },
        ))
    }

    fn from_log(log: &Log) -> Ship {
        let observations = observations(&log.samples);
        let row_of = |days: f64| {
            observations
                .partition_point(|o| o.time.unwrap().seconds_since(log.start) < days * DAY_S)
        };
        let watched = row_of(LEARN_DAYS);
        let mut rows: Vec<Row> = Vec::with_capacity(observations.len());
        let (mut known, mut days) = (watched, LEARN_DAYS);
        while rows.len() < observations.len() {
            let model = fit(&observations[..known]);
            days += RENEW_DAYS;
            let until = row_of(days);
            let mut last = rows.last().map(|row| row.time);
            for o in &observations[rows.len()..until] {
                let before = last.replace(o.time.unwrap());
                rows.push(row(o, &model, before));
            }
            known = until;
        }
        let happened = |name: Name| log.happened.iter().find(|h| h.what == name);
        let event = happened(Name::Step).or(happened(Name::Cargo));
        Ship {
            hours: hours(&rows),
            rows,
            watched,
            event: event.map(|event| event.from),
            bound_rows: lorden::rows_needed(log, crate::score::ln_run_length()),
            samples: log.samples.clone(),
        }
    }

    /// Returns the rows at which the product reports a certain change of the vessel's
    /// magnetism.
    pub(crate) fn product_alarms(&self) -> Vec<usize> {
        let reported = binnacle_tracking::analyse(&binnacle_tracking::Input {
            samples: &self.samples,
            logbook: &[],
            azimuths: &[],
            prior: &ShipPrior::population(),
            settings: AnalysisSettings::default(),
        });
        let alarms = reported.changes.iter().filter(|c| is_alarm(c));
        let row = |c: &Change| self.rows.partition_point(|row| row.time < c.detected_at);
        let mut rows: Vec<usize> = alarms.map(row).filter(|row| *row >= self.watched).collect();
        rows.sort_unstable();
        rows
    }

    /// Years that are watched.
    pub(crate) fn years(&self) -> f64 {
        let rows = &self.rows[self.watched..];
        let seconds = rows[rows.len() - 1].time.seconds_since(rows[0].time);
        seconds / (365.25 * DAY_S)
    }

    /// The first row in which the event shows.
    pub(crate) fn changed_row(&self) -> Option<usize> {
        let event = self.event?;
        Some(self.rows.partition_point(|row| row.time < event))
    }

    /// Standard deviation of residuals in the rows before the watch, by their median.
    pub(crate) fn usual_deg(&self) -> f64 {
        spread(self.rows[..self.watched].iter().map(|row| row.residual_deg))
    }

    /// Returns the standard deviation of an hour's means.
    pub(crate) fn usual_hour_deg(&self) -> f64 {
        let learnt = self.hours.iter().filter(|hour| hour.last < self.watched);
        spread(learnt.map(|hour| hour.mean_deg))
    }
}

pub(crate) fn is_alarm(change: &Change) -> bool {
    change.confirmed && change.cause.changes_deviation()
}

fn variety(seed: u64) -> Variety {
    [Variety::Rich, Variety::Medium, Variety::Poor][(seed % 3) as usize]
}

/// The samples against their references, failed references left out, as the product
/// has them.
fn observations(samples: &[Sample]) -> Vec<Observation> {
    let mut day = i64::MIN;
    let mut field = None;
    let readings: Vec<HeadingReading> = samples
        .iter()
        .map(|sample| {
            let of = sample.time.micros().div_euclid(86_400_000_000);
            if std::mem::replace(&mut day, of) != of {
                field = FieldAt::from_time(FieldModel::Igrf14, sample.time).ok();
            }
            let here = field.as_ref().unwrap().at(sample.position, 0.0).unwrap();
            HeadingReading {
                time: Some(sample.time),
                position: Some(sample.position),
                compass: sample.compass,
                gyro: sample.gyro,
                satellite: sample.satellite,
                unnamed: None,
                variation: here.declination(),
                h_nt: here.h_nt(),
                z_nt: here.z_nt,
                sog_kn: sample.sog_kn,
                windows: sample.windows,
                spread_deg: sample.spread_deg,
                weight: 1.0,
            }
        })
        .collect();
    let referred =
        observe_readings(&readings, REFERENCE_CONSTANT_SD_DEG).expect("two good references");
    referred.observations.into_iter().flatten().collect()
}

/// Returns the product's model without the variance of the reference's constant error: a
/// constant is no change.
fn fit(observations: &[Observation]) -> Model {
    let options = RobustOptions::default();
    let fitted = fit_robust(observations, &options);
    let mut model = fitted.expect("two months carry a model").model;
    let covariance = model.covariance.as_mut().expect("every fit has one");
    covariance[7][7] -= options.reference_constant_sd_deg.powi(2);
    model
}

fn row(o: &Observation, model: &Model, before: Option<Timestamp>) -> Row {
    let compass_deg = o.compass.degrees();
    let (fitted, unknown_deg) = predicted(model, compass_deg, o.h_nt, o.z_nt);
    // Over hours the satellite compass is the steadier reference.
    let less = o.gyro_less_satellite_deg.unwrap_or(0.0) * o.gyro_share;
    let usual_deg = NOISE_DEG.hypot(NOISE_DEG * 24_000.0 / o.h_nt);
    let sure = 2.0_f64.sqrt() * NOISE_DEG / usual_deg.hypot(unknown_deg);
    let (sin, cos) = compass_deg.to_radians().sin_cos();
    let time = o.time.unwrap();
    Row {
        time,
        residual_deg: sure * wrap_180(o.deviation.degrees_east() - less - fitted),
        compass_deg,
        deg_per_ut: [sin, cos].map(|part| sure * (part * 1000.0 / o.h_nt).to_degrees()),
        follows: before.is_some_and(|before| time.seconds_since(before) < GAP_S),
    }
}

fn hours(rows: &[Row]) -> Vec<Hour> {
    let hour = |row: &Row| row.time.micros().div_euclid(HOUR_MICROS);
    let usual = spread(rows.iter().map(|row| row.residual_deg));
    let mut last = 0;
    let of_one = |rows: &[Row]| {
        last += rows.len();
        let middle = median(rows.iter().map(|row| row.residual_deg));
        let tame = |row: &&Row| (row.residual_deg - middle).abs() <= WILD * usual;
        let tame: Vec<&Row> = rows.iter().filter(tame).collect();
        let mean = |of: &dyn Fn(&Row) -> f64| {
            tame.iter().map(|row| of(row)).sum::<f64>() / tame.len() as f64
        };
        Hour {
            last: last - 1,
            mean_deg: mean(&|row| row.residual_deg),
            deg_per_ut: [
                mean(&|row| row.deg_per_ut[0]),
                mean(&|row| row.deg_per_ut[1]),
            ],
        }
    };
    rows.chunk_by(|a, b| hour(a) == hour(b))
        .map(of_one)
        .collect()
}

/// Standard deviation by the median absolute value, as wild readings leave it.
pub(crate) fn spread(values: impl Iterator<Item = f64>) -> f64 {
    1.4826 * median(values.map(f64::abs))
}
