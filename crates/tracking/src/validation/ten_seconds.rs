//! Means of ten seconds of a raw recording, and samples of several of them.

use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading, wrap_180};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;

const MICROS: i64 = 10_000_000;

/// Mean of the rows of ten seconds.
#[derive(Clone, Debug)]
pub(super) struct TenSeconds {
    /// Tens of seconds since 1970.
    pub(super) index: i64,
    /// Row in the middle, for all that is not averaged.
    middle: Sample,
    compass_deg: f64,
    /// Reference less compass.
    gyro_off_deg: Option<f64>,
    satellite_off_deg: Option<f64>,
    cog_off_deg: Option<f64>,
    rate_of_turn_deg_min: Option<f64>,
    roll_deg: Option<f64>,
    pub(super) sog_kn: Option<f64>,
}

impl TenSeconds {
    fn new(rows: &[Sample]) -> Option<TenSeconds> {
        let compass_deg = mean_angle(rows.iter().map(|row| row.compass.degrees()))?;
        let off = |of: fn(&Sample) -> Option<f64>| {
            mean_angle(
                rows.iter()
                    .filter_map(|row| Some(of(row)? - row.compass.degrees())),
            )
        };
        Some(TenSeconds {
            index: rows.first()?.time.micros().div_euclid(MICROS),
            middle: rows[rows.len() / 2],
            compass_deg,
            gyro_off_deg: off(|row| row.gyro.map(TrueHeading::degrees)),
            satellite_off_deg: off(|row| row.satellite.map(TrueHeading::degrees)),
            cog_off_deg: off(|row| row.cog.map(CourseOverGround::degrees)),
            rate_of_turn_deg_min: mean(rows.iter().filter_map(|row| row.rate_of_turn_deg_min)),
            roll_deg: mean(rows.iter().filter_map(|row| row.roll_deg)),
            sog_kn: mean(rows.iter().filter_map(|row| row.sog_kn)),
        })
    }

    pub(super) fn has_reference(&self, grade: ReferenceGrade) -> bool {
        match grade {
            ReferenceGrade::Heading => self.off_deg().is_some(),
            ReferenceGrade::CourseOverGround => self.cog_off_deg.is_some(),
        }
    }

    /// Returns reference less compass.
    fn off_deg(&self) -> Option<f64> {
        self.satellite_off_deg.or(self.gyro_off_deg)
    }

    /// Returns the turn since another one by the steadier of compass and reference: a card swings
    /// in the sea, and a course over ground jitters.
    pub(super) fn turned_deg(&self, other: &TenSeconds) -> f64 {
        let by_compass = wrap_180(self.compass_deg - other.compass_deg).abs();
        let reference = |t: &TenSeconds| Some(t.compass_deg + t.off_deg()?);
        let pair = reference(self).zip(reference(other));
        pair.map_or(by_compass, |(a, b)| by_compass.min(wrap_180(a - b).abs()))
    }
}

/// Returns the means of each ten seconds of rows in order of time.
pub(super) fn ten_seconds(rows: &[Sample]) -> Vec<TenSeconds> {
    let index = |row: &Sample| row.time.micros().div_euclid(MICROS);
    rows.chunk_by(|a, b| index(a) == index(b))
        .filter_map(TenSeconds::new)
        .collect()
}

/// Returns the sample of tens of seconds on one heading; none without any.
pub(super) fn mean_sample(tens: &[&TenSeconds]) -> Option<Sample> {
    let (first, last) = (tens.first()?, tens.last()?);
    let middle = &tens[tens.len() / 2].middle;
    let middle_micros = (first.index + last.index + 1) * (MICROS / 2);
    let compass_deg = mean_angle(tens.iter().map(|t| t.compass_deg))?;
    // Differences are averaged: a reference that drops out shifts nothing.
    let by = |of: fn(&TenSeconds) -> Option<f64>| {
        let known: Vec<f64> = tens.iter().filter_map(|t| of(t)).collect();
        if known.len() * 2 < tens.len() {
            return None;
        }
        Some(compass_deg + mean_angle(known)?)
    };
    let average = |of: fn(&TenSeconds) -> Option<f64>| mean(tens.iter().filter_map(|t| of(t)));
    Some(Sample {
        gyro: by(|t| t.gyro_off_deg).and_then(TrueHeading::new),
        satellite: by(|t| t.satellite_off_deg).and_then(TrueHeading::new),
        cog: by(|t| t.cog_off_deg).and_then(CourseOverGround::new),
        sog_kn: average(|t| t.sog_kn),
        rate_of_turn_deg_min: average(|t| t.rate_of_turn_deg_min),
        roll_deg: average(|t| t.roll_deg),
        spread_deg: spread(tens),
        windows: tens.len().min(usize::from(u16::MAX)) as u16,
        gyro_source: middle.gyro_source,
        satellite_source: middle.satellite_source,
        position_reckoned: middle.position_reckoned,
        temperature_c: middle.temperature_c,
        ..Sample::new(
            Timestamp::from_micros(middle_micros).ok()?,
            middle.position,
            CompassHeading::new(compass_deg)?,
        )
    })
}

/// Returns the standard deviation of reference less compass; none of a single one.
fn spread(tens: &[&TenSeconds]) -> Option<f64> {
    let offs: Vec<f64> = tens.iter().filter_map(|t| t.off_deg()).collect();
    let middle = mean_angle(offs.iter().copied())?;
    let squares: f64 = offs.iter().map(|x| wrap_180(x - middle).powi(2)).sum();
    (offs.len() > 1).then(|| (squares / (offs.len() - 1) as f64).sqrt())
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value;
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}

/// Returns the mean of angles that lie near each other; none of none.
pub(super) fn mean_angle(angles: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut angles = angles.into_iter().peekable();
    let origin = *angles.peek()?;
    let off = mean(angles.map(|angle| wrap_180(angle - origin)))?;
    Some(origin + off)
}
