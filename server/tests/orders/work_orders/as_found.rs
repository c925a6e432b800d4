//! Correctors as found, before every plan; and a half-done order that is cancelled.

use binnacle_server_testing::TestServer;
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::{Job, as_found, reading, second_reading};
use serde_json::json;

on_both!(
    nothing_is_planned_before_the_correctors_are_confirmed,
    a_setting_other_than_recorded_needs_a_reason_and_becomes_the_record,
    a_defective_compass_is_mended_before_anything_is_planned,
    a_half_done_order_that_is_cancelled_lets_the_ship_be_planned_again,
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
    let recorded = job.person.get(&job.path("/binnacle")).await.good();
    assert_eq!(recorded["revision"], 2);
    assert_eq!(recorded["binnacle"]["setting"]["athwartship"][0]["hole"], 7);
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
    job.confirm_as_found().await;
    job.post("/plan", &json!({})).await.good();
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
