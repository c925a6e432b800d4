//! The rate limit of sign-ins: it slows those who guess, and keeps no owner out.

use binnacle_platform::audit::{Refusal, RequestContext};
use binnacle_platform::client_address::Origin;
use binnacle_platform::session::throttle::{self, Subjects};
use binnacle_server_testing::{ApiResponse, DAY_S, PASSWORD, TestServer, on_both, try_sign_in};
use reqwest::Method;
use reqwest::header::SET_COOKIE;
use serde_json::json;
use std::net::IpAddr;

on_both!(
    strangers_guesses_do_not_keep_out_a_browser_that_signed_in_before,
    a_known_browser_is_slowed_down_by_its_own_guesses,
    a_browser_is_known_for_its_own_user_alone,
    an_open_session_is_not_held_up_by_strangers,
    a_clock_that_was_wrong_locks_nobody_out,
    guesses_from_one_site_are_counted_together,
    nobody_signs_in_as_a_network,
);

/// Signs in from a browser with a cookie of a device.
async fn sign_in(server: &TestServer, device: &str, email: &str, password: &str) -> ApiResponse {
    let request = server.http.post(format!("{}/api/v1/session", server.url));
    let request = request.header("cookie", device);
    ApiResponse::send(request.json(&json!({ "email": email, "password": password }))).await
}

/// Returns the cookie of the device that a sign-in has set.
fn device(response: &ApiResponse) -> String {
    let set = response.headers.get_all(SET_COOKIE).iter();
    let mut pairs = set.map(|cookie| cookie.to_str().unwrap().split(';').next().unwrap());
    let found = pairs.find(|pair| pair.starts_with("binnacle_device="));
    found.unwrap().to_owned()
}

/// Guesses a password eight times from a browser that nobody signed in from.
async fn guess(server: &TestServer, email: &str) {
    for _ in 0..8 {
        assert_ne!(try_sign_in(server, email, "a guess").await.status, 200);
    }
    let stranger = try_sign_in(server, email, PASSWORD).await;
    assert_eq!(stranger.problem(), "throttled");
}

async fn strangers_guesses_do_not_keep_out_a_browser_that_signed_in_before(server: TestServer) {
    let ada = server.admin("ada").await;
    let known = device(&try_sign_in(&server, &ada.email, PASSWORD).await);
    server.advance(30.0 * DAY_S);
    guess(&server, &ada.email).await;
    let owner = sign_in(&server, &known, &ada.email, PASSWORD).await;
    assert_eq!(owner.status, 200, "{owner:?}");
    // Each sign-in replaces the cookie, and strangers still wait.
    assert_ne!(device(&owner), known);
    let stranger = try_sign_in(&server, &ada.email, PASSWORD).await;
    assert_eq!(stranger.problem(), "throttled");
    server.finish().await;
}

async fn a_known_browser_is_slowed_down_by_its_own_guesses(server: TestServer) {
    let ada = server.admin("ada").await;
    let known = device(&try_sign_in(&server, &ada.email, PASSWORD).await);
    for _ in 0..5 {
        let wrong = sign_in(&server, &known, &ada.email, "a guess").await;
        assert_eq!(wrong.problem(), "wrong-password");
    }
    let slowed = sign_in(&server, &known, &ada.email, PASSWORD).await;
    assert_eq!(slowed.problem(), "throttled");
    assert_eq!(try_sign_in(&server, &ada.email, PASSWORD).await.status, 200);
    server.advance(1.0);
    let right = sign_in(&server, &known, &ada.email, PASSWORD).await;
    assert_eq!(right.status, 200);
    server.finish().await;
}

async fn a_browser_is_known_for_its_own_user_alone(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let eves = device(&try_sign_in(&server, &eve.email, PASSWORD).await);
    guess(&server, &ada.email).await;
    for foreign in [eves.as_str(), "binnacle_device=invented"] {
        let refused = sign_in(&server, foreign, &ada.email, PASSWORD).await;
        assert_eq!(refused.problem(), "throttled", "{foreign}");
    }
    server.finish().await;
}

async fn an_open_session_is_not_held_up_by_strangers(server: TestServer) {
    let ada = server.admin("ada").await;
    guess(&server, &ada.email).await;
    let change = json!({ "current": PASSWORD, "new": "seven gulls over the quay" });
    let changed = ada.request(Method::PUT, "/me/password").json(&change);
    assert_eq!(ApiResponse::send(changed).await.status, 204);
    server.finish().await;
}

async fn a_clock_that_was_wrong_locks_nobody_out(server: TestServer) {
    let ada = server.admin("ada").await;
    let wrong_by_s = 3650.0 * DAY_S;
    server.advance(wrong_by_s);
    guess(&server, &ada.email).await;
    server.advance(-wrong_by_s);
    assert_eq!(try_sign_in(&server, &ada.email, PASSWORD).await.status, 200);
    // What was counted at the wrong time does not add to what is counted now.
    let wrong = try_sign_in(&server, &ada.email, "a guess").await;
    assert_eq!(wrong.problem(), "wrong-password");
    assert_eq!(try_sign_in(&server, &ada.email, PASSWORD).await.status, 200);
    server.finish().await;
}

async fn nobody_signs_in_as_a_network(server: TestServer) {
    // A name under which failures of this network are counted, if names are not kept apart.
    for _ in 0..5 {
        try_sign_in(&server, "address 127.0.0.1", "a guess").await;
    }
    for number in 0..45 {
        let email = format!("{number}\u{7}@example.com");
        let refused = try_sign_in(&server, &email, "a guess").await;
        assert_eq!(refused.problem(), "wrong-password", "{number}");
    }
    server.finish().await;
}

async fn guesses_from_one_site_are_counted_together(server: TestServer) {
    let now = server.app.clock.now();
    let request = RequestContext::of_command(&server.app.db, "test", now.into());
    let from = |address: String| {
        let address: IpAddr = address.parse().unwrap();
        Subjects::address(&Origin {
            address: Some(address),
            ..Origin::default()
        })
    };
    for network in 0..200 {
        let subjects = from(format!("2001:db8:1:{network:x}::7"));
        throttle::check(&request, &subjects, now).await.unwrap();
        throttle::note_failure(&request, &subjects, Refusal::WrongPassword, now)
            .await
            .unwrap();
    }
    let elsewhere = from("2001:db8:2::7".to_owned());
    throttle::check(&request, &elsewhere, now).await.unwrap();
    let same_site = from("2001:db8:1:ffff::7".to_owned());
    let refused = throttle::check(&request, &same_site, now).await;
    assert!(refused.is_err());
    server.finish().await;
}
