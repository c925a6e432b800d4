//! Every refusal that an adjustment knows, brought about as it would be at the binnacle.

use super::{HEADING_DEG, Job, read_again, reading, word};
use crate::binnacles::{binnacle, put};
use crate::on_both;
use crate::support::{Person, Shore};
use serde_json::{Value, json};

on_both!(
    a_reading_that_cannot_be_is_refused_by_its_word,
    a_plan_that_would_not_do_is_refused_by_its_word,
    a_lambda_that_the_last_adjustment_contradicts_is_refused_until_the_logbook_explains_it,
    limits_that_nobody_may_ask_for_are_refused,
    one_of_two_browsers_does_a_step,
    what_was_read_before_the_ship_changed_is_read_again,
    correctors_that_are_not_on_board_are_said_to_be_missing,
);

impl Job {
    /// Another order for the same compass, whose plan keeps to these limits.
    pub(super) async fn order_again(&mut self, limits: Value) {
        self.post("/cancel", &json!({ "text": "other limits" }))
            .await
            .good();
        let mut order = self.new_order();
        order["limits"] = limits;
        let made = self.person.post("/work-orders", &order).await.good();
        made["id"].as_str().unwrap().clone_into(&mut self.order);
    }

    /// The word of the first refusal of what is sent.
    async fn refused(&self, rest: &str, body: &Value) -> Value {
        let answer = self.post(rest, body).await;
        assert_eq!(answer.problem(), "not-adjustable", "{answer:?}");
        let refusal = answer.json()["refusals"][0].clone();
        assert!(!refusal["cures"].as_array().unwrap().is_empty());
        assert!(!refusal["words"].as_str().unwrap().is_empty());
        refusal["refusal"].clone()
    }
}

fn with(changes: &Value) -> Value {
    let mut body = reading();
    let changes = changes.as_object().unwrap().clone();
    body.as_object_mut().unwrap().extend(changes);
    body
}

async fn a_reading_that_cannot_be_is_refused_by_its_word(shore: Shore) {
    let job = Job::begin(&shore).await;
    let good = reading();
    let part = |name: &str, times: f64| json!(times * good[name].as_f64().unwrap());
    let times = |times: f64| {
        with(&json!({ "forward": part("forward", times), "starboard": part("starboard", times) }))
    };
    for (body, word) in [
        (
            with(&json!({ "heading_true_deg": HEADING_DEG + 9.0 })),
            "inconsistent_berth",
        ),
        (times(4.0), "implausible_lambda"),
        (times(1e4), "no_such_field"),
        (times(0.0), "no_such_field"),
        (with(&json!({ "down": 1e6 })), "no_such_field"),
        (
            with(&json!({ "lat": -64.1, "lon": 136.0 })),
            "field_too_weak",
        ),
        // In the far south her own field and the earth's undo each other on this heading.
        (
            with(&json!({ "lat": -61.2, "lon": 136.0, "heading_true_deg": 225.0 })),
            "ambiguous_headings",
        ),
    ] {
        assert_eq!(job.refused("/berth-reading", &body).await, word, "{body}");
    }
    let nanotesla = times(1000.0);
    let answer = job.post("/berth-reading", &nanotesla).await.json();
    let could_be = answer["refusals"][0]["could_be"].to_string();
    assert!(could_be.contains("in nanotesla"), "{answer}");
    shore.finish().await;
}

async fn a_plan_that_would_not_do_is_refused_by_its_word(shore: Shore) {
    let mut job = Job::begin(&shore).await;
    let none = json!({});
    for (limits, body, word) in [
        (json!({ "model_age_days": 1.0 }), &none, "model_too_old"),
        (json!({ "band_deg": 0.2 }), &none, "band_too_wide"),
        (json!({ "residual_deg": 0.5 }), &none, "residual_too_large"),
        (
            json!({ "residual_deg": 0.5, "lambda_sd": 0.005 }),
            &json!({ "magnetometer": "other" }),
            // Spheres have to stay, and would not lessen what is left of her.
            "residual_too_large",
        ),
        (
            json!({}),
            &json!({ "cargo_on_board": true }),
            "cargo_on_board",
        ),
        // The heading is right, and nobody is sure of that.
        (
            json!({}),
            &json!({ "heading_sd_deg": 4.0 }),
            "unchecked_berth",
        ),
    ] {
        job.order_again(limits.clone()).await;
        job.post("/berth-reading", &with(body)).await.good();
        let order = job.seen().await;
        for (name, limit) in limits.as_object().unwrap() {
            assert_eq!(order["limits"][name], *limit);
        }
        let refused = job.refused("/plan", &json!({})).await;
        assert_eq!(refused, word, "{limits}");
        assert_eq!(job.seen().await["state"], "measured");
    }
    shore.finish().await;
}

/// As a ship whose magnetism has changed by 2 µT along the needle would make it.
async fn a_lambda_that_the_last_adjustment_contradicts_is_refused_until_the_logbook_explains_it(
    shore: Shore,
) {
    let mut job = Job::begin(&shore).await;
    let done = job.complete().await;
    let setting = done["plan"]["plan"]["setting"].clone();
    let made = job.person.post("/work-orders", &job.new_order()).await;
    made.good()["id"]
        .as_str()
        .unwrap()
        .clone_into(&mut job.order);
    let read = |times: f64| {
        let mut body = reading();
        let again = read_again(&setting);
        for name in ["forward", "starboard"] {
            body[name] = json!(again[name].as_f64().unwrap() * times);
        }
        body["compass_deg"] = Value::Null;
        body
    };
    let is_other = |answer: &crate::support::Answer| answer.text.contains("\"other_lambda\"");
    job.post("/berth-reading", &read(1.0)).await.good();
    let same = job.person.get(&job.path("/plan")).await;
    assert_eq!(same.status, 200, "{}", same.text);
    job.post("/berth-reading", &read(1.1)).await.good();
    let other = job.person.get(&job.path("/plan")).await;
    assert!(is_other(&other), "{}", other.text);
    assert!(other.text.contains("berth of 2026-11-21"), "{}", other.text);
    let repair = json!({ "kind": "repair", "from": super::AT, "to": super::AT });
    let path = job.ship.path("/logbook");
    job.person.post(&path, &repair).await.good();
    job.post("/berth-reading", &read(1.1)).await.good();
    let explained = job.person.get(&job.path("/plan")).await;
    assert_eq!(explained.status, 200, "{}", explained.text);
    shore.finish().await;
}

async fn limits_that_nobody_may_ask_for_are_refused(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.post("/cancel", &json!({ "text": "another" }))
        .await
        .good();
    for limits in [
        json!({ "residual_deg": 6.0 }),
        json!({ "residual_deg": -1.0 }),
        json!({ "band_deg": 10.0 }),
        json!({ "model_age_days": 400.0 }),
        json!({ "residual": 3.0 }),
    ] {
        let mut order = job.new_order();
        order["limits"] = limits.clone();
        let answer = job.person.post("/work-orders", &order).await;
        assert_eq!(answer.problem(), "invalid", "{limits}");
        assert!(answer.text.contains("limits"), "{}", answer.text);
    }
    shore.finish().await;
}

async fn one_of_two_browsers_does_a_step(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let step = &order["next_step"];
    let path = format!("/steps/{}", step["number"]);
    let read = json!({ "after_deg": step["expected_compass_deg"] });
    let (one, other) = tokio::join!(job.post(&path, &read), job.post(&path, &read));
    let mut answers = [one.status, other.status];
    answers.sort_unstable();
    assert_eq!(answers, [200, 409], "{one:?} {other:?}");
    assert_eq!(job.seen().await["last_seq"], 4, "it is done once");
    shore.finish().await;
}

async fn what_was_read_before_the_ship_changed_is_read_again(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.post("/berth-reading", &reading()).await.good();
    let welded = json!({ "kind": "welding", "from": "2026-11-21T06:45:00Z" });
    job.person
        .post(&job.ship.path("/logbook"), &welded)
        .await
        .good();
    shore.work().await;
    let refused = job.post("/plan", &json!({})).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(refused.text.contains("read the berth again"), "{refused:?}");
    // And what was read long ago, when she may have lain elsewhere.
    let other = Job::of(&shore, shore.admin("eve").await).await;
    other.post("/berth-reading", &reading()).await.good();
    shore.advance(60.0 * 3600.0);
    let person = Person::sign_in(&shore, other.person.operator, &other.person.email);
    let late = Job {
        person: person.await,
        ..other
    };
    let refused = late.post("/plan", &json!({})).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(refused.text.contains("hours ago"), "{refused:?}");
    shore.finish().await;
}

async fn correctors_that_are_not_on_board_are_said_to_be_missing(shore: Shore) {
    let job = Job::begin(&shore).await;
    let path = job
        .ship
        .path(&format!("/compasses/{}/binnacle", job.compass));
    let mut empty = binnacle();
    empty["aboard"]["magnets"] = json!([]);
    let answer = put(&job.person, &path, &empty).await;
    assert_eq!(answer.problem(), "invalid");
    assert!(answer.text.contains("name at least one"), "{answer:?}");
    // One magnet is too few for what she needs.
    let mut few = binnacle();
    few["aboard"] = json!({ "magnets": [{ "magnet": "200 mm", "count": 1 }] });
    put(&job.person, &path, &few).await.good();
    job.post("/berth-reading", &reading()).await.good();
    assert_eq!(job.refused("/plan", &json!({})).await, "residual_too_large");
    let early = job.post("/complete", &word()).await;
    assert_eq!(early.problem(), "wrong-state");
    shore.finish().await;
}
