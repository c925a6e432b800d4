//! Azimuths, entered ashore and on board, and their entries in the deviation book.

use binnacle_server_testing::on_both;
use binnacle_server_testing::{
    ApiResponse, Person, Ship, TestServer, days_at_sea, sun_by_azimuth, true_model,
};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    an_azimuth_shows_its_errors_at_once,
    azimuths_are_listed_latest_first_and_by_time,
    an_impossible_azimuth_is_refused_by_field_and_not_stored,
    an_unlikely_azimuth_is_accepted_once_confirmed,
    a_vessel_with_two_compasses_must_name_one,
    an_azimuth_repeated_under_its_key_is_one,
    a_withdrawn_azimuth_stays_and_cannot_come_back,
    a_viewer_reads_azimuths_and_enters_none,
    an_azimuth_from_on_board_is_stored_once,
    an_agent_changes_only_its_own_azimuths,
    the_deviation_book_has_every_azimuth,
    the_book_is_paged_where_entries_share_an_instant,
);

const ON_BOARD: &str = "01934f2a-7c00-7000-8000-0000000000a2";
const A_WHILE_S: f64 = 10.0;

/// Returns an azimuth with some fields changed.
fn changed(azimuth: &Value, changes: &Value) -> Value {
    let mut changed = azimuth.clone();
    for (name, value) in changes.as_object().unwrap() {
        changed[name] = value.clone();
    }
    changed
}

async fn listed(person: &Person, ship: &Ship, query: &str) -> Vec<Value> {
    let list = person.get(&ship.path(&format!("/azimuths{query}"))).await;
    list.good()["items"].as_array().unwrap().clone()
}

async fn observe(person: &Person, ship: &Ship, changes: &Value) -> ApiResponse {
    let azimuth = changed(&sun_by_azimuth(), changes);
    person.post(&ship.path("/azimuths"), &azimuth).await
}

async fn an_azimuth_shows_its_errors_at_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let entered = observe(&ada, &nao, &json!({ "remark": " hazy " })).await;
    assert_eq!(entered.status, 201);
    let entered = entered.json();
    let degrees = |name: &str| entered["result"][name].as_f64().unwrap();
    assert!(
        (degrees("true_bearing_deg") - 152.0).abs() < 5.0,
        "{entered}"
    );
    let error = degrees("true_bearing_deg") - 150.0;
    assert!((degrees("compass_error_deg") - error).abs() < 1e-9);
    assert!((degrees("gyro_error_deg") - (92.0 + error - 94.0)).abs() < 1e-9);
    let sum = degrees("deviation_deg") + degrees("variation_deg");
    assert!((sum - error).abs() < 1e-9);
    assert_eq!(entered["created_by"], "ada@example.com");
    assert_eq!(
        (&entered["observer"], &entered["remark"]),
        (&json!("LW"), &json!("hazy"))
    );
    let path = nao.path(&format!("/azimuths/{}", entered["id"].as_str().unwrap()));
    assert_eq!(ada.get(&path).await.good(), entered);
    // The analysis is asked for, like after a logbook entry.
    assert_eq!(server.work().await.len(), 1);
    server.finish().await;
}

async fn azimuths_are_listed_latest_first_and_by_time(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    for time in ["09:30", "11:00", "10:00", "10:00"] {
        let time = format!("2026-11-20T{time}:00Z");
        let changes = json!({ "time": time, "confirmed": true });
        observe(&ada, &nao, &changes).await.good();
    }
    let (mut found, mut after) = (Vec::new(), String::new());
    loop {
        let path = nao.path(&format!("/azimuths?limit=1{after}"));
        let page = ada.get(&path).await.good();
        found.push(page["items"][0].clone());
        let Some(next) = page["next"].as_str() else {
            break;
        };
        after = format!("&after={next}");
    }
    let times: Vec<&str> = found
        .iter()
        .map(|one| &one["time"].as_str().unwrap()[11..16])
        .collect();
    assert_eq!(times, ["11:00", "10:00", "10:00", "09:30"]);
    assert_eq!(found, listed(&ada, &nao, "").await);
    let range = "?from=2026-11-20T10:00:00Z&to=2026-11-20T11:00:00Z";
    assert_eq!(listed(&ada, &nao, range).await, found[1..3]);
    let none = "?compass=00000000-0000-0000-0000-000000000000";
    assert!(listed(&ada, &nao, none).await.is_empty());
    let wrong = ada.get(&nao.path("/azimuths?from=noon")).await;
    assert_eq!(wrong.problem(), "invalid");
    server.finish().await;
}

async fn an_impossible_azimuth_is_refused_by_field_and_not_stored(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    for (field, changes) in [
        ("time", json!({ "time": "2026-11-23T10:00:00Z" })),
        ("time", json!({ "time": "2026-11-19T23:00:00Z" })),
        ("no time of day", json!({ "time": "2026-11-20" })),
        ("lat", json!({ "lat": 95 })),
        ("compass_bearing_deg", json!({ "compass_bearing_deg": 361 })),
        (
            "compass_bearing_deg",
            json!({ "compass_bearing_deg": null }),
        ),
        ("true_bearing_deg", json!({ "true_bearing_deg": 152 })),
        ("horizon", json!({ "kind": "sun_amplitude" })),
        ("kind", json!({ "kind": "moon" })),
        ("observer", json!({ "observer": " " })),
        ("bearing", json!({ "bearing": 152 })),
        (
            "compass_id",
            json!({ "compass_id": "00000000-0000-0000-0000-000000000000" }),
        ),
    ] {
        let response = observe(&ada, &nao, &changes).await;
        assert_eq!(response.problem(), "invalid", "{changes}");
        let detail = response.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains(field), "{changes}: {detail}");
    }
    assert!(listed(&ada, &nao, "").await.is_empty());
    assert_eq!(server.work().await, []);
    server.finish().await;
}

async fn an_unlikely_azimuth_is_accepted_once_confirmed(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let vega = json!({
        "time": "2026-11-20T20:00:00Z", "kind": "body", "name": "Vega", "true_bearing_deg": 150.0,
    });
    let asked = observe(&ada, &nao, &vega).await;
    assert_eq!(asked.problem(), "invalid");
    let detail = asked.json()["detail"].as_str().unwrap().to_owned();
    assert!(detail.starts_with("confirmed: "), "{detail}");
    let confirmed = changed(&vega, &json!({ "confirmed": true }));
    let entered = observe(&ada, &nao, &confirmed).await.good();
    assert_eq!(entered["result"]["compass_error_deg"], 0.0);
    server.finish().await;
}

async fn a_vessel_with_two_compasses_must_name_one(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let aft = json!({ "name": "Aft", "role": "steering" });
    let aft = ada.post(&nao.path("/compasses"), &aft).await.good()["id"].clone();
    let unnamed = observe(&ada, &nao, &json!({})).await;
    assert!(
        unnamed.json()["detail"]
            .as_str()
            .unwrap()
            .starts_with("compass_id: ")
    );
    let named = observe(&ada, &nao, &json!({ "compass_id": aft }))
        .await
        .good();
    assert_eq!(named["compass_id"], aft);
    let of_aft = format!("?compass={}", aft.as_str().unwrap());
    assert_eq!(listed(&ada, &nao, &of_aft).await, [named]);
    server.finish().await;
}

async fn an_azimuth_repeated_under_its_key_is_one(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let observe = async |bearing_deg: f64| {
        let request = ada.request(Method::POST, &nao.path("/azimuths"));
        let body = changed(
            &sun_by_azimuth(),
            &json!({ "compass_bearing_deg": bearing_deg }),
        );
        ApiResponse::send(request.header("idempotency-key", "k").json(&body)).await
    };
    let (first, repeated) = (observe(150.0).await, observe(150.0).await);
    assert_eq!((first.status, repeated.status), (201, 201));
    assert_eq!(first.json(), repeated.json());
    assert_eq!(observe(151.0).await.problem(), "idempotency-key-reused");
    assert_eq!(listed(&ada, &nao, "").await.len(), 1);
    server.finish().await;
}

async fn a_withdrawn_azimuth_stays_and_cannot_come_back(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let kogge = server.ship(&ada, "Kogge").await;
    let id = observe(&ada, &nao, &json!({})).await.good()["id"].clone();
    let withdraw = format!("/azimuths/{}/withdraw", id.as_str().unwrap());
    let reason = json!({ "reason": "another ship" });
    let elsewhere = ada.post(&kogge.path(&withdraw), &reason).await;
    assert_eq!(elsewhere.problem(), "not-found");
    let withdrawn = ada.post(&nao.path(&withdraw), &reason).await.good();
    assert_eq!(withdrawn["withdrawn_at"], "2026-11-21T07:00:00Z");
    assert_eq!(withdrawn["withdrawn_by"], "ada@example.com");
    assert_eq!(withdrawn["withdrawal_reason"], "another ship");
    server.advance(5.0);
    let repeated = ada.post(&nao.path(&withdraw), &json!({})).await.good();
    assert_eq!(repeated, withdrawn);
    assert_eq!(listed(&ada, &nao, "").await, [withdrawn]);
    assert!(listed(&ada, &nao, "?withdrawn=false").await.is_empty());
    let book = ada.get(&nao.path("/deviation-book")).await.good();
    assert_eq!(book["items"], json!([]));
    server.finish().await;
}

async fn a_viewer_reads_azimuths_and_enters_none(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let id = observe(&ada, &nao, &json!({})).await.good()["id"].clone();
    let viewer = ada.viewer(&server).await;
    assert_eq!(listed(&viewer, &nao, "").await.len(), 1);
    let entered = observe(&viewer, &nao, &json!({})).await;
    assert_eq!(entered.problem(), "forbidden");
    let withdraw = nao.path(&format!("/azimuths/{}/withdraw", id.as_str().unwrap()));
    let withdrawn = viewer.post(&withdraw, &json!({})).await;
    assert_eq!(withdrawn.problem(), "forbidden");
    server.finish().await;
}

async fn an_azimuth_from_on_board_is_stored_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    // A newer agent may send more than this server knows.
    let mut azimuth = changed(&sun_by_azimuth(), &json!({ "cloud": "cirrus" }));
    let stands = json!({ "withdrawn": false });
    assert_eq!(nao.put_azimuth(ON_BOARD, &azimuth).await.good(), stands);
    assert_eq!(nao.put_azimuth(ON_BOARD, &azimuth).await.good(), stands);
    let azimuths = listed(&ada, &nao, "").await;
    assert_eq!(azimuths.len(), 1);
    assert_eq!(azimuths[0]["id"], ON_BOARD);
    assert_eq!(
        (&azimuths[0]["author"], &azimuths[0]["created_by"]),
        (&json!("agent"), &json!("LW"))
    );
    azimuth["withdrawn"] = json!(true);
    let gone = json!({ "withdrawn": true });
    assert_eq!(nao.put_azimuth(ON_BOARD, &azimuth).await.good(), gone);
    azimuth["withdrawn"] = json!(false);
    assert_eq!(nao.put_azimuth(ON_BOARD, &azimuth).await.good(), gone);
    assert_eq!(listed(&ada, &nao, "").await[0]["withdrawn_by"], "LW");
    let impossible = changed(&sun_by_azimuth(), &json!({ "lat": 95 }));
    assert_eq!(
        nao.put_azimuth(ON_BOARD, &impossible).await.problem(),
        "invalid"
    );
    server.finish().await;
}

async fn an_agent_changes_only_its_own_azimuths(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let kogge = server.ship(&ada, "Kogge").await;
    let ashore = observe(&ada, &nao, &json!({})).await.good()["id"].clone();
    let withdrawn = changed(&sun_by_azimuth(), &json!({ "withdrawn": true }));
    let refused = nao.put_azimuth(ashore.as_str().unwrap(), &withdrawn).await;
    assert_eq!(refused.problem(), "not-found");
    assert_eq!(listed(&ada, &nao, "?withdrawn=false").await.len(), 1);
    // The same id on another ship is another azimuth.
    nao.put_azimuth(ON_BOARD, &sun_by_azimuth()).await.good();
    kogge.put_azimuth(ON_BOARD, &withdrawn).await.good();
    assert_eq!(listed(&ada, &nao, "?withdrawn=false").await.len(), 2);
    server.finish().await;
}

async fn the_deviation_book_has_every_azimuth(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let earlier = json!({ "time": "2026-10-01T10:00:00Z", "confirmed": true });
    observe(&ada, &nao, &earlier).await.good();
    let entered = observe(&ada, &nao, &json!({ "remark": "hazy" }))
        .await
        .good();
    let book = ada.get(&nao.path("/deviation-book")).await.good();
    assert_eq!(
        book["items"].as_array().unwrap().len(),
        2,
        "without a sample"
    );
    nao.put(1, &days_at_sea(&true_model(), "2026-11-15T00:00:00Z", 5.0))
        .await
        .good();
    server.advance(A_WHILE_S);
    server.work().await;
    let book = ada
        .get(&nao.path("/deviation-book?limit=1000"))
        .await
        .good();
    let book = book["items"].as_array().unwrap();
    assert!(book.len() > 40);
    assert!(book.is_sorted_by_key(|entry| entry["time"].as_str().unwrap()));
    assert_eq!(book[0]["time"], "2026-10-01T10:00:00Z");
    let entry = book
        .iter()
        .find(|entry| entry["azimuth_id"] == entered["id"])
        .unwrap();
    assert_eq!(entry["occasion"], "azimuth");
    assert_eq!(entry["reference"], "sun_azimuth");
    assert_eq!(entry["observer"], "officer");
    assert_eq!(
        (&entry["initials"], &entry["remark"]),
        (&json!("LW"), &json!("hazy"))
    );
    for name in [
        "compass_error_deg",
        "gyro_error_deg",
        "deviation_deg",
        "variation_deg",
    ] {
        assert_eq!(entry[name], entered["result"][name], "{name}");
    }
    assert_eq!(entry["true_deg"], entered["result"]["true_heading_deg"]);
    assert!(
        book.iter()
            .all(|entry| entry["compass_error_deg"].is_number())
    );

    let csv = ada.get(&nao.path("/deviation-book.csv")).await;
    let lines: Vec<&str> = csv.text.lines().collect();
    assert_eq!(lines.len(), book.len() + 1);
    assert!(lines[0].ends_with("compass_error_deg,gyro_error_deg,initials,remark,azimuth_id"));
    assert!(
        lines
            .iter()
            .any(|line| line.contains("azimuth,43.4") && line.contains(",LW,hazy,"))
    );
    let pdf = ada.get(&nao.path("/deviation-book.pdf")).await;
    assert!(pdf.status == 200 && pdf.text.starts_with("%PDF-1."));
    server.finish().await;
}

async fn the_book_is_paged_where_entries_share_an_instant(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &days_at_sea(&true_model(), "2026-11-15T00:00:00Z", 5.0))
        .await
        .good();
    server.advance(A_WHILE_S);
    server.work().await;
    let book = ada
        .get(&nao.path("/deviation-book?limit=1000"))
        .await
        .good();
    let times: Vec<&Value> = book["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|e| &e["time"])
        .collect();
    for time in [times[3], times[3], times[4]] {
        let transit = json!({
            "time": time, "kind": "transit", "name": "Leading lights", "true_bearing_deg": 151.0,
            "confirmed": true,
        });
        observe(&ada, &nao, &transit).await.good();
    }
    let whole = ada
        .get(&nao.path("/deviation-book?limit=1000"))
        .await
        .good();
    assert_eq!(whole["items"].as_array().unwrap().len(), times.len() + 3);
    let (mut paged, mut after) = (Vec::new(), String::new());
    loop {
        let page = nao.path(&format!("/deviation-book?limit=1{after}"));
        let page = ada.get(&page).await.good();
        paged.extend(page["items"].as_array().unwrap().clone());
        let Some(next) = page["next"].as_str().filter(|_| paged.len() < 9) else {
            break;
        };
        after = format!("&after={next}");
    }
    assert_eq!(paged, whole["items"].as_array().unwrap()[..9]);
    server.finish().await;
}
