//! CSV export of the audit log.

use crate::audit::Line;
use crate::error::{Error, Result};

/// Column names, the same as in JSON.
const COLUMNS: [&str; 17] = [
    "id",
    "at",
    "actor_kind",
    "actor_id",
    "actor_name",
    "token_id",
    "operator_id",
    "firm_id",
    "address",
    "method",
    "route",
    "path",
    "vessel_id",
    "order_id",
    "status",
    "account",
    "refusal",
];

/// Returns the header row.
pub(super) fn head() -> Vec<u8> {
    format!("{}\n", COLUMNS.join(",")).into_bytes()
}

pub(super) fn lines(lines: &[Line]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for line in lines {
        let fields = serde_json::to_value(line)?;
        let record = COLUMNS.map(|column| match &fields[column] {
            serde_json::Value::Null => String::new(),
            serde_json::Value::String(text) => harmless(text),
            other => other.to_string(),
        });
        writer
            .write_record(record)
            .map_err(|error| Error::Internal(error.into()))?;
    }
    writer
        .into_inner()
        .map_err(|error| Error::Internal(error.into_error().into()))
}

/// Neutralises a text for spreadsheets: people choose their names, and none may be read as
/// a formula.
fn harmless(text: &str) -> String {
    if text.starts_with(['=', '+', '-', '@']) {
        format!("'{text}")
    } else {
        text.to_owned()
    }
}
