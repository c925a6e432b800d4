//! Correctors as found, before every plan; and a half-done order that is cancelled.

use binnacle_server_testing::TestServer;
use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::{Job, as_found, reading, second_reading};
use serde_json::{Value, json};

on_both!(
    nothing_is_planned_before_the_correctors_are_confirmed,
    a_setting_other_than_recorded_needs_a_reason_and_becomes_the_record,
    a_defective_compass_is_mended_before_anything_is_planned,
    magnetised_spheres_are_no_turn_to_the_west,
    the_order_of_the_trays_is_no_difference,
    a_record_changed_after_the_report_is_no_basis_for_a_reading,
    a_half_done_order_that_is_cancelled_lets_the_ship_be_planned_again,
    an_order_cancelled_against_its_second_reading_leaves_no_model,
    an_order_cancelled_after_an_unexplained_step_leaves_no_model,
);

/// Creates an order without a report, in place of the one that has it.
async fn unconfirmed(server: &TestServer) -> Job {
    let mut job = Job::begin(server).await;
    let text = json!({ "text": "ordered anew" });
    job.post("/cancel", &text).await.good();
    let made = job.person.post("/work-orders", &job.new_order()).await;
    made.good()["id"]
        .as_str()
        .unwrap()
        .clone_into(&mut job.order);
    job
}

async fn nothing_is_planned_before_the_correctors_are_confirmed(server: TestServer) {
    let job = unconfirmed(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    for early in [
        job.person.get(&job.path("/plan")).await,
        job.post("/plan", &json!({})).await,
    ] {
        assert_eq!(early.problem(), "wrong-state");
        assert!(early.text.contains("as-found"), "{early:?}");
    }
    assert!(job.view_order().await["as_found"].is_null());
    job.confirm_as_found().await;
    let order = job.post("/plan", &json!({})).await.good();
    assert_eq!(order["as_found"]["dockside"]["pivot"], "sound");
    server.finish().await;
}

async fn a_setting_other_than_recorded_needs_a_reason_and_becomes_the_record(server: TestServer) {
    let job = unconfirmed(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let mut found = as_found(&json!({
        "athwartship": [{ "hole": 7, "magnet": "200 mm", "count": 1, "red": "port" }],
    }));
    let unexplained = job.post("/as-found", &found).await;
    assert_eq!(unexplained.problem(), "invalid");
    assert!(
        unexplained.text.contains("difference") && unexplained.text.contains("hole 7"),
        "{unexplained:?}"
    );
    found["photos"] = json!(["0199aa00-0000-7000-8000-000000000003"]);
    found["difference"] = json!("record_wrong");
    assert_eq!(job.post("/as-found", &found).await.problem(), "invalid");
    found["photos"] = json!([]);
    let order = job.post("/as-found", &found).await.good();
    // The reading was judged by correctors that do not stand so.
    assert!(order["reading"].is_null(), "{order}");
    for part in ["plan", "setting", "compass_deg", "last_step"] {
        assert!(order[part].is_null(), "{part}: {order}");
    }
    assert_eq!(order["state"], "planned");
    let recorded = job.person.get(&job.path("/binnacle")).await.good();
    assert_eq!(recorded["revision"], 2);
    assert_eq!(recorded["binnacle"]["setting"]["athwartship"][0]["hole"], 7);
    found["setting"]["athwartship"][0]["hole"] = json!(8);
    found["difference"] = json!("moved_since");
    job.post("/as-found", &found).await.good();
    let logbook = job.person.get(&job.ship.path("/logbook")).await.good();
    assert_eq!(logbook["items"][0]["kind"], "corrector_change", "{logbook}");
    server.finish().await;
}

async fn a_defective_compass_is_mended_before_anything_is_planned(server: TestServer) {
    let job = unconfirmed(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let mut found = as_found(&json!({}));
    found["dockside"]["pivot"] = json!("defective");
    job.post("/as-found", &found).await.good();
    let refused = job.post("/plan", &json!({})).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(refused.text.contains("pivot"), "{refused:?}");
    let defects = job.view_order().await["defects"].clone();
    assert!(defects[0].as_str().unwrap().contains("pivot"), "{defects}");
    job.confirm_as_found().await;
    job.post("/plan", &json!({})).await.good();
    server.finish().await;
}

async fn magnetised_spheres_are_no_turn_to_the_west(server: TestServer) {
    let job = unconfirmed(&server).await;
    let mut found = as_found(&json!({}));
    found["dockside"]["spheres_turned_deg"] = json!(-5.0);
    let refused = job.post("/as-found", &found).await;
    assert_eq!(refused.problem(), "invalid");
    assert!(refused.text.contains("spheres_turned_deg"), "{refused:?}");
    server.finish().await;
}

/// Puts a binnacle with these athwartship magnets.
async fn put_athwartship(job: &Job, trays: &Value) {
    let path = format!("/compasses/{}/binnacle", job.compass);
    let mut recorded = binnacle();
    recorded["setting"]["athwartship"] = trays.clone();
    put(&job.person, &job.ship.path(&path), &recorded)
        .await
        .good();
}

async fn the_order_of_the_trays_is_no_difference(server: TestServer) {
    let job = unconfirmed(&server).await;
    let tray = |hole: u8| json!({ "hole": hole, "magnet": "200 mm", "count": 1, "red": "port" });
    put_athwartship(&job, &json!([tray(6), tray(2)])).await;
    for trays in [json!([tray(2), tray(6)]), json!([tray(6), tray(2)])] {
        let found = as_found(&json!({ "athwartship": trays }));
        job.post("/as-found", &found).await.good();
    }
    let recorded = job.person.get(&job.path("/binnacle")).await.good();
    assert_eq!(recorded["revision"], 2);
    server.finish().await;
}

async fn a_record_changed_after_the_report_is_no_basis_for_a_reading(server: TestServer) {
    let job = Job::begin(&server).await;
    let tray = json!({ "hole": 6, "magnet": "200 mm", "count": 1, "red": "port" });
    put_athwartship(&job, &json!([tray])).await;
    let refused = job.post("/berth-reading", &reading()).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(refused.text.contains("as-found"), "{refused:?}");
    job.confirm_as_found().await;
    job.post("/berth-reading", &reading()).await.good();
    server.finish().await;
}

async fn a_half_done_order_that_is_cancelled_lets_the_ship_be_planned_again(server: TestServer) {
    let mut job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let step = &order["next_step"];
    let read = json!({ "after_deg": step["expected_compass_deg"] });
    let path = format!("/steps/{}", step["number"]);
    let order = job.post(&path, &read).await.good();
    let left = order["setting"].clone();
    job.replace_order(json!({ "residual_deg": 3.0 })).await;
    server.work().await;
    let recorded = job.person.get(&job.path("/binnacle")).await.good();
    assert_eq!(recorded["binnacle"]["setting"], left);
    let model = job.person.get(&job.ship.path("/model")).await.good();
    assert!(model["foretold_by"].is_string(), "{model}");
    // Nobody finished an adjustment.
    let card = job.card().await;
    assert_eq!(card["adjusted_at"], Value::Null, "{card}");
    assert_eq!(card["next_due"], Value::Null, "{card}");
    assert_eq!(card["replaces"]["reason"], "corrector_change");
    let mut again = reading();
    let there = second_reading(&left);
    for part in ["forward", "starboard"] {
        again[part] = there[part].clone();
    }
    again.as_object_mut().unwrap().remove("compass_deg");
    job.post("/berth-reading", &again).await.good();
    let offer = job.person.get(&job.path("/plan")).await.good();
    assert!(!offer["plans"].as_array().unwrap().is_empty(), "{offer}");
    // A prediction is no fresher than the headings behind it.
    let note = offer["notes"][0].as_str().unwrap();
    assert!(note.contains("no heading at sea"), "{note}");
    server.finish().await;
}

/// Cancels the order, and checks that neither the model nor the card before it holds.
async fn cancel_without_model(server: &TestServer, job: &Job) {
    let text = json!({ "text": "she sails" });
    job.post("/cancel", &text).await.good();
    server.work().await;
    let card = job.person.get(&job.ship.path("/card.json")).await;
    assert_eq!(card.problem(), "no-model-yet");
    let logbook = job.person.get(&job.ship.path("/logbook")).await.good();
    assert_eq!(logbook["items"][0]["kind"], "corrector_change", "{logbook}");
}

async fn an_order_cancelled_against_its_second_reading_leaves_no_model(server: TestServer) {
    let job = Job::begin(&server).await;
    let order = job.adjust().await;
    let left = order["plan"]["plan"]["setting"].clone();
    let mut off = second_reading(&left);
    off["forward"] = json!(off["forward"].as_f64().unwrap() + 33.0);
    let order = job.post("/second-reading", &off).await.good();
    assert_eq!(order["second_reading"]["verdict"], "unexplained");
    cancel_without_model(&server, &job).await;
    let recorded = job.person.get(&job.path("/binnacle")).await.good();
    assert_eq!(recorded["binnacle"]["setting"], left);
    server.finish().await;
}

async fn an_order_cancelled_after_an_unexplained_step_leaves_no_model(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let step = &order["next_step"];
    let odd_deg = step["expected_compass_deg"].as_f64().unwrap() + 90.0;
    let read = json!({ "after_deg": odd_deg.rem_euclid(360.0) });
    let path = format!("/steps/{}", step["number"]);
    let order = job.post(&path, &read).await.good();
    assert_eq!(order["last_step"]["verdict"], "unexplained", "{order}");
    // The magnets may have moved.
    let early = job.post("/berth-reading", &reading()).await;
    assert_eq!(early.problem(), "wrong-state");
    cancel_without_model(&server, &job).await;
    server.finish().await;
}
