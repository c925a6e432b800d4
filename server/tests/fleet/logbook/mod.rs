//! The logbook: entries reported, amended and withdrawn, ashore and on board.

mod effects;

use binnacle_server_testing::on_both;
use binnacle_server_testing::patch;
use binnacle_server_testing::{ApiResponse, Person, Ship, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    entries_are_paged_latest_first,
    a_logbook_is_searched_by_kind_and_time,
    an_amendment_keeps_the_earlier_revision,
    a_withdrawn_entry_stays_and_cannot_be_changed,
    an_invalid_entry_is_refused_by_field_and_not_stored,
    a_report_repeated_under_its_key_is_one_entry,
    a_viewer_can_read_but_not_write,
    an_entry_is_found_with_its_own_vessel_only,
    a_repeated_report_from_on_board_is_one_entry,
    an_agent_can_change_only_its_own_reports,
);

pub(crate) const DAY: &str = "2026-11-15T00:00:00Z";
pub(crate) const A_WHILE_S: f64 = 60.0;

async fn listed(person: &Person, ship: &Ship, query: &str) -> Vec<Value> {
    let list = person.get(&ship.path(&format!("/logbook{query}"))).await;
    list.good()["items"].as_array().unwrap().clone()
}

fn notes(entries: &[Value]) -> Vec<&str> {
    entries
        .iter()
        .map(|e| e["note"].as_str().unwrap())
        .collect()
}

async fn entries_are_paged_latest_first(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    for (note, from) in [
        ("b", "2026-11-02T00:00:00Z"),
        ("c", "2026-11-03T00:00:00+02:00"),
        ("a", "2026-11-01T00:00:00Z"),
        ("b2", "2026-11-02T00:00:00Z"),
    ] {
        nao.report(&ada, &json!({ "kind": "note", "from": from, "note": note }))
            .await;
    }
    let (mut found, mut after) = (Vec::new(), String::new());
    loop {
        let path = nao.path(&format!("/logbook?limit=1{after}"));
        let page = ada.get(&path).await.good();
        found.push(page["items"][0].clone());
        let Some(next) = page["next"].as_str() else {
            break;
        };
        after = format!("&after={next}");
    }
    assert_eq!(notes(&found), ["c", "b2", "b", "a"]);
    assert_eq!(found[0]["from"], "2026-11-02T22:00:00Z");
    let wrong = ada.get(&nao.path("/logbook?after=1.x")).await;
    assert_eq!(wrong.problem(), "bad-request");
    server.finish().await;
}

async fn a_logbook_is_searched_by_kind_and_time(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    for (kind, from, to) in [
        ("lightning", "2026-11-01T00:00:00Z", json!(null)),
        ("magnetic_cargo", "2026-11-02T00:00:00Z", json!(null)),
        (
            "berth",
            "2026-11-03T00:00:00Z",
            json!("2026-11-04T00:00:00Z"),
        ),
        ("repair", "2026-11-10T00:00:00Z", json!(null)),
    ] {
        nao.report(&ada, &json!({ "kind": kind, "from": from, "to": to }))
            .await;
    }
    for (query, kinds) in [
        ("?kind=berth", vec!["berth"]),
        (
            "?from=2026-11-05T00:00:00Z",
            vec!["repair", "magnetic_cargo"],
        ),
        (
            "?from=2026-11-04T00:00:00Z&to=2026-11-10T00:00:00Z",
            vec!["berth", "magnetic_cargo"],
        ),
        ("?to=2026-11-02T00:00:00Z", vec!["lightning"]),
    ] {
        let found = listed(&ada, &nao, query).await;
        let found: Vec<&str> = found.iter().map(|e| e["kind"].as_str().unwrap()).collect();
        assert_eq!(found, kinds, "{query}");
    }
    let wrong = ada.get(&nao.path("/logbook?from=noon")).await;
    assert_eq!(wrong.problem(), "invalid");
    let wrong = ada.get(&nao.path("/logbook?kind=ufo")).await;
    assert_eq!(wrong.problem(), "bad-request");
    server.finish().await;
}

/// Counts the samples excluded for a reason.
async fn an_amendment_keeps_the_earlier_revision(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let cargo = json!({
        "kind": "magnetic_cargo", "from": DAY, "cargo": "steel", "hatch": "1", "port": "Bilbao",
    });
    let entry = nao.report(&ada, &cargo).await;
    assert_eq!(
        (&entry["author"], &entry["revision"]),
        (&json!("user"), &json!(1))
    );
    assert_eq!(entry["created_by"], "ada@example.com");
    let path = nao.path(&format!("/logbook/{}", entry["id"].as_str().unwrap()));
    let same = patch(&ada, &path, &json!({ "port": " Bilbao " }))
        .await
        .good();
    assert_eq!(same["revision"], 1, "nothing was changed");
    server.advance(5.0);
    let change = json!({ "port": null, "cargo": "scrap", "note": "rails" });
    let amended = patch(&ada, &path, &change).await.good();
    assert_eq!(amended["port"], json!(null));
    assert_eq!(amended["hatch"], "1");
    assert_eq!(amended["revised_at"], "2026-11-21T07:00:05Z");
    assert_eq!(amended["revised_by"], "ada@example.com");
    assert_eq!(amended["created_at"], entry["created_at"]);

    let found = ada.get(&path).await.good();
    let revisions = found["revisions"].as_array().unwrap();
    assert_eq!(
        (found["note"].clone(), revisions.len()),
        (json!("rails"), 2)
    );
    assert_eq!(revisions[0]["entry"]["port"], "Bilbao");
    assert_eq!(revisions[0]["entry"]["cargo"], "steel");
    assert_eq!(revisions[1]["number"], 2);
    assert_eq!(revisions[1]["entry"]["cargo"], "scrap");
    let turned = json!({ "to": "2026-11-14T00:00:00Z" });
    assert_eq!(patch(&ada, &path, &turned).await.problem(), "invalid");
    let misspelt = json!({ "till": "2026-11-16T00:00:00Z" });
    assert_eq!(patch(&ada, &path, &misspelt).await.problem(), "invalid");
    assert_eq!(ada.get(&path).await.good(), found);
    server.finish().await;
}

async fn a_withdrawn_entry_stays_and_cannot_be_changed(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let entry = nao
        .report(&ada, &json!({ "kind": "lightning", "from": DAY }))
        .await;
    let path = nao.path(&format!("/logbook/{}", entry["id"].as_str().unwrap()));
    let withdraw = format!("{path}/withdraw");
    let reason = json!({ "reason": "another ship" });
    let withdrawn = ada.post(&withdraw, &reason).await.good();
    assert_eq!(withdrawn["withdrawn_at"], "2026-11-21T07:00:00Z");
    assert_eq!(withdrawn["withdrawn_by"], "ada@example.com");
    assert_eq!(withdrawn["withdrawal_reason"], "another ship");
    server.advance(5.0);
    let repeated = ada.post(&withdraw, &json!({ "reason": "no" })).await.good();
    assert_eq!(repeated, withdrawn);
    assert_eq!(
        patch(&ada, &path, &json!({ "note": "x" })).await.problem(),
        "gone"
    );
    assert_eq!(listed(&ada, &nao, "").await, [withdrawn]);
    assert!(listed(&ada, &nao, "?withdrawn=false").await.is_empty());
    server.finish().await;
}

async fn an_invalid_entry_is_refused_by_field_and_not_stored(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let kogge = server.ship(&ada, "Kogge").await;
    let other = ada.get(&kogge.path("/compasses")).await.good();
    let other = &other["items"][0]["id"];
    for (field, body) in [
        ("from", json!({ "kind": "note" })),
        (
            "from",
            json!({ "kind": "note", "from": "2026-11-23T00:00:00Z" }),
        ),
        ("noon", json!({ "kind": "note", "from": "noon" })),
        ("kind", json!({ "from": DAY })),
        (
            "until",
            json!({ "kind": "magnetic_cargo", "from": DAY, "until": "2026-11-16T00:00:00Z" }),
        ),
        ("ufo", json!({ "kind": "ufo", "from": DAY })),
        (
            "to",
            json!({ "kind": "berth", "from": DAY, "to": "2026-11-14T23:59:59Z" }),
        ),
        (
            "cargo",
            json!({ "kind": "berth", "from": DAY, "cargo": "steel" }),
        ),
        (
            "hatch",
            json!({ "kind": "berth", "from": DAY, "hatch": "2" }),
        ),
        (
            "note",
            json!({ "kind": "note", "from": DAY, "note": "a\u{0}b" }),
        ),
        (
            "compass_id",
            json!({ "kind": "lightning", "from": DAY, "compass_id": other }),
        ),
        (
            "compass_id",
            json!({ "kind": "adjustment", "from": DAY, "compass_id": other }),
        ),
    ] {
        let response = ada.post(&nao.path("/logbook"), &body).await;
        assert_eq!(response.problem(), "invalid", "{body}");
        let detail = response.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains(field), "{body}: {detail}");
    }
    assert!(listed(&ada, &nao, "").await.is_empty());
    assert_eq!(server.work().await, []);
    server.finish().await;
}

async fn a_report_repeated_under_its_key_is_one_entry(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let report = async |note: &str| {
        let request = ada.request(Method::POST, &nao.path("/logbook"));
        let body = json!({ "kind": "shock", "from": DAY, "note": note });
        ApiResponse::send(request.header("idempotency-key", "k").json(&body)).await
    };
    let (first, repeated) = (report("aground").await, report("aground").await);
    assert_eq!((first.status, repeated.status), (201, 201));
    assert_eq!(first.json(), repeated.json());
    assert_eq!(report("afloat").await.problem(), "idempotency-key-reused");
    assert_eq!(listed(&ada, &nao, "").await.len(), 1);
    server.finish().await;
}

async fn a_viewer_can_read_but_not_write(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let entry = json!({ "kind": "welding", "from": DAY });
    let id = nao.report(&ada, &entry).await["id"].clone();
    let path = nao.path(&format!("/logbook/{}", id.as_str().unwrap()));
    let viewer = ada.viewer(&server).await;
    assert_eq!(listed(&viewer, &nao, "").await.len(), 1);
    let written = [
        viewer.post(&nao.path("/logbook"), &entry).await,
        patch(&viewer, &path, &json!({ "note": "x" })).await,
        viewer.post(&format!("{path}/withdraw"), &json!({})).await,
    ];
    for response in written {
        assert_eq!(response.problem(), "forbidden");
    }
    assert_eq!(listed(&ada, &nao, "").await[0]["revision"], 1);
    server.finish().await;
}

async fn an_entry_is_found_with_its_own_vessel_only(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let kogge = server.ship(&ada, "Kogge").await;
    let entry = nao
        .report(&ada, &json!({ "kind": "welding", "from": DAY }))
        .await;
    let path = kogge.path(&format!("/logbook/{}", entry["id"].as_str().unwrap()));
    let found = [
        ada.get(&path).await,
        patch(&ada, &path, &json!({})).await,
        ada.post(&format!("{path}/withdraw"), &json!({})).await,
    ];
    for response in found {
        assert_eq!(response.problem(), "not-found");
    }
    assert!(listed(&ada, &kogge, "").await.is_empty());
    server.finish().await;
}

async fn a_repeated_report_from_on_board_is_one_entry(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let id = "01934f2a-7c00-7000-8000-0000000000b1";
    let mut report = json!({
        "revision": 1, "reporter": "Li", "kind": "magnetic_cargo", "from": DAY, "cargo": "steel",
    });
    let first = nao.put_report(id, &report).await;
    assert_eq!(first.good(), json!({ "revision": 1, "withdrawn": false }));
    assert_eq!(nao.put_report(id, &report).await.good(), first.json());
    let entries = listed(&ada, &nao, "").await;
    assert_eq!(entries.len(), 1);
    assert_eq!(
        (&entries[0]["author"], &entries[0]["created_by"]),
        (&json!("agent"), &json!("Li"))
    );

    // A later revision arrives before the one that it follows.
    report["revision"] = json!(3);
    report["to"] = json!("2026-11-16T00:00:00Z");
    nao.put_report(id, &report).await.good();
    report["revision"] = json!(2);
    report["to"] = json!("2026-11-18T00:00:00Z");
    assert_eq!(nao.put_report(id, &report).await.good()["revision"], 3);
    let entry = &listed(&ada, &nao, "").await[0];
    assert_eq!(
        (&entry["to"], &entry["revision"]),
        (&json!("2026-11-16T00:00:00Z"), &json!(2))
    );

    report["revision"] = json!(4);
    report["withdrawn"] = json!(true);
    assert_eq!(nao.put_report(id, &report).await.good()["withdrawn"], true);
    report["revision"] = json!(5);
    report["withdrawn"] = json!(false);
    assert_eq!(nao.put_report(id, &report).await.good()["withdrawn"], true);
    let entry = &listed(&ada, &nao, "").await[0];
    assert_eq!(entry["withdrawn_by"], "Li");

    // An entry that was withdrawn before it could be sent.
    let id = "01934f2a-7c00-7000-8000-0000000000b2";
    report["withdrawn"] = json!(true);
    assert_eq!(nao.put_report(id, &report).await.good()["withdrawn"], true);
    assert_eq!(listed(&ada, &nao, "?withdrawn=false").await.len(), 0);
    server.finish().await;
}

async fn an_agent_can_change_only_its_own_reports(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let kogge = server.ship(&ada, "Kogge").await;
    let ashore = nao
        .report(&ada, &json!({ "kind": "note", "from": DAY }))
        .await;
    let report = json!({ "revision": 9, "kind": "shock", "from": DAY, "note": "hers" });
    let response = nao
        .put_report(ashore["id"].as_str().unwrap(), &report)
        .await;
    assert_eq!(response.problem(), "not-found");
    // The same id on another ship is another entry.
    let id = "01934f2a-7c00-7000-8000-0000000000b1";
    nao.put_report(id, &report).await.good();
    kogge.put_report(id, &report).await.good();
    assert_eq!(listed(&ada, &nao, "").await.len(), 2);
    assert_eq!(listed(&ada, &kogge, "").await.len(), 1);

    let mut wrong = report.clone();
    wrong["from"] = json!("2027-01-01T00:00:00Z");
    assert_eq!(nao.put_report(id, &wrong).await.problem(), "invalid");
    wrong = report.clone();
    wrong["revision"] = json!(0);
    assert_eq!(nao.put_report(id, &wrong).await.problem(), "invalid");
    assert_eq!(nao.put_report("x", &report).await.problem(), "not-found");
    server.finish().await;
}
