//! Due dates of compasses, and the rules behind them.

use super::{due_vessel, enter_port_call, put};
use binnacle_compass::model::Model;
use binnacle_planning::notifications::notify_of_needs;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{Person, Ship, TestServer, days_at_sea, true_model};
use serde_json::{Value, json};

on_both!(
    a_compass_without_a_record_is_unknown_and_says_by_which_rule,
    known_particulars_postpone_the_due_date,
    needs_are_paged_by_due_date,
    ship_work_and_a_canal_transit_bring_a_due_date_forward,
    a_moved_compass_is_due_like_a_new_one,
    planned_work_does_not_count_as_done,
    deviation_over_its_limit_becomes_overdue,
    a_need_says_how_far_the_order_of_its_compass_has_come,
    predicted_deviation_at_a_next_port_brings_a_due_date_forward,
    deviation_over_the_vessels_own_limit_brings_a_due_date_forward,
    particulars_are_validated_and_belong_to_the_operator,
    a_cancelled_order_does_not_count_as_an_adjustment,
    an_operators_own_terms_apply_to_it_alone,
);

const A_WHILE_S: f64 = 60.0;

fn path(vessel: &Value, rest: &str) -> String {
    format!("/vessels/{}{rest}", vessel["id"].as_str().unwrap())
}

async fn need(person: &Person, vessel: &Value) -> Value {
    let list = person.get(&path(vessel, "/needs")).await.good();
    list["items"][0].clone()
}

async fn a_compass_without_a_record_is_unknown_and_says_by_which_rule(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let need = need(&ada, &nao).await;
    assert_eq!(
        (&need["due_on"], &need["urgency"]),
        (&json!("2027-01-20"), &json!("unknown"))
    );
    assert_eq!(need["vessel_name"], "Nao");
    assert_eq!(need["causes"][0]["kind"], "never_adjusted");
    let rule = &need["causes"][0]["rule"];
    assert_eq!(rule["document"], "ISO 25862:2019");
    assert_eq!(rule["second_hand"], true);
    let all = ["flag_state", "gross_tonnage", "trade", "deviation_record"];
    assert_eq!(need["not_known"], json!(all));
    server.finish().await;
}

async fn a_need_says_how_far_the_order_of_its_compass_has_come(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    assert_eq!(need(&ada, &nao).await["order"], Value::Null);
    let order = json!({ "vessel_id": nao["id"], "compass_id": nao["compasses"][0]["id"],
                        "port": "Bilbao", "planned_at": "2026-11-22T09:00:00Z" });
    let order = ada.post("/work-orders", &order).await.good();
    let open = need(&ada, &nao).await["order"].clone();
    assert_eq!(
        (&open["id"], &open["state"]),
        (&order["id"], &json!("planned"))
    );
    assert_eq!(open["until"], "2026-11-22T12:00:00Z");
    let orders = format!("/work-orders/{}", order["id"].as_str().unwrap());
    let on_board = format!("{orders}/on-board");
    ada.post(&on_board, &json!({})).await.good();
    assert_eq!(need(&ada, &nao).await["order"]["state"], "on_board");
    let cancel = json!({ "text": "the call is too short" });
    ada.post(&format!("{orders}/cancel"), &cancel).await.good();
    assert_eq!(need(&ada, &nao).await["order"], Value::Null);
    server.finish().await;
}

async fn known_particulars_postpone_the_due_date(server: TestServer) {
    let ada = server.admin("ada").await;
    let flagged = json!({ "name": "Nao", "flag": "Panama" });
    let nao = ada.post("/vessels", &flagged).await.good();
    let adjusted = json!({ "kind": "adjustment", "from": "2026-03-01T08:00:00Z" });
    ada.post(&path(&nao, "/logbook"), &adjusted).await.good();
    // A Panamanian ship without a record has a year.
    assert_eq!(need(&ada, &nao).await["due_on"], "2027-03-01");
    let kept = json!({ "deviation_record": "kept" });
    put(&ada, &path(&nao, "/particulars"), &kept).await.good();
    let need = need(&ada, &nao).await;
    assert_eq!(
        (&need["due_on"], &need["urgency"]),
        (&json!("2028-03-01"), &json!("routine"))
    );
    assert_eq!(need["adjusted_on"], "2026-03-01");
    assert_eq!(need["not_known"], json!(["gross_tonnage", "trade"]));
    server.finish().await;
}

async fn needs_are_paged_by_due_date(server: TestServer) {
    let ada = server.admin("ada").await;
    due_vessel(&ada, "Nao").await;
    ada.create_vessel("Pinta").await;
    due_vessel(&ada, "Santa").await;
    let (mut found, mut after) = (Vec::new(), String::new());
    loop {
        let page = ada.get(&format!("/needs?limit=1{after}")).await.good();
        found.push(page["items"][0]["vessel_name"].clone());
        let Some(next) = page["next"].as_str() else {
            break;
        };
        after = format!("&after={next}");
    }
    // Of Pinta no adjustment is on record.
    assert_eq!(found, ["Nao", "Santa", "Pinta"]);
    let soon = ada
        .get("/needs?urgency=soon&due_by=2026-12-20")
        .await
        .good();
    assert_eq!(soon["items"].as_array().unwrap().len(), 2);
    let eve = server.admin("eve").await;
    assert_eq!(eve.get("/needs").await.good()["items"], json!([]));
    server.finish().await;
}

async fn ship_work_and_a_canal_transit_bring_a_due_date_forward(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    assert_eq!(need(&ada, &nao).await["due_on"], "2026-12-20");
    let docked = json!({ "kind": "dry_docking", "from": "2026-11-01T00:00:00Z",
                         "to": "2026-11-10T00:00:00Z" });
    ada.post(&path(&nao, "/logbook"), &docked).await.good();
    let after_dock = need(&ada, &nao).await;
    assert_eq!(after_dock["due_on"], "2026-12-10");
    assert!(
        after_dock["reason"]
            .as_str()
            .unwrap()
            .contains("dry-docking")
    );
    let transit =
        json!({ "flag_state": "NO", "transits": [{ "canal": "panama", "on": "2026-12-05" }] });
    put(&ada, &path(&nao, "/particulars"), &transit)
        .await
        .good();
    let before_transit = need(&ada, &nao).await;
    assert_eq!(before_transit["due_on"], "2026-12-05");
    assert_eq!(before_transit["causes"][0]["kind"], "transit");
    server.finish().await;
}

async fn a_moved_compass_is_due_like_a_new_one(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let moved = json!({ "kind": "compass_moved", "from": "2026-11-05T00:00:00Z" });
    ada.post(&path(&nao, "/logbook"), &moved).await.good();
    let after = need(&ada, &nao).await;
    assert_eq!(after["due_on"], "2026-12-05", "{after}");
    assert_eq!(after["causes"][0]["kind"], "event");
    server.finish().await;
}

async fn planned_work_does_not_count_as_done(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let docking = json!({ "kind": "dry_docking", "from": "2026-11-21T20:00:00Z",
                          "to": "2026-11-25T00:00:00Z" });
    ada.post(&path(&nao, "/logbook"), &docking).await.good();
    let events = |need: &Value| {
        let causes = need["causes"].as_array().unwrap().iter();
        let of_events = causes.filter(|cause| cause["kind"] == "event");
        of_events
            .map(|cause| cause["due_on"].clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(events(&need(&ada, &nao).await), Vec::<Value>::new());
    server.advance(86_400.0);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    assert_eq!(events(&need(&ada, &nao).await), [json!("2026-12-25")]);
    server.finish().await;
}

/// Creates an Australian ship with a record of deviations and some days at sea. Its band
/// limit is so wide that it raises no alert.
async fn australian(server: &TestServer, ada: &Person, true_model: &Model) -> (Ship, Value) {
    let nao = server.ship(ada, "Nao").await;
    let samples = days_at_sea(true_model, "2026-11-10T00:00:00Z", 6.0);
    nao.put(1, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    let vessel = ada.get(&nao.path("")).await.good();
    let mut settings = ada.get(&nao.path("/settings")).await.good();
    settings["alerts"]["band95_deg"] = json!(45.0);
    put(ada, &nao.path("/settings"), &settings).await.good();
    let known = json!({ "flag_state": "AU", "deviation_record": "kept" });
    put(ada, &nao.path("/particulars"), &known).await.good();
    (nao, vessel)
}

/// Two weeks from the first sighting, not from each day.
async fn deviation_over_its_limit_becomes_overdue(server: TestServer) {
    let ada = server.admin("ada").await;
    let mut strong = true_model();
    strong.parameters_over_lambda.bx_nt += 3_000.0;
    let (nao, vessel) = australian(&server, &ada, &strong).await;
    let adjusted = json!({ "kind": "adjustment", "from": "2026-11-01T08:00:00Z" });
    ada.post(&nao.path("/logbook"), &adjusted).await.good();
    notify_of_needs(&server.app).await.unwrap();
    let first = need(&ada, &vessel).await;
    assert_eq!(first["causes"][0]["kind"], "over_limit", "{first}");
    assert_eq!(first["due_on"], "2026-12-05");
    server.advance(20.0 * 86_400.0);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let later = need(&ada, &vessel).await;
    assert_eq!(
        (&later["due_on"], &later["urgency"]),
        (&json!("2026-12-05"), &json!("overdue"))
    );
    let reason = later["reason"].as_str().unwrap();
    assert!(reason.contains("or more since 2026-11-21"), "{reason}");
    server.finish().await;
}

async fn predicted_deviation_at_a_next_port_brings_a_due_date_forward(server: TestServer) {
    let ada = server.admin("ada").await;
    let (nao, vessel) = australian(&server, &ada, &true_model()).await;
    let adjusted = json!({ "kind": "adjustment", "from": "2025-12-01T08:00:00Z" });
    let sure = need(&ada, &vessel).await;
    let here = sure["predicted"][0]["worst_deviation_deg"]
        .as_f64()
        .unwrap();
    assert_eq!(sure["predicted"][0]["place"], "here");
    ada.post(&nao.path("/logbook"), &adjusted).await.good();
    // In the far north the directive field is weak, and the ship's field weighs more.
    enter_port_call(&ada, &vessel, "NOTOS", 8).await;
    let need = need(&ada, &vessel).await;
    let ahead = &need["predicted"][1];
    assert_eq!(
        (&ahead["place"], &ahead["on"]),
        (&json!("Tromsø"), &json!("2026-12-08"))
    );
    let there = ahead["worst_deviation_deg"].as_f64().unwrap();
    assert!(there > 1.5 * here && there > 5.0, "{here} {there}");
    let over = need["causes"].as_array().unwrap().iter();
    let mut over = over.filter(|cause| cause["kind"] == "over_limit");
    let over = over.next().unwrap_or_else(|| panic!("{need}"));
    assert!(
        over["rule"]["document"]
            .as_str()
            .unwrap()
            .contains("Australian")
    );
    server.finish().await;
}

async fn deviation_over_the_vessels_own_limit_brings_a_due_date_forward(server: TestServer) {
    let ada = server.admin("ada").await;
    let mut strong = true_model();
    strong.parameters_over_lambda.bx_nt += 3_000.0;
    let (nao, vessel) = australian(&server, &ada, &strong).await;
    // No rule of the vessel's flag limits deviation.
    let known = json!({ "flag_state": "NO", "deviation_record": "kept" });
    put(&ada, &nao.path("/particulars"), &known).await.good();
    let never = need(&ada, &vessel).await;
    let reason = never["reason"].as_str().unwrap();
    assert_eq!(never["urgency"], "urgent");
    assert!(reason.contains("the vessel's own limit of 5°"), "{reason}");
    let adjusted = json!({ "kind": "adjustment", "from": "2026-11-01T08:00:00Z" });
    ada.post(&nao.path("/logbook"), &adjusted).await.good();
    let over = need(&ada, &vessel).await;
    assert_eq!(
        (&over["due_on"], &over["urgency"]),
        (&json!("2026-12-05"), &json!("urgent"))
    );
    assert_eq!(over["causes"][0]["kind"], "over_limit");
    assert_eq!(over["causes"][0]["rule"], Value::Null);
    let here = over["predicted"][0]["worst_deviation_deg"]
        .as_f64()
        .unwrap();
    let now = ada.get(&nao.path("")).await.good();
    let (side, letter) = match now["worst"]["deviation_deg"].as_f64().unwrap() {
        east if east > 0.0 => ("east", "E"),
        _ => ("west", "W"),
    };
    assert_eq!(over["predicted"][0]["side"], side);
    assert_eq!(
        over["reason"],
        format!(
            "{here:.1}° {letter} of deviation at the vessel's position on 2026-11-21, over the \
             vessel's own limit of 5°"
        )
    );
    let alerts = |figure: &str, deg: f64| {
        let mut settings = json!({ "deviation_deg": 5.0, "band95_deg": 45.0 });
        settings[figure] = json!(deg);
        settings
    };
    // Neither below a larger limit, nor with a model that is too uncertain.
    for wider in [alerts("deviation_deg", 45.0), alerts("band95_deg", 0.5)] {
        let mut settings = ada.get(&nao.path("/settings")).await.good();
        settings["alerts"] = wider;
        put(&ada, &nao.path("/settings"), &settings).await.good();
        let need = need(&ada, &vessel).await;
        assert_eq!(need["due_on"], "2028-11-01", "{need}");
    }
    server.finish().await;
}

async fn particulars_are_validated_and_belong_to_the_operator(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let nao = ada.create_vessel("Nao").await;
    let particulars = path(&nao, "/particulars");
    for (field, value) in [
        ("flag_state", json!("Panama")),
        ("gross_tonnage", json!(0)),
        ("gross_tonnage", json!(-5)),
        ("trade", json!("piracy")),
        ("transits", json!([{ "canal": "suez", "on": "2026-12-01" }])),
        (
            "transits",
            json!([{ "canal": "panama", "on": "2026-13-01" }]),
        ),
        ("colour", json!("red")),
    ] {
        let response = put(&ada, &particulars, &json!({ field: value })).await;
        assert_eq!(response.problem(), "invalid", "{field}: {value}");
    }
    assert_eq!(eve.get(&particulars).await.problem(), "not-found");
    let theirs = put(&eve, &particulars, &json!({})).await;
    assert_eq!(theirs.problem(), "not-found");
    let viewer = ada.viewer(&server).await;
    let read = viewer.get(&particulars).await.good();
    assert_eq!(read["gross_tonnage"], json!(null));
    let written = put(&viewer, &particulars, &json!({})).await;
    assert_eq!(written.problem(), "forbidden");
    server.finish().await;
}

async fn an_operators_own_terms_apply_to_it_alone(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let docked = json!({ "kind": "dry_docking", "from": "2026-11-10T00:00:00Z" });
    ada.post(&path(&nao, "/logbook"), &docked).await.good();
    let usual = need(&ada, &nao).await;
    assert_eq!(
        (&usual["due_on"], &usual["urgency"]),
        (&json!("2026-12-10"), &json!("soon"))
    );
    let own = json!({ "terms": { "after_event_days": 14, "urgent_days": 7 } });
    put(&ada, "/schedule/settings", &own).await.good();
    let sooner = need(&ada, &nao).await;
    assert_eq!(
        (&sooner["due_on"], &sooner["urgency"]),
        (&json!("2026-11-24"), &json!("urgent"))
    );
    let own = json!({ "terms": { "after_event_days": 90, "soon_days": 20 } });
    put(&ada, "/schedule/settings", &own).await.good();
    let later = need(&ada, &nao).await;
    assert_eq!(
        (&later["due_on"], &later["urgency"]),
        (&json!("2026-12-20"), &json!("routine"))
    );
    // Another operator keeps the default rules.
    let eve = server.admin("eve").await;
    let nina = due_vessel(&eve, "Nina").await;
    assert_eq!(need(&eve, &nina).await["urgency"], "soon");
    server.finish().await;
}

async fn a_cancelled_order_does_not_count_as_an_adjustment(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let order = json!({ "vessel_id": nao["id"], "compass_id": super::compass_of(&nao),
                        "port": "Rotterdam", "planned_at": "2026-12-01T08:00:00Z" });
    let order = ada.post("/work-orders", &order).await.good();
    let id = order["id"].as_str().unwrap();
    // The record as it is after moved correctors.
    let left = json!({ "kind": "corrector_change", "from": "2026-11-20T08:00:00Z",
                       "note": format!("work order {id}") });
    ada.post(&path(&nao, "/logbook"), &left).await.good();
    let cancel = json!({ "text": "no time" });
    ada.post(&format!("/work-orders/{id}/cancel"), &cancel)
        .await
        .good();
    assert_eq!(need(&ada, &nao).await["due_on"], "2026-12-20");
    server.finish().await;
}
