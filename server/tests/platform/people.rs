//! An operator's people: invited, changed, blocked, removed.

use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, PASSWORD, Person, TestServer, try_sign_in};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    an_invited_person_sets_a_password_and_signs_in,
    a_code_works_once_and_for_a_week,
    a_weak_password_is_refused_and_the_code_stays_valid,
    an_e_mail_address_has_one_account,
    blocking_a_person_ends_access_at_once,
    a_person_with_a_forgotten_password_gets_a_new_code,
    a_removed_persons_tokens_are_revoked,
    an_operator_keeps_at_least_one_admin,
    two_admins_cannot_remove_each_other,
    another_operators_people_are_not_found,
    an_admins_token_cannot_manage_people,
    a_new_code_ends_tokens_and_calendars,
    a_calendar_ends_with_its_creator,
);

const STRONG_PASSWORD: &str = "seven gulls over the quay";

async fn invite(admin: &Person, email: &str, role: &str) -> Value {
    let new = json!({ "email": email, "name": "Grace Hopper", "role": role });
    let response = admin.post("/users", &new).await;
    assert_eq!(response.status, 201, "{response:?}");
    response.json()
}

async fn accept(server: &TestServer, code: &str, password: &str) -> ApiResponse {
    let url = format!("{}/api/v1/invitations/accept", server.url);
    let body = json!({ "code": code, "password": password });
    ApiResponse::send(server.http.post(url).json(&body)).await
}

async fn change(admin: &Person, id: &Value, body: Value) -> ApiResponse {
    let path = format!("/users/{}", id.as_str().unwrap());
    ApiResponse::send(admin.request(Method::PATCH, &path).json(&body)).await
}

async fn remove(admin: &Person, id: &Value) -> ApiResponse {
    let path = format!("/users/{}", id.as_str().unwrap());
    ApiResponse::send(admin.request(Method::DELETE, &path)).await
}

async fn an_invited_person_sets_a_password_and_signs_in(server: TestServer) {
    let ada = server.admin("ada").await;
    let invited = invite(&ada, " Grace@Example.com ", "viewer").await;
    let code = invited["invitation"]["code"].as_str().unwrap();
    let link = format!("https://binnacle.example/invitation#{code}");
    assert_eq!(invited["invitation"]["link"], link.as_str());
    assert_eq!(invited["user"]["state"], "invited");
    assert_eq!(invited["user"]["email"], "grace@example.com");
    // Not even with the empty password that is stored.
    for guess in ["", code] {
        let early = try_sign_in(&server, "grace@example.com", guess).await;
        assert_eq!(early.problem(), "wrong-password");
    }
    let accepted = accept(&server, &code.to_lowercase(), STRONG_PASSWORD)
        .await
        .good();
    assert_eq!(accepted["email"], "grace@example.com");
    let signed_in = try_sign_in(&server, "grace@example.com", STRONG_PASSWORD).await;
    assert_eq!(signed_in.good()["role"], "viewer");
    let listed = ada.get("/users").await.good();
    assert_eq!(listed["items"][1]["state"], "active");
    assert_eq!(listed["items"][1]["invitation_expires_at"], json!(null));
    assert_eq!(listed["items"][0]["last_seen_at"], "2026-11-21T07:00:00Z");
    assert!(!ada.get("/users").await.text.contains("argon2"));
    server.finish().await;
}

async fn a_code_works_once_and_for_a_week(server: TestServer) {
    let ada = server.admin("ada").await;
    let invited = invite(&ada, "grace@example.com", "viewer").await;
    let code = invited["invitation"]["code"].as_str().unwrap().to_owned();
    accept(&server, &code, STRONG_PASSWORD).await.good();
    let repeated = accept(&server, &code, "another good long one").await;
    assert_eq!(repeated.problem(), "not-found");
    let wrong = accept(&server, "AAAA-AAAA-AAAA-AAAA", STRONG_PASSWORD).await;
    assert_eq!(wrong.problem(), "not-found");
    let other = invite(&ada, "mary@example.com", "viewer").await;
    server.advance(7.0 * 86_400.0);
    let late = accept(
        &server,
        other["invitation"]["code"].as_str().unwrap(),
        STRONG_PASSWORD,
    )
    .await;
    assert_eq!(late.problem(), "gone");
    server.finish().await;
}

async fn a_weak_password_is_refused_and_the_code_stays_valid(server: TestServer) {
    let ada = server.admin("ada").await;
    let invited = invite(&ada, "grace@example.com", "viewer").await;
    let code = invited["invitation"]["code"].as_str().unwrap();
    for weak in [
        "short",
        "password1234",
        "grace@example.com",
        "GraceHopper12",
    ] {
        let refused = accept(&server, code, weak).await;
        assert_eq!(refused.problem(), "invalid", "{weak}");
        assert!(
            refused.json()["detail"]
                .as_str()
                .unwrap()
                .starts_with("password: ")
        );
    }
    accept(&server, code, STRONG_PASSWORD).await.good();
    server.finish().await;
}

async fn an_e_mail_address_has_one_account(server: TestServer) {
    let ada = server.admin("ada").await;
    let new = json!({ "email": "ADA@example.com", "name": "Ada", "role": "viewer" });
    assert_eq!(ada.post("/users", &new).await.problem(), "wrong-state");
    for bad in ["", "ada", "a b@example.com", "=x|y", "ada@exämple.com"] {
        let new = json!({ "email": bad, "name": "Ada", "role": "viewer" });
        assert_eq!(ada.post("/users", &new).await.problem(), "invalid", "{bad}");
    }
    let root = json!({ "email": "r@example.com", "name": "R", "role": "platform_admin" });
    assert_eq!(ada.post("/users", &root).await.problem(), "invalid");
    server.finish().await;
}

async fn blocking_a_person_ends_access_at_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let viewer = ada.viewer(&server).await;
    let token = json!({ "name": "ERP", "scope": "read" });
    let token = viewer.post("/tokens", &token).await.good()["token"].clone();
    let by_token = || {
        let request = server.http.get(format!("{}/api/v1/vessels", server.url));
        ApiResponse::send(request.bearer_auth(token.as_str().unwrap()))
    };
    assert_eq!(by_token().await.status, 200);
    let id = viewer.get("/me").await.good()["user_id"].clone();
    let disabled = change(&ada, &id, json!({ "disabled": true })).await.good();
    assert_eq!(disabled["state"], "disabled");
    assert_eq!(viewer.get("/me").await.problem(), "unauthenticated");
    assert_eq!(by_token().await.problem(), "unauthenticated");
    let refused = try_sign_in(&server, &viewer.email, PASSWORD).await;
    assert_eq!(refused.problem(), "wrong-password");
    let path = format!("/users/{}/invitation", id.as_str().unwrap());
    assert_eq!(ada.post(&path, &json!({})).await.problem(), "wrong-state");

    change(&ada, &id, json!({ "disabled": false })).await.good();
    assert_eq!(
        try_sign_in(&server, &viewer.email, PASSWORD).await.status,
        200
    );
    server.finish().await;
}

async fn a_person_with_a_forgotten_password_gets_a_new_code(server: TestServer) {
    let ada = server.admin("ada").await;
    let viewer = ada.viewer(&server).await;
    let id = viewer.get("/me").await.good()["user_id"].clone();
    let path = format!("/users/{}/invitation", id.as_str().unwrap());
    let first = ada.post(&path, &json!({})).await.good();
    let second = ada.post(&path, &json!({})).await.good();
    // Nothing changes until the code is used.
    assert_eq!(viewer.get("/me").await.status, 200);
    let old = accept(&server, first["code"].as_str().unwrap(), STRONG_PASSWORD).await;
    assert_eq!(old.problem(), "not-found");
    accept(&server, second["code"].as_str().unwrap(), STRONG_PASSWORD)
        .await
        .good();
    assert_eq!(viewer.get("/me").await.problem(), "unauthenticated");
    let before = try_sign_in(&server, &viewer.email, PASSWORD).await;
    assert_eq!(before.problem(), "wrong-password");
    assert_eq!(
        try_sign_in(&server, &viewer.email, STRONG_PASSWORD)
            .await
            .status,
        200
    );
    server.finish().await;
}

async fn a_removed_persons_tokens_are_revoked(server: TestServer) {
    let ada = server.admin("ada").await;
    let viewer = ada.viewer(&server).await;
    let token = json!({ "name": "ERP", "scope": "read" });
    let made = viewer.post("/tokens", &token).await.good();
    let id = viewer.get("/me").await.good()["user_id"].clone();
    assert_eq!(remove(&viewer, &id).await.problem(), "forbidden");
    assert_eq!(remove(&ada, &id).await.status, 204);
    assert_eq!(remove(&ada, &id).await.problem(), "not-found");
    assert_eq!(viewer.get("/me").await.problem(), "unauthenticated");
    let request = server.http.get(format!("{}/api/v1/me", server.url));
    let by_token = ApiResponse::send(request.bearer_auth(made["token"].as_str().unwrap())).await;
    assert_eq!(by_token.problem(), "unauthenticated");
    // The e-mail address is free again.
    invite(&ada, &viewer.email, "viewer").await;
    server.finish().await;
}

async fn an_operator_keeps_at_least_one_admin(server: TestServer) {
    let ada = server.admin("ada").await;
    let id = ada.get("/me").await.good()["user_id"].clone();
    // An invited admin does not count as the last admin.
    invite(&ada, "grace@example.com", "admin").await;
    for body in [json!({ "role": "viewer" }), json!({ "disabled": true })] {
        let refused = change(&ada, &id, body).await;
        assert_eq!(refused.problem(), "wrong-state");
    }
    assert_eq!(remove(&ada, &id).await.problem(), "wrong-state");
    assert_eq!(ada.get("/me").await.good()["role"], "admin");

    let viewer = ada.viewer(&server).await;
    let other = viewer.get("/me").await.good()["user_id"].clone();
    change(&ada, &other, json!({ "role": "admin" }))
        .await
        .good();
    let named = json!({ "role": "viewer", "name": "Ada, retired" });
    assert_eq!(
        change(&ada, &id, named).await.good()["name"],
        "Ada, retired"
    );
    assert_eq!(ada.get("/users").await.problem(), "forbidden");
    assert_eq!(viewer.get("/users").await.status, 200);
    server.finish().await;
}

async fn two_admins_cannot_remove_each_other(server: TestServer) {
    let ada = server.admin("ada").await;
    let grace = ada.viewer(&server).await;
    let ids = [
        ada.get("/me").await.good()["user_id"].clone(),
        grace.get("/me").await.good()["user_id"].clone(),
    ];
    change(&ada, &ids[1], json!({ "role": "admin" }))
        .await
        .good();
    let (one, other) = tokio::join!(remove(&ada, &ids[1]), remove(&grace, &ids[0]));
    let gone = [&one, &other]
        .iter()
        .filter(|response| response.status == 204)
        .count();
    assert_eq!(gone, 1, "{one:?} {other:?}");
    server.finish().await;
}

async fn another_operators_people_are_not_found(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let id = ada.get("/me").await.good()["user_id"].clone();
    let listed = eve.get("/users").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);
    let path = format!("/users/{}/invitation", id.as_str().unwrap());
    let responses = [
        change(&eve, &id, json!({ "disabled": true })).await,
        remove(&eve, &id).await,
        eve.post(&path, &json!({})).await,
    ];
    for response in responses {
        assert_eq!(response.problem(), "not-found");
    }
    assert_eq!(ada.get("/me").await.status, 200);
    server.finish().await;
}

/// A program that sends requests with a token.
struct Program {
    http: reqwest::Client,
    url: String,
    token: String,
}

impl Program {
    async fn with_token(server: &TestServer, person: &Person) -> Program {
        let new = json!({ "name": "ERP", "scope": "write" });
        let made = person.post("/tokens", &new).await.good();
        Program {
            http: server.http.clone(),
            url: format!("{}/api/v1", server.url),
            token: made["token"].as_str().unwrap().to_owned(),
        }
    }

    async fn send(&self, method: Method, path: &str, body: &Value) -> ApiResponse {
        let request = self.http.request(method, format!("{}{path}", self.url));
        ApiResponse::send(request.bearer_auth(&self.token).json(body)).await
    }
}

async fn an_admins_token_cannot_manage_people(server: TestServer) {
    let ada = server.admin("ada").await;
    let viewer = ada.viewer(&server).await;
    let other = viewer.get("/me").await.good()["user_id"].clone();
    let other = other.as_str().unwrap();
    let own = ada.get("/me").await.good()["user_id"].clone();
    let program = Program::with_token(&server, &ada).await;
    let new = json!({ "email": "eve@example.com", "name": "Eve", "role": "admin" });
    let tried = [
        (Method::POST, "/users".to_owned(), new),
        (
            Method::POST,
            format!("/users/{other}/invitation"),
            json!({}),
        ),
        (
            Method::POST,
            format!("/users/{}/invitation", own.as_str().unwrap()),
            json!({}),
        ),
        (
            Method::PATCH,
            format!("/users/{other}"),
            json!({ "role": "admin" }),
        ),
        (Method::DELETE, format!("/users/{other}"), json!({})),
        (
            Method::DELETE,
            format!("/users/{other}/second-factor"),
            json!({}),
        ),
        (
            Method::PUT,
            "/sign-in-rules".to_owned(),
            json!({ "second_factor_required": false }),
        ),
    ];
    for (method, path, body) in tried {
        let refused = program.send(method, &path, &body).await;
        assert_eq!(refused.problem(), "forbidden", "{path}");
    }
    // The token may do the work of a program.
    assert_eq!(
        program.send(Method::GET, "/users", &json!({})).await.status,
        200
    );
    let listed = ada.get("/users").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 2);
    server.finish().await;
}

async fn calendar(server: &TestServer, person: &Person) -> String {
    let made = person
        .post("/calendar-feeds", &json!({ "name": "Fleet" }))
        .await
        .good();
    let url = made["url"].as_str().unwrap();
    url.replace("https://binnacle.example", &server.url)
}

async fn a_new_code_ends_tokens_and_calendars(server: TestServer) {
    let ada = server.admin("ada").await;
    let grace = ada.viewer(&server).await;
    let id = grace.get("/me").await.good()["user_id"].clone();
    change(&ada, &id, json!({ "role": "admin" })).await.good();
    let program = Program::with_token(&server, &grace).await;
    let address = calendar(&server, &grace).await;
    let http = server.http.clone();
    let reads = || ApiResponse::send(http.get(&address));
    assert_eq!(reads().await.status, 200);
    let path = format!("/users/{}/invitation", id.as_str().unwrap());
    let code = ada.post(&path, &json!({})).await.good()["code"].clone();
    // Nothing changes until the code is used.
    assert_eq!(
        program.send(Method::GET, "/me", &json!({})).await.status,
        200
    );
    accept(&server, code.as_str().unwrap(), STRONG_PASSWORD)
        .await
        .good();
    let by_token = program.send(Method::GET, "/me", &json!({})).await;
    assert_eq!(by_token.problem(), "unauthenticated");
    assert_eq!(reads().await.problem(), "unauthenticated");
    server.finish().await;
}

async fn a_calendar_ends_with_its_creator(server: TestServer) {
    let ada = server.admin("ada").await;
    let grace = ada.viewer(&server).await;
    let id = grace.get("/me").await.good()["user_id"].clone();
    change(&ada, &id, json!({ "role": "admin" })).await.good();
    let (hers, adas) = (
        calendar(&server, &grace).await,
        calendar(&server, &ada).await,
    );
    let http = server.http.clone();
    let reads = |address: &str| ApiResponse::send(http.get(address));
    change(&ada, &id, json!({ "disabled": true })).await.good();
    assert_eq!(reads(&hers).await.problem(), "unauthenticated");
    change(&ada, &id, json!({ "disabled": false })).await.good();
    assert_eq!(reads(&hers).await.status, 200);
    assert_eq!(remove(&ada, &id).await.status, 204);
    assert_eq!(reads(&hers).await.problem(), "unauthenticated");
    assert_eq!(reads(&adas).await.status, 200);
    server.finish().await;
}
