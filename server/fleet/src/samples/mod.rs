//! Samples of a compass, each with its outcome in the last analysis.

mod chart_data;
mod coverage;
mod export;

use crate::analysis;
use crate::compasses;
use crate::vessels;
use axum::extract::{FromRef, State};
use axum::response::Response;
use binnacle_compass::result::SampleDiagnostic;
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{FileContent, Id, Json, Page, Params, time};
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use chart_data::SamplePicture;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_samples))
        .routes(routes!(samples_csv))
        .routes(routes!(samples_ndjson))
        .routes(routes!(draw_samples))
        .merge(coverage::router())
}

/// Selection of samples.
#[derive(Clone, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Range {
    /// The first instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    from: Option<String>,
    /// The instant after the last, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    to: Option<String>,
    /// A compass of the vessel; its first one by default.
    compass: Option<CompassId>,
}

/// A page of samples.
#[derive(Serialize, ToSchema)]
struct SampleList {
    /// In order of time.
    items: Vec<SampleDiagnostic>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// List a compass's samples
#[utoipa::path(get, path = "/vessels/{id}/samples", tag = "fleet",
    params(("id" = VesselId, Path), Range, Page),
    responses((status = 200, body = SampleList), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn list_samples(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(range): Params<Range>,
    page: Page,
) -> Result<Json<SampleList>> {
    let after = page.after_shared()?;
    let mut samples = find(&app, reader, id, &range).await?;
    let micros = |found: &SampleDiagnostic| found.sample.time.micros();
    let before =
        |samples: &[SampleDiagnostic], at: i64| samples.partition_point(|found| micros(found) < at);
    // Two installations may have sampled at the same instant.
    let begin = after.map_or(0, |(at, listed)| {
        before(&samples, at)
            .saturating_add(listed)
            .min(samples.len())
    });
    let end = (begin + page.limit()).min(samples.len());
    let last = samples[begin..end].last().map(micros);
    let next = last.map(|at| format!("{at}.{}", end - before(&samples, at)));
    let listed = page.cut(samples.split_off(begin), |_| {
        next.clone().unwrap_or_default()
    });
    Ok(Json(SampleList {
        items: listed.items,
        next: listed.next,
    }))
}

/// A compass's samples as CSV, as `fit` reads it
#[utoipa::path(get, path = "/vessels/{id}/samples.csv", tag = "fleet",
    params(("id" = VesselId, Path), Range),
    responses((status = 200, content_type = "text/csv", body = inline(FileContent)), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn samples_csv(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(range): Params<Range>,
) -> Result<Response> {
    export::csv(&find(&app, reader, id, &range).await?)
}

/// A compass's samples as lines of JSON
#[utoipa::path(get, path = "/vessels/{id}/samples.ndjson", tag = "fleet",
    params(("id" = VesselId, Path), Range),
    responses((status = 200, content_type = "application/x-ndjson", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn samples_ndjson(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(range): Params<Range>,
) -> Result<Response> {
    export::ndjson(&find(&app, reader, id, &range).await?)
}

/// A compass's samples as a picture shows them
///
/// Dots that are few enough to draw, and the residuals' means by day or week.
#[utoipa::path(get, path = "/vessels/{id}/samples/picture", tag = "fleet",
    params(("id" = VesselId, Path), Range),
    responses((status = 200, body = SamplePicture), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn draw_samples(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(range): Params<Range>,
) -> Result<Json<SamplePicture>> {
    let samples = find(&app, reader, id, &range).await?;
    Ok(Json(chart_data::summarize(&samples)))
}

async fn find(
    app: &App,
    reader: Reader,
    id: VesselId,
    range: &Range,
) -> Result<Vec<SampleDiagnostic>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let compass = compasses::find(&app.db, id, range.compass).await?;
    let from = time("from", range.from.as_deref())?.map(Time);
    let to = time("to", range.to.as_deref())?.map(Time);
    analysis::samples(&app.db, id, compass.id, from, to).await
}
