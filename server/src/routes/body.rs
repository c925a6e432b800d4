//! Bodies of refused requests: all their mistakes at once, each with a JSON pointer (RFC 6901).
//!
//! Invariants: a request is refused by its handler alone. Only then is its body compared with the
//! schema of the OpenAPI document, for what else is wrong with it. A list where the schema has an
//! object is kept from the handler, which would read it as the object's members in their order.

use super::docs::DOCUMENT;
use axum::body::{Body, Bytes};
use axum::extract::{MatchedPath, Request};
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE};
use axum::http::{Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use binnacle_platform::error::Error;
use binnacle_platform::http::MAX_JSON_BYTES;
use serde_json::{Value, json};

/// Most mistakes that a response lists.
const MOST_MISTAKES: usize = 50;

/// Completes the problem of a refused JSON body by all its mistakes.
pub(super) async fn list_mistakes(request: Request, next: Next) -> Response {
    let Some(schema) = body_schema(&request) else {
        return next.run(request).await;
    };
    let (parts, body) = request.into_parts();
    let Ok(bytes) = axum::body::to_bytes(body, MAX_JSON_BYTES).await else {
        return Error::TooLarge(MAX_JSON_BYTES).into_response();
    };
    let body = serde_json::from_slice::<Value>(&bytes).ok();
    let found = body.as_ref().map(|body| mistakes(schema, body));
    let found = found.unwrap_or_default();
    let has_list = found.iter().any(|mistake| mistake.is_list_for_object);
    let given = if has_list {
        Body::from(LIST_FOR_OBJECT)
    } else {
        Body::from(bytes)
    };
    let response = next.run(Request::from_parts(parts, given)).await;
    if response.status() != StatusCode::UNPROCESSABLE_ENTITY {
        return response;
    }
    with_mistakes(response, &found).await
}

/// Body that no handler takes, in place of one with a list for an object.
const LIST_FOR_OBJECT: &str = "\"a list in place of an object\"";

/// Mistake in a body: something that is not as its schema says.
struct Mistake {
    /// JSON pointer of the part.
    pointer: String,
    detail: String,
    /// True if the part is a list, and an object is among what it may be.
    is_list_for_object: bool,
}

impl Mistake {
    fn new(pointer: &str, detail: impl Into<String>) -> Mistake {
        Mistake {
            pointer: pointer.to_owned(),
            detail: detail.into(),
            is_list_for_object: false,
        }
    }
}

/// Returns the schema of an operation's JSON body.
fn body_schema(request: &Request) -> Option<&'static Value> {
    if matches!(*request.method(), Method::GET | Method::HEAD) {
        return None;
    }
    let route = request.extensions().get::<MatchedPath>()?;
    let method = request.method().as_str().to_lowercase();
    let operation = DOCUMENT["paths"].get(route.as_str())?.get(method)?;
    operation["requestBody"]["content"]["application/json"].get("schema")
}

/// Adds mistakes to the problem in a response.
async fn with_mistakes(response: Response, found: &[Mistake]) -> Response {
    let (mut parts, body) = response.into_parts();
    let is_problem = parts.headers.get(CONTENT_TYPE);
    let is_problem = is_problem.is_some_and(|kind| kind == "application/problem+json");
    let Ok(bytes) = axum::body::to_bytes(body, MAX_JSON_BYTES).await else {
        return Response::from_parts(parts, Body::empty());
    };
    let problem = serde_json::from_slice::<Value>(&bytes).ok();
    let Some(mut problem) = problem.filter(|_| is_problem) else {
        return Response::from_parts(parts, Body::from(bytes));
    };
    let mut errors = problem["errors"].as_array().cloned().unwrap_or_default();
    for mistake in found {
        let pointer = mistake.pointer.as_str();
        if !errors.iter().any(|error| error["pointer"] == pointer) {
            errors.push(json!({ "pointer": pointer, "detail": mistake.detail }));
        }
    }
    if errors.is_empty() {
        return Response::from_parts(parts, Body::from(bytes));
    }
    // A mistake of the whole body says no more than its parts.
    if errors.len() > 1 {
        errors.retain(|error| error["pointer"] != "");
    }
    problem["errors"] = Value::Array(errors);
    parts.headers.remove(CONTENT_LENGTH);
    Response::from_parts(parts, Body::from(Bytes::from(problem.to_string())))
}

/// Lists what in a body is not as its schema says.
fn mistakes(schema: &'static Value, body: &Value) -> Vec<Mistake> {
    let mut found = Vec::new();
    check(schema, body, "", &mut found);
    found.truncate(MOST_MISTAKES);
    found
}

fn check(schema: &'static Value, value: &Value, pointer: &str, found: &mut Vec<Mistake>) {
    if let Some(name) = schema["$ref"].as_str() {
        if let Some(referenced) = DOCUMENT.pointer(name.trim_start_matches('#')) {
            check(referenced, value, pointer, found);
        }
        return;
    }
    let mut add = |detail: String| found.push(Mistake::new(pointer, detail));
    if let Some(forms) = schema["oneOf"].as_array().or(schema["anyOf"].as_array()) {
        return check_forms(forms, value, pointer, found);
    }
    if let Some(allowed) = schema["enum"].as_array()
        && !allowed.contains(value)
    {
        let allowed: Vec<String> = allowed.iter().map(Value::to_string).collect();
        return add(format!("{value} is none of {}", allowed.join(", ")));
    }
    if !has_type(&schema["type"], value) {
        let wanted = schema["type"].to_string().replace(['"', '[', ']'], "");
        let wanted = wanted.replace(',', " or ");
        return found.push(Mistake {
            is_list_for_object: value.is_array() && has_type(&schema["type"], &json!({})),
            ..Mistake::new(pointer, format!("{value} is not of type {wanted}"))
        });
    }
    if let Some(number) = value.as_f64() {
        if let Some(least) = schema["minimum"].as_f64().filter(|least| number < *least) {
            add(format!("{value} is less than {least}"));
        }
        if let Some(most) = schema["maximum"].as_f64().filter(|most| number > *most) {
            add(format!("{value} is more than {most}"));
        }
    }
    if let Some(text) = value.as_str() {
        let length = text.chars().count() as u64;
        if let Some(most) = schema["maxLength"].as_u64().filter(|most| length > *most) {
            add(format!("is longer than {most} characters"));
        }
        if schema["minLength"]
            .as_u64()
            .is_some_and(|least| length < least)
        {
            add("is too short".to_owned());
        }
    }
    for part in schema["allOf"].as_array().into_iter().flatten() {
        check(part, value, pointer, found);
    }
    check_parts(schema, value, pointer, found);
}

/// Checks the members of an object or list.
fn check_parts(schema: &'static Value, value: &Value, pointer: &str, found: &mut Vec<Mistake>) {
    if let Some(object) = value.as_object() {
        let required = schema["required"].as_array().into_iter().flatten();
        for name in required.filter_map(Value::as_str) {
            if !object.contains_key(name) {
                let pointer = format!("{pointer}/{}", escaped(name));
                found.push(Mistake::new(&pointer, "is missing"));
            }
        }
        for (name, part) in object {
            if let Some(property) = schema["properties"].get(name) {
                check(
                    property,
                    part,
                    &format!("{pointer}/{}", escaped(name)),
                    found,
                );
            }
        }
    }
    if let (Some(items), Some(schema)) = (value.as_array(), schema.get("items")) {
        for (at, item) in items.iter().enumerate() {
            check(schema, item, &format!("{pointer}/{at}"), found);
        }
    }
}

/// Checks a value that may have one of several forms: by the form that fits it best.
fn check_forms(forms: &'static [Value], value: &Value, pointer: &str, found: &mut Vec<Mistake>) {
    let mut least: Option<Vec<Mistake>> = None;
    for form in forms {
        let mut here = Vec::new();
        check(form, value, pointer, &mut here);
        if least.as_ref().is_none_or(|least| here.len() < least.len()) {
            least = Some(here);
        }
    }
    // `null` is a form of what may be left out, and no help to who sent something else.
    let given = forms.iter().find(|form| form["type"] != "null");
    match (least, given) {
        (Some(least), Some(form)) if !least.is_empty() && forms.len() == 2 => {
            check(form, value, pointer, found);
        }
        (Some(least), _) => found.extend(least),
        (None, _) => {}
    }
}

fn has_type(wanted: &Value, value: &Value) -> bool {
    let is = |name: &Value| match name.as_str() {
        Some("string") => value.is_string(),
        Some("integer") => value.is_i64() || value.is_u64(),
        Some("number") => value.is_number(),
        Some("boolean") => value.is_boolean(),
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("null") => value.is_null(),
        _ => true,
    };
    match wanted {
        Value::Array(names) => names.iter().any(is),
        Value::Null => true,
        name => is(name),
    }
}

/// Escapes a member's name for a JSON pointer (RFC 6901, section 3).
fn escaped(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}
