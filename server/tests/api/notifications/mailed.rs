//! When a letter goes: at once, after quiet hours, with a digest, or never.

use super::{mailed, say};
use crate::alerts::{limit, with_model};
use crate::mail::{add, deliver};
use crate::offers::{HOUR_S, Trade};
use crate::on_both;
use crate::support::{Answer, Relay, Shore};
use binnacle_planning::notifications::send_due;
use reqwest::Method;
use serde_json::json;

on_both!(
    quiet_hours_keep_letters_back_and_put_them_together,
    what_is_read_in_quiet_hours_is_not_mailed_after_them,
    a_critical_alert_passes_quiet_hours_and_a_warning_does_not,
    who_was_told_of_an_alert_hears_once_that_it_sank_or_is_over,
    who_is_on_the_mailing_list_gets_no_second_letter_of_an_alert,
    a_digest_has_what_came_since_the_last_one,
    two_servers_make_one_letter,
    what_waits_follows_the_new_settings,
    who_is_removed_gets_no_more_letters,
);

/// 08:00 in Madrid when every test begins, in the quiet hours until 09:30.
fn quiet() -> serde_json::Value {
    json!({
        "time_zone": "Europe/Madrid", "quiet_hours": { "from": "21:00", "to": "09:30" },
        "digest": { "every": "day", "at": "12:00" },
    })
}

async fn quiet_hours_keep_letters_back_and_put_them_together(shore: Shore) {
    let relay = Relay::start().await;
    let trade = Trade::planned(&shore, 2).await;
    say(&trade.ada, &quiet()).await.good();
    trade
        .post(&trade.ada, "/offer", &trade.offer())
        .await
        .good();
    let [(_, rosa), (_, juan)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    trade.post(rosa, "/decline", &json!({})).await;
    trade.post(juan, "/accept", &json!({})).await.good();
    // The firms have no quiet hours.
    let offered = "Nao: a job is offered to you at Bilbao";
    assert_eq!(mailed(&shore, &relay).await, [offered; 2]);
    shore.advance(1.5 * HOUR_S - 1.0);
    assert_eq!(mailed(&shore, &relay).await.len(), 2);
    shore.advance(1.0);
    let all = mailed(&shore, &relay).await;
    assert_eq!(all[2..], ["2 notifications from Binnacle"]);
    let letter = relay.got().pop().unwrap();
    assert_eq!(letter.to, ["<ada@example.com>"]);
    let read = crate::mail::read(&letter);
    let text = read["text"].as_str().unwrap();
    let (last, first) = (text.find("juan accepts"), text.find("rosa declines"));
    assert!(last.unwrap() < first.unwrap(), "{text}");
    // What each has to say, with its own page, as a letter of its own has it.
    let page = format!("https://binnacle.example/work-orders/{}", trade.order);
    assert_eq!(text.matches(&page).count(), 2, "{text}");
    let listed = trade.ada.get("/notifications").await.good();
    for one in listed["items"].as_array().unwrap() {
        for line in one["text"].as_str().unwrap().lines() {
            assert!(text.contains(line), "{line:?} is not in {text}");
        }
    }
    assert!(
        text.contains("https://binnacle.example/notifications"),
        "{text}"
    );
    shore.advance(24.0 * HOUR_S);
    assert_eq!(mailed(&shore, &relay).await.len(), 3);
    shore.finish().await;
}

async fn what_is_read_in_quiet_hours_is_not_mailed_after_them(shore: Shore) {
    let relay = Relay::start().await;
    let trade = Trade::offered(&shore, 1).await;
    say(&trade.ada, &quiet()).await.good();
    let rosa = &trade.firms[0].1;
    trade.post(rosa, "/accept", &json!({})).await.good();
    trade.post(rosa, "/on-board", &json!({})).await.good();
    let listed = trade.ada.get("/notifications").await.good();
    let first = json!({ "until": listed["items"][1]["id"] });
    trade.ada.post("/notifications/read", &first).await;
    assert_eq!(mailed(&shore, &relay).await.len(), 1);
    shore.advance(2.0 * HOUR_S);
    let all = mailed(&shore, &relay).await;
    assert_eq!(all[1..], ["Nao: the adjuster is on board at Bilbao"]);
    shore.finish().await;
}

async fn a_critical_alert_passes_quiet_hours_and_a_warning_does_not(shore: Shore) {
    let relay = Relay::start().await;
    let ada = shore.admin("ada").await;
    let nao = with_model(&shore, &ada).await;
    let mut settings = quiet();
    settings["ways"] = json!({ "alert": "mail" });
    say(&ada, &settings).await.good();
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    assert_eq!(mailed(&shore, &relay).await, [""; 0]);
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    let critical = "Nao: critical, deviation over the limit";
    assert_eq!(mailed(&shore, &relay).await, [critical]);
    // Nor does it wait for a digest.
    settings["ways"] = json!({ "alert": "digest" });
    say(&ada, &settings).await.good();
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    assert_eq!(mailed(&shore, &relay).await, [critical; 2]);
    // Only who wants none of it gets none.
    settings["ways"] = json!({ "alert": "off" });
    say(&ada, &settings).await.good();
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 45.0 })).await;
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 1.0 })).await;
    assert_eq!(mailed(&shore, &relay).await.len(), 2);
    shore.finish().await;
}

async fn who_was_told_of_an_alert_hears_once_that_it_sank_or_is_over(shore: Shore) {
    let relay = Relay::start().await;
    let ada = shore.admin("ada").await;
    let nao = with_model(&shore, &ada).await;
    say(&ada, &json!({ "ways": { "alert": "mail" } }))
        .await
        .good();
    let vessel = ada.get(&nao.path("")).await.good();
    let worst_deg = vessel["worst"]["deviation_deg"].as_f64().unwrap().abs();
    // Below the limit, but not by so much that the alert would be over.
    let sunk_deg = worst_deg + 0.45;
    for deviation_deg in [1.0, 2.9, sunk_deg, 45.0, 2.9, sunk_deg, 2.9, 45.0] {
        limit(
            &shore,
            &ada,
            &nao,
            json!({ "deviation_deg": deviation_deg }),
        )
        .await;
        mailed(&shore, &relay).await;
    }
    let [critical, warning, sunk, over] = ["critical", "warning", "only notice now", "over"]
        .map(|state| format!("Nao: {state}, deviation over the limit"));
    let all = mailed(&shore, &relay).await;
    assert_eq!(
        all,
        [&critical, &sunk, &warning, &sunk, &warning, &over].map(String::as_str)
    );
    shore.finish().await;
}

async fn who_is_on_the_mailing_list_gets_no_second_letter_of_an_alert(shore: Shore) {
    let relay = Relay::start().await;
    let ada = shore.admin("ada").await;
    add(&ada, "Ada@example.com", "warning").await;
    let nao = with_model(&shore, &ada).await;
    say(&ada, &json!({ "ways": { "alert": "mail" } }))
        .await
        .good();
    limit(&shore, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    let all = mailed(&shore, &relay).await;
    assert_eq!(all, ["Nao: warning, deviation over the limit"]);
    assert_eq!(super::told(&ada).await, all);
    shore.finish().await;
}

async fn a_digest_has_what_came_since_the_last_one(shore: Shore) {
    let relay = Relay::start().await;
    let trade = Trade::offered(&shore, 1).await;
    let rosa = &trade.firms[0].1;
    let weekly = json!({
        "time_zone": "Asia/Singapore", "ways": { "answered": "digest", "on_board": "digest" },
        "digest": { "every": "week", "on": "sunday", "at": "09:00" },
    });
    let said = say(&trade.ada, &weekly).await.good();
    assert_eq!(said["next_digest_at"], "2026-11-22T01:00:00Z");
    trade.post(rosa, "/accept", &json!({})).await.good();
    assert_eq!(mailed(&shore, &relay).await.len(), 1);
    shore.advance(18.0 * HOUR_S);
    let all = mailed(&shore, &relay).await;
    assert_eq!(all[1..], ["Nao: rosa accepts the job at Bilbao"]);
    trade.post(rosa, "/on-board", &json!({})).await.good();
    shore.advance(6.9 * 24.0 * HOUR_S);
    assert_eq!(mailed(&shore, &relay).await.len(), 2);
    shore.advance(0.1 * 24.0 * HOUR_S);
    let all = mailed(&shore, &relay).await;
    assert_eq!(all[2..], ["Nao: the adjuster is on board at Bilbao"]);
    shore.finish().await;
}

async fn two_servers_make_one_letter(shore: Shore) {
    let relay = Relay::start().await;
    let _trade = Trade::offered(&shore, 1).await;
    let other = shore.second().await;
    let (one, two) = tokio::join!(send_due(&shore.app), send_due(&other));
    one.unwrap();
    two.unwrap();
    assert_eq!(deliver(&shore, &relay).await.len(), 1);
    other.db.close().await;
    shore.finish().await;
}

async fn what_waits_follows_the_new_settings(shore: Shore) {
    let relay = Relay::start().await;
    let trade = Trade::offered(&shore, 1).await;
    say(&trade.ada, &quiet()).await.good();
    trade
        .post(&trade.firms[0].1, "/accept", &json!({}))
        .await
        .good();
    assert_eq!(mailed(&shore, &relay).await.len(), 1);
    say(&trade.ada, &json!({})).await.good();
    let all = mailed(&shore, &relay).await;
    assert_eq!(all[1..], ["Nao: rosa accepts the job at Bilbao"]);
    shore.finish().await;
}

async fn who_is_removed_gets_no_more_letters(shore: Shore) {
    let relay = Relay::start().await;
    let trade = Trade::offered(&shore, 1).await;
    let viewer = trade.ada.viewer(&shore).await;
    say(&viewer, &json!({ "ways": { "answered": "mail" } }))
        .await
        .good();
    trade
        .post(&trade.firms[0].1, "/accept", &json!({}))
        .await
        .good();
    send_due(&shore.app).await.unwrap();
    let id = viewer.get("/me").await.good()["user_id"].clone();
    let path = format!("/users/{}", id.as_str().unwrap());
    let removed = Answer::of(trade.ada.request(Method::DELETE, &path)).await;
    assert_eq!(removed.status, 204, "{removed:?}");
    deliver(&shore, &relay).await;
    let to: Vec<_> = relay
        .got()
        .iter()
        .flat_map(|letter| letter.to.clone())
        .collect();
    assert_eq!(to.len(), 2, "{to:?}");
    assert!(!to.iter().any(|to| to.contains("viewer")), "{to:?}");
    shore.finish().await;
}
