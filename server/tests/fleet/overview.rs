//! The overview of the fleet.

use binnacle_server_testing::alerts::{set_alert_limits, ship_with_model};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Person, TestServer, passage};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    the_overview_agrees_with_the_vessels_page,
    the_overview_predicts_for_the_next_port_call,
    the_overview_of_one_vessel_is_its_operators_alone,
    the_overview_comes_in_pages,
    gnss_interference_is_an_alert_with_its_place_until_it_passes,
    tags_and_saved_views_are_ones_own,
);

const HOUR_S: f64 = 3_600.0;

async fn the_overview_agrees_with_the_vessels_page(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    set_alert_limits(&server, &ada, &nao, json!({ "deviation_deg": 2.5 })).await;
    ada.create_vessel("Kogge").await;

    let fleet = ada.get("/fleet").await.good();
    let vessels = fleet["vessels"].as_array().unwrap();
    let names: Vec<&str> = vessels
        .iter()
        .map(|vessel| vessel["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["Nao", "Kogge"]);

    let page = ada.get(&nao.path("")).await.good();
    let glance = &vessels[0];
    for field in ["id", "name", "last_upload_at", "open_alerts"] {
        assert_eq!(glance[field], page[field], "{field}");
    }
    let worst = |vessel: &Value| vessel["worst"]["deviation_deg"].as_f64().unwrap();
    assert!((worst(glance) - worst(&page)).abs() < 0.001);
    assert_eq!(glance["position"], page["last_position"]);
    assert_eq!(glance["model"]["version"], page["model"]["version"]);
    assert_eq!(glance["alert"]["severity"], page["worst_alert"]);
    assert_eq!(glance["alert"]["cause"], "deviation_over_limit");
    // Fifty hours of samples touch five half days.
    assert_eq!(glance["track"].as_array().unwrap().len(), 5);

    let new = &vessels[1];
    assert_eq!(new["track"], json!([]));
    for field in [
        "position",
        "model",
        "worst",
        "alert",
        "last_upload_at",
        "next_call",
    ] {
        assert_eq!(new[field], Value::Null, "{field}");
    }
    server.finish().await;
}

async fn the_overview_predicts_for_the_next_port_call(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    for (port, eta, etd) in [("FIHEL", "22T06", "22T18"), ("NLRTM", "21T08", "21T10")] {
        let time = |hour: &str| format!("2026-11-{hour}:00:00Z");
        let call = json!({ "port": port, "eta": time(eta), "etd": time(etd) });
        ada.post(&nao.path("/port-calls"), &call).await.good();
    }
    let next = async || ada.get("/fleet").await.good()["vessels"][0]["next_call"].clone();
    let first = next().await;
    assert_eq!(
        (&first["port"], &first["port_name"]),
        (&json!("NLRTM"), &json!("Rotterdam"))
    );
    // The same as the deviation endpoint says for that place and time.
    let there = nao.path("/deviation?lat=51.95&lon=4.13&at=2026-11-21T08:00:00Z&step_deg=5");
    let rows = ada.get(&there).await.good()["rows"].clone();
    let largest = |rows: &Value| {
        let rows = rows.as_array().unwrap().iter();
        rows.map(|row| row["deviation_deg"].as_f64().unwrap().abs())
            .fold(0.0, f64::max)
    };
    let predicted_model = first["worst"]["deviation_deg"].as_f64().unwrap().abs();
    assert!((predicted_model - largest(&rows)).abs() < 0.1, "{first}");

    // The current port call counts until departure; then the next one follows.
    server.advance(2.0 * HOUR_S);
    assert_eq!(next().await["port"], "NLRTM");
    server.advance(2.0 * HOUR_S);
    assert_eq!(next().await["port"], "FIHEL");
    server.finish().await;
}

async fn the_overview_of_one_vessel_is_its_operators_alone(server: TestServer) {
    let ada = server.admin("ada").await;
    ada.create_vessel("Nao").await;
    let kogge = ada.create_vessel("Kogge").await;
    let path = format!("/fleet?vessel={}", kogge["id"].as_str().unwrap());
    let one = ada.get(&path).await.good();
    assert_eq!(one["vessels"].as_array().unwrap().len(), 1);
    assert_eq!(one["vessels"][0]["name"], "Kogge");

    let eve = server.admin("eve").await;
    assert_eq!(eve.get(&path).await.good()["vessels"], json!([]));
    assert_eq!(eve.get("/fleet").await.good()["vessels"], json!([]));
    assert_eq!(eve.get("/fleet?vessel=x").await.problem(), "bad-request");
    server.finish().await;
}

async fn the_overview_comes_in_pages(server: TestServer) {
    let ada = server.admin("ada").await;
    for name in ["Nao", "Kogge", "Gaviota"] {
        ada.create_vessel(name).await;
    }
    let first = ada.get("/fleet?limit=2").await.good();
    let names = |page: &Value| {
        let vessels = page["vessels"].as_array().unwrap().iter();
        vessels
            .map(|vessel| vessel["name"].as_str().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&first), ["Nao", "Kogge"]);
    let next = first["next"].as_str().unwrap();
    let second = ada
        .get(&format!("/fleet?limit=2&after={next}"))
        .await
        .good();
    assert_eq!(names(&second), ["Gaviota"]);
    assert_eq!(second["next"], Value::Null);
    server.finish().await;
}

async fn gnss_interference_is_an_alert_with_its_place_until_it_passes(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    let mut samples = passage("2026-11-20T00:00:00Z", 18);
    for sample in &mut samples[6..] {
        sample.position_reckoned = true;
    }
    nao.put(2, &samples).await.good();
    server.advance(60.0);
    server.work().await;
    let alert = async || {
        let alerts = ada.get("/alerts?state=raised").await.good();
        let alerts = alerts["items"].as_array().unwrap().clone();
        alerts
            .into_iter()
            .find(|alert| alert["cause"] == "gnss_interference")
    };
    let met = async || {
        let fleet = ada.get("/fleet").await.good();
        fleet["vessels"][0]["interference"].clone()
    };
    let summary = alert().await.unwrap()["summary"].to_string();
    assert!(
        summary.contains("° N, ") && summary.contains("° W since 2026-11-20 01:00"),
        "{summary}"
    );
    let begun = met().await;
    assert_eq!(begun[0]["began_at"], "2026-11-20T01:00:00Z", "{begun}");
    assert_eq!(begun[0]["ended_at"], Value::Null);
    let middle = samples[12].position;
    let place = |name: &str| begun[0][name].as_f64().unwrap();
    assert!((place("lat") - middle.lat_deg()).abs() < 0.01, "{begun}");
    assert!((place("lon") - middle.lon_deg()).abs() < 0.01, "{begun}");

    nao.put(3, &passage("2026-11-20T04:00:00Z", 12))
        .await
        .good();
    server.advance(60.0);
    server.work().await;
    assert_eq!(alert().await, None);
    let over = met().await;
    assert_eq!(over[0]["ended_at"], "2026-11-20T04:00:00Z", "{over}");
    server.finish().await;
}

async fn tags_and_saved_views_are_ones_own(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    let nao = ada.create_vessel("Nao").await;
    let path = format!("/vessels/{}/tags", nao["id"].as_str().unwrap());
    let put = async |person: &Person, path: &str, body: Value| {
        ApiResponse::send(person.request(Method::PUT, path).json(&body)).await
    };
    let tags = json!({ "tags": ["tanker", " Atlantic ", "tanker"] });
    assert_eq!(put(&eve, &path, tags.clone()).await.problem(), "not-found");
    put(&ada, &path, tags).await.good();
    let fleet = ada.get("/fleet").await.good();
    assert_eq!(fleet["vessels"][0]["tags"], json!(["Atlantic", "tanker"]));
    let long = json!({ "tags": ["x".repeat(41)] });
    assert_eq!(put(&ada, &path, long).await.problem(), "invalid");
    put(&ada, &path, json!({ "tags": [] })).await.good();
    assert_eq!(
        ada.get("/fleet").await.good()["vessels"][0]["tags"],
        json!([])
    );

    let views = json!({ "items": [
        { "name": "Tankers", "search": "?tag=tanker" },
        { "name": "All", "search": "" },
    ] });
    put(&ada, "/me/fleet-views", views).await.good();
    let saved = ada.get("/me/fleet-views").await.good();
    let names = [&saved["items"][0]["name"], &saved["items"][1]["name"]];
    assert_eq!(names, ["All", "Tankers"]);
    let viewer = ada.viewer(&server).await;
    for other in [&viewer, &eve] {
        assert_eq!(
            other.get("/me/fleet-views").await.good()["items"],
            json!([])
        );
    }
    server.finish().await;
}
