//! Terms of firms with an operator.

use super::{due_vessel, enter_port_call, firm, planned_firm, put, solve, terms};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, TestServer};
use reqwest::Method;
use serde_json::json;

on_both!(
    a_firm_without_working_days_is_kept_and_reported_as_unusable,
    invalid_terms_are_refused_by_field,
    terms_belong_to_one_operator,
    a_firm_without_terms_is_not_in_the_plan,
);

async fn a_firm_without_working_days_is_kept_and_reported_as_unusable(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter_port_call(&ada, &nao, "NLRTM", 8).await;
    let id = firm(&server, &ada, "Maas Compass").await;
    let mut idle = terms();
    idle["working_days"] = json!([]);
    let kept = put(&ada, &format!("/firms/{id}/terms"), &idle).await.good();
    let problem = "working_days: a firm that works on no day of the week serves nobody";
    assert_eq!(kept["problems"], json!([problem]));
    let list = ada.get("/firm-terms").await.good();
    assert_eq!(list["items"][0]["firm_name"], "Maas Compass");
    assert_eq!(list["items"][0]["problems"], json!([problem]));
    let plan = solve(&ada).await;
    assert_eq!(plan["left_out"][0]["firm_name"], "Maas Compass");
    assert_eq!(plan["left_out"][0]["why"], problem);
    assert_eq!(plan["jobs"], json!([]));
    server.finish().await;
}

async fn invalid_terms_are_refused_by_field(server: TestServer) {
    let ada = server.admin("ada").await;
    let id = firm(&server, &ada, "Maas Compass").await;
    let path = format!("/firms/{id}/terms");
    for (field, value) in [
        ("fee_eur", json!(-1)),
        ("fee_eur", json!(null)),
        ("last_hour", json!(7)),
        ("jobs_a_team_day", json!(0)),
        ("teams", json!(1001)),
        ("lead_time_h", json!(-1)),
        ("working_days", json!(["Someday"])),
        ("closed", json!(["2026-02-30"])),
        ("flags", json!(["Panama"])),
        ("ports", json!([{ "port": "XXXXX" }])),
        ("ports", json!([{ "port": "NLRTM" }, { "port": "NLRTM" }])),
        ("colour", json!("red")),
    ] {
        let mut wrong = terms();
        wrong[field] = value.clone();
        let response = put(&ada, &path, &wrong).await;
        assert_eq!(response.problem(), "invalid", "{field}: {value}");
        assert!(response.text.contains(field), "{response:?}");
    }
    let list = ada.get("/firm-terms").await.good();
    assert_eq!(list["items"][0]["terms"], json!(null));
    server.finish().await;
}

async fn terms_belong_to_one_operator(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    let id = planned_firm(&server, &ada, "Maas Compass").await;
    let path = format!("/firms/{id}/terms");
    assert_eq!(put(&eve, &path, &terms()).await.problem(), "not-found");
    let delete = |person: &binnacle_server_testing::Person| person.request(Method::DELETE, &path);
    let theirs = ApiResponse::send(delete(&eve)).await;
    assert_eq!(theirs.problem(), "not-found");
    assert_eq!(eve.get("/firm-terms").await.good()["items"], json!([]));
    let viewer = ada.viewer(&server).await;
    assert_eq!(put(&viewer, &path, &terms()).await.problem(), "forbidden");
    assert_eq!(ApiResponse::send(delete(&ada)).await.status, 204);
    assert_eq!(ApiResponse::send(delete(&ada)).await.problem(), "not-found");
    server.finish().await;
}

async fn a_firm_without_terms_is_not_in_the_plan(server: TestServer) {
    let ada = server.admin("ada").await;
    due_vessel(&ada, "Nao").await;
    firm(&server, &ada, "Maas Compass").await;
    let plan = solve(&ada).await;
    let why = "its terms are not set";
    assert_eq!(plan["left_out"][0]["why"], why);
    let because = &plan["unscheduled"][0]["because"];
    assert_eq!(because, &json!(["no port call is known"]));
    server.finish().await;
}
