//! File responses, and safe file names.

use super::is_control;
use axum::body::Body;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use std::fmt::Write;
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

/// Name of a file, for clients of any age (RFC 6266, appendix D).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileName {
    words: Vec<String>,
    ending: &'static str,
}

impl FileName {
    /// Creates a name from words, which may be in any language.
    pub fn new(words: &[&str], ending: &'static str) -> FileName {
        let words = words.iter().map(|word| (*word).to_owned()).collect();
        FileName { words, ending }
    }

    /// Returns the name in lower-case ASCII letters and digits, joined by hyphens. It is safe in
    /// a header and on any disk. Other characters are dropped.
    fn ascii(&self) -> String {
        let small = self.words.join(" ").to_ascii_lowercase();
        let parts: Vec<&str> = small
            .split(|letter: char| !letter.is_ascii_alphanumeric())
            .filter(|part| !part.is_empty())
            .collect();
        format!("{}.{}", parts.join("-"), self.ending)
    }

    /// Returns the name as it is written, without what disks do not accept in names.
    fn kept(&self) -> String {
        let written = self.words.join(" ");
        let parts: Vec<&str> = written
            .split(|letter: char| is_control(letter) || "\\/:*?\"<>|".contains(letter))
            .map(|part| part.trim_matches([' ', '.']))
            .filter(|part| !part.is_empty())
            .collect();
        format!("{}.{}", parts.join(" "), self.ending)
    }

    /// Returns the header `Content-Disposition` (RFC 6266) for a file to be shown or saved.
    pub fn disposition(&self, how: &str) -> String {
        let mut header = format!("{how}; filename=\"{}\"; filename*=UTF-8''", self.ascii());
        for byte in self.kept().bytes() {
            // `attr-char` of RFC 8187, section 3.2.1.
            if byte.is_ascii_alphanumeric() || b"!#$&+-.^_`|~".contains(&byte) {
                header.push(char::from(byte));
            } else {
                write!(header, "%{byte:02X}").expect("a String takes every write");
            }
        }
        header
    }
}

/// Returns a response with a file that a browser shows, and saves under the given name.
pub fn file(kind: &'static str, name: &FileName, body: impl Into<Body>) -> Response {
    let headers = [
        (CONTENT_TYPE, kind.to_owned()),
        (CONTENT_DISPOSITION, name.disposition("inline")),
    ];
    (headers, body.into()).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_cannot_escape_a_header_or_a_folder() {
        let words = ["card", "../Nao \"Victória\"\r\n", "v2"];
        let name = FileName::new(&words, "pdf");
        assert_eq!(name.ascii(), "card-nao-vict-ria-v2.pdf");
        assert_eq!(name.kept(), "card Nao Victória v2.pdf");
        assert_eq!(FileName::new(&["card", "船"], "pdf").ascii(), "card.pdf");
    }

    #[test]
    fn a_name_in_any_language_is_kept() {
        let header = FileName::new(&["card", "船"], "pdf").disposition("inline");
        let expected = "inline; filename=\"card.pdf\"; filename*=UTF-8''card%20%E8%88%B9.pdf";
        assert_eq!(header, expected);
    }
}
