//! Sign-in through an OpenID Connect provider.

use crate::second_factor::{app_code, now_s, set_up};
use binnacle_platform::audit::RequestContext;
use binnacle_platform::time::Time;
use binnacle_platform::users;
use binnacle_server_testing::{
    ApiResponse, Engine, PASSWORD, Person, Provider, Signer, TestServer, provider_settings,
    try_sign_in,
};
use serde_json::{Value, json};
use tokio::net::TcpListener;

const START: &str = "/api/v1/session/provider/start";
const PUBLIC: &str = "https://binnacle.example";

/// Runs each test on both databases with a provider and an admin, Ada.
macro_rules! with_provider {
    ($($test:ident),* $(,)?) => {
        mod sqlite {
            use super::*;
            $(#[tokio::test] async fn $test() { super::$test(Fixture::new(Engine::Sqlite).await).await; })*
        }
        mod postgres {
            use super::*;
            $(#[tokio::test] async fn $test() { super::$test(Fixture::new(Engine::Postgres).await).await; })*
        }
    };
}

mod refused;

with_provider!(
    a_person_verified_by_the_provider_is_signed_in,
    a_pending_sign_in_is_hidden_from_scripts_and_the_provider,
    a_cancelled_sign_in_returns_to_the_sign_in_page,
    a_person_keeps_the_account_when_the_email_changes,
    people_of_every_operator_sign_in_to_their_own_account,
    a_second_factor_is_required_after_the_provider,
    a_rotated_provider_key_is_fetched,
    an_rsa_signature_of_the_provider_is_accepted,
    a_missing_email_comes_from_the_user_info_endpoint,
    a_provider_sign_in_is_in_the_audit_log,
    a_reset_account_is_linked_to_the_provider_again,
    a_one_time_code_unlinks_the_provider_account,
);

struct Fixture {
    server: TestServer,
    provider: Provider,
    ada: Person,
}

impl Fixture {
    async fn new(engine: Engine) -> Fixture {
        let provider = Provider::start().await;
        let server = TestServer::start_with(engine, &provider.settings()).await;
        let ada = server.admin("ada").await;
        Fixture {
            server,
            provider,
            ada,
        }
    }

    async fn sign_in(&self) -> ApiResponse {
        let (there, cookie) = start_sign_in(&self.server).await;
        let back = callback_address(&self.server, &there).await;
        follow_callback(&self.server, &back, &cookie).await
    }

    /// Signs in through the provider, and returns the account.
    async fn account(&self) -> Value {
        let done = self.sign_in().await;
        assert_eq!(redirect_target(&done), "/");
        let response = with_cookie(&self.server, "/me", &session_cookie(&done).unwrap()).await;
        response.good()
    }
}

async fn get(server: &TestServer, path: &str, cookie: &str) -> ApiResponse {
    let url = format!("{}{path}", server.url);
    ApiResponse::send(server.http.get(url).header("cookie", cookie)).await
}

async fn with_cookie(server: &TestServer, path: &str, cookie: &str) -> ApiResponse {
    get(server, &format!("/api/v1{path}"), cookie).await
}

fn cookies(response: &ApiResponse) -> Vec<String> {
    let all = response.headers.get_all("set-cookie").iter();
    all.map(|cookie| cookie.to_str().unwrap().to_owned())
        .collect()
}

/// Returns the session cookie, if a session was opened.
fn session_cookie(response: &ApiResponse) -> Option<String> {
    let all = cookies(response);
    let found = all
        .iter()
        .find(|cookie| cookie.starts_with("binnacle_session="));
    Some(found?.split(';').next().unwrap().to_owned())
}

/// Returns the redirect target.
fn redirect_target(response: &ApiResponse) -> &str {
    assert_eq!(response.status, 303, "{response:?}");
    response.headers["location"].to_str().unwrap()
}

/// Returns the provider's address, and the cookie that the browser keeps.
async fn start_sign_in(server: &TestServer) -> (String, String) {
    let response = get(server, START, "").await;
    let cookie = cookies(&response)[0].split(';').next().unwrap().to_owned();
    (redirect_target(&response).to_owned(), cookie)
}

/// Follows the address at the provider; returns the callback address.
async fn callback_address(server: &TestServer, address: &str) -> String {
    let response = ApiResponse::send(server.http.get(address)).await;
    let back = redirect_target(&response);
    back.strip_prefix(PUBLIC).unwrap().to_owned()
}

async fn follow_callback(server: &TestServer, back: &str, cookie: &str) -> ApiResponse {
    get(server, back, cookie).await
}

async fn send_code(server: &TestServer, cookie: &str, code: &str) -> ApiResponse {
    let url = format!("{}/api/v1/session/provider/code", server.url);
    let request = server.http.post(url).header("cookie", cookie);
    ApiResponse::send(request.json(&json!({ "code": code }))).await
}

async fn a_person_verified_by_the_provider_is_signed_in(fixture: Fixture) {
    let named = with_cookie(&fixture.server, "/session/provider", "").await;
    assert_eq!(named.good(), json!({ "name": "Example Lines" }));
    let done = fixture.sign_in().await;
    let cookie = session_cookie(&done).unwrap();
    let me = with_cookie(&fixture.server, "/me", &cookie).await.good();
    assert_eq!(me["email"], "ada@example.com");
    let sessions = fixture.ada.get("/sessions").await.good();
    assert_eq!(sessions["items"][0]["provider"], Value::Null);
    assert_eq!(sessions["items"][1]["provider"], "Example Lines");
    let url = format!("{}/api/v1/session", fixture.server.url);
    let out = fixture.server.http.delete(url).header("cookie", &cookie);
    let out = ApiResponse::send(out.header("x-binnacle-request", "1")).await;
    assert_eq!(out.status, 204);
    assert_eq!(
        with_cookie(&fixture.server, "/me", &cookie).await.problem(),
        "unauthenticated"
    );
    fixture.server.finish().await;
}

async fn a_pending_sign_in_is_hidden_from_scripts_and_the_provider(fixture: Fixture) {
    let response = get(&fixture.server, START, "").await;
    let cookie = cookies(&response)[0].clone();
    for part in ["HttpOnly", "SameSite=Lax", "Max-Age=600", "Path=/"] {
        assert!(cookie.contains(part), "{cookie}");
    }
    let kept = cookie.split([';', '=', '.']).nth(2).unwrap();
    assert_eq!(kept.len(), 43);
    let there = redirect_target(&response);
    assert!(there.starts_with(&fixture.provider.issuer));
    assert!(
        !there.contains(kept) && !there.contains("secret"),
        "{there}"
    );
    assert!(there.contains("code_challenge_method=S256"));
    let done = fixture.sign_in().await;
    let all = cookies(&done);
    let session = all
        .iter()
        .find(|cookie| cookie.starts_with("binnacle_session="));
    assert!(session.unwrap().contains("SameSite=Strict"));
    let forgotten = all
        .iter()
        .find(|cookie| cookie.starts_with("binnacle_provider=;"));
    assert!(forgotten.unwrap().contains("Max-Age=0"));
    assert!(done.headers.contains_key("content-security-policy"));
    assert_eq!(done.headers["cache-control"], "no-store");
    fixture.server.finish().await;
}

async fn a_cancelled_sign_in_returns_to_the_sign_in_page(fixture: Fixture) {
    let (there, cookie) = start_sign_in(&fixture.server).await;
    let back = callback_address(&fixture.server, &there).await;
    let (path, query) = back.split_once('?').unwrap();
    let (_, state) = query.split_once("&state=").unwrap();
    let back = format!("{path}?error=access_denied&state={state}");
    let done = follow_callback(&fixture.server, &back, &cookie).await;
    assert_eq!(redirect_target(&done), "/?sign-in=cancelled");
    fixture.server.finish().await;
}

async fn a_person_keeps_the_account_when_the_email_changes(fixture: Fixture) {
    let eve = fixture.server.admin("eve").await;
    assert_eq!(fixture.account().await["email"], "ada@example.com");
    for changed in [
        json!({ "email": "eve@example.com" }),
        json!({ "email": null }),
        json!({ "email": "countess@example.com", "email_verified": false }),
    ] {
        fixture.provider.set_claims(changed);
        assert_eq!(fixture.account().await["email"], "ada@example.com");
    }
    // The address now belongs to someone else.
    fixture.provider.set_claims(json!({ "sub": "person-2" }));
    let done = fixture.sign_in().await;
    assert_eq!(redirect_target(&done), "/?sign-in=taken");
    assert_eq!(session_cookie(&done), None);
    let sessions = eve.get("/sessions").await.good();
    assert_eq!(sessions["items"].as_array().unwrap().len(), 1);
    fixture.server.finish().await;
}

async fn people_of_every_operator_sign_in_to_their_own_account(fixture: Fixture) {
    let server = &fixture.server;
    let eve = server.admin("eve").await;
    let (firm, adjuster) = fixture.ada.adjuster(server, "needle").await;
    let root = fixture.ada.platform_admin(server).await;
    for (person, email) in [&eve, &adjuster, &root].iter().zip(2..) {
        let claims = json!({ "sub": format!("person-{email}"), "email": person.email });
        fixture.provider.set_claims(claims);
        let me = fixture.account().await;
        assert_eq!(me, person.get("/me").await.good());
    }
    fixture
        .provider
        .set_claims(json!({ "sub": "person-3", "email": "ada@example.com" }));
    let me = fixture.account().await;
    assert_eq!(me["firm_id"], json!(firm));
    assert_eq!(me["operator_id"], Value::Null);
    fixture.server.finish().await;
}

async fn a_second_factor_is_required_after_the_provider(fixture: Fixture) {
    let server = &fixture.server;
    let (secret, _) = set_up(server, &fixture.ada).await;
    let (there, cookie) = start_sign_in(server).await;
    let back = callback_address(server, &there).await;
    let early = send_code(server, &cookie, &app_code(&secret, now_s(server))).await;
    assert_eq!(early.problem(), "gone");
    let done = follow_callback(server, &back, &cookie).await;
    assert_eq!(redirect_target(&done), "/?sign-in=code");
    assert_eq!(session_cookie(&done), None);
    let code = app_code(&secret, now_s(server));
    let (_, another) = start_sign_in(server).await;
    for strange in ["", another.as_str()] {
        assert_eq!(send_code(server, strange, &code).await.problem(), "gone");
    }
    let wrong = send_code(server, &cookie, "a guess").await;
    assert_eq!(wrong.problem(), "wrong-code");
    let right = send_code(server, &cookie, &code).await;
    assert_eq!(right.good()["email"], "ada@example.com");
    let me = with_cookie(server, "/me", &session_cookie(&right).unwrap()).await;
    assert_eq!(me.status, 200);
    server.advance(60.0);
    let repeated = send_code(server, &cookie, &app_code(&secret, now_s(server))).await;
    assert_eq!(repeated.problem(), "gone");

    let (there, cookie) = start_sign_in(server).await;
    let back = callback_address(server, &there).await;
    follow_callback(server, &back, &cookie).await;
    server.advance(600.0);
    let late = send_code(server, &cookie, &app_code(&secret, now_s(server))).await;
    assert_eq!(late.problem(), "gone");
    fixture.server.finish().await;
}

async fn a_rotated_provider_key_is_fetched(fixture: Fixture) {
    assert_eq!(redirect_target(&fixture.sign_in().await), "/");
    fixture.provider.rotate_key();
    assert_eq!(
        redirect_target(&fixture.sign_in().await),
        "/?sign-in=untrusted"
    );
    fixture.server.advance(60.0);
    assert_eq!(redirect_target(&fixture.sign_in().await), "/");
    fixture.server.finish().await;
}

async fn an_rsa_signature_of_the_provider_is_accepted(fixture: Fixture) {
    fixture.provider.use_rsa_key();
    assert_eq!(fixture.account().await["email"], "ada@example.com");
    for signer in [Signer::OtherKey, Signer::ClientSecret, Signer::Unsigned] {
        fixture.provider.sign_with(signer);
        assert_eq!(
            redirect_target(&fixture.sign_in().await),
            "/?sign-in=untrusted"
        );
    }
    fixture.provider.sign_with(Signer::Provider);
    fixture.server.advance(60.0);
    fixture.provider.rotate_key();
    assert_eq!(
        redirect_target(&fixture.sign_in().await),
        "/",
        "another RSA key is looked for"
    );
    fixture.server.finish().await;
}

async fn a_missing_email_comes_from_the_user_info_endpoint(fixture: Fixture) {
    fixture
        .provider
        .set_claims(json!({ "email": null, "email_verified": null }));
    let user_info = |subject: &str, verified: bool| json!({ "sub": subject, "email": "ada@example.com", "email_verified": verified });
    fixture.provider.set_user_info(user_info("person-2", true));
    assert_eq!(
        redirect_target(&fixture.sign_in().await),
        "/?sign-in=unverified"
    );
    fixture.provider.set_user_info(user_info("person-1", false));
    assert_eq!(
        redirect_target(&fixture.sign_in().await),
        "/?sign-in=unverified"
    );
    fixture.provider.set_user_info(user_info("person-1", true));
    assert_eq!(fixture.account().await["email"], "ada@example.com");
    fixture.server.finish().await;
}

async fn a_provider_sign_in_is_in_the_audit_log(fixture: Fixture) {
    fixture
        .provider
        .set_claims(json!({ "email": "eve@example.com" }));
    fixture.sign_in().await;
    let before = fixture.ada.get("/audit").await.good();
    fixture.provider.set_claims(json!({}));
    fixture.sign_in().await;
    let after = fixture.ada.get("/audit").await;
    for secret in fixture.provider.secrets() {
        assert!(!after.text.contains(&secret));
    }
    let (before, after) = (before["items"].clone(), after.good()["items"].clone());
    let lines = |all: &Value| all.as_array().unwrap().len();
    assert_eq!(lines(&after), lines(&before) + 1);
    assert_eq!(after[0]["actor_name"], "ada@example.com");
    assert_eq!(after[0]["route"], "/api/v1/session/provider/callback");
    assert_eq!(after[0]["path"], "/api/v1/session/provider/callback");
    assert_eq!(after[0]["status"], 303);
    fixture.server.finish().await;
}

async fn a_reset_account_is_linked_to_the_provider_again(fixture: Fixture) {
    let server = &fixture.server;
    let email = "bob@example.com";
    let colleague = json!({ "email": email, "name": "Bob", "role": "viewer" });
    fixture.ada.post("/users", &colleague).await.good();
    fixture
        .provider
        .set_claims(json!({ "sub": "person-2", "email": email }));
    assert_eq!(fixture.account().await["email"], email);
    let people = fixture.ada.get("/users").await.good();
    assert_eq!(people["items"][1]["state"], "active");
    fixture
        .provider
        .set_claims(json!({ "sub": "person-3", "email": email }));
    assert_eq!(redirect_target(&fixture.sign_in().await), "/?sign-in=taken");
    let now = Time(server.app.clock.now());
    let command = RequestContext::of_command(&server.app.db, "admin reset-user", now);
    users::reset(&command, email, now).await.unwrap();
    assert_eq!(fixture.account().await["email"], email);
    fixture.server.finish().await;
}

async fn a_one_time_code_unlinks_the_provider_account(fixture: Fixture) {
    let ada = fixture.account().await;
    let path = format!("/users/{}/invitation", ada["user_id"].as_str().unwrap());
    let code = fixture.ada.post(&path, &json!({})).await.good()["code"].clone();
    fixture.provider.set_claims(json!({ "sub": "person-2" }));
    assert_eq!(redirect_target(&fixture.sign_in().await), "/?sign-in=taken");
    let url = format!("{}/api/v1/invitations/accept", fixture.server.url);
    let body = json!({ "code": code, "password": "seven gulls over the quay" });
    ApiResponse::send(fixture.server.http.post(url).json(&body))
        .await
        .good();
    assert_eq!(fixture.account().await["email"], "ada@example.com");
    fixture.provider.set_claims(json!({}));
    assert_eq!(redirect_target(&fixture.sign_in().await), "/?sign-in=taken");
    fixture.server.finish().await;
}

#[tokio::test]
async fn an_unavailable_provider_does_not_block_the_server_and_is_retried() {
    // A port without a listener.
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let issuer = format!("http://127.0.0.1:{port}");
    let settings = provider_settings(&issuer);
    let server = TestServer::start_with(Engine::Sqlite, &settings).await;
    server.admin("ada").await;
    let response = get(&server, START, "").await;
    assert_eq!(redirect_target(&response), "/?sign-in=unreachable");
    assert_eq!(
        try_sign_in(&server, "ada@example.com", PASSWORD)
            .await
            .status,
        200
    );
    let provider = Provider::start_at(port).await;
    assert_eq!(provider.issuer, issuer);
    assert_eq!(
        redirect_target(&get(&server, START, "").await),
        "/?sign-in=unreachable"
    );
    server.advance(5.0);
    let (there, cookie) = start_sign_in(&server).await;
    let back = callback_address(&server, &there).await;
    assert_eq!(
        redirect_target(&follow_callback(&server, &back, &cookie).await),
        "/"
    );
    server.finish().await;
}

#[tokio::test]
async fn a_server_without_a_provider_reports_none() {
    let server = TestServer::start(Engine::Sqlite).await;
    let named = with_cookie(&server, "/session/provider", "").await.good();
    assert_eq!(named, json!({ "name": null }));
    assert_eq!(get(&server, START, "").await.problem(), "not-set-up");
    let back = with_cookie(&server, "/session/provider/callback", "").await;
    assert_eq!(back.problem(), "not-set-up");
    assert_eq!(send_code(&server, "", "287082").await.problem(), "gone");
    server.finish().await;
}
