//! Hours of jobs: no team is in two places, and what is agreed holds its hours.

use super::agreed_job::AgreedJob;
use super::offers::{firm, offer, offer_of, order_for_firm};
use super::{compass_of, due_vessel, enter_port_call, put, solve, terms};
use binnacle_platform::db::execute;
use binnacle_platform::ids::FirmId;
use binnacle_platform::time::Time;
use binnacle_server_testing::on_both;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::{Person, TestServer};
use serde_json::{Value, json};
use uuid::Uuid;

on_both!(
    of_three_ships_in_one_short_morning_one_is_planned,
    three_ships_of_a_day_are_offered_one_after_the_other,
    an_agreed_job_holds_its_hours_and_others_go_around_it,
    other_hours_agreed_with_a_firm_hold_in_the_plan,
    hours_booked_by_another_operator_are_not_offered,
    two_offers_that_overlap_are_made_once,
    a_pin_may_name_its_hour,
    hours_across_a_change_of_clocks_are_the_ports,
    a_change_of_legal_time_under_a_booked_hour_is_named,
    an_order_from_before_hours_takes_three,
);

/// Enters a call at Rotterdam between two times of 15 December, a Tuesday, in UTC.
pub(super) async fn call(person: &Person, vessel: &Value, from: &str, to: &str) -> Value {
    let new = json!({ "port": "NLRTM", "eta": format!("2026-12-15T{from}Z"),
                      "etd": format!("2026-12-15T{to}Z") });
    person.post(&port_calls::path(vessel), &new).await.good()
}

/// Three ships that are due, each with a call between two times.
pub(super) async fn three_ships(person: &Person, from: &str, to: &str) -> Vec<Value> {
    let mut ships = Vec::new();
    for name in ["Nao", "Pinta", "Santa"] {
        let ship = due_vessel(person, name).await;
        call(person, &ship, from, to).await;
        ships.push(ship);
    }
    ships
}

/// Terms of one team with three jobs a day.
fn three_a_day() -> Value {
    let mut three = terms();
    three["jobs_a_team_day"] = json!(3);
    three
}

/// Begin and end of each job, in order.
fn hours(plan: &Value) -> Vec<(&str, &str)> {
    let jobs = plan["jobs"].as_array().unwrap().iter();
    jobs.map(|job| (job["from"].as_str().unwrap(), job["to"].as_str().unwrap()))
        .collect()
}

/// Three ships alongside from 07:30 to 11:15, one team, and three hours each.
async fn of_three_ships_in_one_short_morning_one_is_planned(server: TestServer) {
    let ada = server.admin("ada").await;
    let ships = three_ships(&ada, "06:30:00", "10:15:00").await;
    let (id, _) = firm(&server, &ada, "rosa").await;
    put(&ada, &format!("/firms/{id}/terms"), &three_a_day())
        .await
        .good();
    let plan = solve(&ada).await;
    let morning = ("2026-12-15T07:00:00Z", "2026-12-15T10:00:00Z");
    assert_eq!(hours(&plan), [morning], "{plan}");
    let job = &plan["jobs"][0];
    assert_eq!(job["from_local"], "2026-12-15T08:00:00+01:00");
    assert_eq!(job["to_local"], "2026-12-15T11:00:00+01:00");
    assert_eq!(
        (&job["team"], &plan["proven_optimal"]),
        (&json!("1"), &json!(true))
    );
    let unscheduled = plan["unscheduled"].as_array().unwrap();
    assert_eq!(unscheduled.len(), 2, "{plan}");
    let because = unscheduled[0]["because"].to_string();
    assert!(because.contains("from 08:00 to 11:00"), "{because}");
    let help = unscheduled[0]["would_help"].to_string();
    assert!(help.contains("until 14:30"), "{help}");
    // The two others are offered by hand, and their team is found to be elsewhere.
    let planned = ships
        .iter()
        .find(|ship| job["vessel_id"] == ship["id"])
        .unwrap();
    offer(&ada, &plan, planned).await;
    for ship in ships.iter().filter(|ship| *ship != planned) {
        let order = order_for_firm(ship, "NLRTM", "2026-12-15T07:00:00Z", &id);
        let refused = ada.post("/work-orders", &order).await;
        assert_eq!(refused.problem(), "wrong-state");
        assert!(
            refused
                .text
                .contains("rosa has no team left on 2026-12-15 from 08:00 to 11:00"),
            "{refused:?}"
        );
    }
    server.finish().await;
}

async fn three_ships_of_a_day_are_offered_one_after_the_other(server: TestServer) {
    let ada = server.admin("ada").await;
    let ships = three_ships(&ada, "05:00:00", "20:00:00").await;
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let mut long = three_a_day();
    long["last_hour"] = json!(20);
    put(&ada, &format!("/firms/{id}/terms"), &long).await.good();
    let mut plan = solve(&ada).await;
    let one_after_the_other = [
        ("2026-12-15T07:00:00Z", "2026-12-15T10:00:00Z"),
        ("2026-12-15T10:30:00Z", "2026-12-15T13:30:00Z"),
        ("2026-12-15T14:00:00Z", "2026-12-15T17:00:00Z"),
    ];
    assert_eq!(hours(&plan), one_after_the_other);
    let mut orders = Vec::new();
    for ship in &ships {
        let order = offer(&ada, &plan, ship).await;
        rosa.post(&format!("{order}/accept"), &json!({}))
            .await
            .good();
        orders.push(order);
        plan = solve(&ada).await;
        assert_eq!(hours(&plan), one_after_the_other);
    }
    let mut booked = Vec::new();
    for order in &orders {
        let order = ada.get(order).await.good();
        booked.push((order["planned_at"].clone(), order["planned_until"].clone()));
    }
    booked.sort_by_key(|(from, _)| from.to_string());
    let expected = one_after_the_other.map(|(from, to)| (json!(from), json!(to)));
    assert_eq!(booked, expected);
    let states = plan["jobs"].as_array().unwrap().iter();
    let states: Vec<&Value> = states.map(|job| &job["state"]).collect();
    assert_eq!(states, ["confirmed"; 3]);
    // What people read has the port's time: the firm's calendar, and its letter.
    let calendar = rosa.get("/calendar.ics").await.text.replace("\r\n ", "");
    assert!(calendar.contains("DTSTART:20261215T070000Z"), "{calendar}");
    assert!(calendar.contains("DTEND:20261215T100000Z"), "{calendar}");
    assert!(
        calendar.contains("2026-12-15 08:00 to 11:00\\, port's time (UTC+01:00)"),
        "{calendar}"
    );
    let notes = rosa.get("/notifications").await.good().to_string();
    assert!(
        notes.contains("Planned:   2026-12-15 08:00 to 11:00, port's time (UTC+01:00)"),
        "{notes}"
    );
    server.finish().await;
}

async fn an_agreed_job_holds_its_hours_and_others_go_around_it(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let AgreedJob {
        ada, firm, order, ..
    } = &agreed;
    let mut long = three_a_day();
    long["last_hour"] = json!(21);
    put(ada, &format!("/firms/{firm}/terms"), &long)
        .await
        .good();
    agreed.retime("2026-12-15T09:00:00Z").await.good();
    agreed.respond(&agreed.rosa, "accept").await.good();
    let pinta = due_vessel(ada, "Pinta").await;
    call(ada, &pinta, "06:00:00", "20:00:00").await;
    let plan = solve(ada).await;
    let around = [
        ("2026-12-15T09:00:00Z", "2026-12-15T12:00:00Z"),
        ("2026-12-15T12:30:00Z", "2026-12-15T15:30:00Z"),
    ];
    assert_eq!(hours(&plan), around, "{plan}");
    // Only cause moves it: an hour at which she is no longer there.
    agreed
        .move_port_call("2026-12-15T10:00:00Z", "2026-12-15T18:00:00Z")
        .await;
    let plan = solve(ada).await;
    let id = order.rsplit('/').next().unwrap();
    let moved = plan["jobs"].as_array().unwrap().iter();
    let moved: Vec<&Value> = moved
        .filter(|job| job["instead_of"] == json!([id]))
        .collect();
    assert_eq!(moved.len(), 1, "{plan}");
    let why = plan["changes"].to_string();
    assert!(why.contains("at the hour agreed"), "{why}");
    server.finish().await;
}

/// A counter-proposal has a beginning and an end.
async fn other_hours_agreed_with_a_firm_hold_in_the_plan(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, pinta) = (
        due_vessel(&ada, "Nao").await,
        due_vessel(&ada, "Pinta").await,
    );
    for ship in [&nao, &pinta] {
        call(&ada, ship, "05:00:00", "20:00:00").await;
    }
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    put(&ada, &format!("/firms/{id}/terms"), &three_a_day())
        .await
        .good();
    let plan = solve(&ada).await;
    let order = offer(&ada, &plan, &nao).await;
    let propose = async |from: &str, until: &str| {
        let terms = json!({ "terms": { "planned_at": format!("2026-12-15T{from}Z"),
                                       "planned_until": format!("2026-12-15T{until}Z") } });
        rosa.post(&format!("{order}/propose"), &terms).await
    };
    let backwards = propose("09:00:00", "09:00:00").await;
    assert_eq!(backwards.problem(), "invalid");
    assert!(backwards.text.contains("planned_until"), "{backwards:?}");
    propose("07:30:00", "12:00:00").await.good();
    ada.post(&format!("{order}/accept"), &json!({}))
        .await
        .good();
    let agreed = ada.get(&order).await.good();
    assert_eq!(agreed["planned_until"], "2026-12-15T12:00:00Z");
    assert_eq!(agreed["planned_until_local"], "2026-12-15T13:00:00+01:00");
    let plan = solve(&ada).await;
    let long = [
        ("2026-12-15T07:30:00Z", "2026-12-15T12:00:00Z"),
        ("2026-12-15T12:30:00Z", "2026-12-15T15:30:00Z"),
    ];
    assert_eq!(hours(&plan), long, "{plan}");
    // The operator asks for another hour, and the job takes as long as agreed.
    let later = json!({ "terms": { "planned_at": "2026-12-15T08:00:00Z" } });
    ada.post(&format!("{order}/retime"), &later).await.good();
    rosa.post(&format!("{order}/retime/accept"), &json!({}))
        .await
        .good();
    let agreed = ada.get(&order).await.good();
    assert_eq!(agreed["planned_until"], "2026-12-15T12:30:00Z");
    server.finish().await;
}

/// Has a second operator work with a firm.
async fn engage(server: &TestServer, person: &Person, firm: &str) {
    let mut tx = server.app.db.begin().await.unwrap();
    let (id, now) = (FirmId(firm.parse().unwrap()), Time(server.app.clock.now()));
    binnacle_orders::firms::engage(&mut tx, person.operator, id, now)
        .await
        .unwrap();
    tx.commit().await.unwrap();
}

async fn hours_booked_by_another_operator_are_not_offered(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    let nao = due_vessel(&ada, "Nao").await;
    call(&ada, &nao, "05:00:00", "20:00:00").await;
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    engage(&server, &eve, &id).await;
    for operator in [&ada, &eve] {
        put(operator, &format!("/firms/{id}/terms"), &three_a_day())
            .await
            .good();
    }
    let plan = solve(&ada).await;
    assert_eq!(plan["jobs"][0]["from"], "2026-12-15T07:00:00Z");
    // Meanwhile the other operator's order takes the morning, in Antwerp.
    let hind = due_vessel(&eve, "Hind").await;
    let mut theirs = order_for_firm(&hind, "BEANR", "2026-12-15T08:00:00Z", &id);
    theirs["planned_until"] = json!("2026-12-15T10:00:00Z");
    let theirs = eve.post("/work-orders", &theirs).await.good();
    let path = format!("/work-orders/{}", theirs["id"].as_str().unwrap());
    rosa.post(&format!("{path}/accept"), &json!({}))
        .await
        .good();
    let refused = ada.post("/schedule/offer", &offer_of(&plan, &nao)).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(
        refused.text.contains("rosa has no team left"),
        "{refused:?}"
    );
    assert!(!refused.text.contains("Hind"), "{refused:?}");
    // The next plan goes around it, with the drive from Antwerp.
    let plan = solve(&ada).await;
    let from = plan["jobs"][0]["from"].as_str().unwrap();
    assert!(
        ("2026-12-15T11:50".."2026-12-15T12:30").contains(&from),
        "{from}"
    );
    offer(&ada, &plan, &nao).await;
    server.finish().await;
}

async fn two_offers_that_overlap_are_made_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, pinta) = (
        due_vessel(&ada, "Nao").await,
        due_vessel(&ada, "Pinta").await,
    );
    let (id, _) = firm(&server, &ada, "rosa").await;
    put(&ada, &format!("/firms/{id}/terms"), &three_a_day())
        .await
        .good();
    let one = order_for_firm(&nao, "NLRTM", "2026-12-15T08:00:00Z", &id);
    let other = |at: &str| order_for_firm(&pinta, "NLRTM", at, &id);
    let overlapping = other("2026-12-15T10:59:00Z");
    let (one, other_one) = tokio::join!(
        ada.post("/work-orders", &one),
        ada.post("/work-orders", &overlapping)
    );
    let mut statuses = [one.status, other_one.status];
    statuses.sort_unstable();
    assert_eq!(statuses, [201, 409], "{one:?} {other_one:?}");
    let refused = if one.status == 409 { &one } else { &other_one };
    assert!(refused.text.contains("you have work order"), "{refused:?}");
    server.finish().await;
}

async fn a_pin_may_name_its_hour(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let call = enter_port_call(&ada, &nao, "NLRTM", 15).await;
    let (id, _) = firm(&server, &ada, "rosa").await;
    let pin = |from: &str| {
        json!({ "compass_id": compass_of(&nao), "call_id": call["id"], "firm_id": id,
                "day": "2026-12-15", "from": from })
    };
    for wrong in ["2026-12-15T05:59:00Z", "2026-12-16T09:00:00Z"] {
        let refused = ada.post("/schedule/pins", &pin(wrong)).await;
        assert_eq!(refused.problem(), "invalid");
        assert!(refused.text.contains("no hour of the call"), "{refused:?}");
    }
    let at = "2026-12-15T11:15:00Z";
    let kept = ada.post("/schedule/pins", &pin(at)).await.good();
    assert_eq!(kept["from"], at);
    let plan = solve(&ada).await;
    assert_eq!(hours(&plan), [(at, "2026-12-15T14:15:00Z")]);
    assert_eq!(plan["jobs"][0]["pinned"], true);
    server.finish().await;
}

/// The firm's day begins at eight on both sides of the change of 28 March 2027.
async fn hours_across_a_change_of_clocks_are_the_ports(server: TestServer) {
    let ada = server.admin("ada").await;
    let ships = [("Nao", "2027-03-27"), ("Pinta", "2027-03-29")];
    let (id, _) = firm(&server, &ada, "rosa").await;
    for (name, day) in ships {
        let ship = ada.create_vessel(name).await;
        let path = format!("/vessels/{}", ship["id"].as_str().unwrap());
        let adjusted = json!({ "kind": "adjustment", "from": "2025-04-10T08:00:00Z" });
        ada.post(&format!("{path}/logbook"), &adjusted).await.good();
        let call = json!({ "port": "NLRTM", "eta": format!("{day}T01:00:00Z"),
                           "etd": format!("{day}T20:00:00Z") });
        ada.post(&port_calls::path(&ship), &call).await.good();
        let local = if day < "2027-03-28" {
            "+01:00"
        } else {
            "+02:00"
        };
        let planned = if day < "2027-03-28" {
            "07:00:00Z"
        } else {
            "06:00:00Z"
        };
        let order = order_for_firm(&ship, "NLRTM", &format!("{day}T{planned}"), &id);
        let order = ada.post("/work-orders", &order).await.good();
        assert_eq!(order["planned_at_local"], format!("{day}T08:00:00{local}"));
        assert_eq!(order["agreed_at_local"], Value::Null);
    }
    let calendar = ada.get("/calendar.ics").await.text.replace("\r\n ", "");
    for words in [
        "2027-03-27 08:00 to 11:00\\, port's time (UTC+01:00)",
        "2027-03-29 08:00 to 11:00\\, port's time (UTC+02:00)",
    ] {
        assert!(calendar.contains(words), "{calendar}");
    }
    server.finish().await;
}

/// As an older release would have stored it, whose time zone database had another offset.
async fn a_change_of_legal_time_under_a_booked_hour_is_named(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let before = agreed.view_order().await;
    assert_eq!(before["planned_at_local"], "2026-12-15T08:00:00+01:00");
    assert_eq!(before["agreed_at_local"], Value::Null);
    let mut tx = server.app.db.begin().await.unwrap();
    let id: Uuid = before["id"].as_str().unwrap().parse().unwrap();
    execute!(
        &mut tx,
        "UPDATE work_orders SET agreed_utc_offset_s = 7200 WHERE id = $1",
        id
    )
    .unwrap();
    tx.commit().await.unwrap();
    let after = agreed.view_order().await;
    assert_eq!(after["planned_at"], before["planned_at"]);
    assert_eq!(after["agreed_at_local"], "2026-12-15T09:00:00+02:00");
    let plan = solve(&agreed.ada).await;
    assert_eq!(plan["jobs"][0]["from"], before["planned_at"]);
    // Another time that is agreed follows the clocks of now.
    agreed.retime("2026-12-15T10:00:00Z").await.good();
    agreed.respond(&agreed.rosa, "accept").await.good();
    let retimed = agreed.view_order().await;
    assert_eq!(retimed["agreed_at_local"], Value::Null);
    server.finish().await;
}

/// Its log names no end.
async fn an_order_from_before_hours_takes_three(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let order = order_for_firm(&nao, "NLRTM", "2026-12-15T08:00:00Z", &id);
    let order = ada.post("/work-orders", &order).await.good();
    assert_eq!(order["planned_until"], "2026-12-15T11:00:00Z");
    let path = format!("/work-orders/{}", order["id"].as_str().unwrap());
    let mut tx = server.app.db.begin().await.unwrap();
    let uuid: Uuid = order["id"].as_str().unwrap().parse().unwrap();
    execute!(
        &mut tx,
        "UPDATE work_order_entries
         SET line = REPLACE(line, '\"planned_until\":\"2026-12-15T11:00:00Z\",', '')
         WHERE order_id = $1",
        uuid
    )
    .unwrap();
    execute!(
        &mut tx,
        "UPDATE work_orders SET agreed_utc_offset_s = NULL WHERE id = $1",
        uuid
    )
    .unwrap();
    tx.commit().await.unwrap();
    rosa.post(&format!("{path}/accept"), &json!({}))
        .await
        .good();
    let read = ada.get(&path).await.good();
    assert_eq!(read["planned_until"], "2026-12-15T11:00:00Z");
    assert_eq!(read["agreed_at_local"], Value::Null);
    server.finish().await;
}
