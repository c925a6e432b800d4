//! Samples of a compass as CSV or NDJSON.

use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use binnacle_compass::result::SampleDiagnostic;
use binnacle_platform::error::{Error, Result};

/// Not `weight`, which `fit` takes for one known beforehand: it would weight the
/// samples twice.
const ROBUST_WEIGHT: &str = "robust_weight";
/// Later columns stand at the end, so that the others keep their places.
const COLUMNS: [&str; 26] = [
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
    "variation_deg",
    "h_nt",
    "z_nt",
    "deviation_deg",
    "predicted_deg",
    "residual_deg",
    ROBUST_WEIGHT,
    "used",
    "reason",
    "cog_deg",
    "roll_deg",
    "roll_spread_deg",
    "temperature_c",
    "gyro_source",
    "satellite_source",
    "position_reckoned",
];

pub(super) fn csv(samples: &[SampleDiagnostic]) -> Result<Response> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let failed = |error: csv::Error| Error::Internal(error.into());
    writer.write_record(COLUMNS).map_err(failed)?;
    for sample in samples {
        // The names in JSON are the names of the other columns.
        let fields = serde_json::to_value(sample)?;
        let name = |column| match column {
            ROBUST_WEIGHT => "weight",
            same => same,
        };
        let record = COLUMNS.map(|column| match &fields[name(column)] {
            serde_json::Value::Null => String::new(),
            serde_json::Value::String(text) => text.clone(),
            other => other.to_string(),
        });
        writer.write_record(record).map_err(failed)?;
    }
    let bytes = writer
        .into_inner()
        .map_err(|error| Error::Internal(anyhow::anyhow!("{error}")))?;
    Ok(([(CONTENT_TYPE, "text/csv; charset=utf-8")], bytes).into_response())
}

pub(super) fn ndjson(samples: &[SampleDiagnostic]) -> Result<Response> {
    let mut lines = String::new();
    for sample in samples {
        lines.push_str(&serde_json::to_string(sample)?);
        lines.push('\n');
    }
    Ok(([(CONTENT_TYPE, "application/x-ndjson")], lines).into_response())
}
