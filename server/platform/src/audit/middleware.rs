//! Middleware that opens and closes the audit record of each request.

use super::request::RequestContext;
use super::trail::{AuditTrail, Facts};
use crate::app::App;
use crate::client_address::Origin;
use crate::error::Error;
use axum::extract::{FromRequestParts, MatchedPath, RawPathParams, Request, State};
use axum::http::HeaderValue;
use axum::http::request::Parts;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::sync::{Arc, Mutex};
use tracing::{Instrument, error, info_span};
use uuid::Uuid;

/// Response header with the request's id.
const REQUEST_ID: &str = "x-request-id";

/// Serves a request and has its audit line written.
pub async fn log_request(State(app): State<App>, request: Request, next: Next) -> Response {
    let (mut parts, body) = request.into_parts();
    let route = parts.extensions.get::<MatchedPath>();
    let route = route.map_or("", MatchedPath::as_str).to_owned();
    let from = Origin::of_request(&parts, &app);
    let facts = Facts {
        is_change: route.starts_with("/api/v1/") && !parts.method.is_safe(),
        ..Facts::default()
    };
    let trail = Arc::new(AuditTrail {
        id: Uuid::now_v7(),
        at: app.clock.now().into(),
        address: from.address_text(),
        network: from.network(),
        method: parts.method.as_str().to_owned(),
        path: filled(&route, &mut parts).await,
        facts: Mutex::new(facts),
        route,
    });
    let context = RequestContext::new(app.db.clone(), Arc::clone(&trail));
    parts.extensions.insert(context);
    let span = info_span!("request", id = %trail.id);
    let request = Request::from_parts(parts, body);
    let mut response = next.run(request).instrument(span).await;
    match trail.finish(&app, response.status()).await {
        // Responses over a satellite link carry no unnecessary header.
        Ok(true) if !trail.is_of_agent() => {
            if let Ok(id) = HeaderValue::try_from(trail.id.to_string()) {
                response.headers_mut().insert(REQUEST_ID, id);
            }
        }
        Ok(_) => {}
        Err(cause) if response.status().is_success() => {
            return Error::from(cause).into_response();
        }
        Err(cause) => error!(error = ?cause, "a refusal is missing in the audit log"),
    }
    response
}

/// Excludes a route's requests from the audit log: what they write is a log itself.
pub async fn leave_out(context: RequestContext, request: Request, next: Next) -> Response {
    context.leave_out();
    next.run(request).await
}

/// Returns the route with its ids and numbers filled in. Any other text in a path may be a
/// mistake of the caller and must not be stored.
async fn filled(route: &str, parts: &mut Parts) -> String {
    let mut path = route.to_owned();
    let Ok(given) = RawPathParams::from_request_parts(parts, &()).await else {
        return path;
    };
    for (name, value) in &given {
        let harmless = Uuid::parse_str(value).is_ok() || value.parse::<u64>().is_ok();
        let shown = if harmless { value } else { "*" };
        path = path.replace(&format!("{{{name}}}"), shown);
    }
    path
}
