//! A binnacle that tests enter.

use crate::person::{ApiResponse, Person};
use binnacle_adjustment::binnacle::SHIPPED;
use reqwest::Method;
use serde_json::{Value, json};

/// Returns a binnacle with trays, spheres and a Flinders bar in pieces, none of them in use.
pub fn binnacle() -> Value {
    let (_, design) = SHIPPED[0];
    json!({
        "version": 1,
        "serial": "2047",
        "type": serde_json::from_str::<Value>(design).unwrap(),
        "aboard": {
            "magnets": [{ "magnet": "200 mm", "count": 12 }],
            "quadrantal": ["7 inch"],
            "flinders_pieces_mm": [300, 150, 75, 75],
        },
        "setting": {},
    })
}

/// Writes a binnacle.
pub async fn put(person: &Person, path: &str, body: &Value) -> ApiResponse {
    ApiResponse::send(person.request(Method::PUT, path).json(body)).await
}
