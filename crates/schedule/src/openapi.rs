//! Schemas for an OpenAPI document.
//!
//! All types derive theirs; this module corrects them.

use binnacle_compass::openapi::{allow_unknown_properties, schema_mut};
use utoipa::openapi::OpenApi;

/// Names of the written forms that refuse unknown fields.
const STRICT_FORMS: [&str; 4] = ["CanalTransit", "FirmTeam", "ServedPort", "TravelTime"];

/// Corrects the schemas of this crate's types in a document.
///
/// A form that refuses unknown fields today may accept more of them in a later version, so
/// the document does not rule them out.
pub fn correct(document: &mut OpenApi) {
    for name in STRICT_FORMS {
        if let Some(schema) = schema_mut(document, name) {
            allow_unknown_properties(schema);
        }
    }
}
