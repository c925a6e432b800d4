//! What holds an adjustment back: a ship that swung, a binnacle written
//! meanwhile, a moment before its own steps, and a prediction that nobody proved.

use super::{AT, Job, read_again, reading, word};
use crate::binnacles::{binnacle, put};
use crate::on_both;
use crate::ship_alerts::says_that_it_departs;
use crate::support::{Answer, Person, Shore};
use serde_json::{Value, json};

on_both!(
    a_compass_that_turned_by_itself_is_not_read_for_a_step,
    a_binnacle_written_meanwhile_is_noticed,
    cargo_that_is_logged_after_the_reading_holds_the_work_back,
    cargo_that_was_withdrawn_from_the_logbook_refuses_no_new_reading,
    an_adjustment_is_not_dated_before_its_steps,
    a_prediction_that_nothing_proved_does_not_count_as_fresh,
    an_alert_about_the_compass_is_told_with_the_plan,
);

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

async fn a_compass_that_turned_by_itself_is_not_read_for_a_step(shore: Shore) {
    let job = Job::begin(&shore).await;
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
    // The next one is expected from what the compass reads now.
    if let Some(next) = order["next_step"].as_object() {
        let expected = number(&order["compass_deg"]) + number(&next["change_deg"]);
        let off = number(&next["expected_compass_deg"]) - expected.rem_euclid(360.0);
        assert!(off.abs() < 1e-9, "{off}");
    }
    shore.finish().await;
}

async fn a_binnacle_written_meanwhile_is_noticed(shore: Shore) {
    let job = Job::begin(&shore).await;
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
    shore.finish().await;
}

impl Job {
    /// Where the logbook's new entry of magnetic cargo is withdrawn.
    async fn load_steel(&self, from: &str) -> String {
        let steel = json!({ "kind": "magnetic_cargo", "from": from });
        let logbook = self.ship.path("/logbook");
        let entry = self.person.post(&logbook, &steel).await.good();
        format!("{logbook}/{}/withdraw", entry["id"].as_str().unwrap())
    }

    async fn withdraw(&self, path: &str) {
        let reason = json!({ "reason": "another ship" });
        self.person.post(path, &reason).await.good();
    }
}

async fn cargo_that_is_logged_after_the_reading_holds_the_work_back(shore: Shore) {
    let since = "2026-11-21T06:45:00Z";
    let job = Job::begin(&shore).await;
    job.post("/berth-reading", &reading()).await.good();
    let held = |answer: Answer| {
        assert_eq!(answer.problem(), "wrong-state");
        for words in [
            "magnetic cargo on board since 2026-11-21 06:45 UTC",
            "withdraw",
        ] {
            assert!(answer.text.contains(words), "{answer:?}");
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
    let order = job.follow_a_plan().await;
    let steel = job.load_steel(since).await;
    let again = read_again(&order["plan"]["plan"]["setting"]);
    held(job.post("/second-reading", &again).await);
    held(job.post("/complete", &word()).await);
    job.withdraw(&steel).await;
    job.post("/complete", &word()).await.good();
    shore.finish().await;
}

async fn cargo_that_was_withdrawn_from_the_logbook_refuses_no_new_reading(shore: Shore) {
    let job = Job::begin(&shore).await;
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
    shore.finish().await;
}

async fn an_adjustment_is_not_dated_before_its_steps(shore: Shore) {
    let mut job = Job::begin(&shore).await;
    job.post("/berth-reading", &reading()).await.good();
    shore.advance(86_400.0);
    job.person = Person::sign_in(&shore, job.person.operator, &job.person.email).await;
    let order = job.follow_a_plan().await;
    // The berth was read a day before the steps, and so was this.
    let again = read_again(&order["plan"]["plan"]["setting"]);
    let refused = job.post("/second-reading", &again).await;
    assert_eq!(refused.problem(), "invalid");
    assert!(refused.text.contains("before the last step"), "{refused:?}");
    let mut early = word();
    early["at"] = json!("2026-11-21T07:00:00Z");
    let refused = job.post("/complete", &early).await;
    assert_eq!(refused.problem(), "invalid");
    assert!(refused.text.contains("before the last step"), "{refused:?}");
    job.post("/complete", &word()).await.good();
    shore.finish().await;
}

async fn a_prediction_that_nothing_proved_does_not_count_as_fresh(shore: Shore) {
    let mut job = Job::begin(&shore).await;
    let done = job.complete().await;
    let record = job.person.get(&job.path("/record.json")).await.good();
    let made = job
        .person
        .post("/work-orders", &job.new_order())
        .await
        .good();
    made["id"].as_str().unwrap().clone_into(&mut job.order);
    let mut again = reading();
    let there = read_again(&done["setting"]);
    for part in ["forward", "starboard"] {
        again[part] = there[part].clone();
    }
    again.as_object_mut().unwrap().remove("compass_deg");
    again["at"] = json!(AT);
    job.post("/berth-reading", &again).await.good();
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
    shore.finish().await;
}

async fn an_alert_about_the_compass_is_told_with_the_plan(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.post("/berth-reading", &reading()).await.good();
    let notes = async || job.person.get(&job.path("/plan")).await.good()["notes"].to_string();
    let says = "an alert about this compass is open: Compass and gyro parted";
    assert!(!notes().await.contains(says));
    says_that_it_departs(&job.ship, 2).await;
    assert!(notes().await.contains(says), "{}", notes().await);
    shore.finish().await;
}
