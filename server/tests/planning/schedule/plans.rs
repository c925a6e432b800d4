//! Plans: made, stored, and made again when their input changes.

use super::{
    compass_of, due_vessel, enter_port_call, first_job, planned_firm, put, solve, update_schedule,
};
use binnacle_planning::schedule::{self, PlanSlots};
use binnacle_platform::db::Pools;
use binnacle_schedule::{input, plan};
use binnacle_server_testing::on_both;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::{Person, TestServer};
use serde_json::{Value, json};

on_both!(
    a_plan_is_reproducible_from_its_input,
    an_unplanned_job_has_its_reason_and_remedy,
    a_moved_eta_makes_a_new_plan_with_its_cost,
    many_changes_make_one_plan_after_half_a_minute,
    a_new_plan_is_made_each_day,
    an_operator_without_firms_gets_no_automatic_plan,
    a_compass_with_an_open_order_is_listed_beside_the_plan,
    a_fleet_too_large_to_plan_gets_an_error,
    weights_in_settings_apply_and_are_validated,
    schedules_belong_to_one_operator,
);

async fn current(person: &Person) -> Value {
    person.get("/schedule").await.good()
}

async fn a_plan_is_reproducible_from_its_input(server: TestServer) {
    let ada = server.admin("ada").await;
    let none = json!({ "plan": null, "outdated_since": null, "problem": null });
    assert_eq!(current(&ada).await, none);
    assert_eq!(ada.get("/schedule/input").await.problem(), "not-found");
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 8).await;
    planned_firm(&server, &ada, "Maas Compass").await;
    let outdated = current(&ada).await["outdated_since"].clone();
    assert!(outdated.is_string(), "{outdated}");
    let made = solve(&ada).await;
    assert_eq!(first_job(&made), ("NLRTM", "2026-12-09", "Maas Compass"));
    let job = &made["jobs"][0];
    assert_eq!(job["vessel_name"], "Nao");
    assert_eq!(job["compasses"][0]["compass_name"], "Standard compass");
    assert_eq!(
        (&job["state"], &job["due_on"]),
        (&json!("proposed"), &json!("2026-12-20"))
    );
    assert_eq!(
        (&job["fee_eur"], &job["travel_eur"]),
        (&json!(1800.0), &json!(100.0))
    );
    assert_eq!(made["proven_optimal"], true);
    assert_eq!(made["changes"][0]["what"], "new");
    // The same input gives the same plan.
    assert_eq!(solve(&ada).await, made);
    assert_eq!(current(&ada).await["plan"], made);
    let again = ada.get("/schedule/input").await;
    let again = plan::plan(&input::read(&again.text).unwrap());
    assert!((again.cost_eur - made["cost_eur"].as_f64().unwrap()).abs() < 1e-9);
    assert_eq!(again.jobs.len(), 1);
    server.finish().await;
}

async fn an_unplanned_job_has_its_reason_and_remedy(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let pinta = due_vessel(&ada, "Pinta").await;
    for vessel in [&nao, &pinta] {
        // One team and one day suffice for only one of them.
        let call = json!({ "port": "NLRTM", "eta": "2026-12-08T06:00:00Z",
                           "etd": "2026-12-08T20:00:00Z" });
        ada.post(&port_calls::path(vessel), &call).await.good();
    }
    let far = ada.create_vessel("Far").await;
    enter_port_call(&ada, &far, "BRSSZ", 1).await;
    planned_firm(&server, &ada, "Maas Compass").await;
    let made = solve(&ada).await;
    assert_eq!(made["jobs"].as_array().unwrap().len(), 1);
    let unscheduled = made["unscheduled"].as_array().unwrap();
    let of = |name: &str| unscheduled.iter().find(|one| one["vessel_name"] == name);
    let santos = of("Far").unwrap().to_string();
    assert!(santos.contains("no firm serves Santos"), "{santos}");
    let other = of("Nao").or(of("Pinta")).unwrap().to_string();
    assert!(other.contains("teams of 2026-12-08 go to"), "{other}");
    assert!(other.contains("one more team of Maas Compass on 2026-12-08"));
    server.finish().await;
}

async fn a_moved_eta_makes_a_new_plan_with_its_cost(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let call = enter_port_call(&ada, &nao, "NLRTM", 8).await;
    enter_port_call(&ada, &nao, "BEANR", 15).await;
    planned_firm(&server, &ada, "Maas Compass").await;
    assert_eq!(update_schedule(&server).await, Some(ada.operator));
    let before = current(&ada).await["plan"].clone();
    assert_eq!(first_job(&before), ("NLRTM", "2026-12-09", "Maas Compass"));
    let one = format!(
        "{}/{}",
        port_calls::path(&nao),
        call["id"].as_str().unwrap()
    );
    let withdrawn = json!({ "reason": "charter cancelled" });
    ada.post(&format!("{one}/withdraw"), &withdrawn)
        .await
        .good();
    assert_eq!(update_schedule(&server).await, Some(ada.operator));
    let after = current(&ada).await["plan"].clone();
    assert_eq!(first_job(&after), ("BEANR", "2026-12-16", "Maas Compass"));
    let change = &after["changes"][0];
    assert_eq!(change["what"], "moved");
    assert_eq!(
        (&change["from"]["port_name"], &change["from"]["day"]),
        (&json!("Rotterdam"), &json!("2026-12-09"))
    );
    assert_eq!(
        (&change["from"]["paid_eur"], &change["to"]["paid_eur"]),
        (&json!(1900.0), &json!(2200.0))
    );
    assert!(
        change["why"].as_str().unwrap().contains("cancelled"),
        "{change}"
    );
    let against = &after["against"];
    assert_eq!(
        (&against["version"], &against["moved"], &against["paid_eur"]),
        (&json!(1), &json!(1), &json!(300.0))
    );
    let plans = ada.get("/schedule/plans").await.good();
    let versions: Vec<&Value> = plans["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|plan| &plan["version"])
        .collect();
    assert_eq!(versions, [2, 1]);
    assert_eq!(ada.get("/schedule/plans/1").await.good(), before);
    let events = server.events().await;
    assert_eq!(events.iter().filter(|kind| *kind == "schedule").count(), 2);
    server.finish().await;
}

async fn many_changes_make_one_plan_after_half_a_minute(server: TestServer) {
    let ada = server.admin("ada").await;
    planned_firm(&server, &ada, "Maas Compass").await;
    let nao = due_vessel(&ada, "Nao").await;
    for day in [1, 8, 15] {
        enter_port_call(&ada, &nao, "NLRTM", day).await;
    }
    server.advance(20.0);
    assert_eq!(
        schedule::step(&server.app, &PlanSlots::default())
            .await
            .unwrap(),
        None
    );
    let second = server.second_server().await;
    server.advance(11.0);
    let (here, there) = (PlanSlots::default(), PlanSlots::default());
    let (one, other) = tokio::join!(
        schedule::step(&server.app, &here),
        schedule::step(&second, &there)
    );
    // Two servers, one schedule.
    assert!(one.unwrap().is_some() != other.unwrap().is_some());
    assert_eq!(
        schedule::step(&server.app, &PlanSlots::default())
            .await
            .unwrap(),
        None
    );
    assert_eq!(current(&ada).await["plan"]["version"], 1);
    second.db.close().await;
    server.finish().await;
}

async fn a_new_plan_is_made_each_day(server: TestServer) {
    let ada = server.admin("ada").await;
    planned_firm(&server, &ada, "Maas Compass").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 8).await;
    assert!(update_schedule(&server).await.is_some());
    server.advance(86_000.0);
    assert_eq!(
        schedule::step(&server.app, &PlanSlots::default())
            .await
            .unwrap(),
        None
    );
    server.advance(500.0);
    assert!(
        schedule::step(&server.app, &PlanSlots::default())
            .await
            .unwrap()
            .is_some()
    );
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let plan = current(&ada).await["plan"].clone();
    assert_eq!(plan["version"], 2);
    assert_eq!(plan["changes"][0]["what"], "kept");
    server.finish().await;
}

async fn an_operator_without_firms_gets_no_automatic_plan(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 8).await;
    assert!(update_schedule(&server).await.is_some());
    assert_eq!(update_schedule(&server).await, None);
    assert_eq!(current(&ada).await["plan"], json!(null));
    server.finish().await;
}

async fn a_compass_with_an_open_order_is_listed_beside_the_plan(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 8).await;
    planned_firm(&server, &ada, "Maas Compass").await;
    let order = json!({ "vessel_id": nao["id"], "compass_id": compass_of(&nao),
                        "port": "Rotterdam", "planned_at": "2026-12-08T10:00:00Z" });
    let order = ada.post("/work-orders", &order).await.good();
    let made = solve(&ada).await;
    assert_eq!(made["jobs"], json!([]));
    assert_eq!(made["under_way"][0]["order_id"], order["id"]);
    assert_eq!(made["under_way"][0]["vessel_name"], "Nao");
    let cancel = format!("/work-orders/{}/cancel", order["id"].as_str().unwrap());
    ada.post(&cancel, &json!({ "text": "no time" }))
        .await
        .good();
    assert_eq!(solve(&ada).await["jobs"].as_array().unwrap().len(), 1);
    server.finish().await;
}

/// SQL that adds 50,000 port calls, one each second.
macro_rules! many_calls {
    ($id:literal) => {
        concat!(
            "WITH RECURSIVE n (i) AS (SELECT CAST(1 AS BIGINT)
                                      UNION ALL SELECT i + 1 FROM n WHERE i < 50000)
             INSERT INTO port_calls (vessel_id, id, reference, port, eta, eta_uncertainty_h, etd,
                                     etd_uncertainty_h, source, revision, created_at, created_by)
             SELECT c.vessel_id, ",
            $id,
            ", 'n' || n.i, c.port, c.etd + n.i * 1000000, 0, c.etd + n.i * 1000000 + 500000, 0,
                    'api', 1, c.created_at, c.created_by
             FROM port_calls c, n"
        )
    };
}

async fn a_fleet_too_large_to_plan_gets_an_error(server: TestServer) {
    let ada = server.admin("ada").await;
    planned_firm(&server, &ada, "Maas Compass").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 8).await;
    server
        .run_sql(match server.app.db.pools() {
            Pools::Sqlite { .. } => many_calls!("randomblob(16)"),
            Pools::Postgres(_) => many_calls!("gen_random_uuid()"),
        })
        .await;
    let said = "this fleet cannot be planned: port_calls: 50001 entries exceed the limit of 50000";
    let refused = ada.post("/schedule/solve", &json!({})).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert_eq!(refused.json()["detail"], said);
    update_schedule(&server).await;
    assert_eq!(current(&ada).await["problem"], said);
    server.finish().await;
}

async fn weights_in_settings_apply_and_are_validated(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 8).await;
    planned_firm(&server, &ada, "Maas Compass").await;
    for wrong in [
        json!({ "horizon_days": 0 }),
        json!({ "weights": { "job_h": 0 } }),
        json!({ "weights": { "late_eur_day": -1 } }),
        json!({ "weights": { "colour": 1 } }),
        json!({ "terms": { "soon_days": -1 } }),
    ] {
        let response = put(&ada, "/schedule/settings", &wrong).await;
        assert_eq!(response.problem(), "invalid", "{wrong}");
    }
    assert_eq!(
        ada.get("/schedule/settings").await.good()["horizon_days"],
        180
    );
    // Jobs longer than the firm's hours.
    let long = json!({ "weights": { "job_h": 11 } });
    put(&ada, "/schedule/settings", &long).await.good();
    let made = solve(&ada).await;
    let because = made["unscheduled"][0]["because"].to_string();
    assert!(because.contains("too few working hours"), "{because}");
    let near = json!({ "horizon_days": 7 });
    put(&ada, "/schedule/settings", &near).await.good();
    let made = solve(&ada).await;
    assert_eq!(made["later"][0]["vessel_name"], "Nao");
    server.finish().await;
}

async fn schedules_belong_to_one_operator(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    due_vessel(&ada, "Nao").await;
    planned_firm(&server, &ada, "Maas Compass").await;
    solve(&ada).await;
    assert_eq!(current(&eve).await["plan"], json!(null));
    assert_eq!(eve.get("/schedule/plans/1").await.problem(), "not-found");
    assert_eq!(eve.get("/schedule/input").await.problem(), "not-found");
    let plans = eve.get("/schedule/plans").await.good();
    assert_eq!(plans["items"], json!([]));
    let viewer = ada.viewer(&server).await;
    assert!(current(&viewer).await["plan"].is_object());
    let solved = viewer.post("/schedule/solve", &json!({})).await;
    assert_eq!(solved.problem(), "forbidden");
    server.finish().await;
}
