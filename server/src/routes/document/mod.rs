//! Completion of the OpenAPI document with details common to all operations.
//!
//! Invariants: each response has a description, which OpenAPI 3.1 demands. Each problem has the
//! media type of RFC 9457. The problems of reading a request are listed wherever there is
//! something to read.

mod unions;
mod webhooks;

use axum::http::StatusCode;
use binnacle_compass::openapi::{allow_unknown_properties, flatten, schema_mut};
use binnacle_platform::http::spreadsheet::CsvForm;
use serde_json::Value;
use std::mem;
use utoipa::openapi::path::{Operation, ParameterIn};
use utoipa::openapi::schema::{Object, Schema};
use utoipa::openapi::security::SecurityRequirement;
use utoipa::openapi::{OpenApi, RefOr, Response};
use utoipa::{IntoParams, ToSchema};

/// Adds the fields that one domain's problems carry to the schema `Problem`.
///
/// # Panics
/// Panics when `T` is not a struct, or the document has no `Problem`: a mistake in the code.
pub(super) fn add_problem_fields<T: ToSchema>(document: &mut OpenApi) {
    let RefOr::T(Schema::Object(fields)) = T::schema() else {
        panic!("only a struct has fields");
    };
    let mut referenced = Vec::new();
    T::schemas(&mut referenced);
    let schemas = &mut document.components.get_or_insert_default().schemas;
    schemas.extend(referenced);
    let Some(RefOr::T(Schema::Object(problem))) = schemas.get_mut("Problem") else {
        panic!("the document has no problem");
    };
    problem.properties.extend(fields.properties);
}

/// Names of the server's forms that refuse unknown fields.
const STRICT_FORMS: [&str; 4] = [
    "VesselAmendment",
    "CompassAmendment",
    "LogbookAmendment",
    "PortCallAmendment",
];

/// Corrects the schemas that are derived from types of the science crates and the server.
///
/// Flattened fields become fields of the object itself. A form that refuses unknown fields
/// today may accept more of them in a later version, so the document does not rule them out.
pub(super) fn correct_schemas(document: &mut OpenApi) {
    binnacle_compass::openapi::correct(document);
    binnacle_adjustment::openapi::correct(document);
    binnacle_schedule::openapi::correct(document);
    unions::name_variants(document);
    if let Some(coverage) = schema_mut(document, "Coverage") {
        flatten(coverage);
    }
    for name in STRICT_FORMS {
        if let Some(form) = schema_mut(document, name) {
            allow_unknown_properties(form);
        }
    }
}

/// Lists the values that a schema of names allows.
///
/// # Panics
/// Panics when the document has no such schema: a mistake in the code.
pub(super) fn list_values<'a>(
    document: &mut OpenApi,
    name: &str,
    values: impl Iterator<Item = &'a str>,
) {
    object(document, name).enum_values = Some(values.map(Value::from).collect());
}

/// Lets the keys of a property that is a map be the names that a schema allows.
///
/// # Panics
/// Panics when the document has no such property or schema: a mistake in the code.
pub(super) fn name_properties(document: &mut OpenApi, owner: &str, property: &str, names: &str) {
    let names = Schema::Object(object(document, names).clone());
    match object(document, owner).properties.get_mut(property) {
        Some(RefOr::T(Schema::Object(map))) => map.property_names = Some(Box::new(names)),
        _ => panic!("{owner} has no map {property}"),
    }
}

/// Sets the example of a property that is a list.
///
/// # Panics
/// Panics when the document has no such property: a mistake in the code.
pub(super) fn set_example(document: &mut OpenApi, owner: &str, property: &str, example: Value) {
    match object(document, owner).properties.get_mut(property) {
        Some(RefOr::T(Schema::Array(list))) => list.example = Some(example),
        _ => panic!("{owner} has no list {property}"),
    }
}

fn object<'a>(document: &'a mut OpenApi, name: &str) -> &'a mut Object {
    match schema_mut(document, name) {
        Some(Schema::Object(object)) => object,
        _ => panic!("the document has no schema {name}"),
    }
}

/// Adds the webhooks, and the details common to all operations.
pub(super) fn complete(document: &mut OpenApi) {
    webhooks::add(document);
    for path in document.paths.paths.values_mut() {
        let changes = [
            &mut path.post,
            &mut path.put,
            &mut path.patch,
            &mut path.delete,
        ];
        for operation in changes.into_iter().flatten() {
            add_problems(operation);
            add_disk_full(operation);
            require_request_header(operation);
        }
        path.get.iter_mut().for_each(add_csv_form);
        path.get.iter_mut().for_each(add_problems);
        let all = [
            &mut path.get,
            &mut path.post,
            &mut path.put,
            &mut path.patch,
            &mut path.delete,
        ];
        for operation in all.into_iter().flatten() {
            for (status, response) in &mut operation.responses.responses {
                if let RefOr::T(response) = response {
                    describe(status, response);
                }
            }
        }
    }
}

/// Adds the parameters by which a spreadsheet's form of a CSV file is asked for.
fn add_csv_form(operation: &mut Operation) {
    let is_csv = operation.responses.responses.values().any(|response| {
        matches!(response, RefOr::T(response) if response.content.contains_key("text/csv"))
    });
    if is_csv {
        let form = CsvForm::into_params(|| Some(ParameterIn::Query));
        let parameters = operation.parameters.get_or_insert_default();
        parameters.extend(form.into_iter().map(RefOr::T));
    }
}

/// Demands the header of our own pages for a change by session.
fn require_request_header(operation: &mut Operation) {
    let either = [
        SecurityRequirement::default()
            .add::<_, [&str; 0], &str>("session", [])
            .add::<_, [&str; 0], &str>("request", []),
        SecurityRequirement::new::<_, [&str; 0], &str>("token", []),
    ];
    if operation.security.is_none() {
        operation.security = Some(either.to_vec());
    }
}

/// Lists the problem for which a change may fail.
fn add_disk_full(operation: &mut Operation) {
    let responses = &mut operation.responses.responses;
    if let Some(problem) = responses.get("503").cloned() {
        responses.insert("507".to_owned(), problem);
    }
}

/// Lists the problems for which a request may be refused before the operation runs, or because
/// the database does not respond.
fn add_problems(operation: &mut Operation) {
    let responses = &mut operation.responses.responses;
    let Some(problem) = responses
        .get("401")
        .or_else(|| responses.get("404"))
        .cloned()
    else {
        return;
    };
    let parameters = || {
        let all = operation.parameters.iter().flatten();
        all.filter_map(|found| match found {
            RefOr::T(parameter) => Some(parameter),
            RefOr::Ref(_) => None,
        })
    };
    let mut tags = operation.tags.iter().flatten();
    let fleet = tags.any(|tag| ["fleet", "adjusting", "alerts", "people"].contains(&tag.as_str()));
    let query = parameters().any(|found| found.parameter_in == ParameterIn::Query);
    let body = operation.request_body.is_some();
    // A batch is accepted with any media type.
    let json = body && !parameters().any(|found| found.name == "seq");
    for (status, may_be) in [
        ("400", query || body),
        ("403", fleet),
        (
            "412",
            parameters().any(|found| found.name.eq_ignore_ascii_case("If-Match")),
        ),
        ("413", body),
        ("415", json),
        ("422", json),
        ("429", true),
        ("500", true),
        ("503", true),
    ] {
        if may_be && !responses.contains_key(status) {
            responses.insert(status.to_owned(), problem.clone());
        }
    }
}

fn describe(status: &str, response: &mut Response) {
    let Ok(status) = status.parse::<StatusCode>() else {
        return;
    };
    // The health checks respond with text.
    let is_json = response.content.contains_key("application/json");
    let is_problem = status.is_client_error() || (status.is_server_error() && is_json);
    if response.description.is_empty() {
        status
            .canonical_reason()
            .unwrap_or("Response")
            .clone_into(&mut response.description);
    }
    if is_problem {
        let content = mem::take(&mut response.content).into_values();
        response.content = content
            .map(|content| ("application/problem+json".to_owned(), content))
            .collect();
    }
}
