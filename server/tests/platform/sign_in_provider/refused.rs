//! Invalid tokens and sign-ins, and people who may not sign in.

use super::{World, at_provider, begin, come_back, outcome, send_code, session};
use crate::second_factor::{app_code, now_s, set_up};
use binnacle_server_testing::{ApiResponse, Engine, PASSWORD, Signer, attempt};
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

async fn an_invalid_id_token_signs_nobody_in(world: World) {
    let wrong = [
        json!({ "nonce": "of another sign-in" }),
        json!({ "nonce": null }),
        json!({ "aud": "another" }),
        json!({ "aud": ["binnacle", "another"] }),
        json!({ "iss": "https://another.example" }),
        json!({ "exp": 1_795_244_399 }),
    ];
    for claims in wrong {
        world.provider.says(claims.clone());
        let done = world.sign_in().await;
        assert_eq!(outcome(&done), "/?sign-in=untrusted", "{claims}");
        assert_eq!(session(&done), None, "{claims}");
    }
    world.provider.says(json!({}));
    for signer in [Signer::Nobody, Signer::Stranger, Signer::Secret] {
        world.provider.signed_by(signer);
        let done = world.sign_in().await;
        assert_eq!(outcome(&done), "/?sign-in=untrusted", "{signer:?}");
        assert_eq!(session(&done), None, "{signer:?}");
    }
    world.provider.signed_by(Signer::Itself);
    assert_eq!(outcome(&world.sign_in().await), "/");
    world.server.finish().await;
}

async fn a_callback_works_once_in_the_same_browser(world: World) {
    let server = &world.server;
    let (there, cookie) = begin(server).await;
    let back = at_provider(server, &there).await;
    let (_, another) = begin(server).await;
    for strange in ["", another.as_str(), "binnacle_provider=1.x"] {
        let done = come_back(server, &back, strange).await;
        assert_eq!(outcome(&done), "/?sign-in=over", "{strange}");
    }
    let (code, _) = back.split_once("&state=").unwrap();
    let forged = format!("{code}&state=x");
    let done = come_back(server, &forged, &cookie).await;
    assert_eq!(outcome(&done), "/?sign-in=over");
    assert_eq!(outcome(&come_back(server, &back, &cookie).await), "/");
    let again = come_back(server, &back, &cookie).await;
    assert_eq!(outcome(&again), "/?sign-in=over");
    assert_eq!(session(&again), None);

    // A redeemed code with an unused sign-in.
    let (there, cookie) = begin(server).await;
    let fresh = at_provider(server, &there).await;
    let (_, state) = fresh.split_once("&state=").unwrap();
    let replayed = format!("{code}&state={state}");
    let done = come_back(server, &replayed, &cookie).await;
    assert_eq!(outcome(&done), "/?sign-in=untrusted");

    let (there, cookie) = begin(server).await;
    let back = at_provider(server, &there).await;
    server.advance(600.0);
    let late = come_back(server, &back, &cookie).await;
    assert_eq!(outcome(&late), "/?sign-in=over");
    world.server.finish().await;
}

async fn an_unverified_or_unknown_email_gives_no_access_and_no_account(world: World) {
    world.server.admin("kate").await;
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
        world.provider.says(claims.clone());
        let done = world.sign_in().await;
        assert_eq!(outcome(&done), format!("/?sign-in={why}"), "{claims}");
        assert_eq!(session(&done), None, "{claims}");
    }
    let people = world.ada.get("/users").await.good();
    assert_eq!(people["items"].as_array().unwrap().len(), 1);
    world
        .provider
        .says(json!({ "email": " Ada@Example.COM ", "sub": "person-2" }));
    assert_eq!(world.me().await["email"], "ada@example.com");
    world.server.finish().await;
}

async fn a_blocked_person_cannot_sign_in_through_the_provider(world: World) {
    let viewer = world.ada.viewer(&world.server).await;
    let claims = json!({ "sub": "person-2", "email": viewer.email });
    world.provider.says(claims);
    assert_eq!(world.me().await["email"], viewer.email.as_str());
    let people = world.ada.get("/users").await.good();
    let id = people["items"][1]["id"].as_str().unwrap().to_owned();
    let path = format!("/users/{id}");
    let change = |disabled: bool| {
        let request = world.ada.request(Method::PATCH, &path);
        ApiResponse::of(request.json(&json!({ "disabled": disabled })))
    };
    change(true).await.good();
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unknown");
    change(false).await.good();
    assert_eq!(world.me().await["email"], viewer.email.as_str());
    let gone = ApiResponse::of(world.ada.request(Method::DELETE, &path)).await;
    assert_eq!(gone.status, 204, "{gone:?}");
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unknown");
    world.server.finish().await;
}

async fn guessed_callback_codes_are_rate_limited(world: World) {
    let server = &world.server;
    let (secret, _) = set_up(server, &world.ada).await;
    let (there, cookie) = begin(server).await;
    let back = at_provider(server, &there).await;
    come_back(server, &back, &cookie).await;
    for _ in 0..5 {
        let wrong = send_code(server, &cookie, "a guess").await;
        assert_eq!(wrong.problem(), "wrong-code");
    }
    let code = app_code(&secret, now_s(server));
    let slowed = send_code(server, &cookie, &code).await;
    assert_eq!(slowed.problem(), "throttled");
    let by_password = attempt(server, "ada@example.com", PASSWORD).await;
    assert_eq!(by_password.problem(), "throttled");
    server.advance(2.0);
    send_code(server, &cookie, &code).await.good();
    world.server.finish().await;
}

async fn concurrent_callback_guesses_cannot_bypass_the_count(world: World) {
    let server = &world.server;
    set_up(server, &world.ada).await;
    let (there, cookie) = begin(server).await;
    let back = at_provider(server, &there).await;
    come_back(server, &back, &cookie).await;
    let guesses = (0..40).map(|_| send_code(server, &cookie, "a guess"));
    let answers = join_all(guesses).await;
    let taken = answers.iter().filter(|one| one.problem() == "wrong-code");
    assert!(taken.count() <= 10, "{answers:?}");
    world.server.finish().await;
}

async fn failures_from_one_address_are_rate_limited(world: World) {
    world.provider.says(json!({ "email": "eve@example.com" }));
    for _ in 0..50 {
        assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unknown");
    }
    world.provider.says(json!({}));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=throttled");
    world.server.advance(1.0);
    assert_eq!(outcome(&world.sign_in().await), "/");
    world.server.finish().await;
}
