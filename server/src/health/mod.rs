//! Health and metrics.

pub mod disk;
mod names;

use axum::extract::{FromRef, MatchedPath, Request, State};
use axum::http::header::{AUTHORIZATION, FORWARDED};
use axum::http::{HeaderMap, HeaderName, StatusCode};
use axum::middleware::Next;
use axum::response::Response;
use binnacle_fleet::analysis_queue;
use binnacle_platform::app::App;
use binnacle_platform::audit::{Refusal, RequestContext};
use binnacle_platform::client_address::Origin;
use binnacle_platform::db::Workload;
use binnacle_platform::error::{Error, Problem, Result};
use metrics::{counter, gauge, histogram};
use metrics_exporter_prometheus::{PrometheusBuilder, PrometheusHandle};
use std::time::{Duration, Instant};
use tokio::time::timeout;
use tracing::debug;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Wait of a due analysis beyond which the readiness check mentions it, seconds: more workers are
/// needed, or they have died.
const LONG_WAIT_S: f64 = 600.0;

/// Time in which the database must respond for the server to be ready.
const READY_WITHIN: Duration = Duration::from_millis(900);

/// Bounds of the buckets of times, seconds: near enough for the half and the ninety-ninth
/// hundredth of requests, analyses and schedules.
const BUCKETS_S: [f64; 12] = [
    0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 15.0, 60.0,
];

/// Routes of health checks and metrics.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(healthz))
        .routes(routes!(readyz))
        .routes(routes!(metrics_page))
}

/// Sets up the process's metrics.
///
/// # Errors
/// Fails when the metrics are already installed.
pub fn install_metrics() -> anyhow::Result<PrometheusHandle> {
    let handle = PrometheusBuilder::new()
        .set_buckets(&BUCKETS_S)?
        .install_recorder()?;
    names::describe();
    Ok(handle)
}

/// Check whether the process runs
#[utoipa::path(get, path = "/healthz", tag = "operations", security(()),
    responses((status = 200, body = String)))]
async fn healthz() -> &'static str {
    "ok"
}

/// Check whether requests can be served
#[utoipa::path(get, path = "/readyz", tag = "operations", security(()),
    responses((status = 200, body = String), (status = 503, body = String)))]
async fn readyz(State(app): State<App>) -> (StatusCode, String) {
    let unavailable = |reason: &str| (StatusCode::SERVICE_UNAVAILABLE, reason.to_owned());
    if app.stopping.is_cancelled() {
        return unavailable("stopping");
    }
    // Not by the connections for requests: many requests are no reason to send none.
    let db = app.db.for_workload(Workload::Background);
    let oldest_s = analysis_queue::oldest_wait_s(&db, app.clock.now().into());
    let Ok(Ok(oldest_s)) = timeout(READY_WITHIN, oldest_s).await else {
        return unavailable("the database does not respond");
    };
    let oldest_s = oldest_s.unwrap_or(0.0);
    if app.disk.is_full() {
        return unavailable("the disk of the database is full");
    }
    // Requests are served all the same.
    if oldest_s > LONG_WAIT_S {
        let text = format!("ready, but an analysis has waited for {oldest_s:.0} s");
        return (StatusCode::OK, text);
    }
    (StatusCode::OK, "ready".to_owned())
}

/// Metrics for Prometheus
///
/// Requires the token that the server was started with (`BINNACLE_METRICS_TOKEN`). Without a
/// token, only programs on the same machine may read them.
#[utoipa::path(get, path = "/metrics", tag = "operations", security((), ("token" = [])),
    responses((status = 200, body = String), (status = 401, body = Problem)))]
async fn metrics_page(
    State(app): State<App>,
    request: RequestContext,
    origin: Origin,
    headers: HeaderMap,
) -> Result<String> {
    if !may_read_metrics(&app, &origin, &headers) {
        request.refuse(Refusal::InvalidToken, None);
        return Err(Error::Unauthenticated);
    }
    // What the database does not say is left as it was: the rest is needed then most.
    if let Err(error) = read_queue(&app).await {
        debug!(%error, "the queue was not read");
    }
    for usage in app.db.usage() {
        let workload = usage.workload.name();
        for (state, connections) in [("used", usage.used), ("most", usage.most)] {
            gauge!("binnacle_database_connections", "workload" => workload, "state" => state)
                .set(connections as f64);
        }
    }
    app.metrics.run_upkeep();
    Ok(app.metrics.render())
}

/// Sets the metrics of the queue of analyses.
async fn read_queue(app: &App) -> Result<()> {
    for (state, jobs) in analysis_queue::count(&app.db).await? {
        gauge!("binnacle_jobs", "state" => state).set(jobs as f64);
    }
    let oldest_s = analysis_queue::oldest_wait_s(&app.db, app.clock.now().into()).await?;
    gauge!("binnacle_oldest_job_seconds").set(oldest_s.unwrap_or(0.0));
    Ok(())
}

fn may_read_metrics(app: &App, origin: &Origin, headers: &HeaderMap) -> bool {
    if app.config.metrics_token.is_some() {
        let sent = headers
            .get(AUTHORIZATION)
            .and_then(|sent| sent.to_str().ok());
        let sent = sent.and_then(|sent| sent.strip_prefix("Bearer "));
        return sent.is_some_and(|sent| app.config.is_metrics_token(sent));
    }
    // A client behind an unknown proxy may be anybody.
    let is_forwarded = [FORWARDED, HeaderName::from_static("x-forwarded-for")]
        .iter()
        .any(|name| headers.contains_key(name));
    let is_here = origin.address.is_some_and(|address| address.is_loopback());
    is_here && !is_forwarded
}

/// Counts and times every request by its route, never by its ids, and notices a full disk.
pub async fn measure(State(app): State<App>, request: Request, next: Next) -> Response {
    let route = request
        .extensions()
        .get::<MatchedPath>()
        .map_or("dashboard", MatchedPath::as_str)
        .to_owned();
    let method = request.method().as_str().to_owned();
    let begun = Instant::now();
    let response = next.run(request).await;
    if response.status() == StatusCode::INSUFFICIENT_STORAGE {
        app.disk.report_full();
    }
    let status = response.status().as_u16().to_string();
    histogram!("binnacle_http_request_seconds", "route" => route.clone())
        .record(begun.elapsed().as_secs_f64());
    counter!("binnacle_http_requests_total", "method" => method, "route" => route, "status" => status)
        .increment(1);
    response
}
