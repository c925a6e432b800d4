//! Reports of a fleet: what is due, how bad it is, what was done and what that saved.
//!
//! What always holds: JSON, CSV and paper are made from one report and cannot differ; what
//! is reckoned says from which figures, and what is not known is said not to be.

mod csv;
mod gather;
mod layout;
mod mailing_list;
mod monthly;
mod report;
mod settings;

pub use mailing_list::MAILING_LIST;
pub use monthly::{look, watch};

use axum::extract::{FromRef, State};
use axum::response::Response;
use binnacle_drawing::{self, About};
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Json, Params, file, file_name};
use chrono::{Datelike, NaiveDate};
use report::Report;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Jobs are counted in so many days at most.
const LONGEST_DAYS: i64 = 3660;

/// The routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(find_report))
        .routes(routes!(report_csv))
        .routes(routes!(report_pdf))
        .merge(settings::router())
}

/// In which time jobs are counted.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Range {
    /// The first day, UTC; the first of the month of `to` if not said.
    #[param(example = "2026-11-01")]
    from: Option<NaiveDate>,
    /// The last day, UTC; today if not said.
    #[param(example = "2026-11-30")]
    to: Option<NaiveDate>,
}

/// Table of a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ReportTable)]
enum Table {
    /// Due dates of the compasses, the first due first.
    #[default]
    Due,
    /// The greatest deviation of each compass, the greatest first.
    Deviation,
    /// The jobs that were completed.
    Jobs,
}

/// Choice of a table.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Which {
    /// Table to return; `due` by default.
    #[serde(default)]
    #[param(inline)]
    table: Table,
}

/// Report on the fleet
///
/// What is due and the greatest deviations are as of now; jobs, and what they saved
/// against swinging, of the time asked for.
#[utoipa::path(get, path = "/reports/fleet", tag = "fleet", params(Range),
    responses((status = 200, body = Report), (status = 401, body = Problem),
              (status = 422, body = Problem)))]
async fn find_report(
    State(app): State<App>,
    reader: Reader,
    Params(range): Params<Range>,
) -> Result<Json<Report>> {
    Ok(Json(range.report(&app, reader).await?))
}

/// A table of the fleet's report as CSV
#[utoipa::path(get, path = "/reports/fleet.csv", tag = "fleet", params(Range, Which),
    responses((status = 200, content_type = "text/csv", body = String),
              (status = 401, body = Problem), (status = 422, body = Problem)))]
async fn report_csv(
    State(app): State<App>,
    reader: Reader,
    Params(range): Params<Range>,
    Params(which): Params<Which>,
) -> Result<Response> {
    let report = range.report(&app, reader).await?;
    let name = report.file_name(which.table.name(), "csv");
    let text = csv::table(&report, which.table)?;
    Ok(file("text/csv; charset=utf-8", &name, text))
}

/// Print the fleet's report
///
/// Sheets of A4: what is due soon, the greatest deviations, the jobs, and what they saved.
#[utoipa::path(get, path = "/reports/fleet.pdf", tag = "fleet", params(Range),
    responses((status = 200, content_type = "application/pdf", body = Vec<u8>),
              (status = 401, body = Problem), (status = 422, body = Problem)))]
async fn report_pdf(
    State(app): State<App>,
    reader: Reader,
    Params(range): Params<Range>,
) -> Result<Response> {
    let report = range.report(&app, reader).await?;
    let name = report.file_name("report", "pdf");
    Ok(file("application/pdf", &name, report.printed().await?))
}

impl Range {
    async fn report(&self, app: &App, reader: Reader) -> Result<Report> {
        let today = app.clock.now().to_chrono().date_naive();
        let to = self.to.unwrap_or(today);
        let from = self.from.or(to.with_day(1)).unwrap_or(to);
        let invalid = |detail: String| {
            Err(Error::Invalid {
                field: "from",
                detail,
            })
        };
        if from > to {
            return invalid(format!("{from} is after {to}"));
        }
        if (to - from).num_days() > LONGEST_DAYS {
            return invalid(format!("{from} is more than ten years before {to}"));
        }
        gather::gather(app, reader.operator, (from, to), None).await
    }
}

impl Table {
    fn name(self) -> &'static str {
        match self {
            Table::Due => "due",
            Table::Deviation => "deviation",
            Table::Jobs => "jobs",
        }
    }
}

impl Report {
    /// The report on paper.
    async fn printed(self) -> Result<Vec<u8>> {
        let about = About {
            title: format!(
                "Compass report: {}, {} to {}",
                self.operator_name, self.from, self.to
            ),
            created: self.made_at.0,
        };
        let drawn = move || binnacle_drawing::pdf(&layout::sheets(&self), &about);
        Ok(tokio::task::spawn_blocking(drawn).await??)
    }

    fn file_name(&self, what: &str, ending: &str) -> String {
        let (from, to) = (self.from.to_string(), self.to.to_string());
        file_name(&["compass", what, &self.operator_name, &from, &to], ending)
    }
}
