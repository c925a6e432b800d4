//! Azimuths on the local page: officers' observations, with their errors at once.
//!
//! Invariant: an azimuth that the page confirmed is in the spool. The page creates its id, so that
//! an azimuth sent twice by accident is one azimuth.

use super::author::Author;
use super::reports::{refuse_invalid, refuse_unsaved, words};
use super::request_guard::Refusal;
use super::state::PageState;
use crate::spool::{SaveReportError, SpooledAzimuth};
use axum::Json;
use axum::extract::{Path, State};
use binnacle_compass::azimuth::AzimuthResult;
use binnacle_wire::messages::BoardAzimuth;
use serde::Serialize;
use uuid::Uuid;

/// Azimuth as the page shows it.
#[derive(Debug, Serialize)]
pub(crate) struct ShownAzimuth {
    #[serde(flatten)]
    azimuth: SpooledAzimuth,
    /// Compass error and gyro error.
    result: Option<AzimuthResult>,
}

/// Lists the latest azimuths.
pub(super) async fn list_azimuths(
    State(page): State<PageState>,
) -> Result<Json<Vec<ShownAzimuth>>, Refusal> {
    let found = page.spool.azimuths().await;
    let found = found.map_err(|error| refuse_unsaved(&SaveReportError::Spool(error)))?;
    Ok(Json(found.into_iter().map(ShownAzimuth::new).collect()))
}

/// Stores an azimuth, or its withdrawal, and responds with its errors.
pub(super) async fn put_azimuth(
    State(page): State<PageState>,
    Path(id): Path<Uuid>,
    author: Author,
    Json(written): Json<BoardAzimuth>,
) -> Result<Json<ShownAzimuth>, Refusal> {
    let action = action(&written);
    let stored = store(&page, id, written).await;
    let stored = author.record(&page, &action, stored).await?;
    page.upload_wakeup.notify_one();
    Ok(Json(ShownAzimuth::new(stored)))
}

async fn store(
    page: &PageState,
    id: Uuid,
    written: BoardAzimuth,
) -> Result<SpooledAzimuth, Refusal> {
    let now = page.now();
    let report = written.report.checked(now);
    let sent = BoardAzimuth {
        report: report.map_err(|error| refuse_invalid(&error))?,
        ..written
    };
    let stored = page.spool.save_azimuth(id, sent, now).await;
    stored.map_err(|error| refuse_unsaved(&error))
}

/// Describes an azimuth for the record of actions.
fn action(written: &BoardAzimuth) -> String {
    let what = if written.withdrawn {
        "withdrawal of an azimuth"
    } else {
        "azimuth"
    };
    let observation = &written.report.observation;
    format!("{what}: {}, {}", words(&observation.kind), observation.time)
}

impl ShownAzimuth {
    fn new(azimuth: SpooledAzimuth) -> ShownAzimuth {
        let worked_out = azimuth.sent.report.azimuth().ok();
        ShownAzimuth {
            result: worked_out.map(|azimuth| azimuth.result().clone()),
            azimuth,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::page::tests::page;
    use axum::body::Body;
    use axum::extract::Request;
    use axum::http::StatusCode;
    use axum::{Router, body};
    use serde_json::{Value, json};
    use tower::ServiceExt;

    const PATH: &str = "/api/azimuths/01934f2a-7c00-7000-8000-0000000000a2";

    fn sun() -> Value {
        json!({
            "time": "2025-11-21T10:00:00Z", "lat": 43.4, "lon": -3.1, "kind": "sun_azimuth",
            "compass_heading_deg": 92.0, "compass_bearing_deg": 150.0, "gyro_heading_deg": 94.0,
            "observer": " LW ",
        })
    }

    async fn put(router: &Router, guard: &str, azimuth: &Value) -> (StatusCode, String) {
        let request = Request::put(PATH)
            .header("content-type", "application/json")
            .header("host", "192.168.1.9:8090")
            .header("x-binnacle-request", guard)
            .body(Body::from(azimuth.to_string()));
        let response = router.clone().oneshot(request.unwrap()).await.unwrap();
        let status = response.status();
        let text = body::to_bytes(response.into_body(), 1 << 16).await.unwrap();
        (status, String::from_utf8(text.to_vec()).unwrap())
    }

    async fn listed(router: &Router) -> Value {
        let list = Request::get("/api/azimuths").header("host", "localhost");
        let list = list.body(Body::empty()).unwrap();
        let response = router.clone().oneshot(list).await.unwrap();
        let text = body::to_bytes(response.into_body(), 1 << 16).await.unwrap();
        serde_json::from_slice(&text).unwrap()
    }

    #[tokio::test]
    async fn the_errors_are_shown_at_once_and_the_uplink_wakes() {
        let (_directory, page, router) = page().await;
        let (status, text) = put(&router, "1", &sun()).await;
        assert_eq!(status, StatusCode::OK, "{text}");
        let shown: Value = serde_json::from_str(&text).unwrap();
        let degrees = |name: &str| shown["result"][name].as_f64().unwrap();
        let error = degrees("true_bearing_deg") - 150.0;
        assert!(
            (degrees("compass_error_deg") - error).abs() < 1e-9,
            "{shown}"
        );
        assert!(
            (degrees("gyro_error_deg") - (error - 2.0)).abs() < 1e-9,
            "{shown}"
        );
        page.upload_wakeup.notified().await;
        let azimuths = listed(&router).await;
        assert_eq!(azimuths[0], shown);
        assert_eq!(azimuths[0]["observer"], "LW");
        assert_eq!(azimuths[0]["standing"], "waiting");
    }

    #[tokio::test]
    async fn an_unlikely_azimuth_is_questioned_and_kept_once_confirmed() {
        let (_directory, _page, router) = page().await;
        let mut azimuth = sun();
        azimuth["compass_bearing_deg"] = json!(15.0);
        let (status, text) = put(&router, "1", &azimuth).await;
        assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY);
        assert!(text.starts_with("confirmed: "), "{text}");
        azimuth["confirmed"] = json!(true);
        assert_eq!(put(&router, "1", &azimuth).await.0, StatusCode::OK);
    }

    #[tokio::test]
    async fn what_is_no_azimuth_is_refused_by_field_and_leaves_nothing() {
        let (_directory, _page, router) = page().await;
        for (field, value) in [
            ("time", json!("2999-01-01T00:00:00Z")),
            ("time", json!("2025-11-21")),
            ("time", json!("2025-11-21T23:00:00Z")),
            ("lat", json!(95)),
            ("observer", json!("")),
            ("true_bearing_deg", json!(152)),
        ] {
            let mut azimuth = sun();
            azimuth[field] = value;
            let (status, text) = put(&router, "1", &azimuth).await;
            assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY, "{field}");
            assert!(text.contains(field), "{field}: {text}");
        }
        let (status, _) = put(&router, "0", &sun()).await;
        assert_eq!(status, StatusCode::FORBIDDEN, "another site");
        assert_eq!(listed(&router).await, json!([]));
    }

    #[tokio::test]
    async fn a_withdrawn_azimuth_cannot_come_back() {
        let (_directory, _page, router) = page().await;
        let mut azimuth = sun();
        assert_eq!(put(&router, "1", &azimuth).await.0, StatusCode::OK);
        azimuth["withdrawn"] = json!(true);
        assert_eq!(put(&router, "1", &azimuth).await.0, StatusCode::OK);
        azimuth["withdrawn"] = json!(false);
        assert_eq!(put(&router, "1", &azimuth).await.0, StatusCode::CONFLICT);
        assert_eq!(listed(&router).await[0]["withdrawn"], true);
    }
}
