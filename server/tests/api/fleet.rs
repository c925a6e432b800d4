//! Vessels and compasses.

use crate::on_both;
use crate::support::{Answer, Shore};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    vessels_page_in_the_order_they_were_entered,
    a_create_request_sent_again_creates_nothing_more,
    what_is_no_vessel_is_refused_by_its_field,
    a_vessel_may_have_more_compasses,
);

async fn vessels_page_in_the_order_they_were_entered(shore: Shore) {
    let ada = shore.admin("ada").await;
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
    shore.finish().await;
}

async fn a_create_request_sent_again_creates_nothing_more(shore: Shore) {
    let ada = shore.admin("ada").await;
    let create = async |body: Value| {
        let request = ada.request(Method::POST, "/vessels");
        Answer::of(request.header("idempotency-key", "k-1").json(&body)).await
    };
    let first = create(json!({ "name": "Nao" })).await;
    let again = create(json!({ "name": "Nao" })).await;
    assert_eq!((first.status, again.status), (201, 201));
    assert_eq!(first.json(), again.json());
    let other = create(json!({ "name": "Kogge" })).await;
    assert_eq!(other.problem(), "idempotency-key-reused");
    let listed = ada.get("/vessels").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);

    let eve = shore.admin("eve").await;
    let request = eve
        .request(Method::POST, "/vessels")
        .header("idempotency-key", "k-1");
    let theirs = Answer::of(request.json(&json!({ "name": "Nao" }))).await;
    assert_ne!(theirs.good()["id"], first.json()["id"]);
    shore.finish().await;
}

async fn what_is_no_vessel_is_refused_by_its_field(shore: Shore) {
    let ada = shore.admin("ada").await;
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
        let answer = ada.post("/vessels", &body).await;
        assert_eq!(answer.problem(), "invalid");
        let detail = answer.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains(field), "{detail}");
    }
    assert_eq!(ada.get("/vessels").await.good()["items"], json!([]));
    shore.finish().await;
}

async fn a_vessel_may_have_more_compasses(shore: Shore) {
    let ada = shore.admin("ada").await;
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
    shore.finish().await;
}
