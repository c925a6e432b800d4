//! An agreed job that can hardly be done in time any more: its alert, and what ends it.

use super::agreed::Agreed;
use super::offers::{alerts, direct, firm};
use super::{due_vessel, enter, follow, put, solve, terms};
use crate::on_both;
use crate::support::{Answer, Shore};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_call_moved_past_the_due_date_is_at_risk_before_anyone_asks,
    an_agreed_job_stays_at_risk_when_its_firm_is_left_out,
    an_agreed_job_whose_firm_has_no_teams_any_more_is_at_risk,
    an_agreed_job_without_a_call_is_at_risk_once_her_calls_are_known,
);

async fn a_call_moved_past_the_due_date_is_at_risk_before_anyone_asks(shore: Shore) {
    let agreed = Agreed::new(&shore).await;
    follow(&shore).await;
    // She is due on the twentieth.
    agreed
        .moves("2026-12-22T06:00:00Z", "2026-12-23T18:00:00Z")
        .await;
    assert_eq!(agreed.seen().await["call_fit"], "needs_new_day");
    assert_eq!(follow(&shore).await, Some(agreed.ada.operator));
    let told = alerts(&agreed.ada).await;
    assert_eq!(told.len(), 1, "{told:?}");
    let summary = told[0]["summary"].as_str().unwrap();
    assert!(
        summary.contains("agreed with rosa for 2026-12-15"),
        "{summary}"
    );
    // A new day in the call is late, and agreed on all the same if both want it.
    agreed.retime("2026-12-22T08:00:00Z").await.good();
    agreed.answer(&agreed.rosa, "accept").await.good();
    assert_eq!(agreed.seen().await["call_fit"], Value::Null);
    follow(&shore).await;
    let told = alerts(&agreed.ada).await;
    assert_eq!(told.len(), 1, "it is still after the due date: {told:?}");
    shore.finish().await;
}

async fn an_agreed_job_stays_at_risk_when_its_firm_is_left_out(shore: Shore) {
    let agreed = Agreed::new(&shore).await;
    let ada = &agreed.ada;
    solve(ada).await;
    let path = format!("/firms/{}/terms", agreed.firm);
    let left_out = async || {
        Answer::of(ada.request(Method::DELETE, &path)).await;
        let plan = solve(ada).await;
        assert_eq!(plan["under_way"].as_array().unwrap().len(), 1, "{plan}");
        alerts(ada).await
    };
    assert_eq!(left_out().await, [] as [Value; 0]);
    put(ada, &path, &terms()).await.good();
    agreed
        .moves("2026-12-22T06:00:00Z", "2026-12-23T18:00:00Z")
        .await;
    solve(ada).await;
    let before = alerts(ada).await;
    assert_eq!(before.len(), 1, "{before:?}");
    let after = left_out().await;
    assert_eq!(after.len(), 1, "{after:?}");
    assert_eq!(after[0]["id"], before[0]["id"]);
    let summary = after[0]["summary"].as_str().unwrap();
    assert!(
        summary.contains("alongside from 2026-12-22 06:00 UTC to 2026-12-23 18:00 UTC"),
        "{summary}"
    );
    let cancelled = json!({ "text": "sold" });
    ada.post(&format!("{}/cancel", agreed.order), &cancelled)
        .await
        .good();
    solve(ada).await;
    assert_eq!(alerts(ada).await, [] as [Value; 0]);
    shore.finish().await;
}

async fn an_agreed_job_whose_firm_has_no_teams_any_more_is_at_risk(shore: Shore) {
    let agreed = Agreed::new(&shore).await;
    let path = format!("/firms/{}/terms", agreed.firm);
    let mut none = terms();
    none["teams"] = json!(0);
    put(&agreed.ada, &path, &none).await.good();
    solve(&agreed.ada).await;
    let told = alerts(&agreed.ada).await;
    assert_eq!(told.len(), 1, "{told:?}");
    let summary = told[0]["summary"].as_str().unwrap();
    assert!(
        summary.contains("a firm without teams does no jobs"),
        "{summary}"
    );
    put(&agreed.ada, &path, &terms()).await.good();
    solve(&agreed.ada).await;
    assert_eq!(alerts(&agreed.ada).await, [] as [Value; 0]);
    shore.finish().await;
}

async fn an_agreed_job_without_a_call_is_at_risk_once_her_calls_are_known(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let (id, rosa) = firm(&shore, &ada, "rosa").await;
    let order = direct(&nao, "NLRTM", "2026-12-15T09:00:00Z", &id);
    let order = ada.post("/work-orders", &order).await.good();
    let order = format!("/work-orders/{}", order["id"].as_str().unwrap());
    rosa.post(&format!("{order}/accept"), &json!({}))
        .await
        .good();
    solve(&ada).await;
    assert_eq!(alerts(&ada).await, [] as [Value; 0]);
    enter(&ada, &nao, "BEANR", 14).await;
    solve(&ada).await;
    let told = alerts(&ada).await;
    let summary = told[0]["summary"].as_str().unwrap();
    assert!(summary.contains("no port call is known"), "{summary}");
    enter(&ada, &nao, "NLRTM", 16).await;
    solve(&ada).await;
    assert_eq!(alerts(&ada).await.len(), 1);
    shore.finish().await;
}
