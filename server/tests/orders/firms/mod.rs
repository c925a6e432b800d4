//! Firms, their people, and their visibility to operators.

use crate::run;
use binnacle_platform::ids::FirmId;
use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::on_both;
use binnacle_server_testing::program::{assert_refused, good};
use binnacle_server_testing::{ApiResponse, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_platform_admin_engages_a_firm_for_an_operator,
    only_a_platform_admin_manages_operators_and_engages_firms,
    a_firm_with_an_open_order_cannot_be_disengaged,
    names_with_direction_overrides_are_refused,
    an_operator_sees_its_engaged_firms,
    a_firm_repeated_under_its_key_is_created_once,
    an_adjuster_cannot_read_a_fleet,
    a_read_token_cannot_create_a_firm,
);

fn names(list: &Value) -> Vec<&str> {
    let items = list["items"].as_array().unwrap();
    items
        .iter()
        .map(|item| item["name"].as_str().unwrap())
        .collect()
}

async fn a_platform_admin_engages_a_firm_for_an_operator(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    let operators = root.get("/operators").await.good();
    assert_eq!(names(&operators), ["ada"]);
    let operator = operators["items"][0]["id"].as_str().unwrap();
    let new = json!({ "name": " Nervión Compass " });
    let firm = root.post("/firms", &new).await;
    assert_eq!(firm.status, 201);
    let firm = firm.good();
    assert_eq!(firm["name"], "Nervión Compass");
    assert_eq!(names(&ada.get("/firms").await.good()), [""; 0]);
    let between = format!(
        "/operators/{operator}/firms/{}",
        firm["id"].as_str().unwrap()
    );
    for _ in 0..2 {
        let engaged = ApiResponse::send(root.request(Method::PUT, &between)).await;
        assert_eq!(engaged.status, 204, "{engaged:?}");
    }
    assert_eq!(names(&ada.get("/firms").await.good()), ["Nervión Compass"]);
    let dismissed = ApiResponse::send(root.request(Method::DELETE, &between)).await;
    assert_eq!(dismissed.status, 204, "{dismissed:?}");
    assert_eq!(names(&ada.get("/firms").await.good()), [""; 0]);
    let repeated = ApiResponse::send(root.request(Method::DELETE, &between)).await;
    assert_eq!(repeated.problem(), "not-found");
    server.finish().await;
}

async fn a_firm_with_an_open_order_cannot_be_disengaged(server: TestServer) {
    let parties = OfferParties::offered(&server, 2).await;
    let root = parties.ada.platform_admin(&server).await;
    let part = async |firm: FirmId| {
        let between = format!("/operators/{}/firms/{firm}", parties.ada.operator);
        ApiResponse::send(root.request(Method::DELETE, &between)).await
    };
    let [(offered, rosa), (waiting, _)] = &parties.firms[..] else {
        unreachable!("there are two")
    };
    for firm in [offered, waiting] {
        let refused = part(*firm).await;
        assert_eq!(refused.problem(), "wrong-state");
        assert!(
            refused.text.contains("one order is still open"),
            "{refused:?}"
        );
    }
    parties.post(rosa, "/accept", &json!({})).await.good();
    // The waiting firm gets the offer when the first firm gives the order back.
    for firm in [offered, waiting] {
        assert_eq!(part(*firm).await.problem(), "wrong-state");
    }
    let sold = json!({ "text": "sold" });
    parties.post(&parties.ada, "/cancel", &sold).await.good();
    for firm in [offered, waiting] {
        assert_eq!(part(*firm).await.status, 204);
    }
    server.finish().await;
}

async fn names_with_direction_overrides_are_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    for turned in [
        "Nao \u{202e}tsoC",
        "\u{2066}Nao",
        "Nao\u{200f}",
        "Na\u{2028}o",
    ] {
        let refused = ada.post("/vessels", &json!({ "name": turned })).await;
        assert_eq!(refused.problem(), "invalid", "{turned:?}");
        assert!(refused.text.contains("direction of writing"), "{refused:?}");
    }
    // Any script, with its joining characters.
    for name in ["سفينة", "ספינה", "می\u{200c}خواهم"] {
        let made = ada.post("/vessels", &json!({ "name": name })).await;
        assert_eq!(made.good()["name"], name);
    }
    server.finish().await;
}

async fn only_a_platform_admin_manages_operators_and_engages_firms(server: TestServer) {
    let ada = server.admin("ada").await;
    let (firm, rosa) = ada.adjuster(&server, "rosa").await;
    let new = json!({ "name": "Other" });
    let viewer = ada.viewer(&server).await;
    for person in [&ada, &rosa, &viewer] {
        let between = format!("/operators/{}/firms/{firm}", ada.operator);
        let refused = [
            person.get("/operators").await,
            person.get(&format!("/operators/{}", ada.operator)).await,
            person.post("/operators", &new).await,
            ApiResponse::send(person.request(Method::PUT, &between)).await,
            ApiResponse::send(person.request(Method::DELETE, &between)).await,
        ];
        for response in refused {
            assert_eq!(response.problem(), "forbidden");
        }
    }
    for person in [&rosa, &viewer] {
        let refused = person.post("/firms", &new).await;
        assert_eq!(refused.problem(), "forbidden");
    }
    let root = ada.platform_admin(&server).await;
    assert_eq!(root.post("/operators", &new).await.status, 201);
    let blank = json!({ "name": "  " });
    assert_eq!(root.post("/firms", &blank).await.problem(), "invalid");
    for nobody in [
        format!("/operators/{firm}/firms/{firm}"),
        format!("/operators/{0}/firms/{0}", ada.operator),
    ] {
        let response = ApiResponse::send(root.request(Method::PUT, &nobody)).await;
        assert_eq!(response.problem(), "not-found", "{nobody}");
    }
    server.finish().await;
}

async fn an_operator_sees_its_engaged_firms(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let (firm, rosa) = ada.adjuster(&server, "rosa").await;
    let (other, _) = eve.adjuster(&server, "other").await;
    assert_eq!(names(&ada.get("/firms").await.good()), ["rosa"]);
    assert_eq!(names(&eve.get("/firms").await.good()), ["other"]);
    assert_eq!(names(&rosa.get("/firms").await.good()), ["rosa"]);
    let all = ada.platform_admin(&server).await.get("/firms").await.good();
    assert_eq!(names(&all), ["rosa", "other"]);
    let (path, other) = (format!("/firms/{firm}"), format!("/firms/{other}"));
    assert_eq!(ada.get(&path).await.good()["name"], "rosa");
    assert_eq!(rosa.get(&path).await.good()["name"], "rosa");
    assert_eq!(eve.get(&path).await.problem(), "not-found");
    assert_eq!(rosa.get(&other).await.problem(), "not-found");
    server.finish().await;
}

async fn a_firm_repeated_under_its_key_is_created_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    let new = json!({ "name": "Nervión Compass" });
    let mut ids = Vec::new();
    for _ in 0..2 {
        let request = root.request(Method::POST, "/firms").json(&new);
        let made = ApiResponse::send(request.header("Idempotency-Key", "1")).await;
        ids.push(made.good()["id"].clone());
    }
    assert_eq!(ids[0], ids[1]);
    assert_eq!(names(&root.get("/firms").await.good()).len(), 1);
    server.finish().await;
}

async fn an_adjuster_cannot_read_a_fleet(server: TestServer) {
    let ada = server.admin("ada").await;
    let (firm, rosa) = ada.adjuster(&server, "rosa").await;
    let me = rosa.get("/me").await.good();
    assert_eq!(me["role"], "adjuster");
    assert_eq!(me["firm_id"], firm.to_string());
    assert_eq!(me["firm_name"], "rosa");
    assert_eq!(me["operator_id"], Value::Null);
    let vessel = ada.create_vessel("Nao").await;
    let path = format!("/vessels/{}", vessel["id"].as_str().unwrap());
    for path in ["/vessels", &path, &format!("{path}/model")] {
        assert_eq!(rosa.get(path).await.problem(), "forbidden", "{path}");
    }
    let made = rosa.post("/vessels", &json!({ "name": "Other" })).await;
    assert_eq!(made.problem(), "forbidden");
    server.finish().await;
}

async fn a_read_token_cannot_create_a_firm(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    let token = json!({ "name": "ERP", "scope": "read" });
    let token = root.post("/tokens", &token).await.good()["token"].clone();
    let url = format!("{}/api/v1/firms", server.url);
    let request = |method| {
        let request = server.http.request(method, &url);
        request.bearer_auth(token.as_str().unwrap())
    };
    assert_eq!(ApiResponse::send(request(Method::GET)).await.status, 200);
    let new = request(Method::POST).json(&json!({ "name": "Other" }));
    assert_eq!(ApiResponse::send(new).await.problem(), "forbidden");
    server.finish().await;
}

#[test]
fn admin_creates_a_firm_and_its_adjusters() {
    let folder = tempfile::tempdir().unwrap();
    let create = |more: &[&str]| run(folder.path(), &[&["admin", "create"], more].concat());
    let made = |more: &[&str]| serde_json::from_str::<Value>(&good(&create(more))).unwrap();
    let operator = made(&["operator", "--name", "Nao"])["operator_id"].clone();
    let operator = operator.as_str().unwrap();
    let firm = made(&["firm", "--name", "Compass", "--operator", operator]);
    assert_eq!(firm["operators"], json!([operator]));
    let firm = firm["firm_id"].as_str().unwrap();
    let person = ["--email", "rosa@b.example", "--name", "Rosa"];
    let rosa = made(&[&["adjuster", "--firm", firm], &person[..]].concat());
    assert_eq!(
        (&rosa["role"], &rosa["firm_id"]),
        (&json!("adjuster"), &json!(firm))
    );
    let nobody = "00000000-0000-0000-0000-000000000000";
    let refused = create(&["firm", "--name", "Other", "--operator", nobody]);
    assert_refused(&refused, &["--operator", "does not exist"]);
    let other = ["--email", "other@b.example", "--name", "Other"];
    let refused = create(&[&["adjuster", "--firm", operator], &other[..]].concat());
    assert_refused(&refused, &["--firm", "does not exist"]);
    let refused = create(&[&["adjuster", "--firm", firm], &person[..]].concat());
    assert_refused(&refused, &["--email", "already has an account"]);
}
