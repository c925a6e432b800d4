//! Rows of users' tables of headings, and the readings made of them.
//!
//! The caller reads the file. The required columns and the meaning of a row are decided
//! here.

mod motion;

pub use motion::Motion;

use super::HeadingReading;
use crate::gyro_speed_error::gyro_speed_error_deg;
use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation};
use binnacle_compass::field::{FieldAt, FieldModel};
use binnacle_compass::model::ReferenceGrade;
use binnacle_compass::number::CompactNumber;
use binnacle_compass::position::Position;
use binnacle_compass::settings::GyroSpeedError;
use binnacle_compass::time::Timestamp;
use std::cmp::Ordering;

/// A row: every column that such a table may have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CsvRow {
    /// `time`
    pub time: Option<Timestamp>,
    /// `lat`, degrees north.
    pub lat: Option<f64>,
    /// `lon`, degrees east.
    pub lon: Option<f64>,
    /// `variation_deg`, east positive; in place of time and position.
    pub variation_deg: Option<f64>,
    /// `h_nt`, with `variation_deg`.
    pub h_nt: Option<f64>,
    /// `z_nt`, with `variation_deg`.
    pub z_nt: Option<f64>,
    /// `compass_deg`, as read.
    pub compass_deg: Option<f64>,
    /// `gyro_deg`
    pub gyro_deg: Option<f64>,
    /// `satellite_deg`
    pub satellite_deg: Option<f64>,
    /// `reference_deg`: a true heading of unnamed origin.
    pub reference_deg: Option<f64>,
    /// `sog_kn`
    pub sog_kn: Option<f64>,
    /// `cog_deg`: course over ground.
    pub cog_deg: Option<f64>,
    /// `rate_of_turn_deg_min`, starboard positive.
    pub rate_of_turn_deg_min: Option<f64>,
    /// `roll_deg`: mean roll, starboard down positive.
    pub roll_deg: Option<f64>,
    /// `roll_spread_deg`: standard deviation of roll.
    pub roll_spread_deg: Option<f64>,
    /// `temperature_c`
    pub temperature_c: Option<f64>,
    /// `gyro_source`: number of the instrument that gave the gyro heading.
    pub gyro_source: Option<f64>,
    /// `satellite_source`: number of the instrument that gave the satellite-compass heading.
    pub satellite_source: Option<f64>,
    /// `windows`: settled ten-second windows in the row.
    pub windows: Option<f64>,
    /// `spread_deg`: standard deviation of compass less reference among the windows.
    pub spread_deg: Option<f64>,
    /// `weight` beside the other rows; 1 when absent.
    pub weight: Option<f64>,
    /// `position_reckoned`: set if the position is by dead reckoning, under interference with GNSS.
    /// No estimate uses the row.
    pub position_reckoned: bool,
}

/// Error of a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CsvRowError {
    /// A required column is missing from the header.
    #[error("missing column {0}")]
    MissingColumn(&'static str),
    /// A required value is empty.
    #[error("{column} is empty")]
    Empty {
        /// Row, counted from 0.
        row: usize,
        /// Column of the row.
        column: &'static str,
    },
    /// A value is not one that the column may hold.
    #[error("{column}: {message}")]
    Invalid {
        /// Row, counted from 0.
        row: usize,
        /// Column of the row.
        column: &'static str,
        /// Reason.
        message: String,
    },
}

impl CsvRowError {
    /// Returns the row at fault, counted from 0; none when the header is.
    pub fn row(&self) -> Option<usize> {
        match self {
            CsvRowError::MissingColumn(_) => None,
            CsvRowError::Empty { row, .. } | CsvRowError::Invalid { row, .. } => Some(*row),
        }
    }

    /// Returns the column at fault.
    pub fn column(&self) -> &'static str {
        match self {
            CsvRowError::MissingColumn(column)
            | CsvRowError::Empty { column, .. }
            | CsvRowError::Invalid { column, .. } => column,
        }
    }
}

/// Checks that a header has what a fit needs: `compass_deg`; one of `gyro_deg`,
/// `satellite_deg` and `reference_deg`; and either `variation_deg`, `h_nt` and `z_nt` or
/// `time`, `lat` and `lon`. On a ship without these headings `cog_deg` and `sog_kn` stand for
/// them, with `time`, `lat` and `lon`.
///
/// # Errors
/// [`CsvRowError::MissingColumn`] with the first that is missing.
pub fn check_columns<'a>(header: impl IntoIterator<Item = &'a str>) -> Result<(), CsvRowError> {
    let header: Vec<&str> = header.into_iter().collect();
    let has = |name: &str| header.contains(&name);
    let need = |name: &'static str| {
        if has(name) {
            Ok(())
        } else {
            Err(CsvRowError::MissingColumn(name))
        }
    };
    need("compass_deg")?;
    let has_heading = ["gyro_deg", "satellite_deg", "reference_deg"]
        .into_iter()
        .any(has);
    if !has_heading {
        if !has("cog_deg") {
            return Err(CsvRowError::MissingColumn(
                "gyro_deg, satellite_deg, reference_deg or cog_deg",
            ));
        }
        need("sog_kn")?;
        need("time")?;
        need("lat")?;
        return need("lon");
    }
    if ["variation_deg", "h_nt", "z_nt"].into_iter().any(has) && !(has("lat") && has("lon")) {
        need("variation_deg")?;
        need("h_nt")?;
        return need("z_nt");
    }
    need("time")?;
    need("lat")?;
    need("lon")
}

/// Returns the grade of a table: that of course over ground if no row has a true heading, and
/// some have a course.
pub fn reference_grade(rows: &[CsvRow]) -> ReferenceGrade {
    let heading = |row: &CsvRow| row.gyro_deg.or(row.satellite_deg).or(row.reference_deg);
    let has_course = rows.iter().any(|row| row.cog_deg.is_some());
    if has_course && rows.iter().all(|row| heading(row).is_none()) {
        ReferenceGrade::CourseOverGround
    } else {
        ReferenceGrade::Heading
    }
}

/// Makes readings of rows, in order of time and then of everything else, so that the order
/// of the rows changes nothing. Identical rows count once, with a time or without. Where a
/// row has both a field and a place, the field as given is used. Rows whose position is by dead
/// reckoning are checked and left out.
///
/// # Errors
/// Fails at the first row and column that are empty or invalid. A row without any reference
/// heading is not an error.
pub fn readings_from_csv(
    rows: &[CsvRow],
    gyro_speed_error: GyroSpeedError,
) -> Result<Vec<HeadingReading>, CsvRowError> {
    let indexed = rows.iter().enumerate();
    let mut readings = Vec::with_capacity(rows.len());
    for (index, row) in indexed {
        let reading = reading(row, index, gyro_speed_error)?;
        if !row.position_reckoned {
            readings.push(reading);
        }
    }
    readings.sort_by(in_order);
    readings.dedup_by(|a, b| in_order(a, b).is_eq());
    Ok(readings)
}

fn in_order(a: &HeadingReading, b: &HeadingReading) -> Ordering {
    let numbers = |r: &HeadingReading| {
        // A missing value sorts first.
        let or_first = |x: Option<f64>| x.unwrap_or(f64::NEG_INFINITY);
        [
            or_first(r.position.map(Position::lat_deg)),
            or_first(r.position.map(Position::lon_deg)),
            r.compass.degrees(),
            or_first(r.gyro.map(TrueHeading::degrees)),
            or_first(r.satellite.map(TrueHeading::degrees)),
            or_first(r.unnamed.map(TrueHeading::degrees)),
            r.variation.degrees_east(),
            r.h_nt,
            r.z_nt,
            or_first(r.sog_kn),
            f64::from(r.windows),
            or_first(r.spread_deg),
            r.weight,
        ]
    };
    let by_number = || {
        let pairs = numbers(a).into_iter().zip(numbers(b));
        pairs
            .map(|(a, b)| a.total_cmp(&b))
            .find(|order| order.is_ne())
            .unwrap_or(Ordering::Equal)
    };
    a.time.cmp(&b.time).then_with(by_number)
}

fn reading(
    row: &CsvRow,
    index: usize,
    speed: GyroSpeedError,
) -> Result<HeadingReading, CsvRowError> {
    let column = Column { row: index };
    let compass_deg = column.needed("compass_deg", row.compass_deg)?;
    let sog_kn = column.at_least_zero("sog_kn", row.sog_kn)?;
    let position = match (row.lat, row.lon) {
        (Some(lat), Some(lon)) => {
            // Longitude zero shows which of the two is at fault.
            let latitude = Position::new(lat, 0.0);
            latitude.map_err(|e| column.invalid("lat", &e.to_string()))?;
            Some(Position::new(lat, lon).map_err(|e| column.invalid("lon", &e.to_string()))?)
        }
        (Some(_), None) => return Err(column.empty("lon")),
        (None, Some(_)) => return Err(column.empty("lat")),
        (None, None) => None,
    };
    let (variation, h_nt, z_nt) = column.field(row, position)?;
    let mut gyro: Option<TrueHeading> = column.heading("gyro_deg", row.gyro_deg)?;
    if let (GyroSpeedError::Uncorrected, Some(read), Some(sog_kn), Some(place)) =
        (speed, gyro, sog_kn, position)
    {
        let error = gyro_speed_error_deg(read, sog_kn, place.lat_deg());
        gyro = TrueHeading::new(read.degrees() - error);
    }
    let windows = column.at_least_zero("windows", row.windows)?;
    // A fit uses none of these, but they must be valid.
    Motion::from_row(row, index)?;
    Ok(HeadingReading {
        time: row.time,
        position,
        compass: CompassHeading::try_from(compass_deg)
            .map_err(|e| column.invalid("compass_deg", &e.to_string()))?,
        gyro,
        satellite: column.heading("satellite_deg", row.satellite_deg)?,
        unnamed: column.heading("reference_deg", row.reference_deg)?,
        variation,
        h_nt,
        z_nt,
        sog_kn,
        // Without a count a row is taken for a whole ten-minute mean.
        windows: windows.map_or(60.0, |n| n.clamp(1.0, 65_535.0)) as u16,
        spread_deg: column.at_least_zero("spread_deg", row.spread_deg)?,
        weight: column.at_least_zero("weight", row.weight)?.unwrap_or(1.0),
    })
}

/// Row named in its error messages.
struct Column {
    row: usize,
}

impl Column {
    fn empty(&self, column: &'static str) -> CsvRowError {
        CsvRowError::Empty {
            row: self.row,
            column,
        }
    }

    fn invalid(&self, column: &'static str, message: &str) -> CsvRowError {
        CsvRowError::Invalid {
            row: self.row,
            column,
            message: message.to_owned(),
        }
    }

    fn needed(&self, column: &'static str, value: Option<f64>) -> Result<f64, CsvRowError> {
        value.ok_or_else(|| self.empty(column))
    }

    fn heading(
        &self,
        column: &'static str,
        value: Option<f64>,
    ) -> Result<Option<TrueHeading>, CsvRowError> {
        value
            .map(TrueHeading::try_from)
            .transpose()
            .map_err(|e| self.invalid(column, &e.to_string()))
    }

    fn at_least_zero(
        &self,
        column: &'static str,
        value: Option<f64>,
    ) -> Result<Option<f64>, CsvRowError> {
        match value {
            Some(number) if !(number >= 0.0 && number.is_finite()) => Err(self.invalid(
                column,
                &format!("{} is not a number of 0 or more", CompactNumber(number)),
            )),
            _ => Ok(value),
        }
    }

    /// Returns variation, H and Z: as the row gives them, or from its time and place.
    fn field(
        &self,
        row: &CsvRow,
        position: Option<Position>,
    ) -> Result<(Variation, f64, f64), CsvRowError> {
        if row.variation_deg.is_some() || position.is_none() {
            let given = self.needed("variation_deg", row.variation_deg)?;
            let variation = Variation::try_from(given)
                .map_err(|e| self.invalid("variation_deg", &e.to_string()))?;
            let h_nt = self.needed("h_nt", row.h_nt)?;
            if !(h_nt > 0.0 && h_nt <= 1e6) {
                return Err(self.invalid(
                    "h_nt",
                    &format!("{} nT is not a valid horizontal field", CompactNumber(h_nt)),
                ));
            }
            let z_nt = self.needed("z_nt", row.z_nt)?;
            if !(-1e6..=1e6).contains(&z_nt) {
                return Err(self.invalid(
                    "z_nt",
                    &format!("{} nT is not a valid vertical field", CompactNumber(z_nt)),
                ));
            }
            return Ok((variation, h_nt, z_nt));
        }
        let place = position.ok_or_else(|| self.empty("lat"))?;
        let time = row.time.ok_or_else(|| self.empty("time"))?;
        let field = FieldAt::from_time(FieldModel::Igrf14, time)
            .and_then(|model| model.at(place, 0.0))
            .map_err(|e| self.invalid("time", &e.to_string()))?;
        Ok((field.declination(), field.h_nt(), field.z_nt))
    }
}

#[cfg(test)]
mod tests;
