//! The audit log: changes, and reads by firms.

use crate::run;
use binnacle_platform::audit::forget;
use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::on_both;
use binnacle_server_testing::program::good;
use binnacle_server_testing::{ApiResponse, Engine, PASSWORD, Person, TestServer, try_sign_in};
use reqwest::Method;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

on_both!(
    each_change_has_an_audit_line,
    a_refused_change_has_an_audit_line_too,
    a_change_without_an_audit_line_fails,
    each_read_by_a_firm_has_an_audit_line,
    a_firms_audit_lines_are_visible_to_the_vessels_operator_alone,
    each_party_sees_its_own_audit_lines_and_a_viewer_none,
    an_agents_enrolment_has_an_audit_line,
    an_accepted_invitation_has_an_audit_line,
    the_audit_log_contains_no_secret,
    the_audit_log_is_searched_paged_and_exported,
    old_audit_lines_are_deleted,
);

const DAY_S: f64 = 86_400.0;

async fn lines(person: &Person, filter: &str) -> Vec<Value> {
    let listed = person.get(&format!("/audit{filter}")).await.good();
    listed["items"].as_array().unwrap().clone()
}

/// Returns the audited requests, in order: method, route, status.
fn requests(lines: &[Value]) -> Vec<String> {
    let problem = |line: &Value| {
        let word = |name: &str| line[name].as_str().unwrap().replace("/api/v1", "");
        format!("{} {} {}", word("method"), word("route"), line["status"])
    };
    lines.iter().rev().map(problem).collect()
}

async fn each_change_has_an_audit_line(server: TestServer) {
    let ada = server.admin("ada").await;
    let made = ada.post("/vessels", &json!({ "name": "Nao" })).await;
    let id = made.good()["id"].clone();
    let path = format!("/vessels/{}", id.as_str().unwrap());
    let named = ada
        .request(Method::PATCH, &path)
        .json(&json!({ "name": "Nao Victoria" }));
    ApiResponse::send(named).await.good();
    ada.get(&path).await.good();
    let found = lines(&ada, "").await;
    assert_eq!(
        requests(&found),
        [
            "POST /session 200",
            "POST /vessels 201",
            "PATCH /vessels/{id} 200"
        ]
    );
    for line in &found {
        assert_eq!(line["actor_name"], "ada@example.com");
        assert_eq!(line["actor_kind"], "user");
        assert_eq!(line["operator_id"], ada.operator.to_string());
        assert_eq!(line["address"], "127.0.0.1");
        assert_eq!(line["at"], binnacle_server_testing::START);
    }
    assert_eq!(found[0]["path"], format!("/api/v1{path}"));
    assert_eq!(found[0]["vessel_id"], id);
    assert_eq!(found[1]["vessel_id"], id);
    let header = made.headers["x-request-id"].to_str().unwrap();
    assert_eq!(found[1]["id"], header);
    server.finish().await;
}

async fn a_refused_change_has_an_audit_line_too(server: TestServer) {
    let ada = server.admin("ada").await;
    let viewer = ada.viewer(&server).await;
    let eve = server.admin("eve").await;
    let vessel = ada.create_vessel("Nao").await;
    let path = format!("/vessels/{}", vessel["id"].as_str().unwrap());
    let change = json!({ "name": "Mine" });
    for (who, expected) in [(&viewer, 403), (&eve, 404)] {
        let refused = ApiResponse::send(who.request(Method::PATCH, &path).json(&change)).await;
        assert_eq!(refused.status, expected);
    }
    let nobody = server.http.patch(format!("{}/api/v1{path}", server.url));
    assert_eq!(ApiResponse::send(nobody.json(&change)).await.status, 401);
    let wrong = try_sign_in(&server, "ada@example.com", "wrong").await;
    assert_eq!(wrong.status, 401);
    let adas = requests(&lines(&ada, "?route=/api/v1/vessels/{id}").await);
    assert_eq!(adas, ["PATCH /vessels/{id} 403"]);
    let eves = requests(&lines(&eve, "?route=/api/v1/vessels/{id}").await);
    assert_eq!(eves, ["PATCH /vessels/{id} 404"]);
    let signed_in = requests(&lines(&ada, "?route=/api/v1/session").await);
    let expected = [
        "POST /session 200",
        "POST /session 200",
        "POST /session 401",
    ];
    assert_eq!(signed_in, expected);
    server.finish().await;
}

async fn a_change_without_an_audit_line_fails(server: TestServer) {
    let ada = server.admin("ada").await;
    server
        .run_sql("ALTER TABLE audit_lines RENAME TO elsewhere")
        .await;
    let failed = ada.post("/vessels", &json!({ "name": "Nao" })).await;
    assert_eq!(failed.problem(), "internal");
    server
        .run_sql("ALTER TABLE elsewhere RENAME TO audit_lines")
        .await;
    assert_eq!(ada.get("/vessels").await.good()["items"], json!([]));
    ada.create_vessel("Nao").await;
    let found = lines(&ada, "?route=/api/v1/vessels").await;
    assert_eq!(requests(&found), ["POST /vessels 201"]);
    server.finish().await;
}

async fn each_read_by_a_firm_has_an_audit_line(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    let rosa = &parties.firms[0].1;
    server
        .run_sql("ALTER TABLE audit_lines RENAME TO elsewhere")
        .await;
    let failed = rosa.get(&parties.path("")).await;
    assert_eq!(failed.problem(), "internal");
    assert_eq!(parties.view_order().await["state"], "offered");
    server
        .run_sql("ALTER TABLE elsewhere RENAME TO audit_lines")
        .await;
    server.finish().await;
}

async fn a_firms_audit_lines_are_visible_to_the_vessels_operator_alone(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    let (firm, rosa) = &parties.firms[0];
    let eve = server.admin("eve").await;
    let (_, other) = eve.adjuster(&server, "other").await;
    let kept = format!(
        "/vessels/{}/compasses/{}/binnacle",
        parties.vessel, parties.compass
    );
    put(&parties.ada, &kept, &binnacle()).await.good();
    rosa.get(&parties.path("/binnacle")).await.good();
    rosa.get(&parties.path("/model")).await.problem();
    parties.post(rosa, "/accept", &json!({})).await.good();
    assert_eq!(
        other.get(&parties.path("/binnacle")).await.problem(),
        "not-found"
    );
    let stolen = parties.post(&other, "/accept", &json!({})).await;
    assert_eq!(stolen.problem(), "not-found");

    let of_order = format!("?order={}", parties.order);
    let theirs: Vec<Value> = lines(&parties.ada, &of_order).await;
    let by_rosa = |line: &&Value| line["actor_name"] == rosa.email.as_str();
    let hers: Vec<Value> = theirs.iter().filter(by_rosa).cloned().collect();
    assert_eq!(
        requests(&hers),
        [
            "GET /work-orders/{id}/binnacle 200",
            "POST /work-orders/{id}/accept 200"
        ]
    );
    for line in &hers {
        assert_eq!(line["firm_id"], firm.to_string());
        assert_eq!(line["vessel_id"], parties.vessel.as_str());
    }
    let first = theirs.last().unwrap();
    assert_eq!(
        first["route"], "/api/v1/work-orders",
        "who ordered it: {first}"
    );
    assert!(lines(rosa, &of_order).await.iter().all(|line| {
        line["firm_id"] == firm.to_string() && line["actor_name"] == rosa.email.as_str()
    }));
    assert_eq!(lines(rosa, &of_order).await.len(), 2);
    assert_eq!(lines(&eve, &of_order).await, Vec::<Value>::new());
    // The other firm sees its own attempt, and nothing about the order's owner.
    let tried = lines(&other, &of_order).await;
    assert_eq!(requests(&tried), ["POST /work-orders/{id}/accept 404"]);
    assert_eq!(tried[0]["vessel_id"], Value::Null);
    assert_eq!(tried[0]["operator_id"], Value::Null);
    assert!(!theirs.iter().any(|line| line["id"] == tried[0]["id"]));
    server.finish().await;
}

async fn each_party_sees_its_own_audit_lines_and_a_viewer_none(server: TestServer) {
    let ada = server.admin("ada").await;
    let viewer = ada.viewer(&server).await;
    let eve = server.admin("eve").await;
    let (firm, rosa) = ada.adjuster(&server, "rosa").await;
    let root = ada.platform_admin(&server).await;
    ada.create_vessel("Nao").await;
    let engage = format!("/operators/{}/firms/{firm}", eve.operator);
    let engaged = ApiResponse::send(root.request(Method::PUT, &engage)).await;
    assert_eq!(engaged.status, 204);
    for path in ["/audit", "/audit.csv"] {
        assert_eq!(viewer.get(path).await.problem(), "forbidden");
    }
    assert_eq!(requests(&lines(&rosa, "").await), ["POST /session 200"]);
    let adas = requests(&lines(&ada, "").await);
    assert_eq!(
        adas,
        [
            "POST /session 200",
            "POST /session 200",
            "POST /vessels 201"
        ]
    );
    let eves = requests(&lines(&eve, "").await);
    assert_eq!(
        eves,
        ["POST /session 200", "PUT /operators/{id}/firms/{firm} 204"]
    );
    assert_eq!(lines(&root, "").await.len(), 7);
    server.finish().await;
}

async fn an_agents_enrolment_has_an_audit_line(server: TestServer) {
    let ada = server.admin("ada").await;
    let ship = server.ship(&ada, "Nao").await;
    ship.put(
        1,
        &binnacle_server_testing::passage("2026-11-20T00:00:00Z", 3),
    )
    .await
    .good();
    let found = lines(&ada, &format!("?vessel={}", ship.id)).await;
    assert_eq!(
        requests(&found),
        [
            "POST /vessels 201",
            "POST /vessels/{id}/agents 201",
            "POST /agents/enrol 200"
        ]
    );
    assert_eq!(found[0]["actor_kind"], "agent");
    assert_eq!(found[0]["actor_name"], "Nao");
    server.finish().await;
}

async fn an_accepted_invitation_has_an_audit_line(server: TestServer) {
    let ada = server.admin("ada").await;
    let bob = json!({ "email": "bob@example.com", "name": "Bob", "role": "viewer" });
    let bob = ada.post("/users", &bob).await.good();
    let code = &bob["invitation"]["code"];
    let taken = json!({ "code": code, "password": "a lantern astern at midnight" });
    let accept = format!("{}/api/v1/invitations/accept", server.url);
    ApiResponse::send(server.http.post(accept).json(&taken))
        .await
        .good();
    let found = lines(&ada, "?route=/api/v1/invitations/accept").await;
    assert_eq!(requests(&found), ["POST /invitations/accept 200"]);
    assert_eq!(found[0]["actor_name"], "Bob");
    assert_eq!(found[0]["actor_id"], bob["user"]["id"]);
    server.finish().await;
}

async fn the_audit_log_contains_no_secret(server: TestServer) {
    let ada = server.admin("ada").await;
    let made = ada
        .post("/tokens", &json!({ "name": "ERP", "scope": "write" }))
        .await
        .good();
    let token = made["token"].as_str().unwrap();
    let vessels = format!("{}/api/v1/vessels", server.url);
    let request = server.http.post(vessels).bearer_auth(token);
    ApiResponse::send(request.json(&json!({ "name": "Nao" })))
        .await
        .good();
    let hook = json!({ "url": "https://example.com/?key=hidden", "kinds": ["alert.raised"] });
    let hook = ada.post("/webhooks", &hook).await.good();
    // A secret in the place of an id.
    let slip = ApiResponse::send(ada.request(Method::DELETE, &format!("/tokens/{token}"))).await;
    assert_eq!(slip.status, 404);
    let changed = json!({ "current": PASSWORD, "new": "a lantern astern at midnight" });
    let changed = ada.request(Method::PUT, "/me/password").json(&changed);
    assert_eq!(ApiResponse::send(changed).await.status, 204);
    let file = ada.get("/audit.csv").await.text;
    assert!(file.contains("/api/v1/tokens/*"), "{file}");
    let by_token = lines(&ada, "?route=/api/v1/vessels").await;
    assert_eq!(by_token[0]["actor_kind"], "token");
    assert_eq!(by_token[0]["token_id"], made["id"]);
    let cookie = ada.cookie.split_once('=').unwrap().1;
    let secret = hook["secret"].as_str().unwrap();
    for hidden in [
        token,
        PASSWORD,
        "a lantern astern",
        "hidden",
        cookie,
        secret,
    ] {
        assert!(!file.contains(hidden), "{hidden} is in {file}");
    }
    server.finish().await;
}

async fn the_audit_log_is_searched_paged_and_exported(server: TestServer) {
    let ada = server.admin("ada").await;
    for name in ["=1+1", "Pinta", "Niña"] {
        server.advance(60.0);
        ada.create_vessel(name).await;
    }
    let first = ada.get("/audit?limit=3").await.good();
    assert_eq!(first["items"].as_array().unwrap().len(), 3);
    let rest = format!("?limit=3&after={}", first["next"].as_str().unwrap());
    let rest = lines(&ada, &rest).await;
    assert_eq!(requests(&rest), ["POST /session 200"]);
    let between = "?from=2026-11-21T07:02:00Z&to=2026-11-21T07:03:00Z";
    assert_eq!(lines(&ada, between).await.len(), 1);
    let me = ada.get("/me").await.good()["user_id"].clone();
    let mine = format!("?actor={}", me.as_str().unwrap());
    assert_eq!(lines(&ada, &mine).await.len(), 4);
    let nobodys = format!("?actor={}", ada.operator);
    assert_eq!(lines(&ada, &nobodys).await.len(), 0);
    assert_eq!(ada.get("/audit?from=noon").await.problem(), "invalid");
    assert_eq!(ada.get("/audit?after=x").await.problem(), "bad-request");
    for of in ["/audit", "/audit.csv"] {
        let none = ada.get(&format!("{of}?route=%00")).await;
        assert_eq!(none.problem(), "invalid", "{of}");
    }
    let file = ada.get("/audit.csv?route=/api/v1/vessels").await;
    assert_eq!(file.headers["content-type"], "text/csv; charset=utf-8");
    assert_eq!(file.text.lines().count(), 4, "{}", file.text);
    assert!(file.text.starts_with("id,at,actor_kind"));
    server.finish().await;
}

async fn old_audit_lines_are_deleted(server: TestServer) {
    let ada = server.admin("ada").await;
    ada.create_vessel("Nao").await;
    server.advance(1094.0 * DAY_S);
    assert_eq!(forget(&server.app).await.unwrap(), 0);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    server.advance(1.5 * DAY_S);
    assert_eq!(forget(&server.app).await.unwrap(), 2);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let left = requests(&lines(&ada, "").await);
    assert_eq!(left, ["POST /session 200", "POST /session 200"]);
    server.finish().await;
}

/// Lists the source files below a folder.
fn source_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(source_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

#[test]
fn every_handler_begins_its_transaction_from_its_request() {
    let mut handlers = 0;
    let server = Path::new(env!("CARGO_MANIFEST_DIR"));
    let crates = [
        "platform/src",
        "fleet/src",
        "orders/src",
        "planning/src",
        "src",
    ];
    for path in crates
        .iter()
        .flat_map(|folder| source_files(&server.join(folder)))
    {
        let text = std::fs::read_to_string(&path).unwrap();
        let found = text.matches("#[utoipa::path(").count();
        handlers += found;
        // Nor does what handlers call beside them in their file.
        let forgets = found > 0 && text.contains("db.begin()");
        assert!(!forgets, "{}", path.display());
    }
    assert!(handlers > 150, "{handlers} handlers were found");
}

#[tokio::test]
async fn changes_by_the_command_line_have_an_audit_line() {
    let server = TestServer::start(Engine::Sqlite).await;
    let ada = server.admin("ada").await;
    let url = server.app.config.database.database_url.clone();
    let folder = tempfile::tempdir().unwrap();
    let email = ada.viewer(&server).await.email;
    let reset = ["admin", "--database-url", &url, "reset-user", "--email"];
    let reset: Vec<&str> = reset.into_iter().chain([email.as_str()]).collect();
    good(&run(folder.path(), &reset));
    let found = lines(&ada, "").await;
    assert_eq!(requests(&found)[2..], [" admin reset-user null"]);
    assert_eq!(found[0]["actor_kind"], "command");
    assert_eq!(found[0]["operator_id"], ada.operator.to_string());
    server.finish().await;
}
