//! The alert of an agreed job at risk, and its end.

use super::agreed_job::AgreedJob;
use super::offers::{alerts, firm, order_for_firm};
use super::{due_vessel, enter_port_call, put, solve, terms, update_schedule};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{ApiResponse, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_port_call_moved_past_the_due_date_puts_its_job_at_risk_at_once,
    an_agreed_job_at_risk_stays_so_without_its_firm,
    an_agreed_job_is_at_risk_when_its_firm_has_no_teams,
    an_agreed_job_without_a_port_call_is_at_risk_once_port_calls_are_known,
);

async fn a_port_call_moved_past_the_due_date_puts_its_job_at_risk_at_once(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    update_schedule(&server).await;
    // The compass is due on the twentieth.
    agreed
        .move_port_call("2026-12-22T06:00:00Z", "2026-12-23T18:00:00Z")
        .await;
    assert_eq!(agreed.view_order().await["call_fit"], "needs_new_day");
    assert_eq!(update_schedule(&server).await, Some(agreed.ada.operator));
    let raised = alerts(&agreed.ada).await;
    assert_eq!(raised.len(), 1, "{raised:?}");
    let summary = raised[0]["summary"].as_str().unwrap();
    assert!(
        summary.contains("agreed with rosa for 2026-12-15"),
        "{summary}"
    );
    // A new day in the port call is late, but both sides may agree on it.
    agreed.retime("2026-12-22T08:00:00Z").await.good();
    agreed.respond(&agreed.rosa, "accept").await.good();
    assert_eq!(agreed.view_order().await["call_fit"], Value::Null);
    update_schedule(&server).await;
    let raised = alerts(&agreed.ada).await;
    assert_eq!(
        raised.len(),
        1,
        "it is still after the due date: {raised:?}"
    );
    server.finish().await;
}

async fn an_agreed_job_at_risk_stays_so_without_its_firm(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let ada = &agreed.ada;
    solve(ada).await;
    let path = format!("/firms/{}/terms", agreed.firm);
    let left_out = async || {
        ApiResponse::send(ada.request(Method::DELETE, &path)).await;
        let plan = solve(ada).await;
        assert_eq!(plan["under_way"].as_array().unwrap().len(), 1, "{plan}");
        alerts(ada).await
    };
    assert_eq!(left_out().await, [] as [Value; 0]);
    put(ada, &path, &terms()).await.good();
    agreed
        .move_port_call("2026-12-22T06:00:00Z", "2026-12-23T18:00:00Z")
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
    server.finish().await;
}

async fn an_agreed_job_is_at_risk_when_its_firm_has_no_teams(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let path = format!("/firms/{}/terms", agreed.firm);
    let mut none = terms();
    none["teams"] = json!(0);
    put(&agreed.ada, &path, &none).await.good();
    solve(&agreed.ada).await;
    let raised = alerts(&agreed.ada).await;
    assert_eq!(raised.len(), 1, "{raised:?}");
    let summary = raised[0]["summary"].as_str().unwrap();
    assert!(
        summary.contains("a firm without teams does no jobs"),
        "{summary}"
    );
    put(&agreed.ada, &path, &terms()).await.good();
    solve(&agreed.ada).await;
    assert_eq!(alerts(&agreed.ada).await, [] as [Value; 0]);
    server.finish().await;
}

async fn an_agreed_job_without_a_port_call_is_at_risk_once_port_calls_are_known(
    server: TestServer,
) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let (id, rosa) = firm(&server, &ada, "rosa").await;
    let order = order_for_firm(&nao, "NLRTM", "2026-12-15T09:00:00Z", &id);
    let order = ada.post("/work-orders", &order).await.good();
    let order = format!("/work-orders/{}", order["id"].as_str().unwrap());
    rosa.post(&format!("{order}/accept"), &json!({}))
        .await
        .good();
    solve(&ada).await;
    assert_eq!(alerts(&ada).await, [] as [Value; 0]);
    enter_port_call(&ada, &nao, "BEANR", 14).await;
    solve(&ada).await;
    let raised = alerts(&ada).await;
    let summary = raised[0]["summary"].as_str().unwrap();
    assert!(summary.contains("no port call is known"), "{summary}");
    enter_port_call(&ada, &nao, "NLRTM", 16).await;
    solve(&ada).await;
    assert_eq!(alerts(&ada).await.len(), 1);
    server.finish().await;
}
