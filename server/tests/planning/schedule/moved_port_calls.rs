//! A moved port call of an order: both sides get a message, and agree on another time.

use super::agreed_job::{AgreedJob, messages};
use super::offers::{alerts, offer};
use super::{due_vessel, enter_port_call, first_job, put, solve, terms};
use crate::calendar::events;
use crate::notifications::subjects_of;
use binnacle_orders::dispatch::lapse;
use binnacle_server_testing::on_both;
use binnacle_server_testing::patch;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::webhooks::{Receiver, deliver, make};
use binnacle_server_testing::{ApiResponse, TestServer};
use icalendar::Component;
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_moved_eta_is_reported_to_both_sides_with_old_and_new_time,
    port_calls_moved_by_a_file_are_reported_like_those_by_a_request,
    the_old_day_stands_until_a_new_one_is_agreed,
    a_new_day_is_within_the_port_call_and_the_firms_capacity,
    another_time_keeps_the_agreed_fee,
    an_unanswered_request_keeps_the_agreement,
    a_moved_port_call_without_an_order_notifies_nobody,
);

async fn a_moved_eta_is_reported_to_both_sides_with_old_and_new_time(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let (ours, our_url) = Receiver::start().await;
    let (theirs, their_url) = Receiver::start().await;
    make(&agreed.ada, &our_url, &["order.call_moved"]).await;
    make(&agreed.rosa, &their_url, &["order.call_moved"]).await;
    assert_eq!(
        agreed.view_order().await["planned_at"],
        "2026-12-15T07:00:00Z"
    );
    assert_eq!(agreed.view_order().await["call_fit"], Value::Null);
    agreed
        .move_port_call("2026-12-16T06:00:00Z", "2026-12-17T18:00:00Z")
        .await;
    let order = agreed.view_order().await;
    for person in [&agreed.ada, &agreed.rosa] {
        let mut calendar = events(&person.get("/calendar.ics").await.text);
        let uid = format!("{}@binnacle", order["id"].as_str().unwrap());
        let job = calendar.remove(&uid).unwrap();
        assert_eq!(job.property_value("STATUS"), Some("TENTATIVE"));
        let texts = job.get_description().unwrap();
        assert!(texts.contains("call has moved since"), "{texts}");
        assert!(texts.contains("a new day is needed"), "{texts}");
    }
    // The agreed time stands, marked as impossible.
    assert_eq!(order["planned_at"], "2026-12-15T07:00:00Z");
    assert_eq!(order["state"], "accepted");
    assert_eq!(order["call_fit"], "needs_new_day");
    let change = &order["call_change"];
    assert_eq!(change["was"]["eta"], "2026-12-14T06:00:00Z");
    assert_eq!(change["is"]["etd"], "2026-12-17T18:00:00Z");
    assert_eq!(change["is"]["etd_local"], "2026-12-17T19:00:00+01:00");
    assert_eq!(change["by"], "ada@example.com");
    for person in [&agreed.ada, &agreed.rosa] {
        let list = person.get("/notifications?kind=call_moved").await.good();
        let items = list["items"].as_array().unwrap();
        assert_eq!(items.len(), 1, "{list}");
        let text = items[0]["text"].as_str().unwrap();
        for texts in [
            "from 2026-12-14 06:00 UTC (2026-12-14 07:00 port's time, UTC+01:00)",
            "and is from 2026-12-16 06:00 UTC",
            "agree on a new day",
        ] {
            assert!(text.contains(texts), "{text}");
        }
        let texts = messages(person, &agreed.order).await;
        assert_eq!(texts.len(), 1);
        assert_eq!(texts[0]["by"], "Binnacle");
        assert!(texts[0]["text"].as_str().unwrap().contains("has moved"));
        let listed = person.get("/work-orders").await.good();
        assert_eq!(listed["items"][0]["call_fit"], "needs_new_day");
    }
    deliver(&server).await;
    for receiver in [&ours, &theirs] {
        assert_eq!(receiver.kinds(), ["order.call_moved"]);
        let (_, body) = receiver.received().pop().unwrap();
        let body: Value = serde_json::from_str(&body).unwrap();
        let call = &body["entry"]["call"];
        assert_eq!(call["was"]["etd"], "2026-12-15T18:00:00Z");
        assert_eq!(call["is"]["eta_local"], "2026-12-16T07:00:00+01:00");
        assert_eq!(body["work_order"]["call_fit"], "needs_new_day");
    }
    // The port call returns to its day, first later on it, then at its old time.
    agreed
        .move_port_call("2026-12-15T12:00:00Z", "2026-12-16T18:00:00Z")
        .await;
    assert_eq!(agreed.view_order().await["call_fit"], "other_hour");
    agreed
        .move_port_call("2026-12-15T06:00:00Z", "2026-12-16T18:00:00Z")
        .await;
    assert_eq!(agreed.view_order().await["call_fit"], "fits");
    // Another berth or a more certain time is not another time.
    let berth = json!({ "berth": "A5", "eta_uncertainty_h": 3 });
    patch(&agreed.ada, &agreed.call, &berth).await.good();
    assert_eq!(messages(&agreed.rosa, &agreed.order).await.len(), 3);
    server.finish().await;
}

async fn port_calls_moved_by_a_file_are_reported_like_those_by_a_request(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let post = |path: String, kind: &'static str, text: String| {
        let request = agreed.ada.request(Method::POST, &path).body(text);
        ApiResponse::send(request.header("content-type", kind))
    };
    let calls = port_calls::path(&agreed.nao);
    let csv = "id,port,eta,etd\nNLRTM 2026-12-14T06:00:00Z,NLRTM,2026-12-16T06:00:00Z,2026-12-17T18:00:00Z\n";
    let did = post(format!("{calls}.csv"), "text/csv", csv.to_owned()).await;
    assert_eq!(did.good()["amended"], 1);
    assert_eq!(agreed.view_order().await["call_fit"], "needs_new_day");
    // A whole list without references: the missing port call is the new one.
    let row = |eta: &str, etd: &str| format!("port,eta,etd\nNLRTM,{eta},{etd}\n");
    let repeated = row("2026-12-15T06:00:00Z", "2026-12-16T18:00:00Z");
    let did = post(format!("{calls}.csv?replace=true"), "text/csv", repeated)
        .await
        .good();
    assert_eq!((&did["created"], &did["withdrawn"]), (&json!(1), &json!(1)));
    assert_eq!(agreed.view_order().await["call_fit"], "fits");
    let repeated = row("2026-12-17T06:00:00Z", "2026-12-18T18:00:00Z");
    post(format!("{calls}.csv?replace=true"), "text/csv", repeated)
        .await
        .good();
    assert_eq!(agreed.view_order().await["call_fit"], "needs_new_day");
    // A calendar with the real arrival, and one without the port call.
    let event = |more: &str| {
        format!(
            "BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:-//agent//calls//EN\r\nBEGIN:VEVENT\r\n\
             UID:NLRTM 2026-12-17T06:00:00Z\r\nDTSTAMP:20261121T000000Z\r\n\
             DTSTART:20261215T060000Z\r\nDTEND:20261216T180000Z\r\nLOCATION:NLRTM\r\n{more}\
             END:VEVENT\r\nEND:VCALENDAR\r\n"
        )
    };
    let path = || format!("{calls}.ics");
    post(path(), "text/calendar", event("")).await.good();
    assert_eq!(agreed.view_order().await["call_fit"], "fits");
    post(path(), "text/calendar", event("STATUS:CANCELLED\r\n"))
        .await
        .good();
    assert_eq!(agreed.view_order().await["call_fit"], "no_call");
    let texts = messages(&agreed.rosa, &agreed.order).await;
    assert_eq!(texts.len(), 5);
    assert!(texts[4]["text"].as_str().unwrap().contains("is withdrawn"));
    server.finish().await;
}

async fn the_old_day_stands_until_a_new_one_is_agreed(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    agreed
        .move_port_call("2026-12-16T06:00:00Z", "2026-12-17T18:00:00Z")
        .await;
    let requested = agreed.retime("2026-12-17T08:00:00Z").await.good();
    assert_eq!(requested["planned_at"], "2026-12-15T07:00:00Z");
    assert_eq!(requested["state"], "accepted");
    let new = &requested["offers"][0]["new_terms"]["planned_at"];
    assert_eq!(new, "2026-12-17T08:00:00Z");
    let last = subjects_of(&agreed.rosa).await.pop().unwrap();
    assert!(last.contains("another time is proposed to you"), "{last}");
    let refused = agreed.respond(&agreed.rosa, "decline").await.good();
    assert_eq!(refused["planned_at"], "2026-12-15T07:00:00Z");
    assert_eq!(refused["state"], "accepted");
    assert_eq!(refused["call_fit"], "needs_new_day");
    let none = agreed.respond(&agreed.rosa, "accept").await;
    assert_eq!(none.problem(), "wrong-state");
    // Requested, withdrawn, and requested again.
    agreed.retime("2026-12-16T08:00:00Z").await.good();
    agreed.respond(&agreed.ada, "decline").await.good();
    agreed.retime("2026-12-16T08:00:00Z").await.good();
    let not_hers = agreed.respond(&agreed.ada, "accept").await;
    assert_eq!(not_hers.problem(), "wrong-state");
    let order = agreed.respond(&agreed.rosa, "accept").await.good();
    assert_eq!(order["planned_at"], "2026-12-16T08:00:00Z");
    assert_eq!(order["call_fit"], Value::Null);
    assert_eq!(order["offers"][0]["new_terms"], Value::Null);
    assert_eq!(order["answer_by"], Value::Null);
    let last = subjects_of(&agreed.ada).await.pop().unwrap();
    assert!(last.contains("rosa agrees to another time"), "{last}");
    let plan = solve(&agreed.ada).await;
    assert_eq!(first_job(&plan), ("NLRTM", "2026-12-16", "rosa"));
    assert_eq!(plan["jobs"][0]["state"], "confirmed");
    assert_eq!(alerts(&agreed.ada).await, [] as [Value; 0]);
    // After the adjuster is on board there are no more requests.
    agreed.retime("2026-12-17T08:00:00Z").await.good();
    let on_board = format!("{}/on-board", agreed.order);
    agreed.rosa.post(&on_board, &json!({})).await.good();
    let order = agreed.view_order().await;
    assert_eq!(order["answer_by"], Value::Null);
    assert_eq!(order["offers"][0]["new_terms"], Value::Null);
    let late = agreed.retime("2026-12-17T08:00:00Z").await;
    assert_eq!(late.problem(), "wrong-state");
    server.finish().await;
}

async fn a_new_day_is_within_the_port_call_and_the_firms_capacity(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let pinta = due_vessel(&agreed.ada, "Pinta").await;
    enter_port_call(&agreed.ada, &pinta, "NLRTM", 17).await;
    let plan = solve(&agreed.ada).await;
    let jobs = plan["jobs"].as_array().unwrap();
    let hers = jobs
        .iter()
        .find(|job| job["vessel_name"] == "Pinta")
        .unwrap();
    let taken = hers["day"].as_str().unwrap().to_owned();
    let other = offer(&agreed.ada, &plan, &pinta).await;
    agreed
        .rosa
        .post(&format!("{other}/accept"), &json!({}))
        .await
        .good();
    agreed
        .move_port_call("2026-12-16T06:00:00Z", "2026-12-18T18:00:00Z")
        .await;
    for (at, texts) in [
        ("2026-12-15T08:00:00Z", "no call at NLRTM"),
        ("2026-12-18T16:00:00Z", "to 2026-12-18 19:00 UTC"),
        (&format!("{taken}T12:00:00Z"), "no team left"),
    ] {
        let refused = agreed.retime(at).await;
        assert_eq!(refused.problem(), "wrong-state");
        assert!(refused.text.contains(texts), "{at}: {refused:?}");
    }
    let over = agreed.retime("2026-11-20T08:00:00Z").await;
    assert_eq!(over.problem(), "invalid");
    // It is checked again at the response: the team may be taken by then.
    agreed.retime("2026-12-16T08:00:00Z").await.good();
    let mut none = terms();
    none["teams"] = json!(0);
    let path = format!("/firms/{}/terms", agreed.firm);
    put(&agreed.ada, &path, &none).await.good();
    let gone = agreed.respond(&agreed.rosa, "accept").await;
    assert!(gone.text.contains("no team left"), "{gone:?}");
    put(&agreed.ada, &path, &terms()).await.good();
    // The port call may have moved again.
    agreed
        .move_port_call("2026-12-19T06:00:00Z", "2026-12-20T18:00:00Z")
        .await;
    let gone = agreed.respond(&agreed.rosa, "accept").await;
    assert!(gone.text.contains("no call at NLRTM"), "{gone:?}");
    assert_eq!(
        agreed.view_order().await["planned_at"],
        "2026-12-15T07:00:00Z"
    );
    server.finish().await;
}

async fn another_time_keeps_the_agreed_fee(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    agreed
        .move_port_call("2026-12-16T06:00:00Z", "2026-12-17T18:00:00Z")
        .await;
    let dearer = json!({ "terms": { "planned_at": "2026-12-16T08:00:00Z", "fee_eur": 900.5 } });
    let path = format!("{}/retime", agreed.order);
    agreed.ada.post(&path, &dearer).await.good();
    let order = agreed.respond(&agreed.rosa, "accept").await.good();
    assert_eq!(order["offers"][0]["terms"]["fee_eur"], 900.5);
    agreed.retime("2026-12-17T08:00:00Z").await.good();
    let order = agreed.respond(&agreed.rosa, "accept").await.good();
    assert_eq!(order["planned_at"], "2026-12-17T08:00:00Z");
    assert_eq!(order["offers"][0]["terms"]["fee_eur"], 900.5);
    // The vessel is at sea then.
    let elsewhere = agreed.retime("2026-12-20T08:00:00Z").await;
    assert_eq!(elsewhere.problem(), "wrong-state");
    server.finish().await;
}

async fn an_unanswered_request_keeps_the_agreement(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    agreed.retime("2026-12-14T08:00:00Z").await.good();
    server.advance(3601.0);
    let late = agreed.respond(&agreed.rosa, "accept").await;
    assert!(late.text.contains("has lapsed"), "{late:?}");
    assert_eq!(lapse(&server.app).await.unwrap(), 1);
    assert_eq!(lapse(&server.app).await.unwrap(), 0);
    let order = agreed.view_order().await;
    assert_eq!(order["state"], "accepted");
    assert_eq!(order["firm"], "rosa");
    assert_eq!(order["planned_at"], "2026-12-15T07:00:00Z");
    // The firm may still give the order back, and the operator may cancel it.
    agreed.retime("2026-12-14T08:00:00Z").await.good();
    let cancelled = json!({ "text": "sold" });
    let path = format!("{}/cancel", agreed.order);
    agreed.ada.post(&path, &cancelled).await.good();
    server.advance(3601.0);
    assert_eq!(lapse(&server.app).await.unwrap(), 0);
    assert_eq!(agreed.view_order().await["state"], "cancelled");
    server.finish().await;
}

async fn a_moved_port_call_without_an_order_notifies_nobody(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let other = enter_port_call(&agreed.ada, &agreed.nao, "BEANR", 20).await;
    let other = format!(
        "{}/{}",
        port_calls::path(&agreed.nao),
        other["id"].as_str().unwrap()
    );
    let times = json!({ "etd": "2026-12-22T18:00:00Z" });
    patch(&agreed.ada, &other, &times).await.good();
    assert_eq!(messages(&agreed.ada, &agreed.order).await.len(), 0);
    let cancelled = json!({ "text": "sold" });
    let path = format!("{}/cancel", agreed.order);
    agreed.ada.post(&path, &cancelled).await.good();
    agreed
        .move_port_call("2026-12-16T06:00:00Z", "2026-12-17T18:00:00Z")
        .await;
    assert_eq!(agreed.view_order().await["call_fit"], Value::Null);
    assert_eq!(messages(&agreed.ada, &agreed.order).await.len(), 0);
    server.finish().await;
}
