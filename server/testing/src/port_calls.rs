//! Port calls that tests enter.

use serde_json::{Value, json};

pub fn path(vessel: &Value) -> String {
    format!("/vessels/{}/port-calls", vessel["id"].as_str().unwrap())
}

/// Returns a port call of two days in December 2026.
pub fn call(port: &str, day: u32) -> Value {
    json!({
        "port": port,
        "eta": format!("2026-12-{day:02}T06:00:00Z"),
        "etd": format!("2026-12-{:02}T18:00:00Z", day + 1),
    })
}
