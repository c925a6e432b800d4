//! Values of the record as text and numbers.

use binnacle_compass::time::Timestamp;
use binnacle_platform::time::Time;
use chrono::DateTime;
use serde_json::Value;

/// Text of a value; empty for null.
pub(super) fn word(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        other => other.to_string(),
    }
}

/// Number of a value; 0 where it is none.
pub(super) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_default()
}

/// Time for people; the text itself where it is no time.
pub(super) fn minute(value: &Value) -> String {
    let text = word(value);
    Timestamp::parse(&text).map_or(text, |time| Time(time).to_the_minute())
}

/// Local time for people, as `2026-11-21 11:00 (UTC+01:00)`; `None` where it is no time with an
/// offset.
pub(super) fn local_minute(value: &Value) -> Option<String> {
    let time = DateTime::parse_from_rfc3339(value.as_str()?).ok()?;
    Some(time.format("%Y-%m-%d %H:%M (UTC%:z)").to_string())
}
