//! Vessels and compasses.

use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    vessels_are_paged_in_order_of_creation,
    a_repeated_create_request_creates_nothing,
    an_invalid_vessel_is_refused_by_field,
    a_vessel_may_have_several_compasses,
    vessel_and_compass_details_can_be_amended,
);

async fn vessels_are_paged_in_order_of_creation(server: TestServer) {
    let ada = server.admin("ada").await;
    for name in ["A", "B", "C"] {
        ada.create_vessel(name).await;
    }
    let mut names = Vec::new();
    let mut path = "/vessels?limit=2".to_owned();
    loop {
        let page = ada.get(&path).await.good();
        for item in page["items"].as_array().unwrap() {
            names.push(item["name"].as_str().unwrap().to_owned());
        }
        let Some(next) = page["next"].as_str() else {
            break;
        };
        path = format!("/vessels?limit=2&after={next}");
    }
    assert_eq!(names, ["A", "B", "C"]);
    assert_eq!(ada.get("/vessels?after=x").await.problem(), "bad-request");
    assert_eq!(ada.get("/vessels?limit=x").await.problem(), "bad-request");
    server.finish().await;
}

async fn a_repeated_create_request_creates_nothing(server: TestServer) {
    let ada = server.admin("ada").await;
    let create = async |body: Value| {
        let request = ada.request(Method::POST, "/vessels");
        ApiResponse::send(request.header("idempotency-key", "k-1").json(&body)).await
    };
    let first = create(json!({ "name": "Nao" })).await;
    let repeated = create(json!({ "name": "Nao" })).await;
    assert_eq!((first.status, repeated.status), (201, 201));
    assert_eq!(first.json(), repeated.json());
    let other = create(json!({ "name": "Kogge" })).await;
    assert_eq!(other.problem(), "idempotency-key-reused");
    let listed = ada.get("/vessels").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);

    let eve = server.admin("eve").await;
    let request = eve
        .request(Method::POST, "/vessels")
        .header("idempotency-key", "k-1");
    let theirs = ApiResponse::send(request.json(&json!({ "name": "Nao" }))).await;
    assert_ne!(theirs.good()["id"], first.json()["id"]);
    server.finish().await;
}

async fn an_invalid_vessel_is_refused_by_field(server: TestServer) {
    let ada = server.admin("ada").await;
    let long = "x".repeat(201);
    for (body, field) in [
        (json!({ "name": "  " }), "name"),
        (json!({ "name": long }), "name"),
        (json!({ "name": "a\nb" }), "name"),
        (
            json!({ "name": "Nao", "imo_number": "9074728" }),
            "imo_number",
        ),
        (json!({ "imo_number": "9074729" }), "name"),
        (json!({ "name": 5 }), "name"),
    ] {
        let response = ada.post("/vessels", &body).await;
        assert_eq!(response.problem(), "invalid");
        let detail = response.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains(field), "{detail}");
    }
    assert_eq!(ada.get("/vessels").await.good()["items"], json!([]));
    server.finish().await;
}

async fn a_vessel_may_have_several_compasses(server: TestServer) {
    let ada = server.admin("ada").await;
    let vessel = ada.create_vessel("Nao").await;
    let path = format!("/vessels/{}/compasses", vessel["id"].as_str().unwrap());
    let aft = json!({ "name": "Aft", "role": "steering" });
    ada.post(&path, &aft).await.good();
    let listed = ada.get(&path).await.good();
    let roles: Vec<&str> = listed["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|compass| compass["role"].as_str().unwrap())
        .collect();
    assert_eq!(roles, ["standard", "steering"]);
    let odd = json!({ "name": "Aft", "role": "odd" });
    assert_eq!(ada.post(&path, &odd).await.problem(), "invalid");
    server.finish().await;
}

async fn vessel_and_compass_details_can_be_amended(server: TestServer) {
    let ada = server.admin("ada").await;
    let body = json!({ "name": "Nao", "imo_number": "9074729", "flag": "Spain" });
    let vessel = ada.post("/vessels", &body).await.good();
    let path = format!("/vessels/{}", vessel["id"].as_str().unwrap());
    let amend = async |path: &str, body: Value| {
        ApiResponse::send(ada.request(Method::PATCH, path).json(&body)).await
    };
    let change = json!({ "call_sign": " EAVN ", "flag": null });
    let amended = amend(&path, change).await.good();
    let words = ["name", "imo_number", "call_sign", "flag"].map(|field| amended[field].clone());
    assert_eq!(
        Value::from(words.to_vec()),
        json!(["Nao", "9074729", "EAVN", null])
    );
    for (wrong, field) in [
        (json!({ "imo_number": "9074728" }), "imo_number"),
        (json!({ "name": " " }), "name"),
        (json!({ "callsign": "EAVN" }), "callsign"),
    ] {
        let response = amend(&path, wrong).await;
        assert_eq!(response.problem(), "invalid");
        assert!(response.text.contains(field), "{response:?}");
    }
    assert_eq!(ada.get(&path).await.good(), amended);

    let compass = format!(
        "{path}/compasses/{}",
        amended["compasses"][0]["id"].as_str().unwrap()
    );
    let plate = json!({ "make": "Reflecta 1", "serial_number": "34871", "binnacle": "no. 7" });
    let amended = amend(&compass, plate).await.good();
    assert_eq!(
        (&amended["make"], &amended["binnacle"]),
        (&json!("Reflecta 1"), &json!("no. 7"))
    );
    let amended = amend(
        &compass,
        json!({ "binnacle": null, "role": "transmitting" }),
    )
    .await
    .good();
    assert_eq!(amended["serial_number"], "34871");
    assert_eq!(
        (&amended["binnacle"], &amended["role"]),
        (&json!(null), &json!("transmitting"))
    );
    assert_eq!(ada.get(&path).await.good()["compasses"], json!([amended]));
    assert_eq!(
        amend(&compass, json!({ "make": "a\nb" })).await.problem(),
        "invalid"
    );
    let none = format!("{path}/compasses/{}", vessel["id"].as_str().unwrap());
    assert_eq!(amend(&none, json!({})).await.problem(), "not-found");

    let viewer = ada.viewer(&server).await;
    for path in [&path, &compass] {
        let response =
            ApiResponse::send(viewer.request(Method::PATCH, path).json(&json!({}))).await;
        assert_eq!(response.problem(), "forbidden");
    }
    server.finish().await;
}
