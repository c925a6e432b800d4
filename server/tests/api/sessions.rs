//! Signing in and out, and API tokens.

use crate::on_both;
use crate::support::{Answer, PASSWORD, Person, Shore, attempt};
use binnacle_server::session::Role;
use reqwest::Method;
use serde_json::json;

on_both!(
    a_session_lasts_until_the_user_signs_out,
    a_session_ends_by_itself,
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
    shore.advance(72.0 * 3600.0 - 1.0);
    assert_eq!(ada.get("/me").await.status, 200);
    shore.advance(1.0);
    assert_eq!(ada.get("/me").await.status, 401);
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
    Person::create(&shore, None, "root@example.com", Role::PlatformAdmin).await;
    let root = Person::sign_in(&shore, ada.operator, "root@example.com").await;
    assert_eq!(root.get("/me").await.good()["operator_id"], json!(null));
    assert_eq!(root.get("/vessels").await.problem(), "forbidden");
    shore.finish().await;
}
