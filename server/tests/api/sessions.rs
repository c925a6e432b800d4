//! Signing in and out, and API tokens.

use crate::on_both;
use crate::support::{Answer, Engine, PASSWORD, Person, Shore, attempt};
use reqwest::Method;
use serde_json::json;

on_both!(
    a_session_lasts_until_the_user_signs_out,
    a_session_ends_by_itself,
    an_idle_session_ends_sooner,
    one_sees_and_ends_ones_own_sessions,
    another_password_ends_all_other_sessions,
    another_password_needs_the_one_before,
    guesses_from_one_address_are_slowed_down_whatever_the_email,
    the_cookie_is_out_of_reach_of_scripts_and_other_sites,
    a_change_with_a_cookie_needs_the_header_of_our_own_pages,
    guessing_is_slowed_down_whether_or_not_the_email_exists,
    guesses_sent_at_once_do_not_outrun_the_throttle,
    what_is_not_a_sign_in_is_refused_in_words,
    a_token_may_do_what_its_scope_says_until_it_is_revoked,
    a_token_ends_by_itself,
    a_viewer_may_see_and_not_change,
    a_platform_admin_has_no_fleet,
);

async fn a_session_lasts_until_the_user_signs_out(shore: Shore) {
    let ada = shore.admin("ada").await;
    let me = ada.get("/me").await.good();
    assert_eq!(me["email"], "ada@example.com");
    assert_eq!(me["role"], "admin");
    assert_eq!(me["operator_name"], "ada");
    let gone = Answer::of(ada.request(Method::DELETE, "/session")).await;
    assert_eq!(gone.status, 204);
    assert_eq!(ada.get("/me").await.problem(), "unauthenticated");
    shore.finish().await;
}

async fn a_session_ends_by_itself(shore: Shore) {
    let ada = shore.admin("ada").await;
    for _ in 0..3 {
        shore.advance(24.0 * 3600.0 - 1.0);
        assert_eq!(ada.get("/me").await.status, 200);
    }
    shore.advance(3.0);
    assert_eq!(ada.get("/me").await.status, 401);
    shore.finish().await;
}

async fn an_idle_session_ends_sooner(shore: Shore) {
    let ada = shore.admin("ada").await;
    shore.advance(24.0 * 3600.0);
    assert_eq!(ada.get("/me").await.problem(), "unauthenticated");
    let again = Person::sign_in(&shore, ada.operator, &ada.email).await;
    let listed = again.get("/sessions").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);
    shore.finish().await;
}

async fn one_sees_and_ends_ones_own_sessions(shore: Shore) {
    let ada = shore.admin("ada").await;
    let eve = shore.admin("eve").await;
    let telephone = Person::sign_in(&shore, ada.operator, &ada.email).await;
    let office = Person::sign_in(&shore, ada.operator, &ada.email).await;
    shore.advance(900.0);
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
        Answer::of(who.request(Method::DELETE, &path))
    };
    assert_eq!(end(&eve, 1).await.problem(), "not-found");
    assert_eq!(end(&ada, 1).await.status, 204);
    assert_eq!(telephone.get("/me").await.problem(), "unauthenticated");
    assert_eq!(office.get("/me").await.status, 200);
    let others = Answer::of(office.request(Method::DELETE, "/sessions")).await;
    assert_eq!(others.status, 204);
    assert_eq!(ada.get("/me").await.problem(), "unauthenticated");
    assert_eq!(office.get("/me").await.status, 200);
    assert_eq!(eve.get("/me").await.status, 200);
    shore.finish().await;
}

const NEW: &str = "seven gulls over the quay";

async fn put_password(person: &Person, current: &str, new: &str) -> Answer {
    let body = json!({ "current": current, "new": new });
    Answer::of(person.request(Method::PUT, "/me/password").json(&body)).await
}

async fn another_password_ends_all_other_sessions(shore: Shore) {
    let ada = shore.admin("ada").await;
    let stolen = Person::sign_in(&shore, ada.operator, &ada.email).await;
    assert_eq!(put_password(&ada, PASSWORD, NEW).await.status, 204);
    assert_eq!(ada.get("/me").await.status, 200);
    assert_eq!(stolen.get("/me").await.problem(), "unauthenticated");
    assert_eq!(attempt(&shore, &ada.email, PASSWORD).await.status, 401);
    assert_eq!(attempt(&shore, &ada.email, NEW).await.status, 200);
    shore.finish().await;
}

async fn another_password_needs_the_one_before(shore: Shore) {
    let ada = shore.admin("ada").await;
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
        let wrong = put_password(&ada, "a guess at the desk", NEW).await;
        assert_eq!(wrong.problem(), "wrong-password");
    }
    let slowed = put_password(&ada, PASSWORD, NEW).await;
    assert_eq!(slowed.problem(), "throttled");
    let made = json!({ "name": "ERP", "scope": "write" });
    let made = ada.post("/tokens", &made).await.good();
    let request = shore.http.put(format!("{}/api/v1/me/password", shore.url));
    let request = request.json(&json!({ "current": PASSWORD, "new": NEW }));
    let by_token = Answer::of(request.bearer_auth(made["token"].as_str().unwrap())).await;
    assert_eq!(by_token.problem(), "forbidden");
    shore.finish().await;
}

async fn guesses_from_one_address_are_slowed_down_whatever_the_email(shore: Shore) {
    shore.admin("ada").await;
    for guess in 0..50 {
        let email = format!("nobody-{guess}@example.com");
        let wrong = attempt(&shore, &email, "a guess").await;
        assert_eq!(wrong.problem(), "wrong-password", "{guess}");
    }
    let slowed = attempt(&shore, "ada@example.com", PASSWORD).await;
    assert_eq!(slowed.problem(), "throttled");
    shore.advance(1.0);
    let right = attempt(&shore, "ada@example.com", PASSWORD).await;
    assert_eq!(right.status, 200);
    shore.finish().await;
}

#[tokio::test]
async fn behind_proxies_of_ones_own_the_clients_address_counts() {
    let shore = Shore::start_with(Engine::Sqlite, &["--proxies", "1"]).await;
    let ada = shore.admin("ada").await;
    let body = json!({ "email": ada.email, "password": PASSWORD });
    let request = shore.http.post(format!("{}/api/v1/session", shore.url));
    let request = request.header("x-forwarded-for", "203.0.113.9, 198.51.100.7");
    assert_eq!(Answer::of(request.json(&body)).await.status, 200);
    let listed = ada.get("/sessions").await.good();
    assert_eq!(listed["items"][1]["address"], "198.51.100.7");
    shore.finish().await;
}

#[tokio::test]
async fn over_https_alone_no_other_host_can_plant_the_cookie() {
    let shore = Shore::start_with(Engine::Sqlite, &["--secure-cookies"]).await;
    let ada = shore.admin("ada").await;
    let answer = attempt(&shore, &ada.email, PASSWORD).await;
    let cookie = answer.headers["set-cookie"].to_str().unwrap();
    let (pair, attributes) = cookie.split_once("; ").unwrap();
    let token = pair.strip_prefix("__Host-binnacle_session=").unwrap();
    assert_eq!(
        attributes,
        "Path=/; HttpOnly; SameSite=Strict; Max-Age=259200; Secure"
    );
    let planted = shore.http.get(format!("{}/api/v1/me", shore.url));
    let planted = planted.header("cookie", format!("binnacle_session={token}"));
    assert_eq!(Answer::of(planted).await.problem(), "unauthenticated");
    assert_eq!(ada.get("/me").await.status, 200);
    shore.finish().await;
}

async fn the_cookie_is_out_of_reach_of_scripts_and_other_sites(shore: Shore) {
    shore.admin("ada").await;
    let answer = attempt(&shore, "ADA@example.com ", PASSWORD).await;
    let cookie = answer.headers["set-cookie"].to_str().unwrap();
    assert!(
        cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"),
        "{cookie}"
    );
    shore.finish().await;
}

async fn a_change_with_a_cookie_needs_the_header_of_our_own_pages(shore: Shore) {
    let ada = shore.admin("ada").await;
    let forged = shore
        .http
        .post(format!("{}/api/v1/vessels", shore.url))
        .header("cookie", &ada.cookie)
        .json(&json!({ "name": "Forged" }));
    assert_eq!(Answer::of(forged).await.problem(), "forbidden");
    assert_eq!(ada.get("/vessels").await.good()["items"], json!([]));
    shore.finish().await;
}

async fn guessing_is_slowed_down_whether_or_not_the_email_exists(shore: Shore) {
    shore.admin("ada").await;
    for email in ["ada@example.com", "nobody@example.com"] {
        for _ in 0..5 {
            let wrong = attempt(&shore, email, "wrong").await;
            assert_eq!(wrong.problem(), "wrong-password");
        }
        let slowed = attempt(&shore, email, PASSWORD).await;
        assert_eq!(slowed.problem(), "throttled");
        assert_eq!(slowed.headers["retry-after"], "1");
    }
    shore.advance(1.0);
    assert_eq!(
        attempt(&shore, "ada@example.com", PASSWORD).await.status,
        200
    );
    // Having signed in, one may err again.
    assert_eq!(
        attempt(&shore, "ada@example.com", "wrong").await.status,
        401
    );
    assert_eq!(
        attempt(&shore, "ada@example.com", PASSWORD).await.status,
        200
    );
    shore.finish().await;
}

async fn guesses_sent_at_once_do_not_outrun_the_throttle(shore: Shore) {
    let guesses = (0..30).map(|_| attempt(&shore, "ada@example.com", "wrong"));
    let answers = futures_util::future::join_all(guesses).await;
    let judged = answers.iter().filter(|answer| answer.status == 401).count();
    // The fifth failure begins the wait; one more may have been under way.
    assert!((5..=6).contains(&judged), "{judged} guesses were judged");
    let odd = attempt(&shore, "ada\0@example.com", "wrong").await;
    assert_eq!(odd.problem(), "wrong-password");
    shore.finish().await;
}

async fn what_is_not_a_sign_in_is_refused_in_words(shore: Shore) {
    let url = format!("{}/api/v1/session", shore.url);
    let json = |body: &'static str| {
        shore
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
            shore.http.post(&url).body("email=a"),
            "unsupported-media-type",
        ),
        (json("").body(vec![b' '; 70_000]), "too-large"),
    ];
    for (request, problem) in cases {
        assert_eq!(Answer::of(request).await.problem(), problem);
    }
    shore.finish().await;
}

async fn a_token_may_do_what_its_scope_says_until_it_is_revoked(shore: Shore) {
    let ada = shore.admin("ada").await;
    for (scope, status) in [("read", 403), ("write", 201)] {
        let made = ada
            .post("/tokens", &json!({ "name": "ERP", "scope": scope }))
            .await
            .good();
        let secret = made["token"].as_str().unwrap();
        let ask = |method, path: &str| {
            shore
                .http
                .request(method, format!("{}/api/v1{path}", shore.url))
                .bearer_auth(secret)
        };
        let listed = Answer::of(ask(Method::GET, "/vessels")).await;
        assert_eq!(listed.status, 200);
        let created = ask(Method::POST, "/vessels").json(&json!({ "name": "Nao" }));
        assert_eq!(Answer::of(created).await.status, status, "{scope}");
        // A token that leaked cannot make others to outlive it.
        let more = ask(Method::POST, "/tokens").json(&json!({ "name": "x", "scope": "read" }));
        assert_eq!(Answer::of(more).await.status, 403);

        let path = format!("/tokens/{}", made["id"].as_str().unwrap());
        let revoked = Answer::of(ada.request(Method::DELETE, &path)).await;
        assert_eq!(revoked.status, 204);
        assert_eq!(Answer::of(ask(Method::GET, "/vessels")).await.status, 401);
        assert_eq!(
            Answer::of(ada.request(Method::DELETE, &path)).await.status,
            404
        );
    }
    shore.finish().await;
}

async fn a_token_ends_by_itself(shore: Shore) {
    let ada = shore.admin("ada").await;
    let wanted = json!({ "name": "ERP", "scope": "read", "expires_at": "2026-11-21T08:00:00Z" });
    let made = ada.post("/tokens", &wanted).await.good();
    let ask = || {
        let request = shore.http.get(format!("{}/api/v1/me", shore.url));
        Answer::of(request.bearer_auth(made["token"].as_str().unwrap()))
    };
    assert_eq!(ask().await.status, 200);
    let listed = ada.get("/tokens").await.good();
    assert_eq!(listed["items"][0]["last_used_at"], "2026-11-21T07:00:00Z");
    assert!(listed["items"][0].get("token").is_none());
    shore.advance(3600.0);
    assert_eq!(ask().await.status, 401);
    let over = ada.post("/tokens", &wanted).await;
    assert_eq!(over.problem(), "invalid");
    shore.finish().await;
}

async fn a_viewer_may_see_and_not_change(shore: Shore) {
    let ada = shore.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let viewer = ada.viewer(&shore).await;
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
    for answer in refused {
        assert_eq!(answer.problem(), "forbidden");
    }
    shore.finish().await;
}

async fn a_platform_admin_has_no_fleet(shore: Shore) {
    let ada = shore.admin("ada").await;
    let root = ada.platform_admin(&shore).await;
    assert_eq!(root.get("/me").await.good()["operator_id"], json!(null));
    assert_eq!(root.get("/vessels").await.problem(), "forbidden");
    shore.finish().await;
}
