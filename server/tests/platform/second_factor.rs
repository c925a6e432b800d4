//! Codes from an authenticator app: setup, sign-in, single use. And the setting that
//! requires them of everyone.

use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, PASSWORD, Person, TestServer, try_sign_in};
use reqwest::Method;
use ring::hmac;
use serde_json::{Value, json};

on_both!(
    a_confirmed_factor_requires_a_code,
    a_code_works_once_even_when_sent_twice_at_once,
    guessed_codes_are_rate_limited_like_passwords,
    each_recovery_code_signs_in_once,
    a_factor_is_removed_with_the_password_or_by_an_admin,
    an_operator_may_require_a_factor_of_everyone,
    a_token_cannot_change_a_factor,
);

/// Computes the code of an authenticator app (RFC 6238) from the base 32 secret.
pub(crate) fn app_code(secret: &str, unix_s: i64) -> String {
    let digits = secret.bytes().map(|letter| match letter {
        b'A'..=b'Z' => letter - b'A',
        _ => letter - b'2' + 26,
    });
    let bits: Vec<u8> = digits
        .flat_map(|digit| (0..5).rev().map(move |bit| digit >> bit & 1))
        .collect();
    let key: Vec<u8> = bits
        .chunks_exact(8)
        .map(|byte| byte.iter().fold(0, |all, bit| all << 1 | bit))
        .collect();
    let key = hmac::Key::new(hmac::HMAC_SHA1_FOR_LEGACY_USE_ONLY, &key);
    let hash = hmac::sign(&key, &(unix_s / 30).to_be_bytes());
    let at = usize::from(hash.as_ref()[19] & 15);
    let word: [u8; 4] = hash.as_ref()[at..at + 4].try_into().unwrap();
    format!(
        "{:06}",
        (u32::from_be_bytes(word) & 0x7fff_ffff) % 1_000_000
    )
}

pub(crate) fn now_s(server: &TestServer) -> i64 {
    server.app.clock.now().micros() / 1_000_000
}

fn password() -> Value {
    json!({ "password": PASSWORD })
}

/// Sets a factor up; returns its secret and recovery codes. The clock advances, so that
/// the next code differs.
pub(crate) async fn set_up(server: &TestServer, person: &Person) -> (String, Vec<String>) {
    let begun = person.post("/me/second-factor", &password()).await.good();
    let secret = begun["secret"].as_str().unwrap().to_owned();
    assert!(begun["uri"].as_str().unwrap().contains(&secret));
    let code = json!({ "code": app_code(&secret, now_s(server)) });
    let confirmed = person.post("/me/second-factor/confirm", &code).await.good();
    server.advance(60.0);
    let codes = serde_json::from_value(confirmed["recovery_codes"].clone()).unwrap();
    (secret, codes)
}

pub(crate) async fn sign_in(server: &TestServer, email: &str, code: &str) -> ApiResponse {
    let body = json!({ "email": email, "password": PASSWORD, "code": code });
    let url = format!("{}/api/v1/session", server.url);
    ApiResponse::send(server.http.post(url).json(&body)).await
}

async fn a_confirmed_factor_requires_a_code(server: TestServer) {
    let ada = server.admin("ada").await;
    let wrong = json!({ "password": "not the password" });
    let refused = ada.post("/me/second-factor", &wrong).await;
    assert_eq!(refused.problem(), "wrong-password");
    // A setup that was never confirmed locks nobody out.
    ada.post("/me/second-factor", &password()).await.good();
    let none = json!({ "code": "000000" });
    let refused = ada.post("/me/second-factor/confirm", &none).await;
    assert_eq!(refused.problem(), "invalid");
    assert_eq!(try_sign_in(&server, &ada.email, PASSWORD).await.status, 200);

    let other = Person::sign_in(&server, ada.operator, &ada.email).await;
    let (secret, _) = set_up(&server, &ada).await;
    assert_eq!(other.get("/me").await.problem(), "unauthenticated");
    assert_eq!(ada.get("/me").await.good()["second_factor"], true);
    let first_step = try_sign_in(&server, &ada.email, PASSWORD).await;
    assert_eq!(first_step.problem(), "second-factor-needed");
    assert!(first_step.headers.get("set-cookie").is_none());
    assert_eq!(
        try_sign_in(&server, &ada.email, "wrong").await.problem(),
        "wrong-password"
    );
    let code = app_code(&secret, now_s(&server));
    assert_eq!(sign_in(&server, &ada.email, &code).await.status, 200);
    let repeated = ada.post("/me/second-factor", &password()).await;
    assert_eq!(repeated.problem(), "wrong-state");
    server.finish().await;
}

async fn a_code_works_once_even_when_sent_twice_at_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let (secret, _) = set_up(&server, &ada).await;
    let code = app_code(&secret, now_s(&server));
    let tries = (0..4).map(|_| sign_in(&server, &ada.email, &code));
    let responses = futures_util::future::join_all(tries).await;
    let mut statuses: Vec<u16> = responses.iter().map(|response| response.status).collect();
    statuses.sort_unstable();
    assert_eq!(statuses, [200, 401, 401, 401]);
    let seen = responses
        .iter()
        .find(|response| response.status == 401)
        .unwrap();
    assert_eq!(seen.problem(), "wrong-code");
    // Neither does the code before it, which the clock tolerance would accept.
    let before = app_code(&secret, now_s(&server) - 30);
    let late = sign_in(&server, &ada.email, &before).await;
    assert_eq!(late.problem(), "wrong-code");
    server.finish().await;
}

async fn guessed_codes_are_rate_limited_like_passwords(server: TestServer) {
    let ada = server.admin("ada").await;
    let (secret, _) = set_up(&server, &ada).await;
    let right = app_code(&secret, now_s(&server));
    let wrong = if right == "000000" {
        "000001"
    } else {
        "000000"
    };
    for _ in 0..5 {
        let refused = sign_in(&server, &ada.email, wrong).await;
        assert_eq!(refused.problem(), "wrong-code");
    }
    let slowed = sign_in(&server, &ada.email, &right).await;
    assert_eq!(slowed.problem(), "throttled");
    server.advance(1.0);
    assert_eq!(sign_in(&server, &ada.email, &right).await.status, 200);
    server.finish().await;
}

async fn each_recovery_code_signs_in_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let (_, codes) = set_up(&server, &ada).await;
    assert_eq!(codes.len(), 10);
    let typed = codes[0].to_lowercase().replace('-', " ");
    assert_eq!(sign_in(&server, &ada.email, &typed).await.status, 200);
    let repeated = sign_in(&server, &ada.email, &typed).await;
    assert_eq!(repeated.problem(), "wrong-code");
    let path = "/me/second-factor/recovery-codes";
    let renewed = ada.post(path, &password()).await.good();
    let old = sign_in(&server, &ada.email, &codes[1]).await;
    assert_eq!(old.problem(), "wrong-code");
    let new = renewed["recovery_codes"][0].as_str().unwrap();
    assert_eq!(sign_in(&server, &ada.email, new).await.status, 200);
    server.finish().await;
}

async fn a_factor_is_removed_with_the_password_or_by_an_admin(server: TestServer) {
    let ada = server.admin("ada").await;
    let viewer = ada.viewer(&server).await;
    set_up(&server, &ada).await;
    let removed = ada.post("/me/second-factor/remove", &password()).await;
    assert_eq!(removed.status, 204);
    assert_eq!(try_sign_in(&server, &ada.email, PASSWORD).await.status, 200);

    set_up(&server, &viewer).await;
    let id = viewer.get("/me").await.good()["user_id"].clone();
    let path = format!("/users/{}/second-factor", id.as_str().unwrap());
    let theirs = ApiResponse::send(viewer.request(Method::DELETE, &path)).await;
    assert_eq!(theirs.problem(), "forbidden");
    let eve = server.admin("eve").await;
    let foreign = ApiResponse::send(eve.request(Method::DELETE, &path)).await;
    assert_eq!(foreign.problem(), "not-found");
    let reset = ApiResponse::send(ada.request(Method::DELETE, &path)).await;
    assert_eq!(reset.status, 204);
    assert_eq!(
        try_sign_in(&server, &viewer.email, PASSWORD).await.status,
        200
    );
    server.finish().await;
}

async fn an_operator_may_require_a_factor_of_everyone(server: TestServer) {
    let ada = server.admin("ada").await;
    let viewer = ada.viewer(&server).await;
    let token = json!({ "name": "ERP", "scope": "read" });
    let token = viewer.post("/tokens", &token).await.good()["token"].clone();
    let rule = json!({ "second_factor_required": true });
    let put = |person: &Person| {
        ApiResponse::send(person.request(Method::PUT, "/sign-in-rules").json(&rule))
    };
    // Refused while the admin has no factor.
    assert_eq!(put(&ada).await.problem(), "wrong-state");
    set_up(&server, &ada).await;
    assert_eq!(put(&viewer).await.problem(), "forbidden");
    put(&ada).await.good();
    assert_eq!(ada.get("/vessels").await.status, 200);

    for path in ["/vessels", "/firms", "/work-orders"] {
        let refused = viewer.get(path).await;
        assert_eq!(refused.problem(), "second-factor-required", "{path}");
        assert_eq!(refused.status, 403);
    }
    let by_token = server.http.get(format!("{}/api/v1/vessels", server.url));
    let by_token = ApiResponse::send(by_token.bearer_auth(token.as_str().unwrap())).await;
    assert_eq!(by_token.problem(), "second-factor-required");
    let more = json!({ "name": "x", "scope": "read" });
    let more = viewer.post("/tokens", &more).await;
    assert_eq!(more.problem(), "second-factor-required");
    let me = viewer.get("/me").await.good();
    assert_eq!(me["second_factor_required"], true);
    set_up(&server, &viewer).await;
    assert_eq!(viewer.get("/vessels").await.status, 200);
    server.finish().await;
}

async fn a_token_cannot_change_a_factor(server: TestServer) {
    let ada = server.admin("ada").await;
    let token = json!({ "name": "ERP", "scope": "write" });
    let made = ada.post("/tokens", &token).await.good();
    for path in ["", "/remove", "/recovery-codes"] {
        let url = format!("{}/api/v1/me/second-factor{path}", server.url);
        let request = server.http.post(url).json(&password());
        let response =
            ApiResponse::send(request.bearer_auth(made["token"].as_str().unwrap())).await;
        assert_eq!(response.problem(), "forbidden", "{path}");
    }
    server.finish().await;
}
