//! Converts samples to columns of integers, and back.
//!
//! A column holds one integer per sample, or none where the sample lacks the
//! value. Directions are unwound first: a column never jumps by more than half
//! a circle. Decoding wraps them again.

use super::error::{DecodeError, EncodeError};
use super::step::{Decimal, Step};
use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading, wrap_180};
use binnacle_compass::position::Position;
use binnacle_compass::sample::{
    RATE_OF_TURN_RANGE_DEG_MIN, ROLL_RANGE_DEG, ROLL_SPREAD_RANGE_DEG, Sample, SourceId,
    TEMPERATURE_RANGE_C,
};
use binnacle_compass::time::Timestamp;
use std::ops::RangeInclusive;

/// Column ids, in the order of the frame.
pub(super) const TIME: u64 = 1;
const LAT: u64 = 2;
const LON: u64 = 3;
const GYRO: u64 = 4;
const SATELLITE: u64 = 5;
const COMPASS: u64 = 6;
const SOG: u64 = 7;
const RATE_OF_TURN: u64 = 8;
const SPREAD: u64 = 9;
const WINDOWS: u64 = 10;
const COURSE: u64 = 11;
const ROLL: u64 = 12;
const ROLL_SPREAD: u64 = 13;
const TEMPERATURE: u64 = 14;
const GYRO_SOURCE: u64 = 15;
const SATELLITE_SOURCE: u64 = 16;
const RECKONED: u64 = 17;

/// The last id that this version knows.
pub(super) const LAST_KNOWN: u64 = RECKONED;

/// Columns that every sample has: time, latitude, longitude, compass, windows.
pub(super) const REQUIRED: usize = 5;

/// Seconds since 1970, on the grid of the middles of ten-second windows.
const TIME_STEP: Step = Step::new(5, 0);
/// 111 m: a field model changes by less than 0.005° over that.
const PLACE_STEP: Step = Step::new(1, 3);
const REFERENCE_STEP: Step = Step::new(5, 2);
/// A quarter of the noise of ten-minute means, some 0.1°, rounded down.
const COMPASS_STEP: Step = Step::new(2, 2);
const SOG_STEP: Step = Step::new(2, 1);
const RATE_OF_TURN_STEP: Step = Step::new(5, 1);
const SPREAD_STEP: Step = Step::new(2, 2);
const WINDOWS_STEP: Step = Step::new(1, 0);
/// Well below what currents and wind change from sample to sample.
const COURSE_STEP: Step = Step::new(1, 0);
const ROLL_STEP: Step = Step::new(2, 1);
const ROLL_SPREAD_STEP: Step = Step::new(5, 1);
const TEMPERATURE_STEP: Step = Step::new(1, 0);
const SOURCE_STEP: Step = Step::new(1, 0);
const RECKONED_STEP: Step = Step::new(1, 0);

/// Seconds since 1970 at 1980-01-06, when GPS time begins, and at 2100-01-01.
const TIME_RANGE_S: RangeInclusive<f64> = 315_964_800.0..=4_102_444_800.0;
const SOG_RANGE_KN: RangeInclusive<f64> = 0.0..=200.0;
const SPREAD_RANGE_DEG: RangeInclusive<f64> = 0.0..=180.0;
const WINDOWS_RANGE: RangeInclusive<f64> = 1.0..=65_535.0;
const SOURCE_RANGE: RangeInclusive<f64> = 0.0..=65_535.0;

/// One quantity of all samples.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Column {
    pub(super) id: u64,
    pub(super) step: Step,
    /// One value per sample.
    pub(super) values: Vec<Option<i64>>,
}

/// Refuses a sample that no frame can carry, and names the field.
///
/// An agent checks a sample before it stores it, so that a sealed batch can
/// always be encoded.
///
/// # Errors
/// [`EncodeError::OutOfRange`], with the given `row`.
pub fn check(sample: &Sample, row: usize) -> Result<(), EncodeError> {
    let fields = [
        ("time", Some(seconds(sample.time)), TIME_RANGE_S),
        ("sog_kn", sample.sog_kn, SOG_RANGE_KN),
        (
            "rate_of_turn_deg_min",
            sample.rate_of_turn_deg_min,
            RATE_OF_TURN_RANGE_DEG_MIN,
        ),
        ("spread_deg", sample.spread_deg, SPREAD_RANGE_DEG),
        ("windows", Some(f64::from(sample.windows)), WINDOWS_RANGE),
        ("roll_deg", sample.roll_deg, ROLL_RANGE_DEG),
        (
            "roll_spread_deg",
            sample.roll_spread_deg,
            ROLL_SPREAD_RANGE_DEG,
        ),
        ("temperature_c", sample.temperature_c, TEMPERATURE_RANGE_C),
    ];
    for (field, value, range) in fields {
        let Some(value) = value else { continue };
        if !range.contains(&value) {
            let (low, high) = range.into_inner();
            return Err(EncodeError::OutOfRange {
                row,
                field,
                value,
                low,
                high,
            });
        }
    }
    Ok(())
}

fn seconds(time: Timestamp) -> f64 {
    time.micros() as f64 * 1e-6
}

/// Returns the columns of samples that passed [`check`], without the columns
/// that no sample has.
pub(super) fn from_samples(samples: &[Sample]) -> Vec<Column> {
    let mut columns = vec![
        column(TIME, TIME_STEP, samples, |s| Some(seconds(s.time))),
        column(LAT, PLACE_STEP, samples, |s| Some(s.position.lat_deg())),
        direction(LON, PLACE_STEP, samples, |s| Some(s.position.lon_deg())),
        direction(GYRO, REFERENCE_STEP, samples, |s| {
            s.gyro.map(TrueHeading::degrees)
        }),
        direction(SATELLITE, REFERENCE_STEP, samples, satellite_less_gyro),
        direction(COMPASS, COMPASS_STEP, samples, |s| {
            Some(compass_less_reference(s))
        }),
        column(SOG, SOG_STEP, samples, |s| s.sog_kn),
        column(RATE_OF_TURN, RATE_OF_TURN_STEP, samples, |s| {
            s.rate_of_turn_deg_min
        }),
        column(SPREAD, SPREAD_STEP, samples, |s| s.spread_deg),
        column(WINDOWS, WINDOWS_STEP, samples, |s| {
            Some(f64::from(s.windows))
        }),
        direction(COURSE, COURSE_STEP, samples, course_less_reference),
        column(ROLL, ROLL_STEP, samples, |s| s.roll_deg),
        column(ROLL_SPREAD, ROLL_SPREAD_STEP, samples, |s| {
            s.roll_spread_deg
        }),
        column(TEMPERATURE, TEMPERATURE_STEP, samples, |s| s.temperature_c),
        column(GYRO_SOURCE, SOURCE_STEP, samples, |s| {
            s.gyro_source.map(number)
        }),
        column(SATELLITE_SOURCE, SOURCE_STEP, samples, |s| {
            s.satellite_source.map(number)
        }),
        column(RECKONED, RECKONED_STEP, samples, |s| {
            s.position_reckoned.then_some(1.0)
        }),
    ];
    columns.retain(|column| column.values.iter().any(Option::is_some));
    columns
}

fn number(source: SourceId) -> f64 {
    f64::from(source.number())
}

fn column(
    id: u64,
    step: Step,
    samples: &[Sample],
    value: impl Fn(&Sample) -> Option<f64>,
) -> Column {
    let values = samples
        .iter()
        .map(|s| value(s).map(|v| step.count(v)))
        .collect();
    Column { id, step, values }
}

/// A column of angles, unwound.
fn direction(
    id: u64,
    step: Step,
    samples: &[Sample],
    degrees: impl Fn(&Sample) -> Option<f64>,
) -> Column {
    let mut column = column(id, step, samples, degrees);
    let circle = step
        .circle()
        .expect("the steps of directions divide the circle");
    let mut last = None;
    for value in column.values.iter_mut().flatten() {
        // The first lies within half a circle of north, each later one within
        // half a circle of the one before.
        let near = last.unwrap_or(0);
        *value = near + wrap_half(*value - near, circle);
        last = Some(*value);
    }
    column
}

/// Wraps steps into [−circle/2, circle/2).
fn wrap_half(steps: i64, circle: i64) -> i64 {
    (steps + circle / 2).rem_euclid(circle) - circle / 2
}

/// The gyro heading as it will be decoded.
fn gyro_base(sample: &Sample) -> Decimal {
    sample.gyro.map_or(Decimal::ZERO, |gyro| {
        REFERENCE_STEP.exact(REFERENCE_STEP.count(gyro.degrees()))
    })
}

fn satellite_less_gyro(sample: &Sample) -> Option<f64> {
    let satellite = sample.satellite?.degrees();
    Some(wrap_180(satellite - gyro_base(sample).value()))
}

/// The gyro heading, or without one, that of the satellite compass, as it will be decoded.
fn reference_base(sample: &Sample) -> Decimal {
    match sample.satellite {
        Some(satellite) if sample.gyro.is_none() => {
            REFERENCE_STEP.exact(REFERENCE_STEP.count(satellite.degrees()))
        }
        _ => gyro_base(sample),
    }
}

fn compass_less_reference(sample: &Sample) -> f64 {
    wrap_180(sample.compass.degrees() - reference_base(sample).value())
}

fn course_less_reference(sample: &Sample) -> Option<f64> {
    let course = sample.cog?.degrees();
    Some(wrap_180(course - reference_base(sample).value()))
}

/// Returns the samples of `count` rows; every column has that many values.
pub(super) fn to_samples(columns: &[Column], count: usize) -> Result<Vec<Sample>, DecodeError> {
    for column in columns {
        let turns = matches!(column.id, LON | GYRO | SATELLITE | COMPASS | COURSE);
        if turns && column.step.circle().is_none() {
            return Err(DecodeError::BadStep(column.id));
        }
    }
    let mut samples: Vec<Sample> = Vec::with_capacity(count);
    for row in 0..count {
        let sample = to_sample(&Row { columns, row })?;
        if samples.last().is_some_and(|last| last.time > sample.time) {
            return Err(DecodeError::OutOfOrder(row));
        }
        samples.push(sample);
    }
    Ok(samples)
}

/// The values of one sample.
struct Row<'a> {
    columns: &'a [Column],
    row: usize,
}

impl Row<'_> {
    fn optional(&self, id: u64) -> Option<Decimal> {
        let column = self.columns.iter().find(|column| column.id == id)?;
        column.values[self.row].map(|steps| column.step.exact(steps))
    }

    fn required(&self, id: u64) -> Result<Decimal, DecodeError> {
        self.optional(id).ok_or(DecodeError::MissingColumn(id))
    }

    fn out_of_range(&self, column: u64) -> DecodeError {
        DecodeError::OutOfRange {
            row: self.row,
            column,
        }
    }

    fn within(
        &self,
        id: u64,
        value: Decimal,
        range: &RangeInclusive<f64>,
    ) -> Result<f64, DecodeError> {
        let value = value.value();
        if !range.contains(&value) {
            return Err(self.out_of_range(id));
        }
        Ok(value)
    }

    fn optional_within(
        &self,
        id: u64,
        range: &RangeInclusive<f64>,
    ) -> Result<Option<f64>, DecodeError> {
        self.optional(id)
            .map(|v| self.within(id, v, range))
            .transpose()
    }

    fn source(&self, id: u64) -> Result<Option<SourceId>, DecodeError> {
        let number = self.optional_within(id, &SOURCE_RANGE)?;
        Ok(number.map(|number| SourceId::new(number as u16)))
    }
}

fn to_sample(row: &Row<'_>) -> Result<Sample, DecodeError> {
    let time = row.required(TIME)?;
    row.within(TIME, time, &TIME_RANGE_S)?;
    let lon = row.required(LON)?.wrapped_180().value();
    let position =
        Position::new(row.required(LAT)?.value(), lon).map_err(|_| row.out_of_range(LAT))?;
    let gyro = row.optional(GYRO).map(Decimal::wrapped_360);
    let base = gyro.unwrap_or(Decimal::ZERO);
    let satellite = row.optional(SATELLITE).map(|s| s.plus(base).wrapped_360());
    let reference = gyro.or(satellite).unwrap_or(Decimal::ZERO);
    let compass = row.required(COMPASS)?.plus(reference).wrapped_360();
    let windows = row.within(WINDOWS, row.required(WINDOWS)?, &WINDOWS_RANGE)?;
    let course = row
        .optional(COURSE)
        .map(|c| c.plus(reference).wrapped_360());
    let time = i64::try_from(time.micros())
        .ok()
        .and_then(|micros| Timestamp::from_micros(micros).ok())
        .ok_or(row.out_of_range(TIME))?;
    let compass = CompassHeading::new(compass.value()).ok_or(row.out_of_range(COMPASS))?;
    Ok(Sample {
        gyro: gyro.and_then(|g| TrueHeading::new(g.value())),
        satellite: satellite.and_then(|s| TrueHeading::new(s.value())),
        sog_kn: row.optional_within(SOG, &SOG_RANGE_KN)?,
        rate_of_turn_deg_min: row.optional_within(RATE_OF_TURN, &RATE_OF_TURN_RANGE_DEG_MIN)?,
        spread_deg: row.optional_within(SPREAD, &SPREAD_RANGE_DEG)?,
        windows: windows as u16,
        cog: course.and_then(|c| CourseOverGround::new(c.value())),
        roll_deg: row.optional_within(ROLL, &ROLL_RANGE_DEG)?,
        roll_spread_deg: row.optional_within(ROLL_SPREAD, &ROLL_SPREAD_RANGE_DEG)?,
        temperature_c: row.optional_within(TEMPERATURE, &TEMPERATURE_RANGE_C)?,
        gyro_source: row.source(GYRO_SOURCE)?,
        satellite_source: row.source(SATELLITE_SOURCE)?,
        position_reckoned: row.optional(RECKONED).is_some(),
        ..Sample::new(time, position, compass)
    })
}
