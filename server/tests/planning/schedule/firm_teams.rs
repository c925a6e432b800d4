//! Teams that a firm states: their hours, days, licences, ports and travel.

use super::hours::{call, three_ships};
use super::offers::{firm, offer, order_for_firm};
use super::{due_vessel, put, solve, terms};
use binnacle_server_testing::TestServer;
use binnacle_server_testing::on_both;
use serde_json::{Value, json};

on_both!(
    a_firm_states_its_teams_and_they_are_planned_with,
    wrong_teams_are_refused_by_field,
    only_the_firm_states_its_teams,
    a_team_that_is_gone_leaves_its_job_to_another,
);

/// States that one team works in the afternoon, and another holds the licence.
fn teams() -> Value {
    json!({
        "teams": [
            { "name": "Jansen", "first_hour": 13, "last_hour": 17, "ports": ["NLRTM"] },
            { "name": "Peeters", "licences": ["NL-114"], "working_days": ["Tue"] },
        ],
        "travel_times": [{ "from": "NLRTM", "to": "NLRTM", "hours": 1 }],
    })
}

async fn a_firm_states_its_teams_and_they_are_planned_with(server: TestServer) {
    let ada = server.admin("ada").await;
    let ships = three_ships(&ada, "05:00:00", "20:00:00").await;
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let mut two = terms();
    two["jobs_a_team_day"] = json!(2);
    put(&ada, &format!("/firms/{id}/terms"), &two).await.good();
    let path = format!("/firms/{id}/teams");
    let none = ada.get(&path).await.good();
    assert_eq!(
        (&none["teams"], &none["changed_at"]),
        (&json!([]), &json!(null))
    );
    let stated = put(&rosa, &path, &teams()).await.good();
    assert_eq!(ada.get(&path).await.good(), stated);
    assert_eq!(stated["teams"][0]["last_hour"], 17.0);
    let known = json!({ "flag_state": "NO", "gross_tonnage": 24000, "trade": "bulk",
                        "deviation_record": "kept", "licence": "NL-114" });
    let nao = ships[0]["id"].as_str().unwrap();
    put(&ada, &format!("/vessels/{nao}/particulars"), &known)
        .await
        .good();
    let plan = solve(&ada).await;
    let jobs = plan["jobs"].as_array().unwrap();
    assert_eq!(jobs.len(), 3, "{plan}");
    let of = |name: &str| jobs.iter().find(|job| job["vessel_name"] == name).unwrap();
    assert_eq!(of("Nao")["team"], "Peeters");
    let afternoon = jobs.iter().find(|job| job["team"] == "Jansen").unwrap();
    assert_eq!(afternoon["from_local"], "2026-12-15T13:00:00+01:00");
    // Between berths an hour, as the firm says.
    let mut morning: Vec<&str> = jobs
        .iter()
        .filter(|job| job["team"] == "Peeters")
        .map(|job| job["from"].as_str().unwrap())
        .collect();
    morning.sort_unstable();
    assert_eq!(morning, ["2026-12-15T07:00:00Z", "2026-12-15T11:00:00Z"]);
    let order = offer(&ada, &plan, &ships[0]).await;
    let seen = rosa.get(&order).await.good();
    assert_eq!(seen["offers"][0]["team"], "Peeters");
    rosa.post(&format!("{order}/accept"), &json!({}))
        .await
        .good();
    // Peeters has the licence, and is on board.
    let mut again = order_for_firm(&ships[1], "NLRTM", "2026-12-15T08:00:00Z", &id);
    let busy = ada.post("/work-orders", &again).await;
    assert!(busy.text.contains("rosa has no team left"), "{busy:?}");
    again["planned_at"] = json!("2026-12-15T12:00:00Z");
    let taken = ada.post("/work-orders", &again).await.good();
    assert!(!taken["offers"][0]["team"].is_null(), "{taken}");
    // On a Wednesday only the afternoon's team works.
    let mut wednesday = order_for_firm(&ships[2], "BEANR", "2026-12-16T08:00:00Z", &id);
    let nobody = ada.post("/work-orders", &wednesday).await;
    assert!(nobody.text.contains("rosa works from"), "{nobody:?}");
    wednesday["planned_at"] = json!("2026-12-16T12:30:00Z");
    let elsewhere = ada.post("/work-orders", &wednesday).await;
    assert!(
        elsewhere.text.contains("has no team at Antwerpen"),
        "{elsewhere:?}"
    );
    server.finish().await;
}

async fn wrong_teams_are_refused_by_field(server: TestServer) {
    let ada = server.admin("ada").await;
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let path = format!("/firms/{id}/teams");
    for (wrong, named) in [
        (json!({ "teams": [{ "name": " " }] }), "teams"),
        (
            json!({ "teams": [{ "name": "a" }, { "name": "a " }] }),
            "teams: \\\"a\\\" appears twice",
        ),
        (
            json!({ "teams": [{ "name": "a", "first_hour": 19 }] }),
            "not in order",
        ),
        (
            json!({ "teams": [{ "name": "a", "working_days": [] }] }),
            "no day of the week",
        ),
        (
            json!({ "teams": [{ "name": "a", "working_days": ["Someday"] }] }),
            "working_days",
        ),
        (
            json!({ "teams": [{ "name": "a", "ports": ["XXXXX"] }] }),
            "XXXXX",
        ),
        (
            json!({ "teams": [{ "name": "a", "colour": "red" }] }),
            "colour",
        ),
        (
            json!({ "travel_times": [{ "from": "NLRTM", "to": "BEANR", "hours": -1 }] }),
            "travel_times",
        ),
        (
            json!({ "travel_times": [{ "from": "NLRTM", "to": "BEANR", "hours": 1 },
                                  { "from": "BEANR", "to": "NLRTM", "hours": 2 }] }),
            "NLRTM appears twice",
        ),
        (
            json!({ "teams": [{ "name": "a", "ports": ["NLRTM"] }],
                 "travel_times": [{ "from": "NLRTM", "to": "BEANR", "hours": 1 }] }),
            "BEANR is not among its ports",
        ),
    ] {
        let response = put(&rosa, &path, &wrong).await;
        assert_eq!(response.problem(), "invalid", "{wrong}");
        assert!(response.text.contains(named), "{named}: {response:?}");
    }
    let kept = rosa.get(&path).await.good();
    assert_eq!(kept["teams"], json!([]));
    server.finish().await;
}

async fn only_the_firm_states_its_teams(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let (_, juan) = ada.adjuster(&server, "juan").await;
    let path = format!("/firms/{id}/teams");
    for person in [&ada, &eve, &juan] {
        assert_eq!(put(person, &path, &teams()).await.problem(), "not-found");
    }
    put(&rosa, &path, &teams()).await.good();
    assert_eq!(eve.get(&path).await.problem(), "not-found");
    assert_eq!(juan.get(&path).await.problem(), "not-found");
    let listed = ada.get("/firm-terms").await.good();
    let of_rosa = listed["items"].as_array().unwrap().iter();
    let of_rosa = { of_rosa }
        .find(|one| one["firm_id"] == id.as_str())
        .unwrap();
    assert_eq!(of_rosa["teams"][1]["name"], "Peeters");
    server.finish().await;
}

async fn a_team_that_is_gone_leaves_its_job_to_another(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    call(&ada, &nao, "05:00:00", "20:00:00").await;
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let path = format!("/firms/{id}/teams");
    let named = |name: &str| json!({ "teams": [{ "name": name }] });
    put(&rosa, &path, &named("Jansen")).await.good();
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    rosa.post(&format!("{order}/accept"), &json!({}))
        .await
        .good();
    put(&rosa, &path, &named("Peeters")).await.good();
    let plan = solve(&ada).await;
    let job = &plan["jobs"][0];
    assert_eq!(
        (&job["state"], &job["team"]),
        (&json!("confirmed"), &json!("Peeters"))
    );
    // His hours are booked all the same.
    let pinta = due_vessel(&ada, "Pinta").await;
    let order = order_for_firm(&pinta, "NLRTM", "2026-12-15T07:00:00Z", &id);
    let refused = ada.post("/work-orders", &order).await;
    assert!(refused.text.contains("no team left"), "{refused:?}");
    server.finish().await;
}
