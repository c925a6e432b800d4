//! A withdrawn port call of an agreed job, and the job at the next one.

use super::agreed_job::{AgreedJob, messages};
use super::offers::alerts;
use super::{enter_port_call, first_job, solve, update_schedule};
use crate::notifications::subjects_of;
use binnacle_server_testing::on_both;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::{ApiResponse, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_job_of_a_withdrawn_port_call_moves_to_another_one,
    a_port_call_entered_again_has_its_agreed_job_again,
);

async fn a_job_of_a_withdrawn_port_call_moves_to_another_one(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let why = json!({ "reason": "charter" });
    let path = format!("{}/withdraw", agreed.call);
    agreed.ada.post(&path, &why).await.good();
    let order = agreed.view_order().await;
    assert_eq!(order["call_fit"], "no_call");
    assert_eq!(order["call_change"]["is"], Value::Null);
    assert_eq!(order["state"], "accepted");
    let last = subjects_of(&agreed.rosa).await.pop().unwrap();
    assert!(last.contains("the port call is withdrawn"), "{last}");
    update_schedule(&server).await;
    assert_eq!(alerts(&agreed.ada).await.len(), 1);
    let nowhere = agreed.retime("2026-12-15T08:00:00Z").await;
    assert_eq!(nowhere.problem(), "wrong-state");
    // Another port means another journey, and thus another order.
    enter_port_call(&agreed.ada, &agreed.nao, "BEANR", 14).await;
    let elsewhere = agreed.retime("2026-12-15T08:00:00Z").await;
    assert_eq!(elsewhere.problem(), "wrong-state");
    enter_port_call(&agreed.ada, &agreed.nao, "NLRTM", 17).await;
    agreed.retime("2026-12-17T08:00:00Z").await.good();
    agreed.respond(&agreed.rosa, "accept").await.good();
    let plan = solve(&agreed.ada).await;
    assert_eq!(first_job(&plan), ("NLRTM", "2026-12-17", "rosa"));
    assert_eq!(plan["jobs"][0]["state"], "confirmed");
    assert_eq!(alerts(&agreed.ada).await, [] as [Value; 0]);
    server.finish().await;
}

async fn a_port_call_entered_again_has_its_agreed_job_again(server: TestServer) {
    let agreed = AgreedJob::new(&server).await;
    let withdrawn = format!("{}/withdraw", agreed.call);
    agreed.ada.post(&withdrawn, &json!({})).await.good();
    assert_eq!(agreed.view_order().await["call_fit"], "no_call");
    // A port call at another port or time does not get the job.
    enter_port_call(&agreed.ada, &agreed.nao, "NLRTM", 18).await;
    assert_eq!(agreed.view_order().await["call_fit"], "no_call");
    let call = enter_port_call(&agreed.ada, &agreed.nao, "NLRTM", 14).await;
    let order = agreed.view_order().await;
    assert_eq!(order["call_fit"], "fits");
    assert_eq!(order["call_change"]["call_id"], call["id"]);
    let last = messages(&agreed.rosa, &agreed.order).await.pop().unwrap();
    let last = last["text"].as_str().unwrap();
    assert!(
        last.contains("The port call at NLRTM is planned again"),
        "{last}"
    );
    assert!(last.ends_with("still lies in it."), "{last}");
    let plan = solve(&agreed.ada).await;
    assert_eq!(plan["jobs"][0]["state"], "confirmed", "{plan}");
    assert_eq!(alerts(&agreed.ada).await, [] as [Value; 0]);
    // The same holds for a file that withdraws a port call, and a later one with it.
    let file = async |text: &str| {
        let path = format!("{}.csv?replace=true", port_calls::path(&agreed.nao));
        let request = agreed
            .ada
            .request(Method::POST, &path)
            .body(text.to_owned());
        ApiResponse::send(request.header("content-type", "text/csv"))
            .await
            .good()
    };
    agreed
        .ada
        .post(
            &format!(
                "{}/{}/withdraw",
                port_calls::path(&agreed.nao),
                call["id"].as_str().unwrap()
            ),
            &json!({}),
        )
        .await
        .good();
    assert_eq!(agreed.view_order().await["call_fit"], "no_call");
    file("id,port,eta,etd\nx,NLRTM,2026-12-14T06:00:00Z,2026-12-15T18:00:00Z\n").await;
    assert_eq!(agreed.view_order().await["call_fit"], "fits");
    server.finish().await;
}
