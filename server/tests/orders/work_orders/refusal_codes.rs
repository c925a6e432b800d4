//! Every refusal code of an adjustment, caused as at the binnacle.

use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::AT;
use binnacle_server_testing::work_orders::{
    HEADING_DEG, Job, LAMBDA, at_berth, completion_details, reading, second_reading,
};
use binnacle_server_testing::{Person, TestServer, true_model};
use serde_json::{Value, json};

on_both!(
    an_impossible_reading_is_refused_with_its_code,
    an_insufficient_plan_is_refused_with_its_code,
    steel_on_the_quay_shows_on_another_heading,
    a_lambda_contradicting_the_last_adjustment_needs_a_logbook_entry,
    invalid_limits_are_refused,
    a_step_is_done_by_one_of_two_browsers,
    a_reading_from_before_a_change_must_be_repeated,
    missing_correctors_are_named,
);

fn reading_with(changes: &Value) -> Value {
    let mut body = reading();
    let changes = changes.as_object().unwrap().clone();
    body.as_object_mut().unwrap().extend(changes);
    body
}

async fn an_impossible_reading_is_refused_with_its_code(server: TestServer) {
    let job = Job::begin(&server).await;
    let good = reading();
    let part = |name: &str, times: f64| json!(times * good[name].as_f64().unwrap());
    let times = |times: f64| {
        reading_with(
            &json!({ "forward": part("forward", times), "starboard": part("starboard", times) }),
        )
    };
    for (body, word) in [
        (
            reading_with(&json!({ "heading_true_deg": HEADING_DEG + 9.0 })),
            "inconsistent_berth",
        ),
        (times(4.0), "implausible_lambda"),
        (times(1e4), "no_such_field"),
        (times(0.0), "no_such_field"),
        (reading_with(&json!({ "down": 1e6 })), "no_such_field"),
        (
            reading_with(&json!({ "lat": -64.1, "lon": 136.0 })),
            "field_too_weak",
        ),
        // In the far south the ship's own field cancels the earth's on this heading.
        (
            reading_with(&json!({ "lat": -61.2, "lon": 136.0, "heading_true_deg": 225.0 })),
            "ambiguous_headings",
        ),
    ] {
        assert_eq!(
            job.refusal_code("/berth-reading", &body).await,
            word,
            "{body}"
        );
    }
    let nanotesla = times(1000.0);
    let response = job.post("/berth-reading", &nanotesla).await.json();
    let could_be = response["refusals"][0]["could_be"].to_string();
    assert!(could_be.contains("in nanotesla"), "{response}");
    server.finish().await;
}

async fn an_insufficient_plan_is_refused_with_its_code(server: TestServer) {
    let mut job = Job::begin(&server).await;
    let none = json!({});
    for (limits, body, word) in [
        (json!({ "model_age_days": 1.0 }), &none, "model_too_old"),
        (json!({ "band_deg": 0.2 }), &none, "band_too_wide"),
        (json!({ "residual_deg": 0.5 }), &none, "residual_too_large"),
        (
            json!({ "residual_deg": 0.5, "lambda_sd": 0.005 }),
            &json!({ "magnetometer": "other" }),
            // The spheres are fixed, and would not reduce the rest.
            "residual_too_large",
        ),
        (
            json!({}),
            &json!({ "cargo_on_board": true }),
            "cargo_on_board",
        ),
        // The heading is right, but of unknown accuracy.
        (
            json!({}),
            &json!({ "heading_sd_deg": 4.0 }),
            "unchecked_berth",
        ),
    ] {
        job.replace_order(limits.clone()).await;
        job.post("/berth-reading", &reading_with(body)).await.good();
        let order = job.view_order().await;
        for (name, limit) in limits.as_object().unwrap() {
            assert_eq!(order["limits"][name], *limit);
        }
        let refused = job.refusal_code("/plan", &json!({})).await;
        assert_eq!(refused, word, "{limits}");
        assert_eq!(job.view_order().await["state"], "measured");
    }
    server.finish().await;
}

/// The ship is shifted by 120 degrees, and lies there beside steel or not.
async fn steel_on_the_quay_shows_on_another_heading(server: TestServer) {
    let job = Job::begin(&server).await;
    let (magnetic_deg, earth) = at_berth();
    let other_rad = (magnetic_deg + 120.0).to_radians();
    let parameters = true_model().parameters_over_lambda;
    let there = parameters.field_over_lambda(other_rad, earth);
    let [forward, starboard] = there.map(|part| LAMBDA * part / 1000.0);
    let shifted = |steel: f64| {
        reading_with(&json!({ "shifted": {
            "heading_true_deg": HEADING_DEG + 120.0,
            "forward": forward + steel, "starboard": starboard,
        } }))
    };
    let near = reading_with(&json!({ "shifted": {
        "heading_true_deg": HEADING_DEG + 10.0, "forward": forward, "starboard": starboard,
    } }));
    let refused = job.post("/berth-reading", &near).await;
    assert_eq!(refused.problem(), "invalid");
    assert!(refused.text.contains("shifted"), "{refused:?}");
    job.post("/berth-reading", &shifted(5.0)).await.good();
    let code = job.refusal_code("/plan", &json!({})).await;
    assert_eq!(code, "foreign_field");
    job.post("/berth-reading", &shifted(0.0)).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let notes = order["plan"]["notes"].to_string();
    assert!(!notes.contains("steel on the quay"), "{notes}");
    server.finish().await;
}

/// The reading is that of a ship whose magnetism changed by 2 µT along the needle.
async fn a_lambda_contradicting_the_last_adjustment_needs_a_logbook_entry(server: TestServer) {
    let mut job = Job::begin(&server).await;
    let done = job.complete().await;
    let setting = done["plan"]["plan"]["setting"].clone();
    let made = job.person.post("/work-orders", &job.new_order()).await;
    made.good()["id"]
        .as_str()
        .unwrap()
        .clone_into(&mut job.order);
    job.confirm_as_found().await;
    let read = |times: f64| {
        let mut body = reading();
        let repeated = second_reading(&setting);
        for name in ["forward", "starboard"] {
            body[name] = json!(repeated[name].as_f64().unwrap() * times);
        }
        body["compass_deg"] = Value::Null;
        body
    };
    let is_other = |response: &binnacle_server_testing::ApiResponse| {
        response.text.contains("\"other_lambda\"")
    };
    job.post("/berth-reading", &read(1.0)).await.good();
    let same = job.person.get(&job.path("/plan")).await;
    assert_eq!(same.status, 200, "{}", same.text);
    job.post("/berth-reading", &read(1.1)).await.good();
    let other = job.person.get(&job.path("/plan")).await;
    assert!(is_other(&other), "{}", other.text);
    assert!(other.text.contains("berth of 2026-11-21"), "{}", other.text);
    let repair = json!({ "kind": "repair", "from": AT, "to": AT });
    let path = job.ship.path("/logbook");
    job.person.post(&path, &repair).await.good();
    job.post("/berth-reading", &read(1.1)).await.good();
    let explained = job.person.get(&job.path("/plan")).await;
    assert_eq!(explained.status, 200, "{}", explained.text);
    server.finish().await;
}

async fn invalid_limits_are_refused(server: TestServer) {
    let job = Job::begin(&server).await;
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
        let response = job.person.post("/work-orders", &order).await;
        assert_eq!(response.problem(), "invalid", "{limits}");
        assert!(response.text.contains("limits"), "{}", response.text);
    }
    server.finish().await;
}

async fn a_step_is_done_by_one_of_two_browsers(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let step = &order["next_step"];
    let path = format!("/steps/{}", step["number"]);
    let read = json!({ "after_deg": step["expected_compass_deg"] });
    let (one, other) = tokio::join!(job.post(&path, &read), job.post(&path, &read));
    let mut statuses = [one.status, other.status];
    statuses.sort_unstable();
    assert_eq!(statuses, [200, 409], "{one:?} {other:?}");
    assert_eq!(job.view_order().await["last_seq"], 5, "it is done once");
    server.finish().await;
}

async fn a_reading_from_before_a_change_must_be_repeated(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let welded = json!({ "kind": "welding", "from": "2026-11-21T06:45:00Z" });
    job.person
        .post(&job.ship.path("/logbook"), &welded)
        .await
        .good();
    server.work().await;
    let refused = job.post("/plan", &json!({})).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(refused.text.contains("read the berth again"), "{refused:?}");
    // Neither does an old reading, when the ship may have lain elsewhere.
    let other = Job::for_person(&server, server.admin("eve").await).await;
    other.post("/berth-reading", &reading()).await.good();
    server.advance(60.0 * 3600.0);
    let person = Person::sign_in(&server, other.person.operator, &other.person.email);
    let late = Job {
        person: person.await,
        ..other
    };
    let refused = late.post("/plan", &json!({})).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(refused.text.contains("hours ago"), "{refused:?}");
    server.finish().await;
}

async fn missing_correctors_are_named(server: TestServer) {
    let job = Job::begin(&server).await;
    let path = job
        .ship
        .path(&format!("/compasses/{}/binnacle", job.compass));
    let mut empty = binnacle();
    empty["aboard"]["magnets"] = json!([]);
    let response = put(&job.person, &path, &empty).await;
    assert_eq!(response.problem(), "invalid");
    assert!(response.text.contains("name at least one"), "{response:?}");
    // One magnet is too few for this ship.
    let mut few = binnacle();
    few["aboard"] = json!({ "magnets": [{ "magnet": "200 mm", "count": 1 }] });
    put(&job.person, &path, &few).await.good();
    job.post("/berth-reading", &reading()).await.good();
    assert_eq!(
        job.refusal_code("/plan", &json!({})).await,
        "residual_too_large"
    );
    let early = job.post("/complete", &completion_details()).await;
    assert_eq!(early.problem(), "wrong-state");
    server.finish().await;
}
