//! The logbook on the local page: officers' reports and their delivery.
//!
//! Invariant: a report that the page confirmed is in the spool. The page creates the report's id,
//! so that a report sent twice by accident is one report.

use super::author::Author;
use super::request_guard::Refusal;
use super::state::PageState;
use crate::spool::{SaveReportError, StoredReport};
use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use binnacle_wire::logbook::{Report, ReportError, reporter};
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Report as the form sends it.
#[derive(Debug, Deserialize)]
pub(crate) struct ReportForm {
    #[serde(default)]
    reporter: String,
    #[serde(default)]
    withdrawn: bool,
    #[serde(flatten)]
    report: Report,
}

/// Lists the latest reports.
pub(super) async fn list_reports(
    State(page): State<PageState>,
) -> Result<Json<Vec<StoredReport>>, Refusal> {
    let found = page.spool.reports().await;
    found
        .map(Json)
        .map_err(|error| refuse_unsaved(&SaveReportError::Spool(error)))
}

/// Stores a report, or a change of one.
pub(super) async fn put_report(
    State(page): State<PageState>,
    Path(id): Path<Uuid>,
    author: Author,
    Json(written): Json<ReportForm>,
) -> Result<Json<StoredReport>, Refusal> {
    let action = written.action();
    let stored = store(&page, id, written).await;
    let stored = author.record(&page, &action, stored).await?;
    page.upload_wakeup.notify_one();
    Ok(Json(stored))
}

async fn store(page: &PageState, id: Uuid, written: ReportForm) -> Result<StoredReport, Refusal> {
    let now = page.now();
    let reporter = reporter(&written.reporter).map_err(|error| refuse_invalid(&error))?;
    let mut report = written
        .report
        .checked(now)
        .map_err(|error| refuse_invalid(&error))?;
    if !written.withdrawn {
        report = report
            .ending_within_a_year(now)
            .map_err(|error| refuse_invalid(&error))?;
    }
    let saved = page
        .spool
        .save_report(id, report, reporter, written.withdrawn, now);
    saved.await.map_err(|error| refuse_unsaved(&error))
}

impl ReportForm {
    /// Describes the report for the record of actions.
    fn action(&self) -> String {
        let what = if self.withdrawn {
            "withdrawal of a report"
        } else {
            "report"
        };
        let kind = words(&self.report.kind);
        format!("{what}: {kind}, {}", self.report.from)
    }
}

/// Returns the words of a kind.
pub(super) fn words(kind: &impl Serialize) -> String {
    let word = serde_json::to_value(kind).unwrap_or_default();
    word.as_str().unwrap_or_default().replace('_', " ")
}

pub(super) fn refuse_invalid(error: &ReportError) -> Refusal {
    (StatusCode::UNPROCESSABLE_ENTITY, error.to_string())
}

pub(super) fn refuse_unsaved(error: &SaveReportError) -> Refusal {
    let status = match error {
        SaveReportError::Withdrawn => StatusCode::CONFLICT,
        SaveReportError::TooMany => StatusCode::INSUFFICIENT_STORAGE,
        SaveReportError::Spool(cause) => {
            tracing::error!(error = %cause, "the reports cannot be stored or read");
            StatusCode::INTERNAL_SERVER_ERROR
        }
    };
    (status, error.to_string())
}

#[cfg(test)]
mod tests {
    use crate::page::tests::page;
    use crate::spool::ReportState;
    use axum::body::Body;
    use axum::extract::Request;
    use axum::http::StatusCode;
    use axum::response::Response;
    use axum::{Router, body};
    use serde_json::{Value, json};
    use tower::ServiceExt;

    const PATH: &str = "/api/reports/01934f2a-7c00-7000-8000-0000000000b1";

    fn cargo() -> Value {
        json!({
            "reporter": "Li", "kind": "magnetic_cargo", "from": "2026-11-20T06:00:00Z",
            "to": null, "cargo": "scrap", "hatch": " 2 ", "port": "", "note": "",
        })
    }

    fn put(path: &str, headers: &[(&str, &str)], body: &Value) -> Request {
        let mut request = Request::put(path)
            .header("content-type", "application/json")
            .header("host", "192.168.1.9:8090");
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        request.body(Body::from(body.to_string())).unwrap()
    }

    async fn send(router: &Router, request: Request) -> Response {
        router.clone().oneshot(request).await.unwrap()
    }

    const OWN: [(&str, &str); 2] = [
        ("x-binnacle-request", "1"),
        ("origin", "http://192.168.1.9:8090"),
    ];

    #[tokio::test]
    async fn a_report_is_kept_trimmed_and_listed_and_wakes_the_uplink() {
        let (_directory, page, router) = page().await;
        let response = send(&router, put(PATH, &OWN, &cargo())).await;
        assert_eq!(response.status(), StatusCode::OK);
        page.upload_wakeup.notified().await;
        let stored = page.spool.next_report().await.unwrap().unwrap();
        assert_eq!(stored.sent.report.hatch.as_deref(), Some("2"));
        assert_eq!(stored.sent.report.port, None);
        assert_eq!(stored.state, ReportState::Waiting);

        let list = Request::get("/api/reports").header("host", "localhost");
        let response = send(&router, list.body(Body::empty()).unwrap()).await;
        let listed = body::to_bytes(response.into_body(), 1 << 16).await.unwrap();
        let listed: Value = serde_json::from_slice(&listed).unwrap();
        assert_eq!(listed[0]["standing"], "waiting");
        assert_eq!(listed[0]["cargo"], "scrap");
    }

    #[tokio::test]
    async fn another_site_cannot_report() {
        let (_directory, page, router) = page().await;
        let tricks: [&[(&str, &str)]; 3] = [
            &[],
            &[
                ("x-binnacle-request", "1"),
                ("origin", "http://evil.example"),
            ],
            &[("x-binnacle-request", "1"), ("origin", "null")],
        ];
        for headers in tricks {
            let response = send(&router, put(PATH, headers, &cargo())).await;
            assert_eq!(response.status(), StatusCode::FORBIDDEN, "{headers:?}");
        }
        assert!(page.spool.reports().await.unwrap().is_empty());
    }

    #[tokio::test]
    async fn what_is_no_report_is_refused_in_words_and_leaves_nothing() {
        let (_directory, page, router) = page().await;
        for (field, value) in [
            ("to", json!("2026-11-19T00:00:00Z")),
            ("from", json!("2999-01-01T00:00:00Z")),
            ("kind", json!("ufo")),
            ("note", json!("x".repeat(1001))),
            ("reporter", json!("a\nb")),
        ] {
            let mut body = cargo();
            body[field] = value;
            let response = send(&router, put(PATH, &OWN, &body)).await;
            assert_eq!(
                response.status(),
                StatusCode::UNPROCESSABLE_ENTITY,
                "{field}"
            );
        }
        let mut large = cargo();
        large["note"] = json!("x".repeat(20_000));
        let response = send(&router, put(PATH, &OWN, &large)).await;
        assert_eq!(response.status(), StatusCode::PAYLOAD_TOO_LARGE);
        let response = send(&router, put("/api/reports/x", &OWN, &cargo())).await;
        assert_eq!(response.status(), StatusCode::BAD_REQUEST);
        assert!(page.spool.reports().await.unwrap().is_empty());
    }
}
