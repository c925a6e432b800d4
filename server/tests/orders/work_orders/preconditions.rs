//! Conditions that stop an adjustment: a ship that swung, a binnacle changed meanwhile,
//! a completion dated before the steps, a prediction that is not verified.

use binnacle_server_testing::alerts::report_departure_without_samples;
use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::{AT, Job, completion_details, reading, second_reading};
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use serde_json::{Value, json};

on_both!(
    a_compass_that_turned_by_itself_does_not_count_as_a_step,
    a_binnacle_changed_meanwhile_is_detected,
    cargo_logged_after_the_reading_stops_the_work,
    a_withdrawn_cargo_entry_allows_a_new_reading,
    a_completion_cannot_be_dated_before_its_steps,
    an_unverified_prediction_does_not_count_as_recent,
    a_plan_lists_open_alerts_of_the_compass,
);

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

async fn a_compass_that_turned_by_itself_does_not_count_as_a_step(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let step = &order["next_step"];
    let now_deg = number(&order["compass_deg"]);
    let path = format!("/steps/{}", step["number"]);
    let from = |before_deg: f64| {
        let after_deg = before_deg + number(&step["change_deg"]);
        json!({ "before_deg": before_deg.rem_euclid(360.0), "after_deg": after_deg.rem_euclid(360.0) })
    };
    let swung = job.post(&path, &from(now_deg + 40.0)).await;
    assert_eq!(swung.problem(), "invalid");
    assert!(
        swung.text.contains("before_deg") && swung.text.contains("swung"),
        "{swung:?}"
    );
    let order = job.post(&path, &from(now_deg + 1.0)).await.good();
    // The next step starts from the present compass reading.
    if let Some(next) = order["next_step"].as_object() {
        let expected = number(&order["compass_deg"]) + number(&next["change_deg"]);
        let off = number(&next["expected_compass_deg"]) - expected.rem_euclid(360.0);
        assert!(off.abs() < 1e-9, "{off}");
    }
    server.finish().await;
}

async fn a_binnacle_changed_meanwhile_is_detected(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let path = job
        .ship
        .path(&format!("/compasses/{}/binnacle", job.compass));
    let mut more = binnacle();
    more["aboard"]["magnets"][0]["count"] = json!(16);
    put(&job.person, &path, &more).await.good();
    let held = job.post("/plan", &json!({})).await;
    assert_eq!(held.problem(), "wrong-state");
    assert!(held.text.contains("was revised"), "{held:?}");
    job.post("/berth-reading", &reading()).await.good();
    job.post("/plan", &json!({})).await.good();
    let refused = put(&job.person, &path, &binnacle()).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(refused.text.contains("is being adjusted"), "{refused:?}");
    server.finish().await;
}

async fn cargo_logged_after_the_reading_stops_the_work(server: TestServer) {
    let since = "2026-11-21T06:45:00Z";
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let held = |response: ApiResponse| {
        assert_eq!(response.problem(), "wrong-state");
        for words in [
            "magnetic cargo on board since 2026-11-21 06:45 UTC",
            "withdraw",
        ] {
            assert!(response.text.contains(words), "{response:?}");
        }
    };
    let steel = job.load_steel(since).await;
    held(job.person.get(&job.path("/plan")).await);
    held(job.post("/plan", &json!({})).await);
    job.withdraw(&steel).await;
    let order = job.post("/plan", &json!({})).await.good();
    let steel = job.load_steel(since).await;
    let step = &order["next_step"];
    let path = format!("/steps/{}", step["number"]);
    let after = json!({ "after_deg": step["expected_compass_deg"] });
    held(job.post(&path, &after).await);
    job.withdraw(&steel).await;
    let order = job.follow_plan().await;
    let steel = job.load_steel(since).await;
    let repeated = second_reading(&order["plan"]["plan"]["setting"]);
    held(job.post("/second-reading", &repeated).await);
    held(job.post("/complete", &completion_details()).await);
    job.withdraw(&steel).await;
    job.post("/complete", &completion_details()).await.good();
    server.finish().await;
}

async fn a_withdrawn_cargo_entry_allows_a_new_reading(server: TestServer) {
    let job = Job::begin(&server).await;
    let steel = job.load_steel("2026-11-21T06:00:00Z").await;
    job.post("/berth-reading", &reading()).await.good();
    assert_eq!(
        job.post("/plan", &json!({})).await.problem(),
        "not-adjustable"
    );
    job.withdraw(&steel).await;
    let held = job.post("/plan", &json!({})).await;
    assert_eq!(held.problem(), "wrong-state");
    assert!(held.text.contains("read the berth again"), "{held:?}");
    job.post("/berth-reading", &reading()).await.good();
    job.post("/plan", &json!({})).await.good();
    server.finish().await;
}

async fn a_completion_cannot_be_dated_before_its_steps(server: TestServer) {
    let mut job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    server.advance(86_400.0);
    job.person = Person::sign_in(&server, job.person.operator, &job.person.email).await;
    let order = job.follow_plan().await;
    // This time is before the steps too, like that of the berth reading.
    let repeated = second_reading(&order["plan"]["plan"]["setting"]);
    let refused = job.post("/second-reading", &repeated).await;
    assert_eq!(refused.problem(), "invalid");
    assert!(refused.text.contains("before the last step"), "{refused:?}");
    let mut early = completion_details();
    early["at"] = json!("2026-11-21T07:00:00Z");
    let refused = job.post("/complete", &early).await;
    assert_eq!(refused.problem(), "invalid");
    assert!(refused.text.contains("before the last step"), "{refused:?}");
    job.post("/complete", &completion_details()).await.good();
    server.finish().await;
}

async fn an_unverified_prediction_does_not_count_as_recent(server: TestServer) {
    let mut job = Job::begin(&server).await;
    let done = job.complete().await;
    let record = job.person.get(&job.path("/record.json")).await.good();
    let made = job
        .person
        .post("/work-orders", &job.new_order())
        .await
        .good();
    made["id"].as_str().unwrap().clone_into(&mut job.order);
    job.confirm_as_found().await;
    let mut repeated = reading();
    let there = second_reading(&done["setting"]);
    for part in ["forward", "starboard"] {
        repeated[part] = there[part].clone();
    }
    repeated.as_object_mut().unwrap().remove("compass_deg");
    repeated["at"] = json!(AT);
    job.post("/berth-reading", &repeated).await.good();
    let offer = job.person.get(&job.path("/plan")).await.good();
    let note = offer["notes"][0].as_str().unwrap();
    assert!(
        note.starts_with("no heading at sea has confirmed"),
        "{note}"
    );
    let log = job.person.get(&job.path("/entries")).await.good();
    let entries = log["items"].as_array().unwrap();
    let read = entries
        .iter()
        .find(|line| line["entry"]["kind"] == "berth_reading")
        .unwrap();
    let model = &read["entry"]["content"]["basis"]["model"];
    assert_eq!(model["headings_until"], record["data"]["until"]);
    server.finish().await;
}

async fn a_plan_lists_open_alerts_of_the_compass(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let notes = async || job.person.get(&job.path("/plan")).await.good()["notes"].to_string();
    let says = "an alert about this compass is open: Compass and gyro parted";
    assert!(!notes().await.contains(says));
    report_departure_without_samples(&job.ship, 2).await;
    assert!(notes().await.contains(says), "{}", notes().await);
    server.finish().await;
}
