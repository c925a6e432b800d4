//! Signing in by the word of an OpenID Connect provider.

use crate::second_factor::{app_code, now_s, set_up};
use binnacle_platform::audit::RequestContext;
use binnacle_platform::time::Time;
use binnacle_platform::users;
use binnacle_server_testing::{
    Answer, Engine, PASSWORD, Person, Provider, Shore, Signer, attempt, provider_settings,
};
use serde_json::{Value, json};
use tokio::net::TcpListener;

const START: &str = "/api/v1/session/provider/start";
const PUBLIC: &str = "https://binnacle.example";

/// Each with a provider, and Ada who is an admin.
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
    whoever_the_provider_vouches_for_is_signed_in,
    a_sign_in_is_kept_from_scripts_and_tells_the_provider_no_secret,
    a_person_may_change_their_mind,
    a_person_stays_who_they_are_whatever_becomes_of_the_email,
    people_of_every_company_sign_in_as_themselves,
    whoever_has_a_second_factor_is_asked_for_it,
    another_key_of_the_providers_is_looked_for,
    a_provider_that_signs_with_rsa_is_believed,
    an_email_may_be_told_only_to_who_asks_for_it,
    a_sign_in_is_in_the_audit_log,
    a_person_who_begins_anew_is_found_anew,
    a_one_time_code_forgets_whom_the_provider_means,
);

struct World {
    shore: Shore,
    provider: Provider,
    ada: Person,
}

impl World {
    async fn new(engine: Engine) -> World {
        let provider = Provider::start().await;
        let shore = Shore::start_with(engine, &provider.settings()).await;
        let ada = shore.admin("ada").await;
        World {
            shore,
            provider,
            ada,
        }
    }

    async fn sign_in(&self) -> Answer {
        let (there, cookie) = begin(&self.shore).await;
        let back = at_provider(&self.shore, &there).await;
        come_back(&self.shore, &back, &cookie).await
    }

    /// Whom the provider signs in.
    async fn me(&self) -> Value {
        let done = self.sign_in().await;
        assert_eq!(outcome(&done), "/");
        let answer = with_cookie(&self.shore, "/me", &session(&done).unwrap()).await;
        answer.good()
    }
}

async fn get(shore: &Shore, path: &str, cookie: &str) -> Answer {
    let url = format!("{}{path}", shore.url);
    Answer::of(shore.http.get(url).header("cookie", cookie)).await
}

async fn with_cookie(shore: &Shore, path: &str, cookie: &str) -> Answer {
    get(shore, &format!("/api/v1{path}"), cookie).await
}

fn cookies(answer: &Answer) -> Vec<String> {
    let all = answer.headers.get_all("set-cookie").iter();
    all.map(|cookie| cookie.to_str().unwrap().to_owned())
        .collect()
}

/// The cookie of a session, if one was opened.
fn session(answer: &Answer) -> Option<String> {
    let all = cookies(answer);
    let found = all
        .iter()
        .find(|cookie| cookie.starts_with("binnacle_session="));
    Some(found?.split(';').next().unwrap().to_owned())
}

/// Where the browser is sent to.
fn outcome(answer: &Answer) -> &str {
    assert_eq!(answer.status, 303, "{answer:?}");
    answer.headers["location"].to_str().unwrap()
}

/// The provider's address, and the cookie that the browser keeps.
async fn begin(shore: &Shore) -> (String, String) {
    let answer = get(shore, START, "").await;
    let cookie = cookies(&answer)[0].split(';').next().unwrap().to_owned();
    (outcome(&answer).to_owned(), cookie)
}

/// What the provider sends the browser back to.
async fn at_provider(shore: &Shore, address: &str) -> String {
    let answer = Answer::of(shore.http.get(address)).await;
    let back = outcome(&answer);
    back.strip_prefix(PUBLIC).unwrap().to_owned()
}

async fn come_back(shore: &Shore, back: &str, cookie: &str) -> Answer {
    get(shore, back, cookie).await
}

async fn send_code(shore: &Shore, cookie: &str, code: &str) -> Answer {
    let url = format!("{}/api/v1/session/provider/code", shore.url);
    let request = shore.http.post(url).header("cookie", cookie);
    Answer::of(request.json(&json!({ "code": code }))).await
}

async fn whoever_the_provider_vouches_for_is_signed_in(world: World) {
    let named = with_cookie(&world.shore, "/session/provider", "").await;
    assert_eq!(named.good(), json!({ "name": "Example Lines" }));
    let done = world.sign_in().await;
    let cookie = session(&done).unwrap();
    let me = with_cookie(&world.shore, "/me", &cookie).await.good();
    assert_eq!(me["email"], "ada@example.com");
    let sessions = world.ada.get("/sessions").await.good();
    assert_eq!(sessions["items"][0]["provider"], Value::Null);
    assert_eq!(sessions["items"][1]["provider"], "Example Lines");
    let url = format!("{}/api/v1/session", world.shore.url);
    let out = world.shore.http.delete(url).header("cookie", &cookie);
    let out = Answer::of(out.header("x-binnacle-request", "1")).await;
    assert_eq!(out.status, 204);
    assert_eq!(
        with_cookie(&world.shore, "/me", &cookie).await.problem(),
        "unauthenticated"
    );
    world.shore.finish().await;
}

async fn a_sign_in_is_kept_from_scripts_and_tells_the_provider_no_secret(world: World) {
    let answer = get(&world.shore, START, "").await;
    let cookie = cookies(&answer)[0].clone();
    for part in ["HttpOnly", "SameSite=Lax", "Max-Age=600", "Path=/"] {
        assert!(cookie.contains(part), "{cookie}");
    }
    let kept = cookie.split([';', '=', '.']).nth(2).unwrap();
    assert_eq!(kept.len(), 43);
    let there = outcome(&answer);
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
    world.shore.finish().await;
}

async fn a_person_may_change_their_mind(world: World) {
    let (there, cookie) = begin(&world.shore).await;
    let back = at_provider(&world.shore, &there).await;
    let (path, query) = back.split_once('?').unwrap();
    let (_, state) = query.split_once("&state=").unwrap();
    let back = format!("{path}?error=access_denied&state={state}");
    let done = come_back(&world.shore, &back, &cookie).await;
    assert_eq!(outcome(&done), "/?sign-in=cancelled");
    world.shore.finish().await;
}

async fn a_person_stays_who_they_are_whatever_becomes_of_the_email(world: World) {
    let eve = world.shore.admin("eve").await;
    assert_eq!(world.me().await["email"], "ada@example.com");
    for changed in [
        json!({ "email": "eve@example.com" }),
        json!({ "email": null }),
        json!({ "email": "countess@example.com", "email_verified": false }),
    ] {
        world.provider.says(changed);
        assert_eq!(world.me().await["email"], "ada@example.com");
    }
    // The address went over to someone else.
    world.provider.says(json!({ "sub": "person-2" }));
    let done = world.sign_in().await;
    assert_eq!(outcome(&done), "/?sign-in=taken");
    assert_eq!(session(&done), None);
    let sessions = eve.get("/sessions").await.good();
    assert_eq!(sessions["items"].as_array().unwrap().len(), 1);
    world.shore.finish().await;
}

async fn people_of_every_company_sign_in_as_themselves(world: World) {
    let shore = &world.shore;
    let eve = shore.admin("eve").await;
    let (firm, adjuster) = world.ada.adjuster(shore, "needle").await;
    let root = world.ada.platform_admin(shore).await;
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
    world.shore.finish().await;
}

async fn whoever_has_a_second_factor_is_asked_for_it(world: World) {
    let shore = &world.shore;
    let (secret, _) = set_up(shore, &world.ada).await;
    let (there, cookie) = begin(shore).await;
    let back = at_provider(shore, &there).await;
    let early = send_code(shore, &cookie, &app_code(&secret, now_s(shore))).await;
    assert_eq!(early.problem(), "gone");
    let done = come_back(shore, &back, &cookie).await;
    assert_eq!(outcome(&done), "/?sign-in=code");
    assert_eq!(session(&done), None);
    let code = app_code(&secret, now_s(shore));
    let (_, another) = begin(shore).await;
    for strange in ["", another.as_str()] {
        assert_eq!(send_code(shore, strange, &code).await.problem(), "gone");
    }
    let wrong = send_code(shore, &cookie, "a guess").await;
    assert_eq!(wrong.problem(), "wrong-code");
    let right = send_code(shore, &cookie, &code).await;
    assert_eq!(right.good()["email"], "ada@example.com");
    let me = with_cookie(shore, "/me", &session(&right).unwrap()).await;
    assert_eq!(me.status, 200);
    shore.advance(60.0);
    let again = send_code(shore, &cookie, &app_code(&secret, now_s(shore))).await;
    assert_eq!(again.problem(), "gone");

    let (there, cookie) = begin(shore).await;
    let back = at_provider(shore, &there).await;
    come_back(shore, &back, &cookie).await;
    shore.advance(600.0);
    let late = send_code(shore, &cookie, &app_code(&secret, now_s(shore))).await;
    assert_eq!(late.problem(), "gone");
    world.shore.finish().await;
}

async fn another_key_of_the_providers_is_looked_for(world: World) {
    assert_eq!(outcome(&world.sign_in().await), "/");
    world.provider.changes_its_key();
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=untrusted");
    world.shore.advance(60.0);
    assert_eq!(outcome(&world.sign_in().await), "/");
    world.shore.finish().await;
}

async fn a_provider_that_signs_with_rsa_is_believed(world: World) {
    world.provider.signs_by_rsa();
    assert_eq!(world.me().await["email"], "ada@example.com");
    for signer in [Signer::Stranger, Signer::Secret, Signer::Nobody] {
        world.provider.signed_by(signer);
        assert_eq!(outcome(&world.sign_in().await), "/?sign-in=untrusted");
    }
    world.provider.signed_by(Signer::Itself);
    world.shore.advance(60.0);
    world.provider.changes_its_key();
    assert_eq!(
        outcome(&world.sign_in().await),
        "/",
        "another RSA key is looked for"
    );
    world.shore.finish().await;
}

async fn an_email_may_be_told_only_to_who_asks_for_it(world: World) {
    world
        .provider
        .says(json!({ "email": null, "email_verified": null }));
    let told = |subject: &str, verified: bool| json!({ "sub": subject, "email": "ada@example.com", "email_verified": verified });
    world.provider.tells(told("person-2", true));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unverified");
    world.provider.tells(told("person-1", false));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unverified");
    world.provider.tells(told("person-1", true));
    assert_eq!(world.me().await["email"], "ada@example.com");
    world.shore.finish().await;
}

async fn a_sign_in_is_in_the_audit_log(world: World) {
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
    world.shore.finish().await;
}

async fn a_person_who_begins_anew_is_found_anew(world: World) {
    let shore = &world.shore;
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
    let now = Time(shore.app.clock.now());
    let command = RequestContext::of_command(&shore.app.db, "admin reset-user", now);
    users::reset(&command, email, now).await.unwrap();
    assert_eq!(world.me().await["email"], email);
    world.shore.finish().await;
}

async fn a_one_time_code_forgets_whom_the_provider_means(world: World) {
    let ada = world.me().await;
    let path = format!("/users/{}/invitation", ada["user_id"].as_str().unwrap());
    let code = world.ada.post(&path, &json!({})).await.good()["code"].clone();
    world.provider.says(json!({ "sub": "person-2" }));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=taken");
    let url = format!("{}/api/v1/invitations/accept", world.shore.url);
    let body = json!({ "code": code, "password": "seven gulls over the quay" });
    Answer::of(world.shore.http.post(url).json(&body))
        .await
        .good();
    assert_eq!(world.me().await["email"], "ada@example.com");
    world.provider.says(json!({}));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=taken");
    world.shore.finish().await;
}

#[tokio::test]
async fn a_provider_that_is_down_stands_in_nobodys_way_and_is_tried_again() {
    // A port that nobody listens at.
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let issuer = format!("http://127.0.0.1:{port}");
    let settings = provider_settings(&issuer);
    let shore = Shore::start_with(Engine::Sqlite, &settings).await;
    shore.admin("ada").await;
    let answer = get(&shore, START, "").await;
    assert_eq!(outcome(&answer), "/?sign-in=unreachable");
    assert_eq!(
        attempt(&shore, "ada@example.com", PASSWORD).await.status,
        200
    );
    let provider = Provider::start_at(port).await;
    assert_eq!(provider.issuer, issuer);
    assert_eq!(
        outcome(&get(&shore, START, "").await),
        "/?sign-in=unreachable"
    );
    shore.advance(5.0);
    let (there, cookie) = begin(&shore).await;
    let back = at_provider(&shore, &there).await;
    assert_eq!(outcome(&come_back(&shore, &back, &cookie).await), "/");
    shore.finish().await;
}

#[tokio::test]
async fn a_server_without_a_provider_says_so() {
    let shore = Shore::start(Engine::Sqlite).await;
    let named = with_cookie(&shore, "/session/provider", "").await.good();
    assert_eq!(named, json!({ "name": null }));
    assert_eq!(get(&shore, START, "").await.problem(), "not-set-up");
    let back = with_cookie(&shore, "/session/provider/callback", "").await;
    assert_eq!(back.problem(), "not-set-up");
    assert_eq!(send_code(&shore, "", "287082").await.problem(), "gone");
    shore.finish().await;
}
