//! Invalid tokens and sign-ins, and people who may not sign in.

use super::{
    Fixture, callback_address, follow_callback, redirect_target, send_code, session_cookie,
    start_sign_in,
};
use crate::second_factor::{app_code, now_s, set_up};
use binnacle_server_testing::{ApiResponse, Engine, PASSWORD, Signer, try_sign_in};
use futures_util::future::join_all;
use reqwest::Method;
use serde_json::json;

with_provider!(
    an_invalid_id_token_signs_nobody_in,
    a_callback_works_once_in_the_same_browser,
    an_unverified_or_unknown_email_gives_no_access_and_no_account,
    a_blocked_person_cannot_sign_in_through_the_provider,
    guessed_callback_codes_are_rate_limited,
    concurrent_callback_guesses_cannot_bypass_the_count,
    failures_from_one_address_are_rate_limited,
);

async fn an_invalid_id_token_signs_nobody_in(fixture: Fixture) {
    let wrong = [
        json!({ "nonce": "of another sign-in" }),
        json!({ "nonce": null }),
        json!({ "aud": "another" }),
        json!({ "aud": ["binnacle", "another"] }),
        json!({ "iss": "https://another.example" }),
        json!({ "exp": 1_795_244_399 }),
    ];
    for claims in wrong {
        fixture.provider.set_claims(claims.clone());
        let done = fixture.sign_in().await;
        assert_eq!(redirect_target(&done), "/?sign-in=untrusted", "{claims}");
        assert_eq!(session_cookie(&done), None, "{claims}");
    }
    fixture.provider.set_claims(json!({}));
    for signer in [Signer::Unsigned, Signer::OtherKey, Signer::ClientSecret] {
        fixture.provider.sign_with(signer);
        let done = fixture.sign_in().await;
        assert_eq!(redirect_target(&done), "/?sign-in=untrusted", "{signer:?}");
        assert_eq!(session_cookie(&done), None, "{signer:?}");
    }
    fixture.provider.sign_with(Signer::Provider);
    assert_eq!(redirect_target(&fixture.sign_in().await), "/");
    fixture.server.finish().await;
}

async fn a_callback_works_once_in_the_same_browser(fixture: Fixture) {
    let server = &fixture.server;
    let (there, cookie) = start_sign_in(server).await;
    let back = callback_address(server, &there).await;
    let (_, another) = start_sign_in(server).await;
    for strange in ["", another.as_str(), "binnacle_provider=1.x"] {
        let done = follow_callback(server, &back, strange).await;
        assert_eq!(redirect_target(&done), "/?sign-in=over", "{strange}");
    }
    let (code, _) = back.split_once("&state=").unwrap();
    let forged = format!("{code}&state=x");
    let done = follow_callback(server, &forged, &cookie).await;
    assert_eq!(redirect_target(&done), "/?sign-in=over");
    assert_eq!(
        redirect_target(&follow_callback(server, &back, &cookie).await),
        "/"
    );
    let repeated = follow_callback(server, &back, &cookie).await;
    assert_eq!(redirect_target(&repeated), "/?sign-in=over");
    assert_eq!(session_cookie(&repeated), None);

    // A redeemed code with an unused sign-in.
    let (there, cookie) = start_sign_in(server).await;
    let fresh = callback_address(server, &there).await;
    let (_, state) = fresh.split_once("&state=").unwrap();
    let replayed = format!("{code}&state={state}");
    let done = follow_callback(server, &replayed, &cookie).await;
    assert_eq!(redirect_target(&done), "/?sign-in=untrusted");

    let (there, cookie) = start_sign_in(server).await;
    let back = callback_address(server, &there).await;
    server.advance(600.0);
    let late = follow_callback(server, &back, &cookie).await;
    assert_eq!(redirect_target(&late), "/?sign-in=over");
    fixture.server.finish().await;
}

async fn an_unverified_or_unknown_email_gives_no_access_and_no_account(fixture: Fixture) {
    fixture.server.admin("kate").await;
    let cases = [
        (json!({ "email_verified": false }), "unverified"),
        (json!({ "email_verified": null }), "unverified"),
        (json!({ "email": null }), "unverified"),
        (json!({ "email": "eve@example.com" }), "unknown"),
        (json!({ "email": "\u{0}" }), "unknown"),
        // A Kelvin sign, whose lower case is k.
        (json!({ "email": "\u{212a}ate@example.com" }), "unknown"),
        (json!({ "sub": "\u{0}" }), "untrusted"),
    ];
    for (claims, why) in cases {
        fixture.provider.set_claims(claims.clone());
        let done = fixture.sign_in().await;
        assert_eq!(
            redirect_target(&done),
            format!("/?sign-in={why}"),
            "{claims}"
        );
        assert_eq!(session_cookie(&done), None, "{claims}");
    }
    let people = fixture.ada.get("/users").await.good();
    assert_eq!(people["items"].as_array().unwrap().len(), 1);
    fixture
        .provider
        .set_claims(json!({ "email": " Ada@Example.COM ", "sub": "person-2" }));
    assert_eq!(fixture.account().await["email"], "ada@example.com");
    fixture.server.finish().await;
}

async fn a_blocked_person_cannot_sign_in_through_the_provider(fixture: Fixture) {
    let viewer = fixture.ada.viewer(&fixture.server).await;
    let claims = json!({ "sub": "person-2", "email": viewer.email });
    fixture.provider.set_claims(claims);
    assert_eq!(fixture.account().await["email"], viewer.email.as_str());
    let people = fixture.ada.get("/users").await.good();
    let id = people["items"][1]["id"].as_str().unwrap().to_owned();
    let path = format!("/users/{id}");
    let change = |disabled: bool| {
        let request = fixture.ada.request(Method::PATCH, &path);
        ApiResponse::send(request.json(&json!({ "disabled": disabled })))
    };
    change(true).await.good();
    assert_eq!(
        redirect_target(&fixture.sign_in().await),
        "/?sign-in=unknown"
    );
    change(false).await.good();
    assert_eq!(fixture.account().await["email"], viewer.email.as_str());
    let gone = ApiResponse::send(fixture.ada.request(Method::DELETE, &path)).await;
    assert_eq!(gone.status, 204, "{gone:?}");
    assert_eq!(
        redirect_target(&fixture.sign_in().await),
        "/?sign-in=unknown"
    );
    fixture.server.finish().await;
}

async fn guessed_callback_codes_are_rate_limited(fixture: Fixture) {
    let server = &fixture.server;
    let (secret, _) = set_up(server, &fixture.ada).await;
    let (there, cookie) = start_sign_in(server).await;
    let back = callback_address(server, &there).await;
    follow_callback(server, &back, &cookie).await;
    for _ in 0..5 {
        let wrong = send_code(server, &cookie, "a guess").await;
        assert_eq!(wrong.problem(), "wrong-code");
    }
    let code = app_code(&secret, now_s(server));
    let slowed = send_code(server, &cookie, &code).await;
    assert_eq!(slowed.problem(), "throttled");
    let by_password = try_sign_in(server, "ada@example.com", PASSWORD).await;
    assert_eq!(by_password.problem(), "throttled");
    server.advance(2.0);
    send_code(server, &cookie, &code).await.good();
    fixture.server.finish().await;
}

async fn concurrent_callback_guesses_cannot_bypass_the_count(fixture: Fixture) {
    let server = &fixture.server;
    set_up(server, &fixture.ada).await;
    let (there, cookie) = start_sign_in(server).await;
    let back = callback_address(server, &there).await;
    follow_callback(server, &back, &cookie).await;
    let guesses = (0..40).map(|_| send_code(server, &cookie, "a guess"));
    let responses = join_all(guesses).await;
    let taken = responses.iter().filter(|one| one.problem() == "wrong-code");
    assert!(taken.count() <= 10, "{responses:?}");
    fixture.server.finish().await;
}

async fn failures_from_one_address_are_rate_limited(fixture: Fixture) {
    fixture
        .provider
        .set_claims(json!({ "email": "eve@example.com" }));
    for _ in 0..50 {
        assert_eq!(
            redirect_target(&fixture.sign_in().await),
            "/?sign-in=unknown"
        );
    }
    fixture.provider.set_claims(json!({}));
    assert_eq!(
        redirect_target(&fixture.sign_in().await),
        "/?sign-in=throttled"
    );
    fixture.server.advance(1.0);
    assert_eq!(redirect_target(&fixture.sign_in().await), "/");
    fixture.server.finish().await;
}
