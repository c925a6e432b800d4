//! Values of a row beside its headings: course, motion, temperature, instruments.

use super::{Column, CsvRow, CsvRowError};
use binnacle_compass::angle::CourseOverGround;
use binnacle_compass::number::CompactNumber;
use binnacle_compass::sample::{
    RATE_OF_TURN_RANGE_DEG_MIN, ROLL_RANGE_DEG, ROLL_SPREAD_RANGE_DEG, Sample, SourceId,
    TEMPERATURE_RANGE_C,
};
use std::ops::RangeInclusive;

/// Values of a row beside its headings, each within its range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Course over ground.
    pub cog: Option<CourseOverGround>,
    /// Rate of turn, degrees a minute, starboard positive.
    pub rate_of_turn_deg_min: Option<f64>,
    /// Mean roll, degrees, starboard down positive.
    pub roll_deg: Option<f64>,
    /// Standard deviation of roll, degrees.
    pub roll_spread_deg: Option<f64>,
    /// Temperature, degrees Celsius.
    pub temperature_c: Option<f64>,
    /// Instrument that gave the gyro heading.
    pub gyro_source: Option<SourceId>,
    /// Instrument that gave the satellite-compass heading.
    pub satellite_source: Option<SourceId>,
}

impl Motion {
    /// Takes the values of a row, counted from 0.
    ///
    /// # Errors
    /// Fails at the first column whose value is out of its range.
    pub fn from_row(row: &CsvRow, index: usize) -> Result<Motion, CsvRowError> {
        let column = Column { row: index };
        let within = |name, value, range| column.within(name, value, &range);
        let cog = row.cog_deg.map(CourseOverGround::try_from).transpose();
        Ok(Motion {
            cog: cog.map_err(|e| column.invalid("cog_deg", &e.to_string()))?,
            rate_of_turn_deg_min: within(
                "rate_of_turn_deg_min",
                row.rate_of_turn_deg_min,
                RATE_OF_TURN_RANGE_DEG_MIN,
            )?,
            roll_deg: within("roll_deg", row.roll_deg, ROLL_RANGE_DEG)?,
            roll_spread_deg: within(
                "roll_spread_deg",
                row.roll_spread_deg,
                ROLL_SPREAD_RANGE_DEG,
            )?,
            temperature_c: within("temperature_c", row.temperature_c, TEMPERATURE_RANGE_C)?,
            gyro_source: column.source("gyro_source", row.gyro_source)?,
            satellite_source: column.source("satellite_source", row.satellite_source)?,
        })
    }

    /// Returns a sample with these values in place of its own.
    pub fn put_into(self, sample: Sample) -> Sample {
        Sample {
            cog: self.cog,
            rate_of_turn_deg_min: self.rate_of_turn_deg_min,
            roll_deg: self.roll_deg,
            roll_spread_deg: self.roll_spread_deg,
            temperature_c: self.temperature_c,
            gyro_source: self.gyro_source,
            satellite_source: self.satellite_source,
            ..sample
        }
    }
}

impl Column {
    fn within(
        &self,
        column: &'static str,
        value: Option<f64>,
        range: &RangeInclusive<f64>,
    ) -> Result<Option<f64>, CsvRowError> {
        match value {
            Some(number) if !range.contains(&number) => {
                let (low, high) = (range.start(), range.end());
                let message = format!("{} is not within {low} to {high}", CompactNumber(number));
                Err(self.invalid(column, &message))
            }
            _ => Ok(value),
        }
    }

    fn source(
        &self,
        column: &'static str,
        value: Option<f64>,
    ) -> Result<Option<SourceId>, CsvRowError> {
        let Some(number) = self.within(column, value, &(0.0..=f64::from(u16::MAX)))? else {
            return Ok(None);
        };
        if number.fract() != 0.0 {
            let message = format!("{} is not a whole number", CompactNumber(number));
            return Err(self.invalid(column, &message));
        }
        Ok(Some(SourceId::new(number as u16)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_taken_and_an_empty_one_is_absent() {
        let row = CsvRow {
            cog_deg: Some(359.5),
            rate_of_turn_deg_min: Some(-2.0),
            roll_deg: Some(-1.5),
            roll_spread_deg: Some(3.0),
            temperature_c: Some(-4.0),
            gyro_source: Some(65_535.0),
            ..CsvRow::default()
        };
        let expected = Motion {
            cog: CourseOverGround::new(359.5),
            rate_of_turn_deg_min: Some(-2.0),
            roll_deg: Some(-1.5),
            roll_spread_deg: Some(3.0),
            temperature_c: Some(-4.0),
            gyro_source: Some(SourceId::new(u16::MAX)),
            satellite_source: None,
        };
        assert_eq!(Motion::from_row(&row, 0), Ok(expected));
        let none = Motion::from_row(&CsvRow::default(), 0);
        assert_eq!(none, Ok(Motion::default()));
    }

    #[test]
    fn a_bad_value_is_refused_by_name() {
        let wrong = |row: CsvRow| Motion::from_row(&row, 7).unwrap_err();
        let row = CsvRow::default();
        let found = [
            wrong(CsvRow {
                cog_deg: Some(360.5),
                ..row
            }),
            wrong(CsvRow {
                rate_of_turn_deg_min: Some(3601.0),
                ..row
            }),
            wrong(CsvRow {
                roll_deg: Some(-90.5),
                ..row
            }),
            wrong(CsvRow {
                roll_spread_deg: Some(-0.1),
                ..row
            }),
            wrong(CsvRow {
                temperature_c: Some(f64::NAN),
                ..row
            }),
            wrong(CsvRow {
                gyro_source: Some(1.5),
                ..row
            }),
            wrong(CsvRow {
                satellite_source: Some(65_536.0),
                ..row
            }),
        ];
        let texts = found.each_ref().map(ToString::to_string);
        assert_eq!(
            texts,
            [
                "cog_deg: 360.5 degrees is outside 0 to 360",
                "rate_of_turn_deg_min: 3601 is not within -3600 to 3600",
                "roll_deg: -90.5 is not within -90 to 90",
                "roll_spread_deg: -0.1 is not within 0 to 90",
                "temperature_c: NaN is not within -100 to 100",
                "gyro_source: 1.5 is not a whole number",
                "satellite_source: 65536 is not within 0 to 65535",
            ]
        );
        assert!(found.iter().all(|error| error.row() == Some(7)));
    }
}
