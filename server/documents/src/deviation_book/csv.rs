//! Deviation book as CSV.

use super::entry::Entry;
use binnacle_platform::error::{Error, Result};

/// Named as in JSON.
const COLUMNS: [&str; 25] = [
    "time",
    "occasion",
    "lat",
    "lon",
    "compass_deg",
    "reference",
    "true_deg",
    "gyro_deg",
    "satellite_deg",
    "variation_deg",
    "deviation_deg",
    "model_version",
    "card_status",
    "card_deviation_deg",
    "card_band95_deg",
    "difference_deg",
    "windows",
    "spread_deg",
    "reason",
    "observer",
    "compass_error_deg",
    "gyro_error_deg",
    "initials",
    "remark",
    "azimuth_id",
];

/// Returns the line of column names.
pub(super) fn head() -> Vec<u8> {
    format!("{}\n", COLUMNS.join(",")).into_bytes()
}

/// Writes a line for each entry.
pub(super) fn lines(entries: &[Entry]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for entry in entries {
        let fields = serde_json::to_value(entry)?;
        let record = COLUMNS.map(|column| match &fields[column] {
            serde_json::Value::Null => String::new(),
            serde_json::Value::String(text) => text.clone(),
            // Angles are observed to a tenth; the hundredth is for rounding.
            number if column.ends_with("_deg") => number
                .as_f64()
                .map_or_else(String::new, |degrees| format!("{degrees:.2}")),
            number => number.to_string(),
        });
        writer
            .write_record(record)
            .map_err(|error| Error::Internal(error.into()))?;
    }
    writer
        .into_inner()
        .map_err(|error| Error::Internal(error.into_error().into()))
}
