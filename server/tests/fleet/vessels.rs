//! Vessels and compasses.

use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    vessels_are_paged_in_order_of_creation,
    a_repeated_create_request_creates_nothing,
    an_invalid_vessel_is_refused_by_field,
    a_vessel_may_have_several_compasses,
    vessel_and_compass_details_can_be_amended,
    an_imo_number_is_one_vessels_within_an_operator,
    duplicate_imo_numbers_from_before_are_kept_until_someone_amends_them,
    a_file_of_vessels_is_entered_whole_or_not_at_all,
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

fn numbered(name: &str, number: &str) -> Value {
    json!({ "name": name, "imo_number": number })
}

async fn amend(person: &Person, vessel: &Value, body: Value) -> ApiResponse {
    let path = format!("/vessels/{}", vessel["id"].as_str().unwrap());
    ApiResponse::send(person.request(Method::PATCH, &path).json(&body)).await
}

async fn an_imo_number_is_one_vessels_within_an_operator(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    let nao = ada
        .post("/vessels", &numbered("Nao", "9074729"))
        .await
        .good();
    let second = ada.post("/vessels", &numbered("Kogge", "9074729")).await;
    assert_eq!(second.problem(), "invalid");
    let detail = second.json()["detail"].as_str().unwrap().to_owned();
    assert_eq!(detail, "imo_number: 9074729 is the IMO number of Nao");
    let kogge = ada.create_vessel("Kogge").await;
    let amended = amend(&ada, &kogge, json!({ "imo_number": "9074729" })).await;
    assert_eq!(amended.problem(), "invalid");
    amend(
        &ada,
        &nao,
        json!({ "imo_number": "9074729", "name": "Nao Victoria" }),
    )
    .await
    .good();
    // A vessel that was sold is two operators'.
    eve.post("/vessels", &numbered("Nao", "9074729"))
        .await
        .good();
    server.finish().await;
}

async fn duplicate_imo_numbers_from_before_are_kept_until_someone_amends_them(server: TestServer) {
    let ada = server.admin("ada").await;
    ada.post("/vessels", &numbered("Nao", "9074729"))
        .await
        .good();
    let other = ada.create_vessel("Other Nao").await;
    // As before the migration, with a duplicate; then its statements again.
    for before in [
        "DROP INDEX vessels_by_imo",
        "ALTER TABLE vessels DROP COLUMN imo_shared",
        "UPDATE vessels SET imo_number = '9074729'",
    ] {
        server.run_sql(before).await;
    }
    let migration = include_str!("../../../migrations/0020_first_run.sql");
    let (_, of_vessels) = migration.split_once("ALTER TABLE vessels").unwrap();
    let (column, rest) = of_vessels.split_once(';').unwrap();
    server
        .run_sql(format!("ALTER TABLE vessels{column}").leak())
        .await;
    for statement in rest.split(';').filter(|text| !text.trim().is_empty()) {
        server.run_sql(statement).await;
    }
    let listed = ada.get("/vessels").await.good();
    for vessel in listed["items"].as_array().unwrap() {
        assert_eq!(vessel["imo_number"], "9074729");
    }
    // The duplicate may be renamed, and gets a number of its own.
    amend(&ada, &other, json!({ "name": "Kogge" })).await.good();
    amend(&ada, &other, json!({ "imo_number": "9211561" }))
        .await
        .good();
    let back = amend(&ada, &other, json!({ "imo_number": "9074729" })).await;
    assert_eq!(back.problem(), "invalid");
    server.finish().await;
}

async fn a_file_of_vessels_is_entered_whole_or_not_at_all(server: TestServer) {
    let ada = server.admin("ada").await;
    let send = async |text: &str| {
        let request = ada.request(Method::POST, "/vessels.csv");
        let request = request.header("content-type", "text/csv");
        ApiResponse::send(request.body(text.to_owned())).await
    };
    ada.create_vessel("Kogge").await;
    let faulty = "name,imo_number\nNao,9074728\nKogge,\nHulk,9074729\nHolk,9074729\n";
    let refused = send(faulty).await;
    assert_eq!(refused.problem(), "invalid");
    let detail = refused.json()["detail"].as_str().unwrap().to_owned();
    for message in [
        "line 2: imo_number: 9074728 is not an IMO number",
        "line 3: name: Kogge is in the fleet already",
        "line 5: imo_number: 9074729 is already on line 4",
    ] {
        assert!(detail.contains(message), "{detail}");
    }
    // As spreadsheets write it, with a blank line.
    let refused = send("name,imo_number\r\n\r\nNao,9074729\r\nHulk,9074728\r\n").await;
    let detail = refused.json()["detail"].as_str().unwrap().to_owned();
    assert!(detail.contains("line 4: imo_number"), "{detail}");
    let good = send("\u{feff}name;flag;imo_number\r\nNao Victoria;ES;9074729\r\nHulk;;\r\n").await;
    assert_eq!((good.status, good.good()), (201, json!({ "created": 2 })));
    let listed = ada.get("/vessels").await.good();
    let named = |at: usize| listed["items"][at]["name"].as_str().unwrap();
    assert_eq!(
        [named(0), named(1), named(2)],
        ["Kogge", "Nao Victoria", "Hulk"]
    );
    assert_eq!(listed["items"][1]["flag"], "ES");
    assert_eq!(listed["items"][1]["compasses"].as_array().unwrap().len(), 1);
    for (text, message) in [
        ("imo\n1\n", "line 1: imo: is not a column"),
        ("flag\nES\n", "line 1: name: the column is missing"),
        ("name\n", "the file names no vessel"),
        ("name,flag,flag\nNao,ES,ES\n", "line 1: flag: appears twice"),
    ] {
        let refused = send(text).await;
        let detail = refused.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains(message), "{detail}");
    }
    server.finish().await;
}
