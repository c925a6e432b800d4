//! `analyse`: from a file, what the server does with a vessel's uploads.

use super::{BadInput, answer, input, json};
use crate::config::Analyse;
use binnacle_magnetics::analyse::{AnalysisSettings, LogbookEntry, analyse as run};
use binnacle_magnetics::fit::CsvRow;
use binnacle_magnetics::sample::Sample;
use serde_json::{Map, Value, json};
use std::process::ExitCode;

/// Prints epochs, models and what became of each sample, as JSON.
///
/// # Errors
/// When standard output is closed.
pub fn analyse(arguments: &Analyse) -> anyhow::Result<ExitCode> {
    answer(find(arguments))
}

fn find(arguments: &Analyse) -> Result<String, BadInput> {
    let table = input::Table::read(&arguments.file)?;
    let mut samples = Vec::with_capacity(table.rows.len());
    for (index, row) in table.rows.iter().enumerate() {
        samples.push(sample(row).map_err(|(column, what)| table.invalid(index, column, what))?);
    }
    let logbook: Vec<LogbookEntry> = match &arguments.logbook {
        Some(path) => input::json_file(path)?,
        None => Vec::new(),
    };
    Ok(json(&run(&samples, &logbook, &AnalysisSettings::default())))
}

/// A sample of a row: the checks are those of its JSON form.
fn sample(row: &CsvRow) -> Result<Sample, (&'static str, String)> {
    let fields = [
        ("time", row.time.map(|time| json!(time))),
        ("lat", row.lat.map(Value::from)),
        ("lon", row.lon.map(Value::from)),
        ("compass_deg", row.compass_deg.map(Value::from)),
        ("gyro_deg", row.gyro_deg.map(Value::from)),
        (
            "satellite_deg",
            row.satellite_deg.or(row.reference_deg).map(Value::from),
        ),
        ("sog_kn", row.sog_kn.map(Value::from)),
        (
            "windows",
            Some(json!(
                row.windows.unwrap_or(60.0).clamp(1.0, 65_535.0) as u16
            )),
        ),
    ];
    for (name, value) in &fields[..4] {
        if value.is_none() {
            return Err((name, "is empty".to_owned()));
        }
    }
    let object: Map<String, Value> = fields
        .iter()
        .filter_map(|(name, value)| Some(((*name).to_owned(), value.clone()?)))
        .collect();
    serde_json::from_value(Value::Object(object)).map_err(|error| {
        let what = error.to_string();
        let about = if what.contains("latitude") {
            "lat"
        } else if what.contains("longitude") {
            "lon"
        } else {
            "heading"
        };
        (about, what)
    })
}
