//! The card after an adjustment: predicted, verified at sea, ended with its epoch.

use binnacle_compass::sample::Sample;
use binnacle_server_testing::alerts::set_alert_limits;
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::{Job, predicted_model};
use binnacle_server_testing::{TestServer, days_at_sea};
use serde_json::{Value, json};

on_both!(
    a_card_is_verified_when_headings_at_sea_agree_until_a_change_ends_the_epoch,
    an_adjustment_failing_at_sea_keeps_its_card_predicted,
    an_order_closed_without_verification_keeps_its_card_predicted,
    a_card_after_an_adjustment_has_no_earlier_alert,
);

async fn a_card_is_verified_when_headings_at_sea_agree_until_a_change_ends_the_epoch(
    server: TestServer,
) {
    let mut job = Job::begin(&server).await;
    job.expect_card_status("predicted").await;
    let ship = predicted_model(&job.complete().await);
    job.expect_card_status("predicted").await;
    let card = job.card().await;
    assert_eq!(card["verified"], Value::Null);
    assert_eq!(card["adjusted_by"]["order"], job.order);
    assert_eq!(card["adjusted_by"]["licence"], "ES-CA-114");
    // Nothing at sea supports it yet: no term starts, and the card names its order.
    assert_eq!(card["unverified_order"], job.order);
    assert_eq!(card["next_due"], Value::Null);
    assert!(
        !card["not_recorded"]
            .as_array()
            .unwrap()
            .contains(&json!("next_due"))
    );
    let statement = card["statement"].as_str().unwrap();
    assert!(
        statement.starts_with("Predicted from the adjustment at the berth"),
        "{statement}"
    );
    assert!(statement.contains(&job.order), "{statement}");
    let source = &card["model"];
    let data = [&source["data_from"], &source["data_until"]];
    assert!(
        data.iter().all(|at| at.as_str().unwrap() < "2026-11-20T12"),
        "{source}"
    );
    let csv = job.person.get(&job.ship.path("/card.csv")).await.text;
    let order = format!(",{},", job.order);
    assert!(
        csv.lines().skip(1).all(|line| line.contains(&order)),
        "{csv}"
    );
    let svg = job.person.get(&job.ship.path("/card.svg")).await.text;
    for words in ["not verified at sea", "unverified berth adjustment"] {
        assert!(svg.contains(words), "{words}: {svg}");
    }
    assert!(!svg.contains("(logbook)"), "{svg}");
    let more = job.sail(&server, &ship, 2, 6.0).await;
    assert_eq!(more["state"], "verified", "{}", more["verification"]);

    job.expect_card_status("verified").await;
    let card = job.card().await;
    assert_eq!(card["next_due"]["on"], "2028-11-21");
    assert_eq!(card["unverified_order"], Value::Null);
    let by = &card["verified"];
    assert_eq!(by["order"], job.order);
    assert_eq!(by["adjusted_at"], more["completed_at"]);
    let passed = &more["verification"]["verification"];
    assert_eq!(by["headings"], passed["headings"]);
    assert_eq!(by["until"], more["verification"]["until"]);
    let rows = card["rows"].as_array().unwrap();
    let observed = rows.iter().filter(|row| row["samples"] != 0).count();
    assert!(
        observed >= by["headings"].as_u64().unwrap() as usize,
        "{card}"
    );
    let pdf = job.person.get(&job.ship.path("/card.pdf")).await;
    assert_eq!(pdf.status, 200);

    // A later fit of the same epoch belongs to the same adjustment.
    let later = days_at_sea(&ship, "2026-11-28T13:00:00Z", 60.0);
    let later: Vec<Sample> = later.into_iter().step_by(8).collect();
    job.send(&server, 3, &later, 60.5).await;
    let model = job.person.get(&job.ship.path("/model")).await.good();
    assert_eq!(model["foretold_by"], Value::Null, "it has been fitted");
    assert_eq!(model["epoch_from"], by["adjusted_at"]);
    job.expect_card_status("verified").await;
    // The book has the card status of each time.
    let book = job.book_statuses("2026-11-21T12:00:00Z").await;
    let then: Vec<&Value> = book.iter().collect();
    assert_eq!(then.first(), Some(&&json!("predicted")), "{book:?}");
    assert_eq!(then.last(), Some(&&json!("verified")), "{book:?}");
    let after = job.book_statuses("2026-11-28T14:00:00Z").await;
    assert!(after.iter().all(|status| status == "verified"), "{after:?}");

    // A moved magnet ends it,
    let now = server.app.clock.now().to_string();
    let moved = json!({ "kind": "corrector_change", "from": now });
    job.person
        .post(&job.ship.path("/logbook"), &moved)
        .await
        .good();
    server.work().await;
    let none = job.person.get(&job.ship.path("/card.json")).await;
    assert_eq!(none.problem(), "no-model-yet");
    // and the next fit is predicted.
    let mut other = ship.clone();
    other.parameters_over_lambda.bx_nt += 700.0;
    let since = days_at_sea(&other, "2027-01-28T02:00:00Z", 6.0);
    job.send(&server, 4, &since, 7.0).await;
    job.expect_card_status("predicted").await;
    assert_eq!(job.card().await["verified"], Value::Null);
    server.finish().await;
}

/// A ship that stops sending: its order is closed without verification.
async fn an_order_closed_without_verification_keeps_its_card_predicted(server: TestServer) {
    let mut job = Job::begin(&server).await;
    let ship = predicted_model(&job.complete().await);
    let early = job.post("/close", &json!({ "text": "filed" })).await;
    assert!(early.text.contains("without_verification"), "{early:?}");
    assert_eq!(early.problem(), "wrong-state");
    let why = json!({ "text": "sold for scrap", "without_verification": true });
    let closed = job.post("/close", &why).await.good();
    assert_eq!(closed["state"], "closed_unverified");
    assert_eq!(closed["standing"], "predicted, not a certificate");
    assert_eq!(closed["verification"], Value::Null);
    job.expect_card_status("predicted").await;
    let card = job.card().await;
    assert_eq!(card["next_due"], Value::Null, "{card}");
    let log = job.person.get(&job.path("/entries")).await.good();
    let said = "closed without verification: sold for scrap";
    assert!(log.to_string().contains(said), "{log}");
    let audit = job.person.get("/audit").await.good();
    let is_closing = |line: &Value| line["route"] == "/api/v1/work-orders/{id}/close";
    let lines = audit["items"].as_array().unwrap();
    assert!(lines.iter().any(is_closing), "{audit}");
    let report = job.person.get("/reports/fleet").await.good();
    let jobs = report["jobs"].to_string();
    assert!(jobs.contains("\"closed_unverified\""), "{report}");
    // Neither later samples nor a second closing change it.
    let sent = job.sail(&server, &ship, 2, 6.0).await;
    assert_eq!(sent["state"], "closed_unverified");
    assert_eq!(sent["verification"], Value::Null);
    job.expect_card_status("predicted").await;
    let again = job.post("/close", &json!({ "text": "again" })).await;
    assert_eq!(again.problem(), "wrong-state");
    let needs = job.person.get("/needs").await.good();
    let reason = needs["items"][0]["reason"].as_str().unwrap();
    assert!(
        reason.starts_with("adjusted, not yet verified at sea"),
        "{reason}"
    );
    server.finish().await;
}

async fn an_adjustment_failing_at_sea_keeps_its_card_predicted(server: TestServer) {
    let mut job = Job::begin(&server).await;
    let mut ship = predicted_model(&job.complete().await);
    ship.parameters_over_lambda.bx_nt += 4000.0;
    let failed = job.sail(&server, &ship, 2, 6.0).await;
    assert_eq!(failed["state"], "failed");
    job.expect_card_status("predicted").await;
    let closed = job.post("/close", &json!({ "text": "to be swung" })).await;
    assert_eq!(closed.good()["standing"], "predicted, not a certificate");
    job.expect_card_status("predicted").await;
    server.finish().await;
}

async fn a_card_after_an_adjustment_has_no_earlier_alert(server: TestServer) {
    let job = Job::begin(&server).await;
    set_alert_limits(
        &server,
        &job.person,
        &job.ship,
        json!({ "deviation_deg": 1.0 }),
    )
    .await;
    let notes = async || job.card().await["notes"].to_string();
    assert!(
        notes().await.contains("over the limit of 1°"),
        "{}",
        notes().await
    );
    // No analysis has cleared the alert yet.
    job.complete().await;
    assert!(
        !notes().await.contains("over the limit"),
        "{}",
        notes().await
    );
    server.finish().await;
}
