//! Sign-in through an OpenID Connect provider.

use crate::second_factor::{app_code, now_s, set_up};
use binnacle_platform::audit::RequestContext;
use binnacle_platform::time::Time;
use binnacle_platform::users;
use binnacle_server_testing::{
    ApiResponse, Engine, PASSWORD, Person, Provider, Signer, TestServer, attempt, provider_settings,
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
            $(#[tokio::test] async fn $test() { super::$test(World::new(Engine::Sqlite).await).await; })*
        }
        mod postgres {
            use super::*;
            $(#[tokio::test] async fn $test() { super::$test(World::new(Engine::Postgres).await).await; })*
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

struct World {
    server: TestServer,
    provider: Provider,
    ada: Person,
}

impl World {
    async fn new(engine: Engine) -> World {
        let provider = Provider::start().await;
        let server = TestServer::start_with(engine, &provider.settings()).await;
        let ada = server.admin("ada").await;
        World {
            server,
            provider,
            ada,
        }
    }

    async fn sign_in(&self) -> ApiResponse {
        let (there, cookie) = begin(&self.server).await;
        let back = at_provider(&self.server, &there).await;
        come_back(&self.server, &back, &cookie).await
    }

    /// Signs in through the provider, and returns the account.
    async fn me(&self) -> Value {
        let done = self.sign_in().await;
        assert_eq!(outcome(&done), "/");
        let response = with_cookie(&self.server, "/me", &session(&done).unwrap()).await;
        response.good()
    }
}

async fn get(server: &TestServer, path: &str, cookie: &str) -> ApiResponse {
    let url = format!("{}{path}", server.url);
    ApiResponse::of(server.http.get(url).header("cookie", cookie)).await
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
fn session(response: &ApiResponse) -> Option<String> {
    let all = cookies(response);
    let found = all
        .iter()
        .find(|cookie| cookie.starts_with("binnacle_session="));
    Some(found?.split(';').next().unwrap().to_owned())
}

/// Returns the redirect target.
fn outcome(response: &ApiResponse) -> &str {
    assert_eq!(response.status, 303, "{response:?}");
    response.headers["location"].to_str().unwrap()
}

/// Returns the provider's address, and the cookie that the browser keeps.
async fn begin(server: &TestServer) -> (String, String) {
    let response = get(server, START, "").await;
    let cookie = cookies(&response)[0].split(';').next().unwrap().to_owned();
    (outcome(&response).to_owned(), cookie)
}

/// Follows the address at the provider; returns the callback address.
async fn at_provider(server: &TestServer, address: &str) -> String {
    let response = ApiResponse::of(server.http.get(address)).await;
    let back = outcome(&response);
    back.strip_prefix(PUBLIC).unwrap().to_owned()
}

async fn come_back(server: &TestServer, back: &str, cookie: &str) -> ApiResponse {
    get(server, back, cookie).await
}

async fn send_code(server: &TestServer, cookie: &str, code: &str) -> ApiResponse {
    let url = format!("{}/api/v1/session/provider/code", server.url);
    let request = server.http.post(url).header("cookie", cookie);
    ApiResponse::of(request.json(&json!({ "code": code }))).await
}

async fn a_person_verified_by_the_provider_is_signed_in(world: World) {
    let named = with_cookie(&world.server, "/session/provider", "").await;
    assert_eq!(named.good(), json!({ "name": "Example Lines" }));
    let done = world.sign_in().await;
    let cookie = session(&done).unwrap();
    let me = with_cookie(&world.server, "/me", &cookie).await.good();
    assert_eq!(me["email"], "ada@example.com");
    let sessions = world.ada.get("/sessions").await.good();
    assert_eq!(sessions["items"][0]["provider"], Value::Null);
    assert_eq!(sessions["items"][1]["provider"], "Example Lines");
    let url = format!("{}/api/v1/session", world.server.url);
    let out = world.server.http.delete(url).header("cookie", &cookie);
    let out = ApiResponse::of(out.header("x-binnacle-request", "1")).await;
    assert_eq!(out.status, 204);
    assert_eq!(
        with_cookie(&world.server, "/me", &cookie).await.problem(),
        "unauthenticated"
    );
    world.server.finish().await;
}

async fn a_pending_sign_in_is_hidden_from_scripts_and_the_provider(world: World) {
    let response = get(&world.server, START, "").await;
    let cookie = cookies(&response)[0].clone();
    for part in ["HttpOnly", "SameSite=Lax", "Max-Age=600", "Path=/"] {
        assert!(cookie.contains(part), "{cookie}");
    }
    let kept = cookie.split([';', '=', '.']).nth(2).unwrap();
    assert_eq!(kept.len(), 43);
    let there = outcome(&response);
    assert!(there.starts_with(&world.provider.issuer));
    assert!(
        !there.contains(kept) && !there.contains("secret"),
        "{there}"
    );
    assert!(there.contains("code_challenge_method=S256"));
    let done = world.sign_in().await;
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
    world.server.finish().await;
}

async fn a_cancelled_sign_in_returns_to_the_sign_in_page(world: World) {
    let (there, cookie) = begin(&world.server).await;
    let back = at_provider(&world.server, &there).await;
    let (path, query) = back.split_once('?').unwrap();
    let (_, state) = query.split_once("&state=").unwrap();
    let back = format!("{path}?error=access_denied&state={state}");
    let done = come_back(&world.server, &back, &cookie).await;
    assert_eq!(outcome(&done), "/?sign-in=cancelled");
    world.server.finish().await;
}

async fn a_person_keeps_the_account_when_the_email_changes(world: World) {
    let eve = world.server.admin("eve").await;
    assert_eq!(world.me().await["email"], "ada@example.com");
    for changed in [
        json!({ "email": "eve@example.com" }),
        json!({ "email": null }),
        json!({ "email": "countess@example.com", "email_verified": false }),
    ] {
        world.provider.says(changed);
        assert_eq!(world.me().await["email"], "ada@example.com");
    }
    // The address now belongs to someone else.
    world.provider.says(json!({ "sub": "person-2" }));
    let done = world.sign_in().await;
    assert_eq!(outcome(&done), "/?sign-in=taken");
    assert_eq!(session(&done), None);
    let sessions = eve.get("/sessions").await.good();
    assert_eq!(sessions["items"].as_array().unwrap().len(), 1);
    world.server.finish().await;
}

async fn people_of_every_operator_sign_in_to_their_own_account(world: World) {
    let server = &world.server;
    let eve = server.admin("eve").await;
    let (firm, adjuster) = world.ada.adjuster(server, "needle").await;
    let root = world.ada.platform_admin(server).await;
    for (person, email) in [&eve, &adjuster, &root].iter().zip(2..) {
        let claims = json!({ "sub": format!("person-{email}"), "email": person.email });
        world.provider.says(claims);
        let me = world.me().await;
        assert_eq!(me, person.get("/me").await.good());
    }
    world
        .provider
        .says(json!({ "sub": "person-3", "email": "ada@example.com" }));
    let me = world.me().await;
    assert_eq!(me["firm_id"], json!(firm));
    assert_eq!(me["operator_id"], Value::Null);
    world.server.finish().await;
}

async fn a_second_factor_is_required_after_the_provider(world: World) {
    let server = &world.server;
    let (secret, _) = set_up(server, &world.ada).await;
    let (there, cookie) = begin(server).await;
    let back = at_provider(server, &there).await;
    let early = send_code(server, &cookie, &app_code(&secret, now_s(server))).await;
    assert_eq!(early.problem(), "gone");
    let done = come_back(server, &back, &cookie).await;
    assert_eq!(outcome(&done), "/?sign-in=code");
    assert_eq!(session(&done), None);
    let code = app_code(&secret, now_s(server));
    let (_, another) = begin(server).await;
    for strange in ["", another.as_str()] {
        assert_eq!(send_code(server, strange, &code).await.problem(), "gone");
    }
    let wrong = send_code(server, &cookie, "a guess").await;
    assert_eq!(wrong.problem(), "wrong-code");
    let right = send_code(server, &cookie, &code).await;
    assert_eq!(right.good()["email"], "ada@example.com");
    let me = with_cookie(server, "/me", &session(&right).unwrap()).await;
    assert_eq!(me.status, 200);
    server.advance(60.0);
    let again = send_code(server, &cookie, &app_code(&secret, now_s(server))).await;
    assert_eq!(again.problem(), "gone");

    let (there, cookie) = begin(server).await;
    let back = at_provider(server, &there).await;
    come_back(server, &back, &cookie).await;
    server.advance(600.0);
    let late = send_code(server, &cookie, &app_code(&secret, now_s(server))).await;
    assert_eq!(late.problem(), "gone");
    world.server.finish().await;
}

async fn a_rotated_provider_key_is_fetched(world: World) {
    assert_eq!(outcome(&world.sign_in().await), "/");
    world.provider.changes_its_key();
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=untrusted");
    world.server.advance(60.0);
    assert_eq!(outcome(&world.sign_in().await), "/");
    world.server.finish().await;
}

async fn an_rsa_signature_of_the_provider_is_accepted(world: World) {
    world.provider.signs_by_rsa();
    assert_eq!(world.me().await["email"], "ada@example.com");
    for signer in [Signer::Stranger, Signer::Secret, Signer::Nobody] {
        world.provider.signed_by(signer);
        assert_eq!(outcome(&world.sign_in().await), "/?sign-in=untrusted");
    }
    world.provider.signed_by(Signer::Itself);
    world.server.advance(60.0);
    world.provider.changes_its_key();
    assert_eq!(
        outcome(&world.sign_in().await),
        "/",
        "another RSA key is looked for"
    );
    world.server.finish().await;
}

async fn a_missing_email_comes_from_the_user_info_endpoint(world: World) {
    world
        .provider
        .says(json!({ "email": null, "email_verified": null }));
    let user_info = |subject: &str, verified: bool| json!({ "sub": subject, "email": "ada@example.com", "email_verified": verified });
    world.provider.tells(user_info("person-2", true));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unverified");
    world.provider.tells(user_info("person-1", false));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unverified");
    world.provider.tells(user_info("person-1", true));
    assert_eq!(world.me().await["email"], "ada@example.com");
    world.server.finish().await;
}

async fn a_provider_sign_in_is_in_the_audit_log(world: World) {
    world.provider.says(json!({ "email": "eve@example.com" }));
    world.sign_in().await;
    let before = world.ada.get("/audit").await.good();
    world.provider.says(json!({}));
    world.sign_in().await;
    let after = world.ada.get("/audit").await;
    for secret in world.provider.secrets() {
        assert!(!after.text.contains(&secret));
    }
    let (before, after) = (before["items"].clone(), after.good()["items"].clone());
    let lines = |all: &Value| all.as_array().unwrap().len();
    assert_eq!(lines(&after), lines(&before) + 1);
    assert_eq!(after[0]["actor_name"], "ada@example.com");
    assert_eq!(after[0]["route"], "/api/v1/session/provider/callback");
    assert_eq!(after[0]["path"], "/api/v1/session/provider/callback");
    assert_eq!(after[0]["status"], 303);
    world.server.finish().await;
}

async fn a_reset_account_is_linked_to_the_provider_again(world: World) {
    let server = &world.server;
    let email = "bob@example.com";
    let colleague = json!({ "email": email, "name": "Bob", "role": "viewer" });
    world.ada.post("/users", &colleague).await.good();
    world
        .provider
        .says(json!({ "sub": "person-2", "email": email }));
    assert_eq!(world.me().await["email"], email);
    let people = world.ada.get("/users").await.good();
    assert_eq!(people["items"][1]["state"], "active");
    world
        .provider
        .says(json!({ "sub": "person-3", "email": email }));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=taken");
    let now = Time(server.app.clock.now());
    let command = RequestContext::of_command(&server.app.db, "admin reset-user", now);
    users::reset(&command, email, now).await.unwrap();
    assert_eq!(world.me().await["email"], email);
    world.server.finish().await;
}

async fn a_one_time_code_unlinks_the_provider_account(world: World) {
    let ada = world.me().await;
    let path = format!("/users/{}/invitation", ada["user_id"].as_str().unwrap());
    let code = world.ada.post(&path, &json!({})).await.good()["code"].clone();
    world.provider.says(json!({ "sub": "person-2" }));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=taken");
    let url = format!("{}/api/v1/invitations/accept", world.server.url);
    let body = json!({ "code": code, "password": "seven gulls over the quay" });
    ApiResponse::of(world.server.http.post(url).json(&body))
        .await
        .good();
    assert_eq!(world.me().await["email"], "ada@example.com");
    world.provider.says(json!({}));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=taken");
    world.server.finish().await;
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
    assert_eq!(outcome(&response), "/?sign-in=unreachable");
    assert_eq!(
        attempt(&server, "ada@example.com", PASSWORD).await.status,
        200
    );
    let provider = Provider::start_at(port).await;
    assert_eq!(provider.issuer, issuer);
    assert_eq!(
        outcome(&get(&server, START, "").await),
        "/?sign-in=unreachable"
    );
    server.advance(5.0);
    let (there, cookie) = begin(&server).await;
    let back = at_provider(&server, &there).await;
    assert_eq!(outcome(&come_back(&server, &back, &cookie).await), "/");
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
