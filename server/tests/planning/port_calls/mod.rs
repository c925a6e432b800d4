//! Single port calls: entered, amended, withdrawn; and the berth heading.

mod files;
mod timestamps;

use binnacle_server_testing::on_both;
use binnacle_server_testing::patch;
use binnacle_server_testing::port_calls::{call, path};
use binnacle_server_testing::{Person, TestServer};
use serde_json::json;

on_both!(
    each_revision_of_a_port_call_is_kept,
    an_invalid_port_call_is_refused_by_field_and_not_stored,
    port_calls_of_one_vessel_cannot_overlap,
    a_port_call_repeated_under_its_key_is_stored_once,
    port_calls_are_listed_by_time_for_fleet_and_vessel,
    a_port_call_is_found_under_its_own_vessel_only,
    a_viewer_can_read_but_not_write,
    a_berth_heading_comes_from_the_fleets_earlier_port_calls,
    ports_are_found_by_name_and_by_code,
);

async fn listed(person: &Person, path: &str) -> Vec<String> {
    let list = person.get(path).await.good();
    let items = list["items"].as_array().unwrap().iter();
    items
        .map(|item| {
            let eta = item["eta"].as_str().unwrap();
            format!("{} {}", item["port"].as_str().unwrap(), &eta[8..10])
        })
        .collect()
}

async fn each_revision_of_a_port_call_is_kept(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let mut new = call("NLRTM", 8);
    new["eta"] = json!("2026-12-08T07:00:00+01:00");
    new["eta_uncertainty_h"] = json!(12);
    let entered = ada.post(&path(&nao), &new).await;
    assert_eq!(entered.status, 201);
    let entered = entered.json();
    assert_eq!(entered["reference"], "NLRTM 2026-12-08T06:00:00Z");
    assert_eq!(entered["port_name"], "Rotterdam");
    assert_eq!(
        (&entered["source"], &entered["revision"]),
        (&json!("api"), &json!(1))
    );
    let one = format!("{}/{}", path(&nao), entered["id"].as_str().unwrap());
    let later = json!({ "etd": "2026-12-11T00:00:00Z", "berth": " A5 " });
    let amended = patch(&ada, &one, &later).await.good();
    assert_eq!(
        (&amended["revision"], &amended["berth"]),
        (&json!(2), &json!("A5"))
    );
    assert_eq!(amended["eta_uncertainty_h"], 12.0);
    for field in [
        "port",
        "eta",
        "etd",
        "eta_uncertainty_h",
        "etd_uncertainty_h",
    ] {
        let nothing = patch(&ada, &one, &json!({ field: null })).await;
        assert_eq!(nothing.problem(), "invalid", "{field}");
    }
    // The same again changes nothing.
    assert_eq!(patch(&ada, &one, &later).await.good()["revision"], 2);
    let withdrawn = ada
        .post(&format!("{one}/withdraw"), &json!({ "reason": "ice" }))
        .await;
    assert_eq!(withdrawn.good()["withdrawal_reason"], "ice");
    let whole = ada.get(&one).await.good();
    assert_eq!(whole["revisions"][0]["call"]["etd"], "2026-12-09T18:00:00Z");
    assert_eq!(whole["revisions"][1]["call"]["berth"], "A5");
    assert_eq!(patch(&ada, &one, &later).await.problem(), "gone");
    assert_eq!(listed(&ada, &path(&nao)).await, [] as [&str; 0]);
    let all = format!("{}?withdrawn=true", path(&nao));
    assert_eq!(listed(&ada, &all).await, ["NLRTM 08"]);
    assert_eq!(server.events().await, ["port_call"; 3]);
    server.finish().await;
}

async fn an_invalid_port_call_is_refused_by_field_and_not_stored(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    for (field, value, message) in [
        ("eta", json!("2026-12-08T06:00:00"), "has no time zone"),
        ("eta", json!("tomorrow"), "is not an RFC 3339 time"),
        ("etd", json!("2026-12-08T06:00:00Z"), "is not after eta"),
        ("etd", json!("2027-12-08T06:00:00Z"), "more than 120 days"),
        ("port", json!("XXXXX"), "is not a sea port"),
        ("port", json!("Rotterdam"), "is not a UN/LOCODE"),
        ("eta_uncertainty_h", json!(-1), "is not within 0 to 720"),
        ("berth_heading_deg", json!(361), "is not within 0 to 360"),
        ("berth", json!("x".repeat(201)), "longer than 200"),
        ("reference", json!("a\nb"), "control characters"),
        ("colour", json!("red"), "unknown field"),
        ("port", json!("CNSHA"), "the sea port Shanghai is CNSGH"),
    ] {
        let mut wrong = call("NLRTM", 8);
        wrong[field] = value.clone();
        let response = ada.post(&path(&nao), &wrong).await;
        assert_eq!(response.problem(), "invalid", "{field}: {value}");
        let detail = response.json()["detail"].as_str().unwrap().to_owned();
        assert!(
            detail.contains(field) && detail.contains(message),
            "{detail}"
        );
    }
    let past =
        json!({ "port": "NLRTM", "eta": "2026-11-01T00:00:00Z", "etd": "2026-11-02T00:00:00Z" });
    let response = ada.post(&path(&nao), &past).await;
    assert!(
        response
            .text
            .contains("etd: 2026-11-02T00:00:00Z is in the past")
    );
    assert_eq!(listed(&ada, &path(&nao)).await, [] as [&str; 0]);
    server.finish().await;
}

async fn port_calls_of_one_vessel_cannot_overlap(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let first = ada.post(&path(&nao), &call("NLRTM", 8)).await.good();
    let overlapping = ada.post(&path(&nao), &call("BEANR", 9)).await;
    assert_eq!(overlapping.problem(), "wrong-state");
    assert!(overlapping.text.contains("NLRTM 2026-12-08T06:00:00Z"));
    let repeated = ada.post(&path(&nao), &call("NLRTM", 8)).await;
    assert!(repeated.text.contains("belongs to call"));
    let next = ada.post(&path(&nao), &call("BEANR", 10)).await.good();
    let one = format!("{}/{}", path(&nao), next["id"].as_str().unwrap());
    let into_first = json!({ "eta": "2026-12-09T17:59:00Z" });
    assert_eq!(
        patch(&ada, &one, &into_first).await.problem(),
        "wrong-state"
    );
    // Right after the other port call it may; and into a withdrawn one.
    let right_after = json!({ "eta": "2026-12-09T18:00:00Z" });
    patch(&ada, &one, &right_after).await.good();
    let withdraw = format!("{}/{}/withdraw", path(&nao), first["id"].as_str().unwrap());
    ada.post(&withdraw, &json!({})).await.good();
    patch(&ada, &one, &into_first).await.good();
    // Another vessel may be in port at the same time.
    let other = ada.create_vessel("Pinta").await;
    ada.post(&path(&other), &call("BEANR", 9)).await.good();
    server.finish().await;
}

async fn a_port_call_repeated_under_its_key_is_stored_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let mut ids = Vec::new();
    for _ in 0..2 {
        let request = ada.request(reqwest::Method::POST, &path(&nao));
        let request = request
            .header("idempotency-key", "k")
            .json(&call("NLRTM", 8));
        ids.push(
            binnacle_server_testing::ApiResponse::send(request)
                .await
                .good()["id"]
                .clone(),
        );
    }
    assert_eq!(ids[0], ids[1]);
    assert_eq!(listed(&ada, &path(&nao)).await, ["NLRTM 08"]);
    server.finish().await;
}

async fn port_calls_are_listed_by_time_for_fleet_and_vessel(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    let pinta = ada.create_vessel("Pinta").await;
    ada.post(&path(&nao), &call("NLRTM", 14)).await.good();
    ada.post(&path(&nao), &call("BEANR", 8)).await.good();
    ada.post(&path(&pinta), &call("ESBIO", 10)).await.good();
    assert_eq!(listed(&ada, &path(&nao)).await, ["BEANR 08", "NLRTM 14"]);
    let all = ["BEANR 08", "ESBIO 10", "NLRTM 14"];
    assert_eq!(listed(&ada, "/port-calls").await, all);
    let page = ada.get("/port-calls?limit=1").await.good();
    let next = format!("/port-calls?after={}", page["next"].as_str().unwrap());
    assert_eq!(listed(&ada, &next).await, all[1..]);
    assert_eq!(
        listed(
            &ada,
            "/port-calls?from=2026-12-09T20:00:00Z&to=2026-12-12T00:00:00Z"
        )
        .await,
        ["ESBIO 10"]
    );
    assert_eq!(listed(&ada, "/port-calls?port=nlrtm").await, ["NLRTM 14"]);
    assert_eq!(ada.get("/port-calls?port=x").await.problem(), "invalid");
    server.finish().await;
}

async fn a_port_call_is_found_under_its_own_vessel_only(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let nao = ada.create_vessel("Nao").await;
    let pinta = ada.create_vessel("Pinta").await;
    let hers = ada.post(&path(&nao), &call("NLRTM", 8)).await.good();
    let id = hers["id"].as_str().unwrap();
    let other = format!("{}/{id}", path(&pinta));
    assert_eq!(ada.get(&other).await.problem(), "not-found");
    assert_eq!(patch(&ada, &other, &json!({})).await.problem(), "not-found");
    let one = format!("{}/{id}", path(&nao));
    assert_eq!(eve.get(&one).await.problem(), "not-found");
    assert_eq!(patch(&eve, &one, &json!({})).await.problem(), "not-found");
    let theirs = eve.post(&format!("{one}/withdraw"), &json!({})).await;
    assert_eq!(theirs.problem(), "not-found");
    let theirs = eve.post(&path(&nao), &call("NLRTM", 20)).await;
    assert_eq!(theirs.problem(), "not-found");
    assert_eq!(eve.get(&path(&nao)).await.problem(), "not-found");
    assert_eq!(listed(&eve, "/port-calls").await, [] as [&str; 0]);
    server.finish().await;
}

async fn a_viewer_can_read_but_not_write(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ada.create_vessel("Nao").await;
    ada.post(&path(&nao), &call("NLRTM", 8)).await.good();
    let viewer = ada.viewer(&server).await;
    assert_eq!(listed(&viewer, &path(&nao)).await, ["NLRTM 08"]);
    let written = viewer.post(&path(&nao), &call("NLRTM", 20)).await;
    assert_eq!(written.problem(), "forbidden");
    server.finish().await;
}

async fn a_berth_heading_comes_from_the_fleets_earlier_port_calls(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let nao = ada.create_vessel("Nao").await;
    let mut known = call("NLRTM", 1);
    known["berth"] = json!("A5");
    known["berth_heading_deg"] = json!(112);
    let known = ada.post(&path(&nao), &known).await.good();
    let given = json!({ "heading_deg": 112.0, "source": "given" });
    assert_eq!(known["berth_heading"], given);
    let pinta = ada.create_vessel("Pinta").await;
    let mut next = call("NLRTM", 8);
    next["berth"] = json!("A5");
    let next = ada.post(&path(&pinta), &next).await.good();
    // The first vessel has not been there yet: the heading is unknown.
    assert_eq!(next["berth_heading"], json!(null));
    server.advance(12.0 * 86_400.0);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let eve = Person::sign_in(&server, eve.operator, &eve.email).await;
    let found = ada.get(&path(&pinta)).await.good();
    let learnt = json!({ "heading_deg": 112.0, "source": "berth" });
    assert_eq!(found["items"][0]["berth_heading"], learnt);
    // A wrong heading can be corrected after the port call.
    let one = format!("{}/{}", path(&nao), known["id"].as_str().unwrap());
    patch(&ada, &one, &json!({ "berth_heading_deg": 292 }))
        .await
        .good();
    let found = ada.get(&path(&pinta)).await.good();
    assert_eq!(found["items"][0]["berth_heading"]["heading_deg"], 292.0);
    // Another operator's ship does not use it.
    let santa = eve.create_vessel("Santa").await;
    let theirs = eve.post(&path(&santa), &call("NLRTM", 12)).await.good();
    assert_eq!(theirs["berth_heading"], json!(null));
    server.finish().await;
}

async fn ports_are_found_by_name_and_by_code(server: TestServer) {
    let ada = server.admin("ada").await;
    let found = ada.get("/ports?q=rotterdam").await.good();
    assert_eq!(found["items"][0]["code"], "NLRTM");
    assert_eq!(found["items"][0]["zone"], "Europe/Amsterdam");
    let limited = ada.get("/ports?q=san&limit=3").await.good();
    assert_eq!(limited["items"].as_array().unwrap().len(), 3);
    let accented = ada.get("/ports?q=malaga").await.good();
    assert_eq!(accented["items"][0]["code"], "ESAGP");
    assert_eq!(ada.get("/ports?q=").await.good()["items"], json!([]));
    assert_eq!(ada.get("/ports").await.problem(), "bad-request");
    server.finish().await;
}
