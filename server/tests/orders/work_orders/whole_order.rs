//! A whole order, from the berth to the verification at sea.

use binnacle_compass::sample::Sample;
use binnacle_server_testing::alerts;
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::{
    Job, LAMBDA, completion_details, predicted_model, reading, reading_on_ship,
};
use binnacle_server_testing::{
    TestServer, days_at_sea, days_in_waters, model_after_step, position, true_model,
};
use serde_json::{Value, json};
use std::collections::BTreeSet;

on_both!(
    a_completed_order_gives_a_predicted_model,
    headings_at_sea_verify_an_adjustment,
    headings_months_apart_verify_an_adjustment,
    a_disagreeing_heading_at_sea_raises_an_alert,
    an_adjustment_after_a_failed_verification_resolves_it_on_its_day,
    another_orders_adjustment_resolves_a_failed_verification,
    an_adjustment_clears_earlier_alerts_of_the_ship,
);

async fn a_completed_order_gives_a_predicted_model(server: TestServer) {
    let job = Job::begin(&server).await;
    let order = job.view_order().await;
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
    let done = job.post("/complete", &completion_details()).await.good();
    assert_eq!(done["state"], "adjusted");

    // The binnacle has the new setting,
    let path = job
        .ship
        .path(&format!("/compasses/{}/binnacle", job.compass));
    let kept = job.person.get(&path).await.good();
    assert_eq!(kept["revision"], 2);
    assert_eq!(
        kept["binnacle"]["setting"],
        order["plan"]["plan"]["setting"]
    );
    // the logbook has the time,
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
    // and the ship gets the predicted model, before and after the analysis.
    for _ in 0..2 {
        let sent = job.ship.downlink("").await;
        assert_eq!(sent["model"]["id"], done["completion"]["model_id"]);
        assert_eq!(sent["model"]["replaces"]["reason"], "adjustment");
        assert_eq!(sent["card_withdrawn"], Value::Null);
        server.work().await;
    }
    let model = job.person.get(&job.ship.path("/model")).await.good();
    assert_eq!(model["foretold_by"], job.order);
    assert_eq!(job.open_alerts().await, Vec::<Value>::new());
    server.finish().await;
}

async fn headings_at_sea_verify_an_adjustment(server: TestServer) {
    let mut job = Job::begin(&server).await;
    let done = job.complete().await;
    assert_eq!(done["verification"], Value::Null);
    let ship = predicted_model(&done);
    let some = job.sail(&server, &ship, 2, 0.25).await;
    assert_eq!(some["state"], "adjusted");
    assert_eq!(
        some["verification"]["verification"]["verdict"],
        "more_needed"
    );
    let needed = &some["verification"]["verification"]["needed"]["count"];
    assert!(needed.as_u64().unwrap() > 0, "{some}");
    let early = job.post("/close", &json!({ "text": "done" })).await;
    assert_eq!(early.problem(), "wrong-state");
    let not_verified = "adjusted, not yet verified at sea: ";
    let reason = due_reason(&job).await;
    assert!(reason.starts_with(not_verified), "{reason}");
    let more = job.sail(&server, &ship, 3, 6.0).await;
    assert_eq!(more["state"], "verified", "{}", more["verification"]);
    assert_eq!(more["standing"], "verified at sea");
    let reason = due_reason(&job).await;
    assert!(!reason.contains(not_verified), "{reason}");
    assert_eq!(job.open_alerts().await, Vec::<Value>::new());
    let notifications = job.person.get("/notifications?kind=verified").await.good();
    let subject = &notifications["items"][0]["subject"];
    assert_eq!(subject, "Nao: verified at sea at Bilbao");
    assert_eq!(notifications["items"].as_array().unwrap().len(), 1);
    let closed = job.post("/close", &json!({ "text": "done" })).await.good();
    assert_eq!(
        (&closed["state"], &closed["standing"]),
        (&json!("closed"), &json!("verified at sea"))
    );
    server.finish().await;
}

/// A ship that is laid up half-way, but for one heading a month.
async fn headings_months_apart_verify_an_adjustment(server: TestServer) {
    let mut job = Job::begin(&server).await;
    let ship = predicted_model(&job.complete().await);
    let easterly = |sample: &Sample| sample.compass.degrees() < 180.0;
    let six_days = |from: &str| days_at_sea(&ship, from, 6.0);
    let (east, _): (Vec<Sample>, Vec<Sample>) = six_days("2026-11-21T12:00:00Z")
        .into_iter()
        .partition(easterly);
    job.send(&server, 2, &east, 6.5).await;
    let mut seq = 3;
    for from in ["2026-12-28", "2027-01-28", "2027-02-28", "2027-03-28"] {
        let watch = days_at_sea(&ship, &format!("{from}T12:00:00Z"), 0.125);
        job.send(&server, seq, &watch, 31.0).await;
        seq += 1;
    }
    let some = job.view_order().await;
    assert_eq!(some["state"], "adjusted", "{}", some["verification"]);
    let (_, west): (Vec<Sample>, Vec<Sample>) = six_days("2027-04-10T12:00:00Z")
        .into_iter()
        .partition(easterly);
    job.send(&server, seq, &west, 19.0).await;
    let more = job.view_order().await;
    assert_eq!(more["state"], "verified", "{}", more["verification"]);
    let headings = &more["verification"]["verification"]["headings"];
    let sectors = |samples: &[Sample]| {
        let sector = |sample: &Sample| (sample.compass.degrees() / 15.0).round() as usize % 24;
        samples
            .iter()
            .map(sector)
            .collect::<BTreeSet<usize>>()
            .len()
    };
    assert!(
        headings.as_u64().unwrap() as usize > sectors(&west),
        "{}",
        more["verification"]
    );
    server.finish().await;
}

async fn a_disagreeing_heading_at_sea_raises_an_alert(server: TestServer) {
    let mut job = Job::begin(&server).await;
    let mut ship = predicted_model(&job.complete().await);
    ship.parameters_over_lambda.bx_nt += 4000.0;
    let failed = job.sail(&server, &ship, 2, 1.0).await;
    assert_eq!(failed["state"], "failed");
    assert_eq!(failed["standing"], "predicted, not a certificate");
    let alerts = job.open_alerts().await;
    let ours = alerts
        .iter()
        .find(|alert| alert["cause"] == "adjustment_not_confirmed");
    let ours = ours.unwrap_or_else(|| panic!("{alerts:?}"));
    assert_eq!(ours["severity"], "critical");
    let path = "/notifications?kind=verification_failed";
    let notifications = job.person.get(path).await.good();
    let text = notifications["items"][0]["text"].as_str().unwrap();
    assert!(text.contains("off the prediction"), "{text}");
    // The compass is due for another adjustment.
    let needs = job.person.get("/needs").await.good();
    let mut causes = needs["items"][0]["causes"].as_array().unwrap().iter();
    let cause = causes.find(|cause| cause["kind"] == "failed_verification");
    let cause = cause.unwrap_or_else(|| panic!("{needs}"));
    assert_eq!(cause["due_on"], "2026-12-22");
    let reason = cause["reason"].as_str().unwrap();
    assert!(reason.contains("failed: headings are"), "{reason}");
    // Closing the order does not change that: the next analysis still raises the alert.
    job.post("/close", &json!({ "text": "filed" })).await.good();
    let after = job.person.get("/needs").await.good();
    assert_eq!(after["items"][0]["causes"], needs["items"][0]["causes"]);
    let more = days_at_sea(&ship, "2026-11-23T12:00:00Z", 1.0);
    job.send(&server, 3, &more, 1.0).await;
    let alerts = job.open_alerts().await;
    let causes: Vec<&Value> = alerts.iter().map(|alert| &alert["cause"]).collect();
    assert!(
        causes.contains(&&json!("adjustment_not_confirmed")),
        "{causes:?}"
    );
    server.finish().await;
}

async fn due_reason(job: &Job) -> String {
    let needs = job.person.get("/needs").await.good();
    let need = &needs["items"][0];
    assert_eq!(need["urgency"], "routine", "{need}");
    need["reason"].as_str().unwrap().to_owned()
}

/// Returns a job that failed verification on the day after the adjustment.
async fn failed_verification(server: &TestServer) -> Job {
    let mut job = Job::begin(server).await;
    let mut ship = predicted_model(&job.complete().await);
    ship.parameters_over_lambda.bx_nt += 4000.0;
    let failed = job.sail(server, &ship, 2, 1.0).await;
    assert_eq!(failed["state"], "failed");
    assert!(is_failed(&job).await);
    job
}

async fn is_failed(job: &Job) -> bool {
    let needs = job.person.get("/needs").await.good();
    let mut causes = needs["items"][0]["causes"].as_array().unwrap().iter();
    causes.any(|cause| cause["kind"] == "failed_verification")
}

async fn an_adjustment_after_a_failed_verification_resolves_it_on_its_day(server: TestServer) {
    let job = failed_verification(&server).await;
    // The last heading at sea was at 11:50 on that day.
    let before = json!({ "kind": "adjustment", "from": "2026-11-22T09:00:00Z" });
    let logbook = job.ship.path("/logbook");
    job.person.post(&logbook, &before).await.good();
    assert!(is_failed(&job).await);
    let after = json!({ "kind": "adjustment", "from": "2026-11-22T15:00:00Z" });
    job.person.post(&logbook, &after).await.good();
    assert!(!is_failed(&job).await);
    server.finish().await;
}

async fn another_orders_adjustment_resolves_a_failed_verification(server: TestServer) {
    let job = failed_verification(&server).await;
    let mut repeated = job.new_order();
    repeated["planned_at"] = json!("2026-11-23T09:00:00Z");
    job.person.post("/work-orders", &repeated).await.good();
    // An hour after the first one, before the verification result.
    server
        .run_sql(
            "UPDATE work_orders SET state = 'adjusted', completed_at =
                 (SELECT MAX(c.completed_at) FROM work_orders c) + 3600000000
             WHERE completed_at IS NULL",
        )
        .await;
    assert!(!is_failed(&job).await);
    let needs = job.person.get("/needs").await.good().to_string();
    assert!(
        needs.contains("adjusted, not yet verified at sea"),
        "{needs}"
    );
    server.finish().await;
}

async fn an_adjustment_clears_earlier_alerts_of_the_ship(server: TestServer) {
    let person = server.admin("ada").await;
    let now = model_after_step(3000.0, 2000.0);
    let mut samples = days_at_sea(&true_model(), "2026-10-27T00:00:00Z", 12.0);
    samples.extend(days_in_waters(
        position(10.0, -25.0),
        &true_model(),
        "2026-11-08T00:00:00Z",
        7.0,
    ));
    samples.extend(days_at_sea(&now, "2026-11-15T00:00:00Z", 5.0));
    let job = Job::with_samples(&server, person, &samples).await;
    alerts::report_departure_without_samples(&job.ship, 2).await;
    server.work().await;
    let causes = |alerts: &[Value]| -> Vec<String> {
        let causes = alerts.iter().map(|alert| alert["cause"].as_str().unwrap());
        causes.map(str::to_owned).collect()
    };
    let open = causes(&job.open_alerts().await);
    for cause in [
        "lightning_or_shock",
        "deviation_over_limit",
        "reported_aboard",
    ] {
        assert!(open.iter().any(|one| one == cause), "{open:?}");
    }
    job.post("/berth-reading", &reading_on_ship(&now))
        .await
        .good();
    job.follow_plan().await;
    job.post("/complete", &completion_details()).await.good();
    server.work().await;
    assert_eq!(job.open_alerts().await, Vec::<Value>::new());
    let list = job.person.get("/alerts").await.good();
    for alert in list["items"].as_array().unwrap() {
        let why = alert["clearing_reason"].as_str().unwrap_or_default();
        assert!(why.contains("the predicted card holds"), "{alert}");
    }
    // New samples do not raise it again within its week.
    let ship = predicted_model(&job.view_order().await);
    let mut job = job;
    job.sail(&server, &ship, 9, 2.0).await;
    assert_eq!(job.open_alerts().await, Vec::<Value>::new());
    server.finish().await;
}
