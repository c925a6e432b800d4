//! The second magnetometer reading, after the steps.

use binnacle_server_testing::TestServer;
use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::{
    AT, Job, at_berth, completion_details, reading, second_reading, second_reading_after,
};
use serde_json::{Value, json};

on_both!(
    a_second_reading_confirms_an_adjustment,
    an_inconsistent_second_reading_stops_the_completion,
    a_found_corrector_setting_explains_a_second_reading,
    residuals_over_the_limits_are_planned_again_from_the_second_reading,
    inconsistent_steps_need_a_second_reading_for_completion,
    an_unhelpful_explanation_leaves_a_second_reading_open,
    a_compass_reading_against_the_field_is_not_confirmed,
    a_vertical_mismatch_needs_another_vertical_reading,
    heeling_magnets_are_confirmed_only_by_the_vertical_part,
    a_reading_of_an_unplanned_setting_is_a_basis_for_a_plan,
);

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

async fn a_second_reading_confirms_an_adjustment(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let setting = &order["plan"]["plan"]["setting"];
    let early = job.post("/second-reading", &second_reading(setting)).await;
    assert_eq!(early.problem(), "wrong-state");
    let order = job.adjust().await;
    let plan = &order["plan"]["plan"];
    let order = job
        .post("/second-reading", &second_reading(&plan["setting"]))
        .await;
    let order = order.good();
    let said = &order["second_reading"];
    assert_eq!(said["verdict"], "as_planned", "{said}");
    assert_eq!(said["parts"].as_array().unwrap().len(), 2);
    let done = job.post("/complete", &completion_details()).await.good();
    assert_ne!(
        done["completion"]["model"]["covariance"],
        plan["model_after"]["covariance"]
    );
    let record = job.person.get(&job.path("/record.json")).await.good();
    assert_eq!(
        record["second_readings"][0]["said"]["verdict"],
        "as_planned"
    );
    assert_eq!(record["not_shown"], Value::Null);
    assert_eq!(record["adjuster"]["account"], "ada@example.com");
    let bx_nt = |model: &Value| model["parameters_over_lambda"]["bx_nt"].as_f64().unwrap();
    let [kept, given] = [&record["model_after"], &done["completion"]["model"]].map(bx_nt);
    assert!((kept - given).abs() < 1e-6, "{kept} {given}");
    server.finish().await;
}

async fn an_inconsistent_second_reading_stops_the_completion(server: TestServer) {
    let job = Job::begin(&server).await;
    let order = job.adjust().await;
    let setting = &order["plan"]["plan"]["setting"];
    let mut wrong = setting.clone();
    for axis in ["fore_and_aft", "athwartship"] {
        for tray in wrong[axis].as_array_mut().unwrap() {
            let turned = match tray["red"].as_str().unwrap() {
                "forward" => "aft",
                "aft" => "forward",
                "port" => "starboard",
                _ => "port",
            };
            tray["red"] = json!(turned);
        }
    }
    let order = job
        .post("/second-reading", &second_reading(&wrong))
        .await
        .good();
    let verdict = order["second_reading"]["verdict"].clone();
    assert!(verdict == "unexplained" || verdict == "slip", "{verdict}");
    let held = job.post("/complete", &completion_details()).await;
    assert_eq!(held.problem(), "wrong-state");
    // Neither the same plan again nor a statement of the setting overrides the reading.
    job.post("/plan", &json!({})).await.good();
    let stand = json!({ "setting": setting });
    let order = job.post("/corrector-settings", &stand).await.good();
    assert_eq!(order["second_reading"]["verdict"], verdict);
    let held = job.post("/complete", &completion_details()).await;
    assert_eq!(held.problem(), "wrong-state");
    // They were corrected, and the field confirms it.
    let order = job.post("/second-reading", &second_reading(setting)).await;
    let order = order.good();
    assert_eq!(order["second_reading"]["verdict"], "as_planned", "{order}");
    let done = job.post("/complete", &completion_details()).await.good();
    assert_eq!(done["state"], "adjusted");
    let record = job.person.get(&job.path("/record.json")).await.good();
    assert_eq!(record["second_readings"].as_array().unwrap().len(), 2);
    assert_eq!(record["second_readings"][0]["said"]["verdict"], verdict);
    server.finish().await;
}

async fn a_found_corrector_setting_explains_a_second_reading(server: TestServer) {
    let job = Job::begin(&server).await;
    job.adjust().await;
    let nothing_done = json!({ "at": AT, "unit": "microtesla",
        "forward": reading()["forward"], "starboard": reading()["starboard"] });
    let order = job.post("/second-reading", &nothing_done).await.good();
    let said = &order["second_reading"];
    assert_ne!(said["verdict"], "as_planned", "{said}");
    // They stand as found: the reading is explained, and a plan is needed.
    let before: Value = serde_json::from_value(binnacle()["setting"].clone()).unwrap();
    let stand = json!({ "setting": before, "compass_deg": reading()["compass_deg"] });
    let order = job.post("/corrector-settings", &stand).await.good();
    assert_eq!(order["second_reading"], Value::Null);
    assert_eq!(order["state"], "measured");
    let again = job.post("/second-reading", &nothing_done).await;
    assert_eq!(again.problem(), "wrong-state");
    server.finish().await;
}

async fn residuals_over_the_limits_are_planned_again_from_the_second_reading(server: TestServer) {
    let mut job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let offer = job.person.get(&job.path("/plan")).await.good();
    let after = offer["plans"][0]["after"].as_array().unwrap();
    let reach_deg = after.iter().map(|table| number(&table["reach_deg"]));
    let reach_deg = reach_deg.fold(0.0, f64::max);
    job.replace_order(json!({ "residual_deg": reach_deg + 0.2 }))
        .await;
    let order = job.adjust().await;
    let setting = &order["plan"]["plan"]["setting"];
    let before = order["plan"]["plan"]["before"].clone();
    let (mut said, mut off) = (Value::Null, Value::Null);
    for (forward, starboard) in [(0.7, 0.7), (0.7, -0.7), (-0.7, 0.7), (-0.7, -0.7)] {
        off = second_reading(setting);
        off["forward"] = json!(number(&off["forward"]) + forward);
        off["starboard"] = json!(number(&off["starboard"]) + starboard);
        let order = job.post("/second-reading", &off).await.good();
        said = order["second_reading"].clone();
        if said["verdict"] == "replan" {
            break;
        }
        assert_eq!(said["verdict"], "as_planned", "{said}");
    }
    assert_eq!(said["verdict"], "replan", "{said}");
    assert_eq!(said["refusals"][0]["refusal"], "residual_too_large");
    let held = job.post("/complete", &completion_details()).await;
    assert_eq!(held.problem(), "wrong-state");
    // Another reading may agree with the plan, and replaces the earlier one.
    let order = job.post("/second-reading", &second_reading(setting)).await;
    let order = order.good();
    assert_eq!(order["second_reading"]["verdict"], "as_planned");
    assert_eq!(order["state"], "adjusting");
    job.post("/second-reading", &off).await.good();
    let order = job.follow_plan().await;
    assert!(order["steps_done"].as_u64() > Some(0), "{order}");
    job.post("/complete", &completion_details()).await.good();
    // The record starts with the first reading of the adjustment.
    let record = job.person.get(&job.path("/record.json")).await.good();
    assert_eq!(record["predicted_before"], before);
    assert_eq!(record["reading"]["forward"], reading()["forward"]);
    server.finish().await;
}

async fn inconsistent_steps_need_a_second_reading_for_completion(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let mut order = job.post("/plan", &json!({})).await.good();
    while let Some(step) = order["next_step"].as_object() {
        // Each within its own tolerance, all in the same direction.
        let off_deg = 0.95 * number(&step["tolerance_deg"]);
        let after_deg = number(&step["expected_compass_deg"]) + off_deg;
        let after = json!({ "after_deg": after_deg.rem_euclid(360.0) });
        let path = format!("/steps/{}", step["number"]);
        order = job.post(&path, &after).await.good();
        assert_eq!(order["last_step"]["verdict"], "confirmed", "{order}");
    }
    let held = job.post("/complete", &completion_details()).await;
    assert_eq!(held.problem(), "wrong-state");
    assert!(held.text.contains("second reading"), "{held:?}");
    let setting = &order["plan"]["plan"]["setting"];
    let order = job.post("/second-reading", &second_reading(setting)).await;
    assert_eq!(order.good()["second_reading"]["verdict"], "as_planned");
    job.post("/complete", &completion_details()).await.good();
    server.finish().await;
}

async fn an_unhelpful_explanation_leaves_a_second_reading_open(server: TestServer) {
    let job = Job::begin(&server).await;
    let order = job.adjust().await;
    let setting = &order["plan"]["plan"]["setting"];
    let mut off = second_reading(setting);
    off["forward"] = json!(number(&off["forward"]) + 33.0);
    let order = job.post("/second-reading", &off).await.good();
    assert_eq!(order["second_reading"]["verdict"], "unexplained");
    assert_eq!(order["looked_since"], false);
    // One magnet in another place cannot explain so much.
    let mut other = setting.clone();
    let trays = if other["athwartship"] == json!([]) {
        "fore_and_aft"
    } else {
        "athwartship"
    };
    let hole = other[trays][0]["hole"].as_u64().unwrap();
    other[trays][0]["hole"] = json!(if hole > 1 { hole - 1 } else { hole + 1 });
    let stand = json!({ "setting": other });
    let order = job.post("/corrector-settings", &stand).await.good();
    assert_eq!(order["second_reading"]["verdict"], "unexplained");
    assert_eq!(order["looked_since"], true);
    let stand = json!({ "setting": setting });
    job.post("/corrector-settings", &stand).await.good();
    job.post("/plan", &json!({})).await.good();
    let held = job.post("/complete", &completion_details()).await;
    assert_eq!(held.problem(), "wrong-state");
    let order = job.post("/second-reading", &second_reading(setting)).await;
    assert_eq!(order.good()["looked_since"], false);
    job.post("/complete", &completion_details()).await.good();
    let record = job.person.get(&job.path("/record.json")).await.good();
    assert_eq!(record["settings_as_said"][0]["after"], other);
    server.finish().await;
}

async fn a_compass_reading_against_the_field_is_not_confirmed(server: TestServer) {
    let job = Job::begin(&server).await;
    let order = job.adjust().await;
    let compass_deg = number(&order["compass_deg"]);
    let mut again = second_reading(&order["plan"]["plan"]["setting"]);
    again["compass_deg"] = json!((compass_deg + 145.0).rem_euclid(360.0));
    let said = job.post("/second-reading", &again).await.good()["second_reading"].clone();
    assert_eq!(said["verdict"], "unexplained");
    let words = said["words"].as_str().unwrap();
    assert!(words.starts_with("the compass read"), "{words}");
    assert_eq!(
        said["could_be"][0],
        "the compass was misread, or its heading mistyped"
    );
    // A mistake that explains both is listed before one that explains the compass alone.
    let mut swapped = again.clone();
    swapped["compass_deg"] = json!(compass_deg);
    swapped["forward"] = again["starboard"].clone();
    swapped["starboard"] = again["forward"].clone();
    let said = job.post("/second-reading", &swapped).await.good()["second_reading"].clone();
    assert_eq!(said["verdict"], "unexplained");
    assert_eq!(said["could_be"][0], "the magnetometer's axes are swapped");
    assert_eq!(
        job.post("/complete", &completion_details()).await.problem(),
        "wrong-state"
    );
    again["compass_deg"] = json!(compass_deg);
    let said = job.post("/second-reading", &again).await.good()["second_reading"].clone();
    assert_eq!(said["verdict"], "as_planned", "{said}");
    server.finish().await;
}

/// Adjusts a ship that needs heeling magnets, with the vertical part of the reading.
async fn adjusted_with_heeling_magnets(server: &TestServer) -> (Job, Value, Value) {
    let job = Job::begin(server).await;
    let path = format!("/compasses/{}/binnacle", job.compass);
    let mut more = binnacle();
    let magnets = more["aboard"]["magnets"].as_array_mut().unwrap();
    magnets.push(json!({ "magnet": "heeling 150 mm", "count": 2 }));
    put(&job.person, &job.ship.path(&path), &more).await.good();
    let mut first = reading();
    first["down"] = json!(at_berth().1.z_nt / 1000.0 + 8.0);
    job.post("/berth-reading", &first).await.good();
    let order = job.follow_plan().await;
    let setting = order["plan"]["plan"]["setting"].clone();
    assert!(setting["heeling"].is_object(), "{setting}");
    (job, first, setting)
}

fn without_down(reading: &Value) -> Value {
    let mut reading = reading.clone();
    reading.as_object_mut().unwrap().remove("down");
    reading
}

async fn a_vertical_mismatch_needs_another_vertical_reading(server: TestServer) {
    let (job, first, setting) = adjusted_with_heeling_magnets(&server).await;
    let mut truly = setting.clone();
    truly["heeling"] = Value::Null;
    let not_done = second_reading_after(&first, &truly);
    let order = job.post("/second-reading", &not_done).await.good();
    assert_eq!(order["second_reading"]["verdict"], "slip", "{order}");
    let blind = job.post("/second-reading", &without_down(&not_done)).await;
    assert_eq!(blind.problem(), "invalid");
    assert!(blind.text.contains("down"), "{blind:?}");
    let held = job.post("/complete", &completion_details()).await;
    assert_eq!(held.problem(), "wrong-state");
    let done = second_reading_after(&first, &setting);
    let order = job.post("/second-reading", &done).await.good();
    assert_eq!(order["second_reading"]["verdict"], "as_planned", "{order}");
    job.post("/complete", &completion_details()).await.good();
    let record = job.person.get(&job.path("/record.json")).await.good();
    assert_eq!(record["not_shown"], Value::Null);
    server.finish().await;
}

async fn heeling_magnets_are_confirmed_only_by_the_vertical_part(server: TestServer) {
    let (job, first, setting) = adjusted_with_heeling_magnets(&server).await;
    let blind = without_down(&second_reading_after(&first, &setting));
    let said = job.post("/second-reading", &blind).await.good()["second_reading"].clone();
    assert_eq!(said["verdict"], "as_planned", "{said}");
    assert!(
        said["words"].as_str().unwrap().contains("heeling"),
        "{said}"
    );
    job.post("/complete", &completion_details()).await.good();
    let record = job.person.get(&job.path("/record.json")).await.good();
    let hidden = record["not_shown"]["steps"].as_array().unwrap();
    assert_eq!(hidden.len(), 1, "{hidden:?}");
    assert!(
        hidden[0].as_str().unwrap().contains("heeling"),
        "{hidden:?}"
    );
    server.finish().await;
}

async fn a_reading_of_an_unplanned_setting_is_a_basis_for_a_plan(server: TestServer) {
    let job = Job::begin(&server).await;
    let order = job.adjust().await;
    let mut other = order["plan"]["plan"]["setting"].clone();
    let axis = if other["athwartship"] == json!([]) {
        "fore_and_aft"
    } else {
        "athwartship"
    };
    let hole = other[axis][0]["hole"].as_u64().unwrap();
    other[axis][0]["hole"] = json!(if hole > 1 { hole - 1 } else { hole + 1 });
    let stand = json!({ "setting": other });
    job.post("/corrector-settings", &stand).await.good();
    let order = job
        .post("/second-reading", &second_reading(&other))
        .await
        .good();
    let said = &order["second_reading"];
    assert_eq!(said["verdict"], "replan", "{said}");
    assert_eq!(order["state"], "measured");
    let offer = job.person.get(&job.path("/plan")).await.good();
    assert!(!offer["plans"].as_array().unwrap().is_empty());
    server.finish().await;
}
