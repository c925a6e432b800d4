//! Extractors that turn every malformed request into an error of the API.

use crate::error::{Error, Result};
use axum::body::{Body, Bytes};
use axum::extract::rejection::JsonRejection;
use axum::extract::{FromRequest, FromRequestParts, Request};
use axum::http::request::Parts;
use binnacle_compass::time::Timestamp;
use serde::de::DeserializeOwned;

pub use axum::Json;

/// Longest accepted name or short remark, characters.
pub const MAX_TEXT: usize = 200;

/// JSON body.
#[derive(FromRequest)]
#[from_request(via(axum::Json), rejection(Error))]
pub struct Valid<T>(pub T);

/// JSON body that may be omitted, which gives the default.
pub struct ValidOrNone<T>(pub T);

impl<S: Send + Sync, T: DeserializeOwned + Default> FromRequest<S> for ValidOrNone<T> {
    type Rejection = Error;

    async fn from_request(request: Request, state: &S) -> Result<ValidOrNone<T>> {
        let (parts, body) = request.into_parts();
        let whole = Request::from_parts(parts.clone(), body);
        let bytes = Bytes::from_request(whole, state)
            .await
            .map_err(JsonRejection::from)?;
        if bytes.is_empty() {
            return Ok(ValidOrNone(T::default()));
        }
        let request = Request::from_parts(parts, Body::from(bytes));
        let Valid(value) = Valid::<Option<T>>::from_request(request, state).await?;
        Ok(ValidOrNone(value.unwrap_or_default()))
    }
}

/// Query string.
pub struct Params<T>(pub T);

impl<S: Send + Sync, T: DeserializeOwned> FromRequestParts<S> for Params<T> {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Params<T>> {
        let query = axum::extract::Query::from_request_parts(parts, state).await?;
        Ok(Params(query.0))
    }
}

/// Ids in a path. An id that does not parse gives 404: nothing has it.
pub struct Id<T>(pub T);

impl<S: Send + Sync, T: DeserializeOwned + Send> FromRequestParts<S> for Id<T> {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Id<T>> {
        let path = axum::extract::Path::from_request_parts(parts, state).await?;
        Ok(Id(path.0))
    }
}

/// Returns a name, trimmed.
///
/// # Errors
/// Fails when it is empty, too long or not on one line.
pub fn text(field: &'static str, value: &str) -> Result<String> {
    checked(field, value, MAX_TEXT, hides_something)
}

/// Returns a remark of at most `most` characters, trimmed. Unlike a name it may have characters that
/// cannot be seen beside others that can: a telephone's pictographs consist of them (Unicode
/// Technical Standard 51, section 2).
///
/// # Errors
/// Fails when it is empty, too long or not on one line.
pub fn remark(field: &'static str, value: &str, most: usize) -> Result<String> {
    let hides_all = |text: &str| text.chars().all(|c| is_invisible(c) || is_joiner(c));
    checked(field, value, most, hides_all)
}

fn checked(
    field: &'static str,
    value: &str,
    most: usize,
    hides_something: impl Fn(&str) -> bool,
) -> Result<String> {
    let value = value.trim();
    let detail = if value.is_empty() {
        "is empty"
    } else if value.chars().count() > most {
        &format!("is longer than {most} characters")
    } else if value.chars().any(is_control) {
        "has control characters, or characters that change the direction of writing"
    } else if hides_something(value) {
        "has characters that cannot be seen"
    } else {
        return Ok(value.to_owned());
    };
    Err(Error::Invalid {
        field,
        detail: detail.to_owned(),
    })
}

/// Checks for a character that is invisible but changes the text: one that ends a line, or one
/// that turns the writing direction and so disguises a name (Unicode Standard Annex 9,
/// section 2).
pub fn is_control(c: char) -> bool {
    let turns = matches!(c, '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}'
                            | '\u{2066}'..='\u{2069}');
    turns || c.is_control() || matches!(c, '\u{2028}' | '\u{2029}')
}

/// Checks for characters that cannot be seen, and so make two names look alike. A joiner is one
/// unless it is between letters that join (RFC 5892, appendices A.1 and A.2).
fn hides_something(text: &str) -> bool {
    let mut before = None;
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        let is_hidden = match c {
            c if is_joiner(c) => ![before, characters.peek().copied()]
                .into_iter()
                .all(|beside| beside.is_some_and(is_joining)),
            _ => is_invisible(c),
        };
        if is_hidden {
            return true;
        }
        before = Some(c);
    }
    false
}

/// Checks for a character that joins its neighbours, or keeps them from joining.
fn is_joiner(c: char) -> bool {
    matches!(c, '\u{200c}' | '\u{200d}')
}

/// Checks for a character of the scripts that join, Arabic to Sinhala and Myanmar.
fn is_joining(c: char) -> bool {
    matches!(c, '\u{620}'..='\u{dff}' | '\u{1000}'..='\u{109f}')
}

/// Checks for a character that takes no place or looks like a blank (Unicode Standard, section 23.2;
/// Default_Ignorable_Code_Point).
fn is_invisible(c: char) -> bool {
    matches!(c, '\u{ad}' | '\u{34f}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}'
                | '\u{180b}'..='\u{180f}' | '\u{200b}' | '\u{2060}'..='\u{206f}'
                | '\u{2800}' | '\u{3164}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{ffa0}'
                | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}')
}

/// Checks an optional text as [`text`] does; blank text counts as absent.
///
/// # Errors
/// Fails when it is too long or not on one line.
pub fn optional_text(field: &'static str, value: Option<&str>) -> Result<Option<String>> {
    let given = value.filter(|value| !value.trim().is_empty());
    given.map(|value| text(field, value)).transpose()
}

/// Returns the reason for which a name is refused that is none of those known.
pub fn unknown_name(name: &str, known: impl Iterator<Item = &'static str>) -> String {
    let known: Vec<String> = known.map(|known| format!("`{known}`")).collect();
    format!(
        "unknown variant `{name}`, expected one of {}",
        known.join(", ")
    )
}

/// Parses a time of a query string.
///
/// # Errors
/// Fails when it is not RFC 3339.
pub fn time(field: &'static str, value: Option<&str>) -> Result<Option<Timestamp>> {
    value
        .map(|text| {
            Timestamp::parse(text).map_err(|error| Error::Invalid {
                field,
                detail: error.to_string(),
            })
        })
        .transpose()
}

/// Returns a number of a query string if it is within its range; NaN never is.
///
/// # Errors
/// Fails when it is outside the range.
pub fn degrees(field: &'static str, value: f64, low: f64, high: f64) -> Result<f64> {
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    Err(Error::Invalid {
        field,
        detail: format!("{value} is outside {low} to {high}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_characters_that_cannot_be_seen_is_refused() {
        for seen in [
            "Nao Victoria",
            "Šibenik",
            "ἀργώ",
            "新しい船",
            "Ærø 2",
            "می\u{200c}خواهم",
            "क्\u{200d}ष",
        ] {
            assert_eq!(text("name", seen).unwrap(), seen);
        }
        for hidden in [
            "Nao\u{200b}Victoria",
            "Nao\u{200c}Victoria",
            "\u{200d}می",
            "Nao\u{feff}",
            "\u{2060}Nao",
            "Na\u{ad}o",
            "\u{3164}",
            "\u{2800}",
            "Nao\u{e0041}",
            "Nao\u{202e}",
            "Nao\nVictoria",
            "  ",
        ] {
            assert!(text("name", hidden).is_err(), "{hidden:?}");
        }
    }

    #[test]
    fn a_remark_may_have_the_pictographs_of_a_telephone() {
        for seen in [
            "Lightning \u{26a0}\u{fe0f}",
            "\u{1f477}\u{200d}\u{2642}\u{fe0f} on board",
        ] {
            assert_eq!(remark("text", seen, 200).unwrap(), seen);
            assert!(text("name", seen).is_err(), "{seen:?}");
        }
        for refused in ["", " ", "\u{200b}\u{200d}", "a\nb", "Nao\u{202e}", "longer"] {
            assert!(remark("text", refused, 5).is_err(), "{refused:?}");
        }
    }
}
