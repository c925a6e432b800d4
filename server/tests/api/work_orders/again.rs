//! The magnetometer read once more, after the steps.

use super::{AT, Job, read_again, reading, word};
use crate::binnacles::binnacle;
use crate::on_both;
use crate::support::Shore;
use serde_json::{Value, json};

on_both!(
    the_magnetometer_read_again_confirms_an_adjustment,
    a_second_reading_that_does_not_fit_holds_back_the_completion,
    correctors_found_to_stand_otherwise_explain_a_second_reading,
);

async fn the_magnetometer_read_again_confirms_an_adjustment(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let setting = &order["plan"]["plan"]["setting"];
    let early = job.post("/second-reading", &read_again(setting)).await;
    assert_eq!(early.problem(), "wrong-state");
    let order = job.adjust().await;
    let plan = &order["plan"]["plan"];
    let order = job
        .post("/second-reading", &read_again(&plan["setting"]))
        .await;
    let order = order.good();
    let said = &order["second_reading"];
    assert_eq!(said["verdict"], "as_planned", "{said}");
    assert_eq!(said["parts"].as_array().unwrap().len(), 2);
    let done = job.post("/complete", &word()).await.good();
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
    let bx_nt = |model: &Value| model["parameters_over_lambda"]["bx_nt"].as_f64().unwrap();
    let [kept, given] = [&record["model_after"], &done["completion"]["model"]].map(bx_nt);
    assert!((kept - given).abs() < 1e-6, "{kept} {given}");
    shore.finish().await;
}

async fn a_second_reading_that_does_not_fit_holds_back_the_completion(shore: Shore) {
    let job = Job::begin(&shore).await;
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
        .post("/second-reading", &read_again(&wrong))
        .await
        .good();
    let verdict = order["second_reading"]["verdict"].clone();
    assert!(verdict == "unexplained" || verdict == "slip", "{verdict}");
    let held = job.post("/complete", &word()).await;
    assert_eq!(held.problem(), "wrong-state");
    // Neither the same plan once more nor a word that they stand so undoes what was read.
    job.post("/plan", &json!({})).await.good();
    let stand = json!({ "setting": setting });
    let order = job.post("/corrector-settings", &stand).await.good();
    assert_eq!(order["second_reading"]["verdict"], verdict);
    let held = job.post("/complete", &word()).await;
    assert_eq!(held.problem(), "wrong-state");
    // They were put right, and the field says so.
    let order = job.post("/second-reading", &read_again(setting)).await;
    let order = order.good();
    assert_eq!(order["second_reading"]["verdict"], "as_planned", "{order}");
    let done = job.post("/complete", &word()).await.good();
    assert_eq!(done["state"], "adjusted");
    let record = job.person.get(&job.path("/record.json")).await.good();
    assert_eq!(record["second_readings"].as_array().unwrap().len(), 2);
    assert_eq!(record["second_readings"][0]["said"]["verdict"], verdict);
    shore.finish().await;
}

async fn correctors_found_to_stand_otherwise_explain_a_second_reading(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.adjust().await;
    let nothing_done = json!({ "at": AT, "unit": "microtesla",
        "forward": reading()["forward"], "starboard": reading()["starboard"] });
    let order = job.post("/second-reading", &nothing_done).await.good();
    let said = &order["second_reading"];
    assert_ne!(said["verdict"], "as_planned", "{said}");
    // They stand as they were found: what was read is explained, and there has to be a plan.
    let before: Value = serde_json::from_value(binnacle()["setting"].clone()).unwrap();
    let stand = json!({ "setting": before, "compass_deg": reading()["compass_deg"] });
    let order = job.post("/corrector-settings", &stand).await.good();
    assert_eq!(order["second_reading"], Value::Null);
    assert_eq!(order["state"], "measured");
    let again = job.post("/second-reading", &nothing_done).await;
    assert_eq!(again.problem(), "wrong-state");
    shore.finish().await;
}
