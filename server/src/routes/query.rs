//! Query strings: a parameter that an operation does not document is refused.
//!
//! Invariants: a misspelt filter never selects everything. Operations that need no sign-in take
//! any parameter: a sign-in provider adds its own (RFC 6749, section 4.1.2).

use axum::extract::{MatchedPath, Query, Request, State};
use axum::http::Method;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use binnacle_platform::error::Error;
use std::collections::HashMap;
use std::sync::Arc;
use utoipa::openapi::path::{Operation, ParameterIn};
use utoipa::openapi::security::SecurityRequirement;
use utoipa::openapi::{OpenApi, RefOr};

/// Names of the query parameters of each operation, by route and method.
#[derive(Clone)]
pub(super) struct QueryParameters(Arc<HashMap<(String, Method), Vec<String>>>);

impl QueryParameters {
    /// Collects the parameters that a document names.
    pub(super) fn of(document: &OpenApi) -> QueryParameters {
        let mut all = HashMap::new();
        for (route, item) in &document.paths.paths {
            let operations = [
                (Method::GET, &item.get),
                (Method::POST, &item.post),
                (Method::PUT, &item.put),
                (Method::PATCH, &item.patch),
                (Method::DELETE, &item.delete),
            ];
            for (method, operation) in operations {
                let needs_sign_in = |found: &&Operation| {
                    let mut ways = found.security.iter().flatten();
                    !ways.any(|way| *way == SecurityRequirement::default())
                };
                if let Some(operation) = operation.as_ref().filter(needs_sign_in) {
                    all.insert((route.clone(), method), names(operation));
                }
            }
        }
        QueryParameters(Arc::new(all))
    }
}

fn names(operation: &Operation) -> Vec<String> {
    let parameters = operation.parameters.iter().flatten();
    let names = parameters.filter_map(|parameter| match parameter {
        RefOr::T(found) if found.parameter_in == ParameterIn::Query => Some(found.name.clone()),
        _ => None,
    });
    names.collect()
}

/// Refuses a request with a query parameter that its operation does not have.
pub(super) async fn refuse_unknown(
    State(known): State<QueryParameters>,
    request: Request,
    next: Next,
) -> Response {
    match known.check(&request) {
        Ok(()) => next.run(request).await,
        Err(refused) => refused.into_response(),
    }
}

impl QueryParameters {
    fn check(&self, request: &Request) -> Result<(), Error> {
        let Some(route) = request.extensions().get::<MatchedPath>() else {
            return Ok(());
        };
        let method = match request.method() {
            &Method::HEAD => Method::GET,
            other => other.clone(),
        };
        let Some(known) = self.0.get(&(route.as_str().to_owned(), method)) else {
            return Ok(());
        };
        let Query(given) = Query::<Vec<(String, String)>>::try_from_uri(request.uri())?;
        let unknown = given.iter().find(|(name, _)| !known.contains(name));
        let Some((name, _)) = unknown else {
            return Ok(());
        };
        let takes = if known.is_empty() {
            "this path takes none".to_owned()
        } else {
            format!("this path takes {}", known.join(", "))
        };
        Err(Error::BadRequest(format!(
            "there is no query parameter {name:?}; {takes}"
        )))
    }
}
