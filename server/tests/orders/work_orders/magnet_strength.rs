//! A step with an unexpected compass reading, and the magnet strength or the wrong record found by it.

use binnacle_compass::model::Model;
use binnacle_server_testing::binnacles::{binnacle, put};
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::{Job, reading_on_ship, second_reading_after};
use binnacle_server_testing::{TestServer, true_model};
use serde_json::{Value, json};

on_both!(
    a_tray_in_a_wrong_hole_does_not_change_the_magnet_strength,
    a_corrected_tray_does_not_change_the_magnet_strength,
    a_wrong_end_in_the_record_stays_corrected_after_another_report,
);

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

/// Returns a ship that needs magnets near the card, where one hole makes a difference.
fn ship() -> Model {
    let mut ship = true_model();
    (
        ship.parameters_over_lambda.bx_nt,
        ship.parameters_over_lambda.by_nt,
    ) = (3_500.0, -3_000.0);
    ship
}

/// Returns the compass reading at the berth with a corrector setting, without needle effects.
fn compass_reading_deg(setting: &Value) -> f64 {
    let field = second_reading_after(&reading_on_ship(&ship()), setting);
    let [forward, starboard] = ["forward", "starboard"].map(|part| number(&field[part]));
    (-starboard).atan2(forward).to_degrees()
}

fn turn_deg(from: &Value, to: &Value) -> f64 {
    (compass_reading_deg(to) - compass_reading_deg(from) + 540.0).rem_euclid(360.0) - 180.0
}

/// Returns setting and hole with the step's tray some holes off; `None` outside the holes.
fn with_hole_error(step: &Value, by: i64) -> Option<(u64, Value)> {
    let to = &step["to"];
    let hole = u64::try_from(to["hole"].as_i64()? + by).ok()?;
    let mut setting = step["setting_after"].clone();
    let axis = step["corrector"].as_str()?.to_owned();
    let trays = setting[axis.as_str()].as_array_mut()?;
    if trays.iter().any(|tray| tray["hole"] == hole) {
        return None;
    }
    let mut trays = trays.iter_mut();
    trays.find(|tray| tray["hole"] == to["hole"])?["hole"] = json!(hole);
    Some((hole, setting))
}

/// Returns a job whose last step was three holes off, with the step, the corrector setting
/// and the compass reading.
async fn job_with_wrong_hole(server: &TestServer) -> (Job, Value, Value, f64) {
    let person = server.admin("ada").await;
    let job = Job::on_ship(server, person, &ship()).await;
    let read = reading_on_ship(&ship());
    job.post("/berth-reading", &read).await.good();
    let mut order = job.post("/plan", &json!({})).await.good();
    loop {
        let step = order["next_step"].clone();
        assert!(step.is_object(), "no step shows three holes: {order}");
        let path = format!("/steps/{}", step["number"]);
        let before_deg = number(&order["compass_deg"]);
        let shows = |(hole, setting): (u64, Value)| {
            let turned_deg = turn_deg(&step["setting_before"], &setting);
            let off_deg = (turned_deg - number(&step["change_deg"])).abs();
            let share = turned_deg / number(&step["change_deg"]);
            let is_shown = off_deg > 1.3 * number(&step["tolerance_deg"]);
            (is_shown && (0.4..1.9).contains(&share)).then_some((hole, setting, turned_deg))
        };
        let mut off = [-3, 3]
            .into_iter()
            .filter_map(|by| with_hole_error(&step, by));
        if let Some((hole, setting, turned_deg)) = off.find_map(shows) {
            let compass_deg = (before_deg + turned_deg).rem_euclid(360.0);
            let read = json!({ "after_deg": compass_deg });
            let order = job.post(&path, &read).await.good();
            let new_setting = &order["last_step"];
            assert_eq!(new_setting["verdict"], "other_strength", "{new_setting}");
            let words = new_setting["words"].as_str().unwrap();
            assert!(
                words.contains(&format!("or stands at hole {hole}")),
                "{words}"
            );
            return (job, step, setting, compass_deg);
        }
        let after = json!({ "after_deg": step["expected_compass_deg"] });
        order = job.post(&path, &after).await.good();
    }
}

/// Follows a new plan with magnets of catalogue strength.
async fn follow_new_plan(job: &Job, new_setting: &Value) {
    let order = job.post("/corrector-settings", new_setting).await.good();
    assert_eq!(order["last_step"], Value::Null);
    let mut order = job.post("/plan", &json!({})).await.good();
    while let Some(step) = order["next_step"].as_object() {
        let turned_deg = turn_deg(&step["setting_before"], &step["setting_after"]);
        let after_deg = (number(&order["compass_deg"]) + turned_deg).rem_euclid(360.0);
        let path = format!("/steps/{}", step["number"]);
        let read = json!({ "after_deg": after_deg });
        order = job.post(&path, &read).await.good();
        let verdict = &order["last_step"]["verdict"];
        assert!(
            *verdict == "confirmed" || *verdict == "not_seen",
            "{}",
            order["last_step"]
        );
    }
}

async fn a_tray_in_a_wrong_hole_does_not_change_the_magnet_strength(server: TestServer) {
    let (job, _, setting, compass_deg) = job_with_wrong_hole(&server).await;
    let new_setting = json!({
        "setting": setting, "compass_deg": compass_deg, "note": "counted from the top",
    });
    follow_new_plan(&job, &new_setting).await;
    server.finish().await;
}

async fn a_corrected_tray_does_not_change_the_magnet_strength(server: TestServer) {
    let (job, step, setting, compass_deg) = job_with_wrong_hole(&server).await;
    let as_planned = &step["setting_after"];
    let compass_deg = compass_deg + turn_deg(&setting, as_planned);
    let new_setting = json!({
        "setting": as_planned, "compass_deg": compass_deg.rem_euclid(360.0),
    });
    follow_new_plan(&job, &new_setting).await;
    server.finish().await;
}

/// Returns the second reading with a setting of a ship whose correctors stood otherwise at the first.
fn field_after(setting: &Value, stood: &Value) -> Value {
    let first = reading_on_ship(&ship());
    let [mut now, before] = [setting, stood].map(|set| second_reading_after(&first, set));
    for part in ["forward", "starboard"] {
        now[part] = json!(number(&now[part]) - number(&before[part]) + number(&first[part]));
    }
    now
}

async fn a_wrong_end_in_the_record_stays_corrected_after_another_report(server: TestServer) {
    let person = server.admin("ada").await;
    let job = Job::on_ship(&server, person, &ship()).await;
    let tray = |red: &str| json!({ "athwartship": [{ "hole": 9, "magnet": "200 mm", "count": 2, "red": red }] });
    let (stood, said) = (tray("port"), tray("starboard"));
    let mut recorded = binnacle();
    recorded["setting"]["athwartship"] = said["athwartship"].clone();
    let path = format!("/compasses/{}/binnacle", job.compass);
    put(&job.person, &job.ship.path(&path), &recorded)
        .await
        .good();
    job.confirm_as_found().await;
    job.post("/berth-reading", &reading_on_ship(&ship()))
        .await
        .good();
    let mut order = job.post("/plan", &json!({})).await.good();
    let step = loop {
        let step = order["next_step"].clone();
        assert!(
            step.is_object(),
            "no step moves the tray: {}",
            order["plan"]["plan"]["steps"]
        );
        let path = format!("/steps/{}", step["number"]);
        if step["corrector"] == "athwartship" && step["from"]["hole"] == 9 {
            // Iron and other magnets stand already as planned.
            let mut before = step["setting_before"].clone();
            for other in before["athwartship"].as_array_mut().unwrap() {
                if other["hole"] == 9 {
                    other["red"] = json!("port");
                }
            }
            let heading = |setting: &Value| {
                let field = field_after(setting, &stood);
                let [forward, starboard] =
                    ["forward", "starboard"].map(|part| number(&field[part]));
                (-starboard).atan2(forward).to_degrees()
            };
            let turned_deg = heading(&step["setting_after"]) - heading(&before);
            let after_deg = (number(&order["compass_deg"]) + turned_deg).rem_euclid(360.0);
            let read = json!({ "after_deg": after_deg });
            order = job.post(&path, &read).await.good();
            break step;
        }
        let after = json!({ "after_deg": step["expected_compass_deg"] });
        order = job.post(&path, &after).await.good();
    };
    assert_eq!(
        order["last_step"]["verdict"], "found_otherwise",
        "{}",
        order["last_step"]
    );
    // They take the magnets of the step out.
    let mut setting = step["setting_after"].clone();
    setting["athwartship"] = json!([]);
    let report = json!({ "setting": setting, "note": "taken out" });
    job.post("/corrector-settings", &report).await.good();
    let field = field_after(&setting, &stood);
    let order = job.post("/second-reading", &field).await.good();
    let result = &order["second_reading"];
    assert_eq!(result["verdict"], "replan", "{result}");
    server.finish().await;
}
