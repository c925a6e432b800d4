//! File responses, and safe file names.

use axum::body::Body;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use utoipa::openapi::schema::{KnownFormat, SchemaFormat};
use utoipa::openapi::{ObjectBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

/// Content of a file in the OpenAPI document: bytes, also where they are text.
pub struct FileContent;

impl PartialSchema for FileContent {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(Type::String)
            .format(Some(SchemaFormat::KnownFormat(KnownFormat::Binary)))
            .into()
    }
}

impl ToSchema for FileContent {}

/// Returns a response with a file that a browser shows, and saves under the given name.
pub fn file(kind: &'static str, name: &str, body: impl Into<Body>) -> Response {
    let headers = [
        (CONTENT_TYPE, kind.to_owned()),
        (CONTENT_DISPOSITION, format!("inline; filename=\"{name}\"")),
    ];
    (headers, body.into()).into_response()
}

/// Returns a file name of lower-case ASCII letters and digits, joined by hyphens. It is safe in
/// a header and on any disk. Other characters are dropped.
pub fn file_name(words: &[&str], ending: &str) -> String {
    let small = words.join(" ").to_ascii_lowercase();
    let parts: Vec<&str> = small
        .split(|letter: char| !letter.is_ascii_alphanumeric())
        .filter(|part| !part.is_empty())
        .collect();
    format!("{}.{ending}", parts.join("-"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_cannot_escape_a_header_or_a_folder() {
        let words = ["card", "../Nao \"Victória\"\r\n", "v2"];
        assert_eq!(file_name(&words, "pdf"), "card-nao-vict-ria-v2.pdf");
        assert_eq!(file_name(&["card", "船"], "pdf"), "card.pdf");
    }
}
