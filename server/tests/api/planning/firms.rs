//! On what terms firms work for an operator.

use super::{due_vessel, enter, firm, planned_firm, put, solve, terms};
use crate::on_both;
use crate::support::{Answer, Shore};
use reqwest::Method;
use serde_json::json;

on_both!(
    a_firm_without_days_is_kept_and_said_to_be_of_no_use,
    wrong_terms_are_refused_by_their_field,
    terms_are_an_operators_own,
    a_firm_without_terms_is_not_planned_with,
);

async fn a_firm_without_days_is_kept_and_said_to_be_of_no_use(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    enter(&ada, &nao, "NLRTM", 8).await;
    let id = firm(&shore, &ada, "Maas Compass").await;
    let mut idle = terms();
    idle["working_days"] = json!([]);
    let kept = put(&ada, &format!("/firms/{id}/terms"), &idle).await.good();
    let said = "working_days: a firm that works on no day of the week serves nobody";
    assert_eq!(kept["problems"], json!([said]));
    let list = ada.get("/firm-terms").await.good();
    assert_eq!(list["items"][0]["firm_name"], "Maas Compass");
    assert_eq!(list["items"][0]["problems"], json!([said]));
    let plan = solve(&ada).await;
    assert_eq!(plan["left_out"][0]["firm_name"], "Maas Compass");
    assert_eq!(plan["left_out"][0]["why"], said);
    assert_eq!(plan["jobs"], json!([]));
    shore.finish().await;
}

async fn wrong_terms_are_refused_by_their_field(shore: Shore) {
    let ada = shore.admin("ada").await;
    let id = firm(&shore, &ada, "Maas Compass").await;
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
        let answer = put(&ada, &path, &wrong).await;
        assert_eq!(answer.problem(), "invalid", "{field}: {value}");
        assert!(answer.text.contains(field), "{answer:?}");
    }
    let list = ada.get("/firm-terms").await.good();
    assert_eq!(list["items"][0]["terms"], json!(null));
    shore.finish().await;
}

async fn terms_are_an_operators_own(shore: Shore) {
    let ada = shore.admin("ada").await;
    let eve = shore.admin("eve").await;
    let id = planned_firm(&shore, &ada, "Maas Compass").await;
    let path = format!("/firms/{id}/terms");
    assert_eq!(put(&eve, &path, &terms()).await.problem(), "not-found");
    let delete = |person: &crate::support::Person| person.request(Method::DELETE, &path);
    let theirs = Answer::of(delete(&eve)).await;
    assert_eq!(theirs.problem(), "not-found");
    assert_eq!(eve.get("/firm-terms").await.good()["items"], json!([]));
    let viewer = ada.viewer(&shore).await;
    assert_eq!(put(&viewer, &path, &terms()).await.problem(), "forbidden");
    assert_eq!(Answer::of(delete(&ada)).await.status, 204);
    assert_eq!(Answer::of(delete(&ada)).await.problem(), "not-found");
    shore.finish().await;
}

async fn a_firm_without_terms_is_not_planned_with(shore: Shore) {
    let ada = shore.admin("ada").await;
    due_vessel(&ada, "Nao").await;
    firm(&shore, &ada, "Maas Compass").await;
    let plan = solve(&ada).await;
    let why = "its terms are not set";
    assert_eq!(plan["left_out"][0]["why"], why);
    let because = &plan["unscheduled"][0]["because"];
    assert_eq!(because, &json!(["no port call is known"]));
    shore.finish().await;
}
