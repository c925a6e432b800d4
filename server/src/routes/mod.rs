//! All routes, their OpenAPI document and their middleware.

mod body;
mod docs;
mod document;
mod query;
mod rate_limit;

use crate::kinds::{event_kinds, message_kinds, notice_kinds};
use crate::state::ServerState;
use crate::{dashboard, health};
use axum::Router;
use axum::extract::{DefaultBodyLimit, MatchedPath, Request};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use binnacle_documents::{card, deviation_book};
use binnacle_fleet::models::NoModelFields;
use binnacle_fleet::{
    alerts, azimuths, binnacles, changes, compasses, deviation_table, enrolment, fleet_views,
    ingest, logbook, models, operators, overview, particulars, samples, settings, tags, vessel_api,
};
use binnacle_orders::work_orders::NotAdjustableFields;
use binnacle_orders::{api as orders_api, firms};
use binnacle_planning::{calendar, needs, notifications, port_calls, reports, schedule};
use binnacle_platform::db::Workload;
use binnacle_platform::http::{MAX_JSON_BYTES, cross_site, headers, host, spreadsheet};
use binnacle_platform::{
    audit, audit_api, error, event_stream, events, mail, oidc, quotas_api, session, session_api,
    signing_keys, users, webhooks,
};
use binnacle_priors as priors;
use serde_json::json;
use std::time::Duration;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::timeout::TimeoutLayer;
use tower_http::trace::TraceLayer;
use tracing::{Span, debug_span};
use utoipa::OpenApi;
use utoipa::openapi::security::{ApiKey, ApiKeyValue, Http, HttpAuthScheme, SecurityScheme};
use utoipa_axum::router::OpenApiRouter;

/// Time limit of a request: a batch over a satellite link may take long.
const PATIENCE: Duration = Duration::from_mins(2);

#[derive(OpenApi)]
#[openapi(
    info(
        title = "Binnacle",
        description = "Magnetic compass deviation of a fleet. Errors are RFC 9457 problem \
            documents; lists page by cursor; times are RFC 3339 UTC; deviation and variation are \
            east-positive degrees; fields are nanotesla. Absence and refusal look the same (404) \
            across operators and firms.",
    ),
    components(schemas(error::Problem, error::Mistake)),
    security(("session" = []), ("token" = [])),
    modifiers(&Security),
    tags(
        (name = "session", description = "Signing in; one's sessions, second factor, API tokens"),
        (name = "people", description = "Users, and the rules for signing in"),
        (name = "platform", description = "Operators and firms, for platform admins"),
        (name = "agents", description = "Interface of the agents on board"),
        (name = "fleet", description = "Vessels, compasses and their models"),
        (name = "adjusting", description = "Binnacles, port calls and work orders. Predictions here are not \
            certificates"),
        (name = "alerts", description = "Alerts, and their delivery by mail and webhook"),
        (name = "webhooks", description = "Messages that this server sends to your programs"),
        (name = "notifications", description = "Your own notifications and their channels"),
        (name = "operations", description = "Health and metrics"),
    )
)]
struct Document;

struct Security;

impl utoipa::Modify for Security {
    fn modify(&self, document: &mut utoipa::openapi::OpenApi) {
        let components = document.components.get_or_insert_default();
        components.add_security_scheme(
            "session",
            SecurityScheme::ApiKey(ApiKey::Cookie(ApiKeyValue::new(session::cookie::PLAIN))),
        );
        components.add_security_scheme(
            "request",
            SecurityScheme::ApiKey(ApiKey::Header(ApiKeyValue::with_description(
                "X-Binnacle-Request",
                "Any value, as `1`, with each change by session: pages of other sites cannot send it",
            ))),
        );
        components.add_security_scheme(
            "token",
            SecurityScheme::Http(Http::new(HttpAuthScheme::Bearer)),
        );
    }
}

/// Returns the routes for agents, with minimal headers to save the satellite link.
fn for_agents() -> OpenApiRouter<ServerState> {
    OpenApiRouter::new()
        .merge(enrolment::agent_router())
        .merge(ingest::router())
        .merge(logbook::agent_router())
        .merge(azimuths::agent_router())
}

fn for_people() -> OpenApiRouter<ServerState> {
    OpenApiRouter::new()
        .merge(session_api::router())
        .merge(signing_keys::router())
        .merge(oidc::router())
        .merge(users::router())
        .merge(quotas_api::router())
        .merge(audit_api::router())
        .merge(operators::router())
        .merge(firms::router())
        .merge(overview::router())
        .merge(vessel_api::router())
        .merge(tags::router())
        .merge(fleet_views::router())
        .merge(compasses::router())
        .merge(binnacles::router())
        .merge(orders_api::router())
        .merge(port_calls::router())
        .merge(particulars::router())
        .merge(needs::router())
        .merge(schedule::router())
        .merge(calendar::router())
        .merge(enrolment::router())
        .merge(settings::router())
        .merge(logbook::router())
        .merge(azimuths::router())
        .merge(models::router())
        .merge(priors::router())
        .merge(deviation_table::router())
        .merge(card::router())
        .merge(deviation_book::router())
        .merge(changes::router())
        .merge(samples::router())
        .merge(reports::router())
        .merge(alerts::router())
        .merge(webhooks::router())
        .merge(mail::router())
        .merge(notifications::router())
        .merge(event_stream::router())
}

/// Returns the OpenAPI document.
pub fn openapi() -> utoipa::openapi::OpenApi {
    Parts::new().document
}

/// Routes by who asks, and the document of all.
struct Parts {
    agents: Router<ServerState>,
    people: Router<ServerState>,
    health: Router<ServerState>,
    document: utoipa::openapi::OpenApi,
}

impl Parts {
    fn new() -> Parts {
        let (people, mut document) = OpenApiRouter::with_openapi(Document::openapi())
            .nest("/api/v1", for_people())
            .split_for_parts();
        let (health, of_health) = OpenApiRouter::new()
            .merge(health::router())
            .split_for_parts();
        let (agents, of_agents) = OpenApiRouter::new()
            .nest("/api/v1", for_agents())
            .split_for_parts();
        document.merge(of_health);
        document.merge(of_agents);
        complete(&mut document);
        let parameters = query::QueryParameters::of(&document);
        let people = people
            .layer(axum::middleware::from_fn(spreadsheet::convert))
            .layer(axum::middleware::from_fn(body::list_mistakes))
            .layer(axum::middleware::from_fn_with_state(
                parameters,
                query::refuse_unknown,
            ));
        Parts {
            agents,
            people: with_dashboard(people),
            health: health.layer(axum::middleware::from_fn(headers::add)),
            document,
        }
    }
}

fn complete(document: &mut utoipa::openapi::OpenApi) {
    document::add_problem_fields::<NoModelFields>(document);
    document::add_problem_fields::<NotAdjustableFields>(document);
    document::correct_schemas(document);
    list_kinds(document);
    document::complete(document);
}

/// Adds the readable document and the dashboard to the routes of people.
fn with_dashboard(people: Router<ServerState>) -> Router<ServerState> {
    people
        .merge(card::check::page_router())
        .route("/api/openapi.json", get(docs::document))
        .route("/api/docs", get(docs::page))
        .route("/api/{*rest}", get(no_such_route).fallback(no_such_route))
        .fallback(get(dashboard::serve))
        .layer(CompressionLayer::new())
        .layer(axum::middleware::from_fn(headers::add))
}

/// Lists the kinds that the capabilities declare in the schemas of their names.
fn list_kinds(document: &mut utoipa::openapi::OpenApi) {
    let events = event_kinds();
    let names = events.iter().map(events::Kind::name);
    document::list_values(document, "EventKind", names);
    document::list_values(document, "MessageKind", message_kinds().names());
    document::list_values(document, "NotificationKind", notice_kinds().names());
    for settings in ["NotificationSettings", "NotificationSettingsInForce"] {
        document::name_properties(document, settings, "ways", "NotificationKind");
    }
    let example = alerts::message_kinds::EXAMPLE;
    document::set_example(document, "NewWebhook", "kinds", json!(example));
}

async fn no_such_method() -> error::Error {
    error::Error::MethodNotAllowed
}

/// Returns the response after a panic; the panic itself is on standard error.
fn panicked(_: Box<dyn std::any::Any + Send>) -> Response {
    error::Error::Internal(anyhow::anyhow!("a handler panicked")).into_response()
}

async fn no_such_route() -> error::Error {
    error::Error::NotFound("page")
}

/// Returns the log span of a request, without the query, which may hold a secret.
fn span(request: &Request) -> Span {
    let route = request.extensions().get::<MatchedPath>();
    let route = route.map_or("dashboard", MatchedPath::as_str);
    debug_span!("http", method = %request.method(), route)
}

/// Returns the router of the process's role.
pub fn router(state: &ServerState) -> Router {
    let config = &state.app.config;
    let role = config.role;
    let parts = Parts::new();
    let mut pages = parts.health;
    pages = if role.serves_people() {
        let limit = axum::middleware::from_fn_with_state(state.app.clone(), rate_limit::limit);
        pages.merge(parts.people.layer(limit))
    } else {
        pages.fallback(no_such_route)
    };
    if config.is_on_https() {
        pages = pages.layer(axum::middleware::from_fn(headers::add_https_only));
    }
    let refuse = axum::middleware::from_fn_with_state(state.app.clone(), cross_site::refuse);
    let pages = pages.layer(refuse);
    let mut router = served(pages, state.for_workload(Workload::People));
    if role.serves_agents() {
        let agents = served(parts.agents, state.for_workload(Workload::Ingest));
        router = router.merge(agents);
    }
    router
        .method_not_allowed_fallback(no_such_method)
        .layer(axum::middleware::from_fn(host::must_be_one))
        .layer(DefaultBodyLimit::max(MAX_JSON_BYTES))
        .layer(TimeoutLayer::with_status_code(
            StatusCode::REQUEST_TIMEOUT,
            PATIENCE,
        ))
        .layer(CatchPanicLayer::custom(panicked))
        .layer(axum::middleware::from_fn_with_state(
            state.app.clone(),
            health::measure,
        ))
        .layer(TraceLayer::new_for_http().make_span_with(span))
}

/// Gives routes their state, and has their requests logged.
fn served(routes: Router<ServerState>, state: ServerState) -> Router {
    let log = axum::middleware::from_fn_with_state(state.app.clone(), audit::log_request);
    routes.layer(log).with_state(state)
}
