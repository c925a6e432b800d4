//! Capacity and opening hours of a firm's teams.

use super::agreed_job::AgreedJob;
use super::offers::{firm, offer, offer_of, order_for_firm};
use super::{due_vessel, enter_port_call, first_job, put, solve, terms};
use binnacle_server_testing::on_both;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::{ApiResponse, TestServer};
use serde_json::{Value, json};

on_both!(
    no_offer_is_made_for_a_time_outside_opening_hours,
    a_firm_is_offered_no_more_ships_than_it_has_teams,
    a_team_booked_by_an_order_is_planned_for_no_other_ship,
    a_firm_with_a_simultaneous_offer_is_planned_for_no_other_ship_then,
    a_firms_team_is_booked_once_across_operators,
    an_order_needs_a_valid_port_and_time,
);

/// Creates a firm with these terms, open from 8 to 18 on every day but Sunday.
async fn no_offer_is_made_for_a_time_outside_opening_hours(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let mut closed = terms();
    closed["closed"] = json!(["2026-12-14"]);
    put(&ada, &format!("/firms/{id}/terms"), &closed)
        .await
        .good();
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    rosa.post(&format!("{order}/accept"), &json!({}))
        .await
        .good();
    let retime = async |at: &str| {
        let terms = json!({ "terms": { "planned_at": at } });
        ada.post(&format!("{order}/retime"), &terms).await
    };
    for (at, message) in [
        (
            "2026-12-14T09:00:00Z",
            "rosa does not work on 2026-12-14, a Monday",
        ),
        (
            "2026-12-15T03:00:00Z",
            "rosa works from 2026-12-15T07:00:00Z to 2026-12-15T17:00:00Z",
        ),
    ] {
        let refused = retime(at).await;
        assert_eq!(refused.problem(), "wrong-state", "{at}");
        assert!(refused.text.contains(message), "{refused:?}");
    }
    retime("2026-12-15T10:00:00Z").await.good();
    let why = json!({ "text": "no more" });
    ada.post(&format!("{order}/cancel"), &why).await.good();
    let new_order = order_for_firm(&nao, "NLRTM", "2026-12-14T09:00:00Z", &id);
    let refused = ada.post("/work-orders", &new_order).await;
    assert!(refused.text.contains("does not work on"), "{refused:?}");
    server.finish().await;
}

async fn a_firm_is_offered_no_more_ships_than_it_has_teams(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, pinta) = (
        due_vessel(&ada, "Nao").await,
        due_vessel(&ada, "Pinta").await,
    );
    for vessel in [&nao, &pinta] {
        enter_port_call(&ada, vessel, "NLRTM", 14).await;
    }
    let (firm_id, _) = firm(&server, &ada, "rosa").await;
    let mut two = terms();
    two["teams"] = json!(2);
    let path = format!("/firms/{firm_id}/terms");
    put(&ada, &path, &two).await.good();
    let plan = solve(&ada).await;
    let days: Vec<&Value> = plan["jobs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|job| &job["day"])
        .collect();
    assert_eq!(days, ["2026-12-15", "2026-12-15"]);
    // One of the teams is lost while both orders are offered.
    put(&ada, &path, &terms()).await.good();
    let (one, other) = (offer_of(&plan, &nao), offer_of(&plan, &pinta));
    let (one, other): (ApiResponse, ApiResponse) = tokio::join!(
        ada.post("/schedule/offer", &one),
        ada.post("/schedule/offer", &other)
    );
    let mut statuses = [one.status, other.status];
    statuses.sort_unstable();
    assert_eq!(statuses, [201, 409], "{one:?} {other:?}");
    server.finish().await;
}

async fn a_firm_with_a_simultaneous_offer_is_planned_for_no_other_ship_then(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, pinta) = (
        due_vessel(&ada, "Nao").await,
        due_vessel(&ada, "Pinta").await,
    );
    let mut that_day = port_calls::call("NLRTM", 15);
    that_day["etd"] = json!("2026-12-15T20:00:00Z");
    for vessel in [&nao, &pinta] {
        ada.post(&port_calls::path(vessel), &that_day).await.good();
    }
    let (rosa, _) = firm(&server, &ada, "rosa").await;
    let (juan, _) = firm(&server, &ada, "juan").await;
    let mut order = order_for_firm(&nao, "NLRTM", "2026-12-15T09:00:00Z", &rosa);
    order["offer"] = json!({ "firms": [rosa, juan], "at_once": true });
    ada.post("/work-orders", &order).await.good();
    // Each of the two firms may accept, and has one team.
    let plan = solve(&ada).await;
    assert_eq!(plan["jobs"].as_array().unwrap().len(), 1, "{plan}");
    assert_eq!(plan["jobs"][0]["state"], "offered");
    let because = plan["unscheduled"][0]["because"].to_string();
    assert!(because.contains("are booked"), "{because}");
    server.finish().await;
}

/// An order whose job was moved still keeps its day at the firm.
async fn a_team_booked_by_an_order_is_planned_for_no_other_ship(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let AgreedJob {
        ada,
        nao,
        firm,
        order,
        ..
    } = &agreed;
    solve(ada).await;
    agreed
        .move_port_call("2026-12-22T06:00:00Z", "2026-12-23T18:00:00Z")
        .await;
    enter_port_call(ada, nao, "BEANR", 17).await;
    let pinta = due_vessel(ada, "Pinta").await;
    let mut that_day = port_calls::call("NLRTM", 15);
    that_day["etd"] = json!("2026-12-15T20:00:00Z");
    ada.post(&port_calls::path(&pinta), &that_day).await.good();
    let plan = solve(ada).await;
    let id = order.rsplit('/').next().unwrap();
    assert_eq!(first_job(&plan), ("BEANR", "2026-12-18", "rosa"));
    assert_eq!(plan["jobs"][0]["instead_of"], json!([id]));
    assert_eq!(plan["jobs"].as_array().unwrap().len(), 1, "{plan}");
    let because = plan["unscheduled"][0]["because"].to_string();
    assert!(
        because.contains("rosa's teams of 2026-12-15 are booked"),
        "{because}"
    );
    let why = plan["changes"].to_string();
    assert!(why.contains("not long enough at the hour agreed"), "{why}");
    // That brought no new information.
    assert_eq!(solve(ada).await["version"], plan["version"]);
    let new_order = order_for_firm(&pinta, "NLRTM", "2026-12-15T09:00:00Z", firm);
    let full = ada.post("/work-orders", &new_order).await;
    assert_eq!(full.problem(), "wrong-state");
    assert!(
        full.text
            .contains(&format!("you have work order {id} of Nao")),
        "{full:?}"
    );
    let cancelled = json!({ "text": "she is late" });
    ada.post(&format!("{order}/cancel"), &cancelled)
        .await
        .good();
    let plan = solve(ada).await;
    assert_eq!(first_job(&plan), ("NLRTM", "2026-12-15", "rosa"));
    offer(ada, &plan, &pinta).await;
    server.finish().await;
}

async fn a_firms_team_is_booked_once_across_operators(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    let (nao, hind) = (
        due_vessel(&ada, "Nao").await,
        due_vessel(&eve, "Hind").await,
    );
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let mut tx = server.app.db.begin().await.unwrap();
    let firm_id = binnacle_platform::ids::FirmId(id.parse().unwrap());
    let now = binnacle_platform::time::Time(server.app.clock.now());
    binnacle_orders::firms::engage(&mut tx, eve.operator, firm_id, now)
        .await
        .unwrap();
    tx.commit().await.unwrap();
    // One team gets two offers before it has responded to either.
    let at = "2026-12-15T09:00:00Z";
    let hers = order_for_firm(&nao, "NLRTM", at, &id);
    let hers = ada.post("/work-orders", &hers).await.good();
    let theirs = order_for_firm(&hind, "BEANR", at, &id);
    let theirs = eve.post("/work-orders", &theirs).await.good();
    let yes = |order: &Value| format!("/work-orders/{}/accept", order["id"].as_str().unwrap());
    let (one, other) = (yes(&hers), yes(&theirs));
    let body = json!({});
    let (one, other) = tokio::join!(rosa.post(&one, &body), rosa.post(&other, &body));
    let mut statuses = [one.status, other.status];
    statuses.sort_unstable();
    assert_eq!(statuses, [200, 409], "{one:?} {other:?}");
    let refused = if one.status == 409 { &one } else { &other };
    assert!(
        refused
            .text
            .contains("your firm has no team left on 2026-12-15: it goes to"),
        "{refused:?}"
    );
    // The later operator learns that, and sees only its own orders.
    let (late, ship, theirs) = if one.status == 409 {
        (&ada, "Niña", "Hind")
    } else {
        (&eve, "Golden", "Nao")
    };
    let ship = due_vessel(late, ship).await;
    let full = late
        .post("/work-orders", &order_for_firm(&ship, "NLRTM", at, &id))
        .await;
    assert_eq!(full.problem(), "wrong-state");
    assert!(
        full.text.contains("rosa has no team left on 2026-12-15"),
        "{full:?}"
    );
    assert!(!full.text.contains(theirs), "{full:?}");
    server.finish().await;
}

async fn an_order_needs_a_valid_port_and_time(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 14).await;
    let (id, _) = firm(&server, &ada, "rosa").await;
    let ask = async |port: &str, at: &str| {
        let order = order_for_firm(&nao, port, at, &id);
        ada.post("/work-orders", &order).await
    };
    let elsewhere = ask("ESBIO", "2026-12-15T09:00:00Z").await;
    assert_eq!(elsewhere.status, 422);
    assert!(
        elsewhere
            .text
            .contains("the vessel is at Rotterdam (NLRTM) then, not at Bilbao (ESBIO)"),
        "{elsewhere:?}"
    );
    for at in [
        "2020-01-01T00:00:00Z",
        "9999-01-01T00:00:00Z",
        "2026-11-20T23:00:00Z",
    ] {
        assert_eq!(ask("NLRTM", at).await.status, 422, "{at}");
    }
    // Two days to respond would be longer than the time left.
    let order = ask("BEANR", "2026-11-21T14:00:00Z").await.good();
    assert_eq!(order["answer_by"], "2026-11-21T14:00:00Z");
    let path = format!("/work-orders/{}", order["id"].as_str().unwrap());
    let why = json!({ "text": "not this day" });
    ada.post(&format!("{path}/cancel"), &why).await.good();
    server.finish().await;
}
