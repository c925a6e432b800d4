//! Retries of mail when the relay is busy, slow or down.

use binnacle_platform::outbox::{self, Sent};
use binnacle_server_testing::DAY_S;
use binnacle_server_testing::alerts::{set_alert_limits, ship_with_model};
use binnacle_server_testing::mail::{add, deliver, mailer, path, subjects, test};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{Behaviour, Person, Relay, Stage, TestServer};
use serde_json::json;

on_both!(
    a_temporary_failure_is_retried_and_a_refusal_is_final,
    a_hanging_or_dropped_session_is_retried,
    an_accepted_letter_is_not_sent_again,
    a_letter_with_a_lost_reply_is_sent_again_with_its_id,
    letters_are_sent_in_order_and_survive_a_restart,
    a_relay_down_for_a_day_leaves_a_dead_letter_that_can_be_resent,
    two_servers_send_a_letter_once,
);

async fn a_temporary_failure_is_retried_and_a_refusal_is_final(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    test(&ada, &bridge).await;
    for busy in [
        Behaviour::Reply(Stage::Greeting, "421 too busy"),
        // Not a reply to this letter: the relay may recover.
        Behaviour::Reply(Stage::Greeting, "554 no service here"),
        Behaviour::Reply(Stage::Recipient, "450 greylisted"),
        Behaviour::Reply(Stage::Data, "451 try later"),
        Behaviour::Reply(Stage::End, "452 disk full"),
    ] {
        relay.behave_next(busy);
        assert_eq!(deliver(&server, &relay).await, [Sent::Failed], "{busy:?}");
        assert_eq!(
            deliver(&server, &relay).await,
            [],
            "before the pause is over"
        );
        server.advance(3600.0);
    }
    let listed = ada.get(&path(&bridge, "/deliveries")).await.good();
    assert_eq!(listed["items"][0]["last_status"], 452);
    let problem = listed["items"][0]["last_error"].as_str().unwrap();
    assert!(problem.contains("disk full"), "{problem}");
    assert_eq!(deliver(&server, &relay).await, [Sent::Delivered]);

    for refusal in [
        Behaviour::Reply(Stage::Recipient, "550 no such mailbox"),
        Behaviour::Reply(Stage::End, "554 not wanted"),
    ] {
        let letter = test(&ada, &bridge).await;
        relay.behave_next(refusal);
        assert_eq!(deliver(&server, &relay).await, [Sent::Dead], "{refusal:?}");
        let again = format!("/deliveries/{}/resend", letter["id"].as_str().unwrap());
        ada.post(&path(&bridge, &again), &json!({})).await.good();
        assert_eq!(deliver(&server, &relay).await, [Sent::Delivered]);
    }
    server.finish().await;
}

async fn a_hanging_or_dropped_session_is_retried(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    test(&ada, &bridge).await;
    for bad in [
        Behaviour::Hang(Stage::Greeting),
        Behaviour::Hang(Stage::Data),
        Behaviour::Drop(Stage::Greeting),
        Behaviour::Drop(Stage::Recipient),
        Behaviour::Reply(Stage::Greeting, "gibberish"),
    ] {
        relay.behave_next(bad);
        assert_eq!(deliver(&server, &relay).await, [Sent::Failed], "{bad:?}");
        server.advance(3600.0);
    }
    assert_eq!(relay.letters(), []);
    assert_eq!(deliver(&server, &relay).await, [Sent::Delivered]);
    assert_eq!(relay.letters().len(), 1);
    server.finish().await;
}

async fn an_accepted_letter_is_not_sent_again(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    for bad in [
        Behaviour::Drop(Stage::Quit),
        Behaviour::Hang(Stage::Quit),
        Behaviour::Reply(Stage::Quit, "554 go away"),
    ] {
        test(&ada, &bridge).await;
        relay.behave_next(bad);
        assert_eq!(deliver(&server, &relay).await, [Sent::Delivered], "{bad:?}");
    }
    server.advance(2.0 * DAY_S);
    assert_eq!(deliver(&server, &relay).await, []);
    assert_eq!(relay.letters().len(), 3);
    server.finish().await;
}

async fn a_letter_with_a_lost_reply_is_sent_again_with_its_id(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    test(&ada, &bridge).await;
    relay.behave_next(Behaviour::Drop(Stage::End));
    assert_eq!(deliver(&server, &relay).await, [Sent::Failed]);
    server.advance(3600.0);
    assert_eq!(deliver(&server, &relay).await, [Sent::Delivered]);
    let got = relay.letters();
    assert_eq!(got.len(), 2);
    assert_eq!(got[0], got[1], "the same letter, to the byte");
    server.finish().await;
}

async fn letters_are_sent_in_order_and_survive_a_restart(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    add(&ada, "bridge@example.com", "notice").await;
    let nao = ship_with_model(&server, &ada).await;
    for deviation_deg in [2.5, 1.0, 45.0] {
        set_alert_limits(
            &server,
            &ada,
            &nao,
            json!({ "deviation_deg": deviation_deg }),
        )
        .await;
    }
    relay.behave_next(Behaviour::Reply(Stage::Data, "451 try later"));
    assert_eq!(
        deliver(&server, &relay).await,
        [Sent::Failed],
        "the next ones wait"
    );
    let server = server.restart().await;
    server.advance(60.0);
    assert_eq!(deliver(&server, &relay).await, [Sent::Delivered; 3]);
    let states: Vec<String> = subjects(&relay)
        .iter()
        .map(|subject| subject.split([':', ',']).nth(1).unwrap().trim().to_owned())
        .collect();
    assert_eq!(states, ["warning", "critical", "over"]);
    server.finish().await;
}

async fn a_relay_down_for_a_day_leaves_a_dead_letter_that_can_be_resent(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    let letter = test(&ada, &bridge).await;
    let (mut tries, mut last) = (0, None);
    while last != Some(Sent::Dead) {
        relay.behave_next(Behaviour::Drop(Stage::Greeting));
        let sent = deliver(&server, &relay).await;
        last = sent.last().copied().or(last);
        tries += sent.len();
        assert!(tries < 50, "it is never given up");
        server.advance(3600.0);
    }
    assert!((15..=26).contains(&tries), "{tries} tries in a day");
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    assert_eq!(ada.get(&path(&bridge, "")).await.good()["dead"], 1);
    let dead = ada
        .get(&path(&bridge, "/deliveries?state=dead"))
        .await
        .good();
    assert_eq!(dead["items"][0]["id"], letter["id"]);
    let again = format!("/deliveries/{}/resend", letter["id"].as_str().unwrap());
    ada.post(&path(&bridge, &again), &json!({})).await.good();
    assert_eq!(
        deliver(&server, &Relay::start().await).await,
        [Sent::Delivered]
    );
    server.finish().await;
}

async fn two_servers_send_a_letter_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let relay = Relay::start().await;
    let bridge = add(&ada, "bridge@example.com", "warning").await;
    test(&ada, &bridge).await;
    let second = server.second_server().await;
    let mailer = mailer(&relay);
    let (one, other) = tokio::join!(
        outbox::step(&server.app, &mailer),
        outbox::step(&second, &mailer)
    );
    let mut sent = [one.unwrap(), other.unwrap()];
    sent.sort_by_key(Option::is_some);
    assert_eq!(sent, [None, Some(Sent::Delivered)]);
    assert_eq!(relay.letters().len(), 1);
    second.db.close().await;
    server.finish().await;
}
