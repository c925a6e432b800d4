//! A person's notification settings.

use super::put_settings;
use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, TestServer};
use reqwest::Method;
use serde_json::json;

on_both!(
    the_default_settings_apply_until_changed,
    invalid_settings_are_refused,
    a_read_token_cannot_change_settings,
);

async fn the_default_settings_apply_until_changed(server: TestServer) {
    let parties = OfferParties::planned(&server, 1).await;
    let usual = parties.ada.get("/me/notifications").await.good();
    assert_eq!(usual["settings"]["time_zone"], "UTC");
    assert_eq!(usual["settings"]["quiet_hours"], json!(null));
    assert_eq!(usual["ways"]["answered"], "mail");
    assert_eq!(usual["ways"]["due_soon"], "digest");
    assert_eq!(usual["ways"]["alert"], "list");
    assert_eq!(usual["ways"]["offered"], json!(null));
    assert_eq!(
        (&usual["address"], &usual["sending"]),
        (&json!("ada@example.com"), &json!(true))
    );
    assert_eq!(usual["next_digest_at"], "2026-11-22T07:00:00Z");
    let viewer = parties.ada.viewer(&server).await;
    let theirs = viewer.get("/me/notifications").await.good();
    assert_eq!(theirs["ways"]["answered"], "list");
    let firms = parties.firms[0].1.get("/me/notifications").await.good();
    assert_eq!(firms["ways"]["offered"], "mail");
    assert_eq!(firms["ways"]["alert"], json!(null));
    let new_settings = json!({
        "time_zone": "Pacific/Auckland", "ways": { "answered": "off" },
        "quiet_hours": { "from": "20:00", "to": "06:00" },
        "digest": { "every": "week", "on": "friday", "at": "17:30" },
    });
    put_settings(&viewer, &new_settings).await.good();
    let stored = viewer.get("/me/notifications").await.good();
    assert_eq!(stored["settings"], new_settings);
    assert_eq!(stored["ways"]["answered"], "off");
    assert_eq!(stored["next_digest_at"], "2026-11-27T04:30:00Z");
    server.finish().await;
}

async fn invalid_settings_are_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    for bad in [
        json!({ "time_zone": "Europe/Atlantis" }),
        json!({ "quiet_hours": { "from": "25:00", "to": "06:00" } }),
        json!({ "quiet_hours": { "from": "22:00", "to": "22:00" } }),
        json!({ "quiet_hours": { "from": "22:00", "to": "08:00" } }),
        json!({ "digest": { "every": "minute", "at": "07:00" } }),
        json!({ "ways": { "offered": "mail" } }),
        json!({ "ways": { "gossip": "mail" } }),
        json!({ "ways": { "answered": "pigeon" } }),
        json!({ "volume": 11 }),
    ] {
        assert_eq!(put_settings(&ada, &bad).await.problem(), "invalid", "{bad}");
    }
    let usual = ada.get("/me/notifications").await.good();
    assert_eq!(usual["settings"]["time_zone"], "UTC");
    let root = ada.platform_admin(&server).await;
    assert_eq!(root.get("/me/notifications").await.problem(), "forbidden");
    server.finish().await;
}

async fn a_read_token_cannot_change_settings(server: TestServer) {
    let ada = server.admin("ada").await;
    let token = json!({ "name": "ERP", "scope": "read" });
    let token = ada.post("/tokens", &token).await.good()["token"].clone();
    let url = format!("{}/api/v1/me/notifications", server.url);
    for (method, status) in [(Method::GET, 200), (Method::PUT, 403)] {
        let request = server.http.request(method, &url).json(&json!({}));
        let response = ApiResponse::send(request.bearer_auth(token.as_str().unwrap())).await;
        assert_eq!(response.status, status, "{response:?}");
    }
    server.finish().await;
}
