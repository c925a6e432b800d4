//! Samples as the table that `fit` reads.

use binnacle_compass::angle::{CourseOverGround, TrueHeading};
use binnacle_compass::sample::{Sample, SourceId};

/// Returns the table, the names of its columns in the first line.
pub(super) fn write(samples: &[Sample]) -> anyhow::Result<Vec<u8>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record([
        "time",
        "lat",
        "lon",
        "compass_deg",
        "gyro_deg",
        "satellite_deg",
        "sog_kn",
        "rate_of_turn_deg_min",
        "spread_deg",
        "windows",
        "cog_deg",
        "roll_deg",
        "roll_spread_deg",
        "temperature_c",
        "gyro_source",
        "satellite_source",
        "position_reckoned",
    ])?;
    for sample in samples {
        table.write_record(record(sample))?;
    }
    Ok(table.into_inner()?)
}

fn record(sample: &Sample) -> [String; 17] {
    let heading = |heading: Option<TrueHeading>| number(heading.map(TrueHeading::degrees), 3);
    let source =
        |source: Option<SourceId>| source.map_or(String::new(), |s| s.number().to_string());
    [
        sample.time.to_string(),
        number(Some(sample.position.lat_deg()), 5),
        number(Some(sample.position.lon_deg()), 5),
        number(Some(sample.compass.degrees()), 3),
        heading(sample.gyro),
        heading(sample.satellite),
        number(sample.sog_kn, 2),
        number(sample.rate_of_turn_deg_min, 2),
        number(sample.spread_deg, 3),
        sample.windows.to_string(),
        number(sample.cog.map(CourseOverGround::degrees), 2),
        number(sample.roll_deg, 2),
        number(sample.roll_spread_deg, 2),
        number(sample.temperature_c, 1),
        source(sample.gyro_source),
        source(sample.satellite_source),
        sample.position_reckoned.to_string(),
    ]
}

/// Formats a number; an empty field is unknown, never zero.
fn number(value: Option<f64>, decimals: usize) -> String {
    value
        .map(|value| format!("{value:.decimals$}"))
        .unwrap_or_default()
}
