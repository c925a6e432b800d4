//! `analyse`: analyses a file as the server analyses a vessel's uploads.

use super::{BadInput, input, json, logbook, print_result};
use crate::cli::{Analyse, GyroSpeedError};
use binnacle_analysis::advice::sail_next;
use binnacle_analysis::fit::{CsvRow, Motion, readings_from_csv};
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::position::Position;
use binnacle_compass::result::{Analysis, SailNext};
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_tracking::Input;
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;

/// Printed result.
#[derive(Serialize)]
struct Analysed {
    #[serde(flatten)]
    analysis: Analysis,
    sail_next: Option<SailNext>,
}

/// Prints epochs, models, headings to sail next and the use of each sample, as JSON.
///
/// # Errors
/// Fails when standard output cannot be written.
pub fn analyse(arguments: &Analyse) -> anyhow::Result<ExitCode> {
    print_result(find(arguments))
}

fn find(arguments: &Analyse) -> Result<String, BadInput> {
    let samples = read_samples(&arguments.file, arguments.gyro_speed_error)?;
    let logbook = read_logbook(arguments.logbook.as_deref())?;
    let settings = AnalysisSettings {
        gyro_speed_error: arguments.gyro_speed_error.into(),
        ..AnalysisSettings::default()
    };
    let analysis = binnacle_tracking::analyse(&Input {
        samples: &samples,
        logbook: &logbook,
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings,
    });
    Ok(json(&Analysed {
        sail_next: sail_next(&analysis),
        analysis,
    }))
}

/// Reads the samples of a table.
pub(super) fn read_samples(
    path: &Path,
    gyro_speed_error: GyroSpeedError,
) -> Result<Vec<Sample>, BadInput> {
    samples(&input::Table::read(path)?, gyro_speed_error)
}

/// Returns the samples of a table.
pub(super) fn samples(
    table: &input::Table,
    gyro_speed_error: GyroSpeedError,
) -> Result<Vec<Sample>, BadInput> {
    // Input that `fit` refuses is refused here too.
    readings_from_csv(&table.rows, gyro_speed_error.into())
        .map_err(|error| table.error_at(&error))?;
    let mut samples = Vec::with_capacity(table.rows.len());
    for (index, row) in table.rows.iter().enumerate() {
        let sample = sample(row).map_err(|(column, what)| table.invalid(index, column, what))?;
        let motion = Motion::from_row(row, index).map_err(|error| table.error_at(&error))?;
        samples.push(motion.put_into(sample));
    }
    Ok(samples)
}

/// Reads a logbook, which is empty without a file.
pub(super) fn read_logbook(path: Option<&Path>) -> Result<Vec<LogbookEntry>, BadInput> {
    path.map_or_else(|| Ok(Vec::new()), logbook::read)
}

/// Returns the sample of a row, or the column at fault and the problem.
fn sample(row: &CsvRow) -> Result<Sample, (&'static str, String)> {
    let empty = |column| move || (column, "is empty".to_owned());
    let lat = row.lat.ok_or_else(empty("lat"))?;
    let lon = row.lon.ok_or_else(empty("lon"))?;
    let compass_deg = row.compass_deg.ok_or_else(empty("compass_deg"))?;
    // Replacing the other coordinate by 0 shows which one is at fault.
    Position::new(lat, 0.0).map_err(|error| ("lat", error.to_string()))?;
    let (satellite, satellite_deg) = match row.satellite_deg {
        Some(found) => ("satellite_deg", Some(found)),
        None => ("reference_deg", row.reference_deg),
    };
    let time = row.time.ok_or_else(empty("time"))?;
    let position = Position::new(lat, lon).map_err(|error| ("lon", error.to_string()))?;
    let compass = CompassHeading::try_from(compass_deg)
        .map_err(|error| ("compass_deg", error.to_string()))?;
    Ok(Sample {
        gyro: heading("gyro_deg", row.gyro_deg)?,
        satellite: heading(satellite, satellite_deg)?,
        sog_kn: row.sog_kn,
        spread_deg: row.spread_deg,
        windows: row.windows.unwrap_or(60.0).clamp(1.0, 65_535.0) as u16,
        position_reckoned: row.position_reckoned,
        ..Sample::new(time, position, compass)
    })
}

fn heading(
    column: &'static str,
    degrees: Option<f64>,
) -> Result<Option<TrueHeading>, (&'static str, String)> {
    degrees
        .map(TrueHeading::try_from)
        .transpose()
        .map_err(|error| (column, error.to_string()))
}
