//! Time of a letter: at once, after quiet hours, with a digest, or never.

use super::{put_settings, sent_subjects};
use binnacle_planning::notifications::send_due;
use binnacle_server_testing::HOUR_S;
use binnacle_server_testing::alerts::{set_alert_limits, ship_with_model};
use binnacle_server_testing::mail::{add, deliver};
use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Relay, TestServer};
use reqwest::Method;
use serde_json::json;

on_both!(
    letters_of_quiet_hours_are_sent_together_afterwards,
    notifications_read_in_quiet_hours_are_not_mailed,
    a_critical_alert_passes_quiet_hours_and_a_warning_does_not,
    a_notified_person_gets_one_letter_when_an_alert_sinks_or_ends,
    a_person_on_the_mailing_list_gets_one_letter_of_an_alert,
    a_digest_contains_everything_since_the_last_one,
    two_servers_make_one_letter,
    waiting_letters_follow_new_settings,
    a_removed_person_gets_no_more_letters,
);

/// Returns settings with quiet hours until 09:30 in Madrid, where every test begins at 08:00.
fn quiet_hours() -> serde_json::Value {
    json!({
        "time_zone": "Europe/Madrid", "quiet_hours": { "from": "21:00", "to": "09:30" },
        "digest": { "every": "day", "at": "12:00" },
    })
}

async fn letters_of_quiet_hours_are_sent_together_afterwards(server: TestServer) {
    let relay = Relay::start().await;
    let parties = OfferParties::planned(&server, 2).await;
    put_settings(&parties.ada, &quiet_hours()).await.good();
    parties
        .post(&parties.ada, "/offer", &parties.offer())
        .await
        .good();
    let [(_, rosa), (_, juan)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    parties.post(rosa, "/decline", &json!({})).await;
    parties.post(juan, "/accept", &json!({})).await.good();
    // The firms have no quiet hours.
    let offered = "Nao: a job is offered to you at Bilbao";
    assert_eq!(sent_subjects(&server, &relay).await, [offered; 2]);
    server.advance(1.5 * HOUR_S - 1.0);
    assert_eq!(sent_subjects(&server, &relay).await.len(), 2);
    server.advance(1.0);
    let all = sent_subjects(&server, &relay).await;
    assert_eq!(all[2..], ["2 notifications from Binnacle"]);
    let letter = relay.letters().pop().unwrap();
    assert_eq!(letter.to, ["<ada@example.com>"]);
    let read = binnacle_server_testing::mail::read(&letter);
    let text = read["text"].as_str().unwrap();
    let (last, first) = (text.find("juan accepts"), text.find("rosa declines"));
    assert!(last.unwrap() < first.unwrap(), "{text}");
    // The text and the link of each, as in a letter of its own.
    let page = format!("https://binnacle.example/work-orders/{}", parties.order);
    assert_eq!(text.matches(&page).count(), 2, "{text}");
    let listed = parties.ada.get("/notifications").await.good();
    for one in listed["items"].as_array().unwrap() {
        for line in one["text"].as_str().unwrap().lines() {
            assert!(text.contains(line), "{line:?} is not in {text}");
        }
    }
    assert!(
        text.contains("https://binnacle.example/notifications"),
        "{text}"
    );
    server.advance(24.0 * HOUR_S);
    assert_eq!(sent_subjects(&server, &relay).await.len(), 3);
    server.finish().await;
}

async fn notifications_read_in_quiet_hours_are_not_mailed(server: TestServer) {
    let relay = Relay::start().await;
    let parties = OfferParties::offered(&server, 1).await;
    put_settings(&parties.ada, &quiet_hours()).await.good();
    let rosa = &parties.firms[0].1;
    parties.post(rosa, "/accept", &json!({})).await.good();
    parties.post(rosa, "/on-board", &json!({})).await.good();
    let listed = parties.ada.get("/notifications").await.good();
    let first = json!({ "until": listed["items"][1]["id"] });
    parties.ada.post("/notifications/read", &first).await;
    assert_eq!(sent_subjects(&server, &relay).await.len(), 1);
    server.advance(2.0 * HOUR_S);
    let all = sent_subjects(&server, &relay).await;
    assert_eq!(all[1..], ["Nao: the adjuster is on board at Bilbao"]);
    server.finish().await;
}

async fn a_critical_alert_passes_quiet_hours_and_a_warning_does_not(server: TestServer) {
    let relay = Relay::start().await;
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    let mut settings = quiet_hours();
    settings["ways"] = json!({ "alert": "mail" });
    put_settings(&ada, &settings).await.good();
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    assert_eq!(sent_subjects(&server, &relay).await, [""; 0]);
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    let critical = "Nao: critical, deviation over the limit";
    assert_eq!(sent_subjects(&server, &relay).await, [critical]);
    // It does not wait for a digest either.
    settings["ways"] = json!({ "alert": "digest" });
    put_settings(&ada, &settings).await.good();
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    assert_eq!(sent_subjects(&server, &relay).await, [critical; 2]);
    // Only a person who turned it off gets none.
    settings["ways"] = json!({ "alert": "off" });
    put_settings(&ada, &settings).await.good();
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    assert_eq!(sent_subjects(&server, &relay).await.len(), 2);
    server.finish().await;
}

async fn a_notified_person_gets_one_letter_when_an_alert_sinks_or_ends(server: TestServer) {
    let relay = Relay::start().await;
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    put_settings(&ada, &json!({ "ways": { "alert": "mail" } }))
        .await
        .good();
    let vessel = ada.get(&nao.path("")).await.good();
    let worst_deg = vessel["worst"]["deviation_deg"].as_f64().unwrap().abs();
    // Below the limit, but not far enough to clear the alert.
    let sunk_deg = worst_deg + 0.45;
    for deviation_deg in [1.0, 2.9, sunk_deg, 45.0, 2.9, sunk_deg, 2.9, 45.0] {
        set_alert_limits(
            &server,
            &ada,
            &nao,
            json!({ "deviation_deg": deviation_deg }),
        )
        .await;
        sent_subjects(&server, &relay).await;
    }
    let [critical, warning, sunk, over] = ["critical", "warning", "only notice now", "over"]
        .map(|state| format!("Nao: {state}, deviation over the limit"));
    let all = sent_subjects(&server, &relay).await;
    assert_eq!(
        all,
        [&critical, &sunk, &warning, &sunk, &warning, &over].map(String::as_str)
    );
    server.finish().await;
}

async fn a_person_on_the_mailing_list_gets_one_letter_of_an_alert(server: TestServer) {
    let relay = Relay::start().await;
    let ada = server.admin("ada").await;
    add(&ada, "Ada@example.com", "warning").await;
    let nao = ship_with_model(&server, &ada).await;
    put_settings(&ada, &json!({ "ways": { "alert": "mail" } }))
        .await
        .good();
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let all = sent_subjects(&server, &relay).await;
    assert_eq!(all, ["Nao: warning, deviation over the limit"]);
    assert_eq!(super::subjects_of(&ada).await, all);
    server.finish().await;
}

async fn a_digest_contains_everything_since_the_last_one(server: TestServer) {
    let relay = Relay::start().await;
    let parties = OfferParties::offered(&server, 1).await;
    let rosa = &parties.firms[0].1;
    let weekly = json!({
        "time_zone": "Asia/Singapore", "ways": { "answered": "digest", "on_board": "digest" },
        "digest": { "every": "week", "on": "sunday", "at": "09:00" },
    });
    let stored = put_settings(&parties.ada, &weekly).await.good();
    assert_eq!(stored["next_digest_at"], "2026-11-22T01:00:00Z");
    parties.post(rosa, "/accept", &json!({})).await.good();
    assert_eq!(sent_subjects(&server, &relay).await.len(), 1);
    server.advance(18.0 * HOUR_S);
    let all = sent_subjects(&server, &relay).await;
    assert_eq!(all[1..], ["Nao: rosa accepts the job at Bilbao"]);
    parties.post(rosa, "/on-board", &json!({})).await.good();
    server.advance(6.9 * 24.0 * HOUR_S);
    assert_eq!(sent_subjects(&server, &relay).await.len(), 2);
    server.advance(0.1 * 24.0 * HOUR_S);
    let all = sent_subjects(&server, &relay).await;
    assert_eq!(all[2..], ["Nao: the adjuster is on board at Bilbao"]);
    server.finish().await;
}

async fn two_servers_make_one_letter(server: TestServer) {
    let relay = Relay::start().await;
    let _trade = OfferParties::offered(&server, 1).await;
    let other = server.second_server().await;
    let (one, two) = tokio::join!(send_due(&server.app), send_due(&other));
    one.unwrap();
    two.unwrap();
    assert_eq!(deliver(&server, &relay).await.len(), 1);
    other.db.close().await;
    server.finish().await;
}

async fn waiting_letters_follow_new_settings(server: TestServer) {
    let relay = Relay::start().await;
    let parties = OfferParties::offered(&server, 1).await;
    put_settings(&parties.ada, &quiet_hours()).await.good();
    parties
        .post(&parties.firms[0].1, "/accept", &json!({}))
        .await
        .good();
    assert_eq!(sent_subjects(&server, &relay).await.len(), 1);
    put_settings(&parties.ada, &json!({})).await.good();
    let all = sent_subjects(&server, &relay).await;
    assert_eq!(all[1..], ["Nao: rosa accepts the job at Bilbao"]);
    server.finish().await;
}

async fn a_removed_person_gets_no_more_letters(server: TestServer) {
    let relay = Relay::start().await;
    let parties = OfferParties::offered(&server, 1).await;
    let viewer = parties.ada.viewer(&server).await;
    put_settings(&viewer, &json!({ "ways": { "answered": "mail" } }))
        .await
        .good();
    parties
        .post(&parties.firms[0].1, "/accept", &json!({}))
        .await
        .good();
    send_due(&server.app).await.unwrap();
    let id = viewer.get("/me").await.good()["user_id"].clone();
    let path = format!("/users/{}", id.as_str().unwrap());
    let removed = ApiResponse::send(parties.ada.request(Method::DELETE, &path)).await;
    assert_eq!(removed.status, 204, "{removed:?}");
    deliver(&server, &relay).await;
    let to: Vec<_> = relay
        .letters()
        .iter()
        .flat_map(|letter| letter.to.clone())
        .collect();
    assert_eq!(to.len(), 2, "{to:?}");
    assert!(!to.iter().any(|to| to.contains("viewer")), "{to:?}");
    server.finish().await;
}
