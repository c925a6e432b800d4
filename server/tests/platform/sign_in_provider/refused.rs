//! Everything that does not hold, and whoever is not let in.

use super::{World, at_provider, begin, come_back, outcome, send_code, session};
use crate::second_factor::{app_code, now_s, set_up};
use binnacle_server_testing::{Answer, Engine, PASSWORD, Signer, attempt};
use futures_util::future::join_all;
use reqwest::Method;
use serde_json::json;

with_provider!(
    a_token_that_does_not_hold_signs_nobody_in,
    a_sign_in_comes_back_once_to_the_browser_that_began_it,
    nobody_is_let_in_or_made_by_an_email_that_is_not_verified_or_not_known,
    who_may_not_sign_in_may_not_by_the_provider_either,
    guesses_at_a_code_are_slowed_down,
    guesses_at_once_do_not_outrun_the_count,
    what_fails_at_one_address_is_slowed_down,
);

async fn a_token_that_does_not_hold_signs_nobody_in(world: World) {
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
    world.shore.finish().await;
}

async fn a_sign_in_comes_back_once_to_the_browser_that_began_it(world: World) {
    let shore = &world.shore;
    let (there, cookie) = begin(shore).await;
    let back = at_provider(shore, &there).await;
    let (_, another) = begin(shore).await;
    for strange in ["", another.as_str(), "binnacle_provider=1.x"] {
        let done = come_back(shore, &back, strange).await;
        assert_eq!(outcome(&done), "/?sign-in=over", "{strange}");
    }
    let (code, _) = back.split_once("&state=").unwrap();
    let forged = format!("{code}&state=x");
    let done = come_back(shore, &forged, &cookie).await;
    assert_eq!(outcome(&done), "/?sign-in=over");
    assert_eq!(outcome(&come_back(shore, &back, &cookie).await), "/");
    let again = come_back(shore, &back, &cookie).await;
    assert_eq!(outcome(&again), "/?sign-in=over");
    assert_eq!(session(&again), None);

    // A code that was redeemed, with a sign-in that was not.
    let (there, cookie) = begin(shore).await;
    let fresh = at_provider(shore, &there).await;
    let (_, state) = fresh.split_once("&state=").unwrap();
    let replayed = format!("{code}&state={state}");
    let done = come_back(shore, &replayed, &cookie).await;
    assert_eq!(outcome(&done), "/?sign-in=untrusted");

    let (there, cookie) = begin(shore).await;
    let back = at_provider(shore, &there).await;
    shore.advance(600.0);
    let late = come_back(shore, &back, &cookie).await;
    assert_eq!(outcome(&late), "/?sign-in=over");
    world.shore.finish().await;
}

async fn nobody_is_let_in_or_made_by_an_email_that_is_not_verified_or_not_known(world: World) {
    world.shore.admin("kate").await;
    let cases = [
        (json!({ "email_verified": false }), "unverified"),
        (json!({ "email_verified": null }), "unverified"),
        (json!({ "email": null }), "unverified"),
        (json!({ "email": "eve@example.com" }), "unknown"),
        (json!({ "email": "\u{0}" }), "unknown"),
        // A Kelvin sign, which is a k in lower case.
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
    world.shore.finish().await;
}

async fn who_may_not_sign_in_may_not_by_the_provider_either(world: World) {
    let viewer = world.ada.viewer(&world.shore).await;
    let claims = json!({ "sub": "person-2", "email": viewer.email });
    world.provider.says(claims);
    assert_eq!(world.me().await["email"], viewer.email.as_str());
    let people = world.ada.get("/users").await.good();
    let id = people["items"][1]["id"].as_str().unwrap().to_owned();
    let path = format!("/users/{id}");
    let change = |disabled: bool| {
        let request = world.ada.request(Method::PATCH, &path);
        Answer::of(request.json(&json!({ "disabled": disabled })))
    };
    change(true).await.good();
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unknown");
    change(false).await.good();
    assert_eq!(world.me().await["email"], viewer.email.as_str());
    let gone = Answer::of(world.ada.request(Method::DELETE, &path)).await;
    assert_eq!(gone.status, 204, "{gone:?}");
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unknown");
    world.shore.finish().await;
}

async fn guesses_at_a_code_are_slowed_down(world: World) {
    let shore = &world.shore;
    let (secret, _) = set_up(shore, &world.ada).await;
    let (there, cookie) = begin(shore).await;
    let back = at_provider(shore, &there).await;
    come_back(shore, &back, &cookie).await;
    for _ in 0..5 {
        let wrong = send_code(shore, &cookie, "a guess").await;
        assert_eq!(wrong.problem(), "wrong-code");
    }
    let code = app_code(&secret, now_s(shore));
    let slowed = send_code(shore, &cookie, &code).await;
    assert_eq!(slowed.problem(), "throttled");
    let by_password = attempt(shore, "ada@example.com", PASSWORD).await;
    assert_eq!(by_password.problem(), "throttled");
    shore.advance(2.0);
    send_code(shore, &cookie, &code).await.good();
    world.shore.finish().await;
}

async fn guesses_at_once_do_not_outrun_the_count(world: World) {
    let shore = &world.shore;
    set_up(shore, &world.ada).await;
    let (there, cookie) = begin(shore).await;
    let back = at_provider(shore, &there).await;
    come_back(shore, &back, &cookie).await;
    let guesses = (0..40).map(|_| send_code(shore, &cookie, "a guess"));
    let answers = join_all(guesses).await;
    let taken = answers.iter().filter(|one| one.problem() == "wrong-code");
    assert!(taken.count() <= 10, "{answers:?}");
    world.shore.finish().await;
}

async fn what_fails_at_one_address_is_slowed_down(world: World) {
    world.provider.says(json!({ "email": "eve@example.com" }));
    for _ in 0..50 {
        assert_eq!(outcome(&world.sign_in().await), "/?sign-in=unknown");
    }
    world.provider.says(json!({}));
    assert_eq!(outcome(&world.sign_in().await), "/?sign-in=throttled");
    world.shore.advance(1.0);
    assert_eq!(outcome(&world.sign_in().await), "/");
    world.shore.finish().await;
}
