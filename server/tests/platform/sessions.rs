//! Signing in and out, and API tokens.

use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Engine, PASSWORD, Person, TestServer, try_sign_in};
use reqwest::Method;
use serde_json::json;

on_both!(
    a_session_lasts_until_the_user_signs_out,
    a_session_expires,
    an_idle_session_expires_sooner,
    people_see_and_end_their_own_sessions,
    a_new_password_ends_all_other_sessions,
    a_new_password_needs_the_current_one,
    guesses_from_one_address_are_rate_limited_whatever_the_email,
    the_cookie_is_inaccessible_to_scripts_and_other_sites,
    a_change_with_a_cookie_needs_the_dashboards_header,
    guesses_are_rate_limited_whether_or_not_the_email_exists,
    concurrent_guesses_cannot_bypass_the_rate_limit,
    an_invalid_sign_in_is_refused_with_a_problem,
    a_token_has_its_scope_until_revoked,
    a_token_expires,
    a_viewer_can_read_but_not_change,
    a_platform_admin_cannot_read_a_fleet,
);

async fn a_session_lasts_until_the_user_signs_out(server: TestServer) {
    let ada = server.admin("ada").await;
    let me = ada.get("/me").await.good();
    assert_eq!(me["email"], "ada@example.com");
    assert_eq!(me["role"], "admin");
    assert_eq!(me["operator_name"], "ada");
    let gone = ApiResponse::send(ada.request(Method::DELETE, "/session")).await;
    assert_eq!(gone.status, 204);
    assert_eq!(ada.get("/me").await.problem(), "unauthenticated");
    server.finish().await;
}

async fn a_session_expires(server: TestServer) {
    let ada = server.admin("ada").await;
    for _ in 0..3 {
        server.advance(24.0 * 3600.0 - 1.0);
        assert_eq!(ada.get("/me").await.status, 200);
    }
    server.advance(3.0);
    assert_eq!(ada.get("/me").await.status, 401);
    server.finish().await;
}

async fn an_idle_session_expires_sooner(server: TestServer) {
    let ada = server.admin("ada").await;
    server.advance(24.0 * 3600.0);
    assert_eq!(ada.get("/me").await.problem(), "unauthenticated");
    let repeated = Person::sign_in(&server, ada.operator, &ada.email).await;
    let listed = repeated.get("/sessions").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);
    server.finish().await;
}

async fn people_see_and_end_their_own_sessions(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let telephone = Person::sign_in(&server, ada.operator, &ada.email).await;
    let office = Person::sign_in(&server, ada.operator, &ada.email).await;
    server.advance(900.0);
    let listed = ada.get("/sessions").await;
    assert!(!listed.text.contains("token"), "{listed:?}");
    let items = listed.good()["items"].clone();
    assert_eq!(items.as_array().unwrap().len(), 3);
    assert_eq!(items[0]["current"], true);
    assert_eq!(items[0]["address"], "127.0.0.1");
    assert_eq!(items[0]["last_seen_at"], "2026-11-21T07:15:00Z");
    assert_eq!(items[1]["last_seen_at"], "2026-11-21T07:00:00Z");
    let end = |who: &Person, n: usize| {
        let path = format!("/sessions/{}", items[n]["id"].as_str().unwrap());
        ApiResponse::send(who.request(Method::DELETE, &path))
    };
    assert_eq!(end(&eve, 1).await.problem(), "not-found");
    assert_eq!(end(&ada, 1).await.status, 204);
    assert_eq!(telephone.get("/me").await.problem(), "unauthenticated");
    assert_eq!(office.get("/me").await.status, 200);
    let others = ApiResponse::send(office.request(Method::DELETE, "/sessions")).await;
    assert_eq!(others.status, 204);
    assert_eq!(ada.get("/me").await.problem(), "unauthenticated");
    assert_eq!(office.get("/me").await.status, 200);
    assert_eq!(eve.get("/me").await.status, 200);
    server.finish().await;
}

const NEW_PASSWORD: &str = "seven gulls over the quay";

async fn put_password(person: &Person, current: &str, new: &str) -> ApiResponse {
    let body = json!({ "current": current, "new": new });
    ApiResponse::send(person.request(Method::PUT, "/me/password").json(&body)).await
}

async fn a_new_password_ends_all_other_sessions(server: TestServer) {
    let ada = server.admin("ada").await;
    let stolen = Person::sign_in(&server, ada.operator, &ada.email).await;
    assert_eq!(put_password(&ada, PASSWORD, NEW_PASSWORD).await.status, 204);
    assert_eq!(ada.get("/me").await.status, 200);
    assert_eq!(stolen.get("/me").await.problem(), "unauthenticated");
    assert_eq!(try_sign_in(&server, &ada.email, PASSWORD).await.status, 401);
    assert_eq!(
        try_sign_in(&server, &ada.email, NEW_PASSWORD).await.status,
        200
    );
    server.finish().await;
}

async fn a_new_password_needs_the_current_one(server: TestServer) {
    let ada = server.admin("ada").await;
    for weak in ["short", "ada@example.com", "qwertyuiop12"] {
        assert_eq!(
            put_password(&ada, PASSWORD, weak).await.problem(),
            "invalid"
        );
    }
    let same = put_password(&ada, PASSWORD, PASSWORD).await;
    assert_eq!(same.problem(), "invalid");
    assert!(same.text.contains("is your current password"), "{same:?}");
    for _ in 0..5 {
        let wrong = put_password(&ada, "a guess at the desk", NEW_PASSWORD).await;
        assert_eq!(wrong.problem(), "wrong-password");
    }
    let slowed = put_password(&ada, PASSWORD, NEW_PASSWORD).await;
    assert_eq!(slowed.problem(), "throttled");
    let made = json!({ "name": "ERP", "scope": "write" });
    let made = ada.post("/tokens", &made).await.good();
    let request = server
        .http
        .put(format!("{}/api/v1/me/password", server.url));
    let request = request.json(&json!({ "current": PASSWORD, "new": NEW_PASSWORD }));
    let by_token = ApiResponse::send(request.bearer_auth(made["token"].as_str().unwrap())).await;
    assert_eq!(by_token.problem(), "forbidden");
    server.finish().await;
}

async fn guesses_from_one_address_are_rate_limited_whatever_the_email(server: TestServer) {
    server.admin("ada").await;
    for guess in 0..50 {
        let email = format!("nobody-{guess}@example.com");
        let wrong = try_sign_in(&server, &email, "a guess").await;
        assert_eq!(wrong.problem(), "wrong-password", "{guess}");
    }
    let slowed = try_sign_in(&server, "ada@example.com", PASSWORD).await;
    assert_eq!(slowed.problem(), "throttled");
    server.advance(1.0);
    let right = try_sign_in(&server, "ada@example.com", PASSWORD).await;
    assert_eq!(right.status, 200);
    server.finish().await;
}

#[tokio::test]
async fn behind_trusted_proxies_the_clients_address_counts() {
    let server = TestServer::start_with(Engine::Sqlite, &["--proxies", "1"]).await;
    let ada = server.admin("ada").await;
    let body = json!({ "email": ada.email, "password": PASSWORD });
    let request = server.http.post(format!("{}/api/v1/session", server.url));
    let request = request.header("x-forwarded-for", "203.0.113.9, 198.51.100.7");
    assert_eq!(ApiResponse::send(request.json(&body)).await.status, 200);
    let listed = ada.get("/sessions").await.good();
    assert_eq!(listed["items"][1]["address"], "198.51.100.7");
    server.finish().await;
}

#[tokio::test]
async fn over_https_the_cookie_has_the_host_prefix() {
    let server = TestServer::start_with(Engine::Sqlite, &["--secure-cookies"]).await;
    let ada = server.admin("ada").await;
    let response = try_sign_in(&server, &ada.email, PASSWORD).await;
    let cookie = response.headers["set-cookie"].to_str().unwrap();
    let (pair, attributes) = cookie.split_once("; ").unwrap();
    let token = pair.strip_prefix("__Host-binnacle_session=").unwrap();
    assert_eq!(
        attributes,
        "Path=/; HttpOnly; SameSite=Strict; Max-Age=259200; Secure"
    );
    let planted = server.http.get(format!("{}/api/v1/me", server.url));
    let planted = planted.header("cookie", format!("binnacle_session={token}"));
    assert_eq!(
        ApiResponse::send(planted).await.problem(),
        "unauthenticated"
    );
    assert_eq!(ada.get("/me").await.status, 200);
    server.finish().await;
}

async fn the_cookie_is_inaccessible_to_scripts_and_other_sites(server: TestServer) {
    server.admin("ada").await;
    let response = try_sign_in(&server, "ADA@example.com ", PASSWORD).await;
    let cookie = response.headers["set-cookie"].to_str().unwrap();
    assert!(
        cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"),
        "{cookie}"
    );
    server.finish().await;
}

async fn a_change_with_a_cookie_needs_the_dashboards_header(server: TestServer) {
    let ada = server.admin("ada").await;
    let forged = server
        .http
        .post(format!("{}/api/v1/vessels", server.url))
        .header("cookie", &ada.cookie)
        .json(&json!({ "name": "Forged" }));
    assert_eq!(ApiResponse::send(forged).await.problem(), "forbidden");
    assert_eq!(ada.get("/vessels").await.good()["items"], json!([]));
    server.finish().await;
}

async fn guesses_are_rate_limited_whether_or_not_the_email_exists(server: TestServer) {
    server.admin("ada").await;
    for email in ["ada@example.com", "nobody@example.com"] {
        for _ in 0..5 {
            let wrong = try_sign_in(&server, email, "wrong").await;
            assert_eq!(wrong.problem(), "wrong-password");
        }
        let slowed = try_sign_in(&server, email, PASSWORD).await;
        assert_eq!(slowed.problem(), "throttled");
        assert_eq!(slowed.headers["retry-after"], "1");
    }
    server.advance(1.0);
    assert_eq!(
        try_sign_in(&server, "ada@example.com", PASSWORD)
            .await
            .status,
        200
    );
    // A sign-in resets the count of failures.
    assert_eq!(
        try_sign_in(&server, "ada@example.com", "wrong")
            .await
            .status,
        401
    );
    assert_eq!(
        try_sign_in(&server, "ada@example.com", PASSWORD)
            .await
            .status,
        200
    );
    server.finish().await;
}

async fn concurrent_guesses_cannot_bypass_the_rate_limit(server: TestServer) {
    let guesses = (0..30).map(|_| try_sign_in(&server, "ada@example.com", "wrong"));
    let responses = futures_util::future::join_all(guesses).await;
    let judged = responses
        .iter()
        .filter(|response| response.status == 401)
        .count();
    // The fifth failure starts the wait; one more may have been in flight.
    assert!((5..=6).contains(&judged), "{judged} guesses were judged");
    let odd = try_sign_in(&server, "ada\0@example.com", "wrong").await;
    assert_eq!(odd.problem(), "wrong-password");
    server.finish().await;
}

async fn an_invalid_sign_in_is_refused_with_a_problem(server: TestServer) {
    let url = format!("{}/api/v1/session", server.url);
    let json = |body: &'static str| {
        server
            .http
            .post(&url)
            .header("content-type", "application/json")
            .body(body)
    };
    let cases = [
        (json("{"), "bad-request"),
        (json("{\"email\": 1, \"password\": \"x\"}"), "invalid"),
        (json("{\"email\": \"a@b.example\"}"), "invalid"),
        (
            server.http.post(&url).body("email=a"),
            "unsupported-media-type",
        ),
        (json("").body(vec![b' '; 70_000]), "too-large"),
    ];
    for (request, problem) in cases {
        assert_eq!(ApiResponse::send(request).await.problem(), problem);
    }
    server.finish().await;
}

async fn a_token_has_its_scope_until_revoked(server: TestServer) {
    let ada = server.admin("ada").await;
    for (scope, status) in [("read", 403), ("write", 201)] {
        let made = ada
            .post("/tokens", &json!({ "name": "ERP", "scope": scope }))
            .await
            .good();
        let secret = made["token"].as_str().unwrap();
        let ask = |method, path: &str| {
            server
                .http
                .request(method, format!("{}/api/v1{path}", server.url))
                .bearer_auth(secret)
        };
        let listed = ApiResponse::send(ask(Method::GET, "/vessels")).await;
        assert_eq!(listed.status, 200);
        let created = ask(Method::POST, "/vessels").json(&json!({ "name": "Nao" }));
        assert_eq!(ApiResponse::send(created).await.status, status, "{scope}");
        // A leaked token cannot end people's sessions.
        let sessions = ApiResponse::send(ask(Method::DELETE, "/sessions")).await;
        assert_eq!(sessions.problem(), "forbidden");
        // It cannot create tokens that outlive it.
        let more = ask(Method::POST, "/tokens").json(&json!({ "name": "x", "scope": "read" }));
        assert_eq!(ApiResponse::send(more).await.status, 403);

        let path = format!("/tokens/{}", made["id"].as_str().unwrap());
        let revoked = ApiResponse::send(ada.request(Method::DELETE, &path)).await;
        assert_eq!(revoked.status, 204);
        assert_eq!(
            ApiResponse::send(ask(Method::GET, "/vessels")).await.status,
            401
        );
        assert_eq!(
            ApiResponse::send(ada.request(Method::DELETE, &path))
                .await
                .status,
            404
        );
    }
    server.finish().await;
}

async fn a_token_expires(server: TestServer) {
    let ada = server.admin("ada").await;
    let new_token = json!({ "name": "ERP", "scope": "read", "expires_at": "2026-11-21T08:00:00Z" });
    let made = ada.post("/tokens", &new_token).await.good();
    let ask = || {
        let request = server.http.get(format!("{}/api/v1/me", server.url));
        ApiResponse::send(request.bearer_auth(made["token"].as_str().unwrap()))
    };
    assert_eq!(ask().await.status, 200);
    let listed = ada.get("/tokens").await.good();
    assert_eq!(listed["items"][0]["last_used_at"], "2026-11-21T07:00:00Z");
    assert!(listed["items"][0].get("token").is_none());
    server.advance(3600.0);
    assert_eq!(ask().await.status, 401);
    let over = ada.post("/tokens", &new_token).await;
    assert_eq!(over.problem(), "invalid");
    server.finish().await;
}

async fn a_viewer_can_read_but_not_change(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let viewer = ada.viewer(&server).await;
    let path = format!("/vessels/{}", vessel["id"].as_str().unwrap());
    assert_eq!(viewer.get(&path).await.status, 200);
    let refused = [
        viewer.post("/vessels", &json!({ "name": "Other" })).await,
        viewer.post(&format!("{path}/agents"), &json!({})).await,
        viewer
            .post(
                &format!("{path}/compasses"),
                &json!({ "name": "x", "role": "steering" }),
            )
            .await,
    ];
    for response in refused {
        assert_eq!(response.problem(), "forbidden");
    }
    server.finish().await;
}

async fn a_platform_admin_cannot_read_a_fleet(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    assert_eq!(root.get("/me").await.good()["operator_id"], json!(null));
    assert_eq!(root.get("/vessels").await.problem(), "forbidden");
    server.finish().await;
}
