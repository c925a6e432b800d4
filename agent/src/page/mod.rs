//! The local page: its files, the status as JSON, the hold buttons, and the forms of logbook and
//! azimuths.
//!
//! For the vessel's own network. Everybody there may read it. What changes the heading or the log
//! needs the PIN, or where none is set, comes from the agent's own computer; it is recorded. A
//! foreign web site that an officer has open must not be able to press a button: every change needs
//! a header that no form can send, and requests under names that resolve elsewhere are refused.

mod acknowledgements;
mod actions;
mod azimuths;
mod exclusions;
mod reports;
mod site;

mod author;
mod state;

mod pin_guard;
mod request_guard;
mod throttle;

pub(crate) use pin_guard::PinGuard;
pub(crate) use state::PageState;

use crate::config::PageConfig;
use crate::status::Status;
use acknowledgements::acknowledge;
use anyhow::Context;
use axum::extract::{DefaultBodyLimit, State};
use axum::middleware;
use axum::routing::{get, post, put};
use axum::{Json, Router};
use binnacle_listener::Limits;
use exclusions::set_exclusion;
use request_guard::reject_foreign_sites;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;

/// Size limit of a request: a report's note has at most 1000 characters.
const MAX_REQUEST_BYTES: usize = 16 * 1024;

/// Limits on connections: many more than a bridge has screens. The page sends a request every
/// second. It must not use up what the uplink and the instruments need.
const LIMITS: Limits = Limits {
    connections: 96,
    connections_per_network: Some(24),
    handshake: Duration::from_secs(10),
    head: Duration::from_secs(10),
    idle: Duration::from_secs(15),
    stall: Duration::from_secs(15),
    drain: Duration::from_secs(2),
};

/// Serves the page until `shutdown`, if it is configured. Returns its address.
pub(crate) async fn serve(
    config: Option<&PageConfig>,
    page: PageState,
    shutdown: &CancellationToken,
) -> anyhow::Result<Option<SocketAddr>> {
    let Some(config) = config else {
        return Ok(None);
    };
    let listener = TcpListener::bind(config.listen)
        .await
        .with_context(|| format!("page.listen {}: cannot listen", config.listen))?;
    let address = listener.local_addr()?;
    let stopping = shutdown.clone();
    tokio::spawn(binnacle_listener::serve(
        listener,
        LIMITS,
        binnacle_listener::plain,
        router(page),
        stopping,
    ));
    Ok(Some(address))
}

/// Returns the routes of the page.
pub(crate) fn router(page: PageState) -> Router {
    Router::new()
        .merge(site::routes())
        .route("/api/status", get(status))
        .route("/api/hold", post(set_exclusion))
        .route("/api/alert/acknowledge", post(acknowledge))
        .route("/api/access", get(actions::show_access))
        .route("/api/actions", get(actions::list_actions))
        .route("/api/azimuths", get(azimuths::list_azimuths))
        .route("/api/azimuths/{id}", put(azimuths::put_azimuth))
        .route("/api/reports", get(reports::list_reports))
        .route("/api/reports/{id}", put(reports::put_report))
        .layer(DefaultBodyLimit::max(MAX_REQUEST_BYTES))
        .layer(middleware::from_fn(reject_foreign_sites))
        .with_state(page)
}

async fn status(State(page): State<PageState>) -> Json<Arc<Status>> {
    Json(page.status.borrow().clone())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::alert::AlertRecord;
    use crate::config::Pin;
    use crate::sampler::Exclusion;
    use crate::spool::Spool;
    use axum::body::{self, Body};
    use axum::extract::{ConnectInfo, Request};
    use axum::http::StatusCode;
    use axum::{Extension, response::Response};
    use binnacle_wire::alert::{ShipAlert, ShipAlertState};
    use tempfile::TempDir;
    use tokio::sync::{Notify, watch};
    use tokio::time::Instant;
    use tower::ServiceExt;
    use uuid::Uuid;

    /// Returns a page without a PIN, as it is reached from the agent's own computer.
    pub(crate) async fn page() -> (TempDir, PageState, Router) {
        page_for(None, "127.0.0.1").await
    }

    /// Returns a page as it is reached from an address.
    pub(crate) async fn page_for(pin: Option<&str>, peer: &str) -> (TempDir, PageState, Router) {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        let pin = pin.map(|pin| Pin::hash(pin).unwrap());
        let page = PageState {
            spool,
            status: watch::channel(Arc::new(Status::default())).1,
            exclusion: watch::Sender::new(None),
            acknowledged: watch::Sender::new(None),
            upload_wakeup: Arc::new(Notify::new()),
            guard: Arc::new(PinGuard::new(pin, Instant::now())),
        };
        let router = reached_from(peer, &page);
        (directory, page, router)
    }

    fn reached_from(peer: &str, page: &PageState) -> Router {
        let peer = SocketAddr::new(peer.parse().unwrap(), 50_000);
        router(page.clone()).layer(Extension(ConnectInfo(peer)))
    }

    fn exclusion(headers: &[(&str, &str)]) -> Request {
        let mut request = Request::post("/api/hold")
            .header("content-type", "application/json")
            .header("host", "192.168.1.9:8090");
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        request.body(Body::from(r#"{"hold":"berthed"}"#)).unwrap()
    }

    #[tokio::test]
    async fn the_button_holds_at_once_and_after_a_restart() {
        let (_directory, page, router) = page().await;
        let own = [
            ("x-binnacle-request", "1"),
            ("origin", "http://192.168.1.9:8090"),
        ];
        let response = router.oneshot(exclusion(&own)).await.unwrap();
        assert_eq!(response.status(), StatusCode::OK);
        assert_eq!(*page.exclusion.borrow(), Some(Exclusion::Berthed));
        assert_eq!(
            page.spool.exclusion().await.unwrap(),
            Some(Exclusion::Berthed)
        );
    }

    #[tokio::test]
    async fn another_site_cannot_press_it() {
        let (_directory, page, router) = page().await;
        let tricks: [&[(&str, &str)]; 3] = [
            &[],
            &[
                ("x-binnacle-request", "1"),
                ("origin", "http://evil.example"),
            ],
            &[("origin", "null"), ("x-binnacle-request", "1")],
        ];
        for headers in tricks {
            let response = router.clone().oneshot(exclusion(headers)).await.unwrap();
            assert_eq!(response.status(), StatusCode::FORBIDDEN, "{headers:?}");
        }
        assert_eq!(*page.exclusion.borrow(), None);
    }

    async fn text(response: Response) -> String {
        let bytes = body::to_bytes(response.into_body(), 1 << 16).await.unwrap();
        String::from_utf8(bytes.to_vec()).unwrap()
    }

    async fn get_json(router: &Router, path: &str) -> serde_json::Value {
        let request = Request::get(path).header("host", "192.168.1.9:8090");
        let request = request.body(Body::empty()).unwrap();
        let response = router.clone().oneshot(request).await.unwrap();
        serde_json::from_str(&text(response).await).unwrap()
    }

    #[tokio::test]
    async fn without_a_pin_the_network_may_look_and_alter_nothing() {
        let (_directory, page, router) = page_for(None, "192.168.1.30").await;
        let access = get_json(&router, "/api/access").await;
        assert_eq!(access, serde_json::json!({"pin": false, "allowed": false}));
        let own = [("x-binnacle-request", "1"), ("x-binnacle-pin", "271828")];
        let response = router.clone().oneshot(exclusion(&own)).await.unwrap();
        assert_eq!(response.status(), StatusCode::FORBIDDEN);
        assert!(text(response).await.contains("own computer"));
        assert_eq!(*page.exclusion.borrow(), None);
        assert_eq!(
            get_json(&router, "/api/actions").await,
            serde_json::json!([])
        );
    }

    #[tokio::test]
    async fn with_a_pin_whoever_knows_it_may_alter_something_and_it_is_recorded() {
        let (_directory, page, router) = page_for(Some("271828"), "192.168.1.30").await;
        let send = async |pin: &str| {
            let headers = [("x-binnacle-request", "1"), ("x-binnacle-pin", pin)];
            let response = router.clone().oneshot(exclusion(&headers)).await.unwrap();
            response.status()
        };
        let without = exclusion(&[("x-binnacle-request", "1")]);
        let response = router.clone().oneshot(without).await.unwrap();
        assert_eq!(response.status(), StatusCode::UNAUTHORIZED);
        assert_eq!(send("314159").await, StatusCode::UNAUTHORIZED);
        assert_eq!(*page.exclusion.borrow(), None);
        assert_eq!(send("271828").await, StatusCode::OK);
        assert_eq!(*page.exclusion.borrow(), Some(Exclusion::Berthed));
        let actions = get_json(&router, "/api/actions").await;
        let said = |number: usize| {
            ["address", "action", "result"].map(|name| actions[number][name].as_str().unwrap())
        };
        assert_eq!(said(0), ["192.168.1.30", "hold: berthed", "done"]);
        assert_eq!(said(1), ["192.168.1.30", "PIN", "wrong"]);
        assert_eq!(actions.as_array().unwrap().len(), 2);
    }

    #[tokio::test]
    async fn a_name_on_the_internet_is_not_this_page() {
        let (_directory, _page, router) = page().await;
        for (host, status) in [
            ("evil.example:8090", StatusCode::FORBIDDEN),
            ("127.0.0.1.evil.example", StatusCode::FORBIDDEN),
            ("localhost:8090", StatusCode::OK),
            ("[::1]:8090", StatusCode::OK),
            ("bridge.local", StatusCode::OK),
            ("10.0.0.4", StatusCode::OK),
        ] {
            let request = Request::get("/api/status").header("host", host);
            let request = request.body(Body::empty()).unwrap();
            let response = router.clone().oneshot(request).await.unwrap();
            assert_eq!(response.status(), status, "{host}");
        }
    }

    #[tokio::test]
    async fn an_alert_is_acknowledged_once_it_is_known_and_only_from_here() {
        let (_directory, page, router) = page().await;
        let at = binnacle_compass::time::Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        let id = Uuid::from_u128(0xa1);
        let record = AlertRecord {
            alert: ShipAlert {
                id,
                revision: 1,
                state: ShipAlertState::Open,
                since: at,
                at,
                gyro_departure_deg: Some(20.0),
                satellite_departure_deg: None,
                limit_deg: 4.0,
                model_version: 1,
            },
            acknowledged: false,
            followed_up: false,
            departed_sectors: 1,
            raised_limit_deg: None,
            clearance_revoked: false,
        };
        page.spool.save_alert(&record).await.unwrap();
        let press = |id: Uuid, guard: &str| {
            Request::post("/api/alert/acknowledge")
                .header("content-type", "application/json")
                .header("host", "192.168.1.9:8090")
                .header("x-binnacle-request", guard)
                .body(Body::from(format!(r#"{{"id":"{id}"}}"#)))
                .unwrap()
        };
        let status = |request: Request| {
            let router = router.clone();
            async move { router.oneshot(request).await.unwrap().status() }
        };
        assert_eq!(status(press(id, "0")).await, StatusCode::FORBIDDEN);
        let other = Uuid::from_u128(2);
        assert_eq!(status(press(other, "1")).await, StatusCode::NOT_FOUND);
        assert!(!page.spool.alert().await.unwrap().unwrap().acknowledged);
        assert_eq!(status(press(id, "1")).await, StatusCode::OK);
        assert!(page.spool.alert().await.unwrap().unwrap().acknowledged);
        assert_eq!(*page.acknowledged.borrow(), Some(id));
    }

    #[tokio::test]
    async fn alerts_that_are_not_sent_ashore_are_acknowledged_too() {
        let (_directory, mut page, _) = page().await;
        let [of_headings, of_gnss] = [0xd1, 0xd2].map(Uuid::from_u128);
        let status = serde_json::json!({
            "heading_difference": {
                "id": of_headings, "is_open": true, "acknowledged": false, "reference": "gyro",
                "difference_deg": 12.0, "limit_deg": 10.0, "says": "they differ", "advice": "",
            },
            "gnss_interference": {
                "id": of_gnss, "acknowledged": false, "since": null,
                "place": { "lat": 36.0, "lon": 15.0 }, "says": "interference", "advice": "",
            },
        });
        let status = Status {
            heading_difference: serde_json::from_value(status["heading_difference"].clone())
                .unwrap(),
            gnss_interference: serde_json::from_value(status["gnss_interference"].clone()).unwrap(),
            ..Status::default()
        };
        page.status = watch::channel(Arc::new(status)).1;
        for id in [of_headings, of_gnss] {
            let request = Request::post("/api/alert/acknowledge")
                .header("content-type", "application/json")
                .header("host", "192.168.1.9:8090")
                .header("x-binnacle-request", "1")
                .body(Body::from(format!(r#"{{"id":"{id}"}}"#)))
                .unwrap();
            let response = reached_from("127.0.0.1", &page)
                .oneshot(request)
                .await
                .unwrap();
            assert_eq!(response.status(), StatusCode::OK);
            assert_eq!(*page.acknowledged.borrow(), Some(id));
        }
    }
}
