//! Versions of what several people may edit (RFC 9110, sections 8.8.3 and 13.1.1).
//!
//! Invariants: a version depends on nothing but the content that can be edited, and is compared
//! in the transaction that changes it. A change without `If-Match` applies to any version.

use crate::error::{Error, Result};
use crate::secret;
use axum::Json;
use axum::extract::FromRequestParts;
use axum::http::header::{ETAG, IF_MATCH};
use axum::http::request::Parts;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use std::fmt::Write;
use utoipa::openapi::path::{Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::{ObjectBuilder, Required, Type};

/// Bytes of the content's hash in a version.
const HASH_BYTES: usize = 12;

/// Version of an editable content, as an entity tag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Version(String);

impl Version {
    /// Returns the version of a content.
    ///
    /// # Errors
    /// Fails when the content cannot be written as JSON.
    pub fn of(content: &impl Serialize) -> Result<Version> {
        let hash = secret::hash(&serde_json::to_string(content)?);
        let mut tag = String::from("\"");
        for byte in hash.iter().take(HASH_BYTES) {
            write!(tag, "{byte:02x}").expect("a String takes every write");
        }
        tag.push('"');
        Ok(Version(tag))
    }
}

/// Content in JSON, with its version in the header `ETag`.
pub struct Versioned<T>(pub T, pub Version);

impl<T: Serialize> IntoResponse for Versioned<T> {
    fn into_response(self) -> Response {
        ([(ETAG, self.1.0)], Json(self.0)).into_response()
    }
}

/// Versions that a change may apply to; any without the header `If-Match`.
pub struct IfMatch(Option<String>);

impl IfMatch {
    /// Checks that the change applies to a content, as it is stored under the lock of the change.
    ///
    /// # Errors
    /// [`Error::Changed`] when it is another version.
    pub fn check(&self, current: &Version) -> Result<()> {
        let Some(wanted) = &self.0 else { return Ok(()) };
        let mut tags = wanted.split(',').map(str::trim);
        if tags.any(|tag| tag == "*" || tag == current.0) {
            return Ok(());
        }
        Err(Error::Changed)
    }
}

impl<S: Send + Sync> FromRequestParts<S> for IfMatch {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<IfMatch> {
        let Some(value) = parts.headers.get(IF_MATCH) else {
            return Ok(IfMatch(None));
        };
        let value = value.to_str().ok();
        let value = value.filter(|tags| tags.contains('"') || tags.trim() == "*");
        let value = value.ok_or_else(|| {
            Error::BadRequest("If-Match is neither * nor a list of quoted entity tags".to_owned())
        })?;
        Ok(IfMatch(Some(value.to_owned())))
    }
}

impl utoipa::IntoParams for IfMatch {
    fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<Parameter> {
        let tag = ObjectBuilder::new().schema_type(Type::String);
        vec![
            ParameterBuilder::new()
                .name(IF_MATCH.as_str())
                .parameter_in(ParameterIn::Header)
                .required(Required::False)
                .description(Some(
                    "The `ETag` of what was read: a content that someone else changed meanwhile \
                     is left as it is (412)",
                ))
                .schema(Some(tag))
                .build(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_applies_to_the_versions_that_it_names_only() {
        let [one, other] = [1, 2].map(|content| Version::of(&content).unwrap());
        assert_ne!(one, other);
        let named = |tags: &str| IfMatch(Some(tags.to_owned())).check(&one).is_ok();
        assert!(named(&one.0));
        assert!(named(&format!("{}, {}", other.0, one.0)));
        assert!(named("*"));
        assert!(!named(&other.0));
        // A weak tag never matches strongly (RFC 9110, section 8.8.3.2).
        assert!(!named(&format!("W/{}", one.0)));
        assert!(IfMatch(None).check(&one).is_ok());
    }
}
