//! Least delay of any detector of a change of magnetism: Lorden's bound.
//!
//! With one false alarm in γ rows the mean delay cannot, as γ grows, be less than
//! until the information of the changed rows against unchanged ones reaches ln γ
//! [Lorden 1971; Lai 1998 for rows that depend on each other]. The information is
//! that of the innovations of a Kalman filter over the generator's own errors,
//! stepped by the minute as the generator steps them, their true sizes known, the
//! ship before and after known, and gyro and satellite compass both read. Storms,
//! anomalies, faults and wild readings are left out, and so is drift: no real
//! detector is quite so well off.

use super::bound::swing;
use super::fleet::{Log, Name};
use super::{Faults, needle};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::model::Parameters;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

/// Schuler swing and rate, slow gyro error, compass's swing, crust, multipath, the
/// gyro's speed error; then what the means of ten minutes hold so far of gyro,
/// satellite compass and compass.
const STATES: usize = 10;
const SWING: usize = 0;
const SLOW: usize = 2;
const COMPASS: usize = 3;
const CRUST: usize = 4;
const MULTIPATH: usize = 5;
const SPEED: usize = 6;
const MEANS: [usize; 3] = [7, 8, 9];
/// Minutes in a mean.
const MINUTES: i64 = 10;
/// Days before the change after which the filter has forgotten how it began.
const RUN_UP_S: f64 = 10.0 * 86_400.0;

/// A mean of ten minutes as the errors meet it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Its last minute.
    pub(crate) end: i64,
    /// Sailed since the row before, nautical miles.
    pub(crate) miles: f64,
    pub(crate) cos_lat: f64,
    pub(crate) h_nt: f64,
    /// Full speed error of a gyro, degrees.
    pub(crate) northerly_deg: f64,
    /// Change of the deviation, degrees.
    pub(crate) shift_deg: f64,
}

/// Noise that is the same for all ships, standard deviations in degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Readings {
    /// White noise of a minute's reading of compass, gyro and satellite compass.
    pub(crate) white_deg: [f64; 3],
    /// The satellite compass's error over some thirty minutes.
    pub(crate) multipath_deg: f64,
}

impl Readings {
    /// The generator's.
    pub(crate) const USUAL: Readings = Readings {
        white_deg: [0.35, 0.15, 0.4],
        multipath_deg: 0.2,
    };
}

/// Returns the rows from the change until the information reaches `ln_run_length`; none
/// without a change or where the voyage ends before.
pub(crate) fn rows_needed(log: &Log, ln_run_length: f64) -> Option<usize> {
    let changed = log.changed?;
    let event = |name: Name| log.happened.iter().find(|h| h.what == name);
    let at = event(Name::Step).or(event(Name::Cargo))?.from;
    let begin = at.plus_seconds(-RUN_UP_S);
    let samples = log.samples.partition_point(|s| s.time < begin);
    let samples = &log.samples[samples..];
    let rows = rows(samples, log.start, at, &changed);
    let reported = information(&rows, &log.turns, &log.sizes, Readings::USUAL);
    let reached = reported.iter().position(|ratio| *ratio >= ln_run_length)?;
    let first = rows.iter().position(|row| row.shift_deg != 0.0)?;
    Some(reached + 1 - first)
}

/// Returns the information (log-likelihood ratio) of the first day's rows after the
/// discharge of cargo, for the ship without it against the ship with it.
pub(crate) fn information_of_discharge(log: &Log) -> Option<f64> {
    let [before, laden] = log.changed?;
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo)?;
    let at = cargo.to?;
    let sailed = log.samples.partition_point(|s| s.time <= at);
    let until = log.samples.get(sailed)?.time.plus_seconds(86_400.0);
    let begin = at.plus_seconds(-RUN_UP_S);
    let place = |time: Timestamp| log.samples.partition_point(|s| s.time < time);
    let samples = &log.samples[place(begin)..place(until)];
    let rows = rows(samples, log.start, at, &[laden, before]);
    let reported = information(&rows, &log.turns, &log.sizes, Readings::USUAL);
    reported.last().copied()
}

/// Returns the information (log-likelihood ratio) of the rows with cargo on board, for the
/// ship with it against the ship without it: with less than the logarithm of the rows
/// between two false alarms, no detector can find it.
pub(crate) fn information_while_laden(log: &Log) -> Option<f64> {
    let changed = log.changed?;
    let cargo = log.happened.iter().find(|h| h.what == Name::Cargo)?;
    let begin = cargo.from.plus_seconds(-RUN_UP_S);
    let place = |time: Timestamp| log.samples.partition_point(|s| s.time < time);
    let until = cargo.to.map_or(log.samples.len(), place);
    let rows = rows(
        &log.samples[place(begin)..until],
        log.start,
        cargo.from,
        &changed,
    );
    let reported = information(&rows, &log.turns, &log.sizes, Readings::USUAL);
    reported.last().copied()
}

fn rows(
    samples: &[Sample],
    start: Timestamp,
    at: Timestamp,
    [before, after]: &[Parameters; 2],
) -> Vec<Row> {
    let minute = |time: Timestamp| (time.seconds_since(start) / 60.0).round() as i64;
    let mut last = None;
    let of = |sample: &Sample| {
        let here = sample.position;
        let lat = here.lat_deg().to_radians();
        let miles = last.replace(here).map_or(0.0, |last| {
            let north = here.lat_deg() - last.lat_deg();
            let east = wrap_180(here.lon_deg() - last.lon_deg()) * lat.cos();
            60.0 * north.hypot(east)
        });
        let field = FieldAt::from_time(FieldModel::Igrf14, sample.time).unwrap();
        let field = field.at(here, 0.0).unwrap();
        let (h, z) = (field.h_nt(), field.z_nt);
        // The generator breaks gyros only.
        let heading = sample.satellite.or(sample.gyro).unwrap().degrees();
        let magnetic = heading - field.declination().degrees_east();
        let end = minute(sample.time);
        let changed = (end + 1 - minute(at)).clamp(0, MINUTES) as f64 / MINUTES as f64;
        let turned = needle(before, magnetic, h, z) - needle(after, magnetic, h, z);
        let northerly = sample.sog_kn.unwrap() / (902.5 * lat.cos()) * heading.to_radians().cos();
        Row {
            end,
            miles,
            cos_lat: lat.cos(),
            h_nt: h,
            northerly_deg: northerly.to_degrees(),
            shift_deg: changed * wrap_180(turned),
        }
    };
    samples.iter().map(of).collect()
}

/// Returns the information (log-likelihood ratio) for the shift against none in all rows so
/// far, after each.
pub(crate) fn information(
    rows: &[Row],
    turns: &[i64],
    sizes: &Faults,
    readings: Readings,
) -> Vec<f64> {
    let mut filter = Filter::new(sizes, readings);
    let mut minute = rows.first().map_or(0, |row| row.end - MINUTES);
    let begin = minute;
    let mut turns = turns.iter().skip_while(|turn| **turn <= begin).peekable();
    let mut ratio = 0.0;
    let mut after_each = Vec::with_capacity(rows.len());
    for row in rows {
        let minutes = row.end - minute;
        filter.begin_mean();
        while minute < row.end {
            minute += 1;
            let turned = turns.next_if(|turn| **turn <= minute).is_some();
            filter.minute(row.miles / minutes as f64, turned);
            if minute > row.end - MINUTES {
                filter.add_to_mean(row);
            }
        }
        ratio += filter.take(row.shift_deg);
        after_each.push(ratio);
    }
    after_each
}

struct Filter<'a> {
    sizes: &'a Faults,
    readings: Readings,
    /// Covariance of the errors, given the rows so far.
    covariance: SMatrix<f64, STATES, STATES>,
    /// Bias of the estimate of each by the shift.
    misled: SVector<f64, STATES>,
}

impl Filter<'_> {
    fn new(sizes: &Faults, readings: Readings) -> Filter<'_> {
        let mut covariance = SMatrix::zeros();
        for (state, sd) in [
            (SWING, sizes.schuler_deg),
            (SLOW, sizes.slow_gyro_deg),
            (CRUST, sizes.variation_deg),
            (COMPASS, sizes.swing_deg),
            (MULTIPATH, readings.multipath_deg),
            (SPEED, sizes.speed_error),
        ] {
            covariance[(state, state)] = sd * sd;
        }
        Filter {
            sizes,
            readings,
            covariance,
            misled: SVector::zeros(),
        }
    }

    /// The errors a minute later.
    fn minute(&mut self, miles: f64, turned: bool) {
        let (step, noise, kick) = swing(self.sizes.schuler_deg);
        let mut transition = SMatrix::<f64, STATES, STATES>::identity();
        transition
            .fixed_view_mut::<2, 2>(SWING, SWING)
            .copy_from(&step);
        let mut new = SMatrix::<f64, STATES, STATES>::zeros();
        let both = Matrix2::from_element(if turned { noise + kick } else { noise });
        new.fixed_view_mut::<2, 2>(SWING, SWING).copy_from(&both);
        for (state, share, sd) in [
            (SLOW, 1.0 / 4320.0, self.sizes.slow_gyro_deg),
            (COMPASS, 1.0 / 20.0, self.sizes.swing_deg),
            (CRUST, miles / 60.0, self.sizes.variation_deg),
            (MULTIPATH, 1.0 / 30.0, self.readings.multipath_deg),
        ] {
            let keep = f64::exp(-share);
            transition[(state, state)] = keep;
            new[(state, state)] = sd * sd * (1.0 - keep * keep);
        }
        self.covariance = transition * self.covariance * transition.transpose() + new;
        self.misled = transition * self.misled;
    }

    fn begin_mean(&mut self) {
        for mean in MEANS {
            self.covariance.fill_row(mean, 0.0);
            self.covariance.fill_column(mean, 0.0);
            self.misled[mean] = 0.0;
        }
    }

    fn add_to_mean(&mut self, row: &Row) {
        let share = 1.0 / MINUTES as f64;
        let [gyro, satellite, compass] = MEANS;
        let mut adding = SMatrix::<f64, STATES, STATES>::identity();
        for (mean, state, size) in [
            (gyro, SWING, 1.0 / row.cos_lat),
            (gyro, SLOW, 1.0 / row.cos_lat),
            (gyro, SPEED, row.northerly_deg),
            (satellite, MULTIPATH, 1.0),
            (compass, COMPASS, 1.0),
            (compass, CRUST, 24e3 / row.h_nt),
        ] {
            adding[(mean, state)] = share * size;
        }
        self.covariance = adding * self.covariance * adding.transpose();
        self.misled = adding * self.misled;
    }

    /// Reads the deviations by both references, and returns the information that the shift
    /// adds.
    fn take(&mut self, shift_deg: f64) -> f64 {
        let [gyro, satellite, compass] = MEANS;
        let mut load = SMatrix::<f64, 2, STATES>::zeros();
        for (reference, mean) in [gyro, satellite].into_iter().enumerate() {
            load[(reference, mean)] = 1.0;
            load[(reference, compass)] = 1.0;
        }
        let [common, of_gyro, of_satellite] =
            self.readings.white_deg.map(|sd| sd * sd / MINUTES as f64);
        let white = Matrix2::new(common + of_gyro, common, common, common + of_satellite);
        let seen = self.covariance * load.transpose();
        let variance = load * seen + white;
        let inverse = variance
            .try_inverse()
            .expect("new noise in both references");
        let innovation = Vector2::from_element(shift_deg) - load * self.misled;
        let gain = seen * inverse;
        self.misled += gain * innovation;
        self.covariance -= gain * seen.transpose();
        // Rounding grows over thousands of rows unless it is kept symmetric.
        self.covariance = (self.covariance + self.covariance.transpose()) / 2.0;
        (innovation.transpose() * inverse * innovation)[0] / 2.0
    }
}
