//! Limits of an order, and the compass reading that a step starts from.

use binnacle_server_testing::TestServer;
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::{Job, completion_details, reading};
use serde_json::{Value, json};

on_both!(
    a_step_starts_from_the_last_compass_reading,
    no_plan_beyond_the_limits_is_offered,
    a_plan_beyond_the_limits_cannot_be_completed,
);

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

fn turned(from_deg: f64, to_deg: f64) -> f64 {
    (to_deg - from_deg + 540.0).rem_euclid(360.0) - 180.0
}

async fn a_step_starts_from_the_last_compass_reading(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let step = &order["next_step"];
    let read_deg = (number(&step["expected_compass_deg"]) + 0.4).rem_euclid(360.0);
    let stand = json!({ "setting": step["setting_after"], "compass_deg": read_deg });
    let order = job.post("/corrector-settings", &stand).await.good();
    let kept_deg = number(&order["compass_deg"]);
    assert!(turned(kept_deg, read_deg).abs() < 1e-9, "{kept_deg}");
    let offer = job.person.get(&job.path("/plan")).await.good();
    let next = &offer["plans"][0]["steps"][0];
    let from_here = turned(read_deg, number(&next["expected_compass_deg"]));
    assert!(
        turned(number(&next["change_deg"]), from_here).abs() < 1e-6,
        "{next}"
    );
    // Moved without a reading: the present compass reading is unknown.
    let stand = json!({ "setting": {} });
    let order = job.post("/corrector-settings", &stand).await.good();
    assert_eq!(order["compass_deg"], Value::Null);
    let order = job.post("/plan", &json!({})).await.good();
    let step = &order["next_step"];
    let after = json!({ "after_deg": step["expected_compass_deg"] });
    let path = format!("/steps/{}", step["number"]);
    let refused = job.post(&path, &after).await;
    assert_eq!(refused.problem(), "invalid");
    assert!(refused.text.contains("before_deg"), "{refused:?}");
    server.finish().await;
}

async fn no_plan_beyond_the_limits_is_offered(server: TestServer) {
    let job = Job::begin(&server).await;
    let order = job.post("/berth-reading", &reading()).await.good();
    let limits = &order["limits"];
    let offer = job.person.get(&job.path("/plan")).await.good();
    let plans = offer["plans"].as_array().unwrap();
    for table in plans
        .iter()
        .flat_map(|plan| plan["after"].as_array().unwrap())
    {
        let (reach, band) = (&table["reach_deg"], &table["widest_band_deg"]);
        assert!(number(reach) <= number(&limits["residual_deg"]), "{table}");
        assert!(number(band) <= number(&limits["band_deg"]), "{table}");
    }
    let next = json!({ "plan": plans.len() + 1 });
    assert_eq!(job.post("/plan", &next).await.problem(), "invalid");
    server.finish().await;
}

async fn a_plan_beyond_the_limits_cannot_be_completed(server: TestServer) {
    let mut job = Job::begin(&server).await;
    job.replace_order(json!({ "residual_deg": 2.9 })).await;
    job.adjust().await;
    // As if planned by an earlier version, which offered plans beyond the limits.
    server
        .run_sql(
            "UPDATE work_order_entries \
             SET line = REPLACE(line, '\"residual_deg\":2.9', '\"residual_deg\":0.5')",
        )
        .await;
    let refused = job.post("/complete", &completion_details()).await;
    assert_eq!(refused.problem(), "not-adjustable", "{refused:?}");
    let refusal = refused.json()["refusals"][0].clone();
    assert_eq!(refusal["refusal"], "residual_too_large");
    assert!(!refusal["cures"].as_array().unwrap().is_empty());
    assert_eq!(job.view_order().await["state"], "adjusting");
    server.finish().await;
}
