//! Quotas: shown, set by a platform admin, and held.

use binnacle_compass::time::Timestamp;
use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::port_calls::{call, path};
use binnacle_server_testing::{ApiResponse, DAY_S, Engine, Person, TestServer, on_both, passage};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    what_is_beyond_a_quota_is_refused_with_its_limit,
    a_message_beyond_the_orders_log_is_refused,
    a_token_is_listed_with_what_it_made_and_takes_it_along,
    a_token_lives_a_year_at_most,
);

async fn set(root: &Person, owner: &Person, name: &str, most: Value) -> u16 {
    let path = format!("/operators/{}/quotas/{name}", owner.operator);
    let request = root
        .request(Method::PUT, &path)
        .json(&json!({ "most": most }));
    ApiResponse::send(request).await.status
}

/// Returns what there is of a thing, and what there may be.
async fn quota(who: &Person, name: &str) -> (i64, i64) {
    let listed = who.get("/quotas").await.good();
    let mut items = listed["items"].as_array().unwrap().iter();
    let found = items.find(|item| item["name"] == name).unwrap();
    (
        found["used"].as_i64().unwrap(),
        found["most"].as_i64().unwrap(),
    )
}

async fn what_is_beyond_a_quota_is_refused_with_its_limit(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let root = ada.platform_admin(&server).await;
    let vessel = ada.create_vessel("Nao").await;
    let hook = json!({ "url": "https://example.com/hook", "kinds": ["alert.raised"] });
    let calls = path(&vessel);
    let user =
        |n: u32| json!({ "email": format!("{n}@example.com"), "name": "N", "role": "viewer" });
    for (name, path, one, another) in [
        ("webhooks", "/webhooks", hook.clone(), hook.clone()),
        (
            "calendar_feeds",
            "/calendar-feeds",
            json!({ "name": "A" }),
            json!({ "name": "B" }),
        ),
        (
            "port_calls",
            calls.as_str(),
            call("NLRTM", 8),
            call("DEHAM", 20),
        ),
        (
            "api_tokens",
            "/tokens",
            json!({ "name": "A", "scope": "read" }),
            json!({ "name": "B", "scope": "read" }),
        ),
        ("users", "/users", user(1), user(2)),
        (
            "firms",
            "/firms",
            json!({ "name": "A" }),
            json!({ "name": "B" }),
        ),
    ] {
        let (used, by_default) = quota(&ada, name).await;
        assert!(by_default > used, "{name}");
        assert_eq!(set(&root, &ada, name, json!(used + 1)).await, 204);
        assert_eq!(ada.post(path, &one).await.status, 201, "{name}");
        assert_eq!(quota(&ada, name).await, (used + 1, used + 1));
        let refused = ada.post(path, &another).await;
        assert_eq!(refused.problem(), "quota-exceeded", "{name}");
        let problem = refused.json();
        assert_eq!((refused.status, &problem["quota"]), (409, &json!(name)));
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains(&format!(" is {}", used + 1)), "{detail}");
        // Another operator's limit is its own, and the one by default comes back.
        assert_eq!(quota(&eve, name).await.1, by_default);
        assert_eq!(set(&root, &ada, name, json!(null)).await, 204);
        assert_eq!(ada.post(path, &another).await.status, 201, "{name}");
    }
    for (who, name, most, status) in [
        (&ada, "users", json!(5), 403),
        (&root, "ships", json!(5), 404),
        (&root, "users", json!(-1), 422),
        (&root, "users", json!("many"), 422),
    ] {
        assert_eq!(set(who, &ada, name, most).await, status, "{name}");
    }
    server.finish().await;
}

async fn a_message_beyond_the_orders_log_is_refused(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    let ada = &parties.ada;
    let root = ada.platform_admin(&server).await;
    let message = json!({ "text": "At the pilot station." });
    assert_eq!(parties.post(ada, "/messages", &message).await.status, 204);
    let (entries, _) = quota(ada, "order_log").await;
    assert_eq!(set(&root, ada, "order_log", json!(entries)).await, 204);
    let refused = parties.post(ada, "/messages", &message).await;
    assert_eq!(refused.problem(), "quota-exceeded");
    assert_eq!(quota(ada, "order_log").await, (entries, entries));
    server.finish().await;
}

async fn a_token_is_listed_with_what_it_made_and_takes_it_along(server: TestServer) {
    let ada = server.admin("ada").await;
    let token = json!({ "name": "ERP", "scope": "write" });
    let token = ada.post("/tokens", &token).await.good();
    let by_token = async |path: &str, body: Value| {
        let request = server.http.post(format!("{}/api/v1{path}", server.url));
        let request = request.bearer_auth(token["token"].as_str().unwrap());
        ApiResponse::send(request.json(&body)).await.good()["id"].clone()
    };
    let hook = json!({ "url": "https://example.com/hook", "kinds": ["alert.raised"] });
    let made = [
        ("webhook", by_token("/webhooks", hook.clone()).await),
        (
            "mail_recipient",
            by_token("/mail-recipients", json!({ "address": "a@example.com" })).await,
        ),
        (
            "calendar_feed",
            by_token("/calendar-feeds", json!({ "name": "A" })).await,
        ),
    ];
    let own = ada.post("/webhooks", &hook).await.good()["id"].clone();
    let listed = ada.get("/tokens").await.good()["items"][0]["made"].clone();
    for (kind, id) in &made {
        let is_this = |item: &&Value| item["kind"] == *kind && item["id"] == *id;
        assert!(
            listed.as_array().unwrap().iter().any(|item| is_this(&item)),
            "{listed}"
        );
    }
    assert_eq!(listed.as_array().unwrap().len(), made.len(), "{listed}");
    let audited = ada
        .get(&format!("/audit?token={}", token["id"].as_str().unwrap()))
        .await;
    assert_eq!(
        audited.good()["items"].as_array().unwrap().len(),
        made.len()
    );
    let path = format!("/tokens/{}?with_made=true", token["id"].as_str().unwrap());
    // Whoever has the token cannot have what it made removed.
    let request = server.http.delete(format!("{}/api/v1{path}", server.url));
    let request = request.bearer_auth(token["token"].as_str().unwrap());
    assert_eq!(ApiResponse::send(request).await.problem(), "forbidden");
    let revoked = ApiResponse::send(ada.request(Method::DELETE, &path)).await;
    assert_eq!(revoked.status, 204);
    let left = ada.get("/webhooks").await.good();
    assert_eq!(left["items"].as_array().unwrap().len(), 1);
    assert_eq!(left["items"][0]["id"], own);
    for path in ["/mail-recipients", "/calendar-feeds", "/tokens"] {
        assert_eq!(ada.get(path).await.good()["items"], json!([]), "{path}");
    }
    server.finish().await;
}

async fn a_token_lives_a_year_at_most(server: TestServer) {
    let ada = server.admin("ada").await;
    let make = async |expires_at: &str| {
        let new = json!({ "name": "ERP", "scope": "read", "expires_at": expires_at });
        ada.post("/tokens", &new).await
    };
    assert_eq!(make("2027-11-22T07:00:00Z").await.status, 201);
    let refused = make("2027-11-22T07:00:01Z").await;
    assert_eq!(refused.problem(), "invalid");
    assert_eq!(refused.json()["errors"][0]["pointer"], "/expires_at");
    server.finish().await;
}

#[tokio::test]
async fn a_token_lives_as_long_as_the_server_lets_it_by_default() {
    let server = TestServer::start_with(Engine::Sqlite, &["--token-days", "30"]).await;
    let ada = server.admin("ada").await;
    let new = json!({ "name": "ERP", "scope": "read" });
    let made = ada.post("/tokens", &new).await.good();
    let expires_at: Timestamp = Timestamp::parse(made["expires_at"].as_str().unwrap()).unwrap();
    let lives_s = expires_at.seconds_since(server.app.clock.now());
    assert!((lives_s - 30.0 * DAY_S).abs() < 1.0, "{lives_s}");
    server.finish().await;
}

#[tokio::test]
async fn uploads_beyond_those_of_a_day_wait_for_the_next() {
    let few = ["--uploads-per-day", "3"];
    let server = TestServer::start_with(Engine::Sqlite, &few).await;
    let ada = server.admin("ada").await;
    let ship = server.ship(&ada, "Nao").await;
    let samples = passage("2026-11-15T00:00:00Z", 4);
    for seq in 1..=3 {
        ship.put(seq, &samples[..1]).await.good();
    }
    let refused = ship.put(4, &samples[..1]).await;
    assert_eq!(refused.problem(), "too-many-uploads");
    let wait_s: f64 = refused.headers["retry-after"]
        .to_str()
        .unwrap()
        .parse()
        .unwrap();
    server.advance(wait_s);
    ship.put(4, &samples[..1]).await.good();
    server.finish().await;
}
