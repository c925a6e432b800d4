//! Health and metrics.

use crate::app::App;
use crate::error::Result;
use axum::extract::{MatchedPath, Request, State};
use axum::http::StatusCode;
use axum::middleware::Next;
use axum::response::Response;
use metrics::{counter, histogram};
use metrics_exporter_prometheus::{PrometheusBuilder, PrometheusHandle};
use std::time::Instant;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The routes of this part.
pub fn router() -> OpenApiRouter<App> {
    OpenApiRouter::new()
        .routes(routes!(healthz))
        .routes(routes!(readyz))
        .routes(routes!(metrics_page))
}

/// Sets up the process's metrics.
///
/// # Errors
/// When it is done twice.
pub fn install_metrics() -> anyhow::Result<PrometheusHandle> {
    let handle = PrometheusBuilder::new()
        .set_buckets(&[0.001, 0.01, 0.1, 1.0, 10.0])?
        .install_recorder()?;
    Ok(handle)
}

/// Whether the process runs
#[utoipa::path(get, path = "/healthz", tag = "operations", security(()),
    responses((status = 200, body = String)))]
async fn healthz() -> &'static str {
    "ok"
}

/// Whether requests can be served
#[utoipa::path(get, path = "/readyz", tag = "operations", security(()),
    responses((status = 200, body = String), (status = 503, body = String)))]
async fn readyz(State(app): State<App>) -> (StatusCode, &'static str) {
    if app.stopping.is_cancelled() {
        return (StatusCode::SERVICE_UNAVAILABLE, "stopping");
    }
    match app.db.ping().await {
        Ok(()) => (StatusCode::OK, "ready"),
        Err(_) => (
            StatusCode::SERVICE_UNAVAILABLE,
            "the database does not answer",
        ),
    }
}

/// Metrics for Prometheus
#[utoipa::path(get, path = "/metrics", tag = "operations", security(()),
    responses((status = 200, body = String)))]
async fn metrics_page(State(app): State<App>) -> Result<String> {
    let waiting = crate::analysis::count_jobs(&app.db).await?;
    for (state, jobs) in waiting {
        metrics::gauge!("binnacle_jobs", "state" => state).set(jobs as f64);
    }
    app.metrics.run_upkeep();
    Ok(app.metrics.render())
}

/// Counts and times every request by its route, never by its ids.
pub async fn measure(request: Request, next: Next) -> Response {
    let route = request
        .extensions()
        .get::<MatchedPath>()
        .map_or("dashboard", MatchedPath::as_str)
        .to_owned();
    let method = request.method().as_str().to_owned();
    let begun = Instant::now();
    let response = next.run(request).await;
    let status = response.status().as_u16().to_string();
    histogram!("binnacle_http_request_seconds", "route" => route.clone())
        .record(begun.elapsed().as_secs_f64());
    counter!("binnacle_http_requests_total", "method" => method, "route" => route, "status" => status)
        .increment(1);
    response
}
