//! The whole way, from the berth to the sea.

use super::{Job, LAMBDA, foretold, reading, word};
use crate::on_both;
use crate::support::{Shore, days_at_sea};
use serde_json::{Value, json};

on_both!(
    an_order_goes_from_the_berth_to_a_predicted_model,
    headings_at_sea_verify_an_adjustment,
    a_heading_at_sea_that_does_not_agree_is_an_alert,
);

async fn an_order_goes_from_the_berth_to_a_predicted_model(shore: Shore) {
    let job = Job::begin(&shore).await;
    let order = job.seen().await;
    assert_eq!(order["state"], "planned");
    assert_eq!(order["standing"], "predicted, not a certificate");
    let order = job.post("/berth-reading", &reading()).await.good();
    assert_eq!(
        (&order["state"], &order["berth"]),
        (&json!("measured"), &json!("A5"))
    );
    let lambda = order["berth_check"]["lambda"].as_f64().unwrap();
    assert!((lambda - LAMBDA).abs() < 0.03, "{lambda}");
    let offer = job.person.get(&job.path("/plan")).await.good();
    assert!(!offer["plans"].as_array().unwrap().is_empty());
    let order = job.adjust().await;
    assert_eq!(
        (&order["state"], &order["next_step"]),
        (&json!("adjusting"), &Value::Null)
    );
    assert!(order["steps_done"].as_u64().unwrap() > 0);
    let done = job.post("/complete", &word()).await.good();
    assert_eq!(done["state"], "adjusted");

    // The binnacle stands as it was set,
    let path = job
        .ship
        .path(&format!("/compasses/{}/binnacle", job.compass));
    let kept = job.person.get(&path).await.good();
    assert_eq!(kept["revision"], 2);
    assert_eq!(
        kept["binnacle"]["setting"],
        order["plan"]["plan"]["setting"]
    );
    // the logbook has the moment,
    let logbook = job
        .person
        .get(&job.ship.path("/logbook?kind=adjustment"))
        .await
        .good();
    assert_eq!(
        logbook["items"][0]["id"],
        done["completion"]["logbook_entry"]
    );
    assert_eq!(logbook["items"][0]["compass_id"], job.compass);
    // and the ship gets what is foretold, before and after the analysis.
    for _ in 0..2 {
        let sent = job.ship.downlink("").await;
        assert_eq!(sent["model"]["id"], done["completion"]["model_id"]);
        assert_eq!(sent["model"]["replaces"]["reason"], "adjustment");
        assert_eq!(sent["card_withdrawn"], Value::Null);
        shore.work().await;
    }
    let model = job.person.get(&job.ship.path("/model")).await.good();
    assert_eq!(model["foretold_by"], job.order);
    assert_eq!(job.open_alerts().await, Vec::<Value>::new());
    shore.finish().await;
}

async fn headings_at_sea_verify_an_adjustment(shore: Shore) {
    let mut job = Job::begin(&shore).await;
    let done = job.complete().await;
    assert_eq!(done["verification"], Value::Null);
    let ship = foretold(&done);
    let some = job.sail(&shore, &ship, 2, 0.25).await;
    assert_eq!(some["state"], "adjusted");
    assert_eq!(
        some["verification"]["verification"]["verdict"],
        "more_needed"
    );
    let needed = &some["verification"]["verification"]["needed"]["count"];
    assert!(needed.as_u64().unwrap() > 0, "{some}");
    let early = job.post("/close", &json!({ "text": "done" })).await;
    assert_eq!(early.problem(), "wrong-state");
    let more = job.sail(&shore, &ship, 3, 6.0).await;
    assert_eq!(more["state"], "verified", "{}", more["verification"]);
    assert_eq!(more["standing"], "verified at sea");
    assert_eq!(job.open_alerts().await, Vec::<Value>::new());
    let told = job.person.get("/notifications?kind=verified").await.good();
    let subject = &told["items"][0]["subject"];
    assert_eq!(subject, "Nao: verified at sea at Bilbao");
    assert_eq!(told["items"].as_array().unwrap().len(), 1);
    let closed = job.post("/close", &json!({ "text": "done" })).await.good();
    assert_eq!(
        (&closed["state"], &closed["standing"]),
        (&json!("closed"), &json!("verified at sea"))
    );
    shore.finish().await;
}

async fn a_heading_at_sea_that_does_not_agree_is_an_alert(shore: Shore) {
    let mut job = Job::begin(&shore).await;
    let mut ship = foretold(&job.complete().await);
    ship.parameters_over_lambda.bx_nt += 4000.0;
    let failed = job.sail(&shore, &ship, 2, 1.0).await;
    assert_eq!(failed["state"], "failed");
    assert_eq!(failed["standing"], "predicted, not a certificate");
    let alerts = job.open_alerts().await;
    let ours = alerts
        .iter()
        .find(|alert| alert["cause"] == "adjustment_not_confirmed");
    let ours = ours.unwrap_or_else(|| panic!("{alerts:?}"));
    assert_eq!(ours["severity"], "critical");
    let path = "/notifications?kind=verification_failed";
    let told = job.person.get(path).await.good();
    let text = told["items"][0]["text"].as_str().unwrap();
    assert!(text.contains("off what was foretold"), "{text}");
    // And the compass is to be adjusted once more.
    let needs = job.person.get("/needs").await.good();
    let mut causes = needs["items"][0]["causes"].as_array().unwrap().iter();
    let cause = causes.find(|cause| cause["kind"] == "failed_verification");
    let cause = cause.unwrap_or_else(|| panic!("{needs}"));
    assert_eq!(cause["due_on"], "2026-12-22");
    let reason = cause["reason"].as_str().unwrap();
    assert!(reason.contains("failed: headings are"), "{reason}");
    // To file it away changes nothing of that: the next analysis still raises the alert.
    job.post("/close", &json!({ "text": "filed" })).await.good();
    let after = job.person.get("/needs").await.good();
    assert_eq!(after["items"][0]["causes"], needs["items"][0]["causes"]);
    let more = days_at_sea(&ship, "2026-11-23T12:00:00Z", 1.0);
    job.send(&shore, 3, &more, 1.0).await;
    let alerts = job.open_alerts().await;
    let causes: Vec<&Value> = alerts.iter().map(|alert| &alert["cause"]).collect();
    assert!(
        causes.contains(&&json!("adjustment_not_confirmed")),
        "{causes:?}"
    );
    shore.finish().await;
}
