//! Reports of a fleet: due dates, deviations, completed jobs and savings.
//!
//! Invariants: JSON, CSV and PDF are made from one report and cannot differ. Each computed figure
//! comes with its inputs, and unknown figures are marked.

mod csv;
mod layout;
mod load;
mod mailing_list;
mod monthly;
mod report;
mod settings;

pub use mailing_list::MAILING_LIST;
pub use monthly::{MESSAGE_KIND, make_due_reports, watch};

use axum::extract::{FromRef, State};
use axum::response::Response;
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{FileContent, FileName, Json, Params, file};
use chrono::{Datelike, NaiveDate};
use csv::Table;
use report::Report;
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Maximum length of the period, days.
const MAX_DAYS: i64 = 3660;

/// Returns the routes of this part.
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

/// Period in which jobs are counted.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Range {
    /// First day, UTC; by default the first of the month of `to`.
    #[param(example = "2026-11-01")]
    from: Option<NaiveDate>,
    /// Last day, UTC; today by default.
    #[param(example = "2026-11-30")]
    to: Option<NaiveDate>,
}

/// Choice of a table.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct TableChoice {
    /// Table to return; `due` by default.
    #[serde(default)]
    #[param(inline)]
    table: Table,
}

/// Report on the fleet
///
/// Due dates and greatest deviations are as of now. Jobs, and their savings against swinging, are
/// those of the period.
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

/// Export a table of the fleet's report as CSV
#[utoipa::path(get, path = "/reports/fleet.csv", tag = "fleet", params(Range, TableChoice),
    responses((status = 200, content_type = "text/csv", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 422, body = Problem)))]
async fn report_csv(
    State(app): State<App>,
    reader: Reader,
    Params(range): Params<Range>,
    Params(choice): Params<TableChoice>,
) -> Result<Response> {
    let report = range.report(&app, reader).await?;
    let name = report.file_name(choice.table.name(), "csv");
    let text = csv::render_table(&report, choice.table)?;
    Ok(file("text/csv; charset=utf-8", &name, text))
}

/// Print the fleet's report
///
/// Sheets of A4 with due dates, greatest deviations, jobs and savings.
#[utoipa::path(get, path = "/reports/fleet.pdf", tag = "fleet", params(Range),
    responses((status = 200, content_type = "application/pdf", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 422, body = Problem)))]
async fn report_pdf(
    State(app): State<App>,
    reader: Reader,
    Params(range): Params<Range>,
) -> Result<Response> {
    let report = range.report(&app, reader).await?;
    let name = report.file_name("report", "pdf");
    Ok(file("application/pdf", &name, report.into_pdf().await?))
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
        if (to - from).num_days() > MAX_DAYS {
            return invalid(format!("{from} is more than ten years before {to}"));
        }
        load::load_report(app, reader.operator, from, to, None).await
    }
}

impl Report {
    fn file_name(&self, content: &str, extension: &'static str) -> FileName {
        let (from, to) = (self.from.to_string(), self.to.to_string());
        FileName::new(
            &["compass", content, &self.operator_name, &from, &to],
            extension,
        )
    }
}
