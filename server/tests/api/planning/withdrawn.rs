//! A port call that is withdrawn under an agreed job, and the job at the next one.

use super::agreed::{Agreed, messages};
use super::offers::alerts;
use super::{enter, first, follow, solve};
use crate::notifications::told;
use crate::on_both;
use crate::port_calls;
use crate::support::{Answer, Shore};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_call_withdrawn_after_acceptance_is_told_and_done_at_another,
    a_call_entered_anew_has_the_agreed_job_again,
);

async fn a_call_withdrawn_after_acceptance_is_told_and_done_at_another(shore: Shore) {
    let agreed = Agreed::new(&shore).await;
    let why = json!({ "reason": "charter" });
    let path = format!("{}/withdraw", agreed.call);
    agreed.ada.post(&path, &why).await.good();
    let order = agreed.seen().await;
    assert_eq!(order["call_fit"], "no_call");
    assert_eq!(order["call_change"]["is"], Value::Null);
    assert_eq!(order["state"], "accepted");
    let last = told(&agreed.rosa).await.pop().unwrap();
    assert!(last.contains("the port call is withdrawn"), "{last}");
    follow(&shore).await;
    assert_eq!(alerts(&agreed.ada).await.len(), 1);
    let nowhere = agreed.retime("2026-12-15T08:00:00Z").await;
    assert_eq!(nowhere.problem(), "wrong-state");
    // In another port the firm would have another journey: that is another order.
    enter(&agreed.ada, &agreed.nao, "BEANR", 14).await;
    let elsewhere = agreed.retime("2026-12-15T08:00:00Z").await;
    assert_eq!(elsewhere.problem(), "wrong-state");
    enter(&agreed.ada, &agreed.nao, "NLRTM", 17).await;
    agreed.retime("2026-12-17T08:00:00Z").await.good();
    agreed.answer(&agreed.rosa, "accept").await.good();
    let plan = solve(&agreed.ada).await;
    assert_eq!(first(&plan), ("NLRTM", "2026-12-17", "rosa"));
    assert_eq!(plan["jobs"][0]["state"], "confirmed");
    assert_eq!(alerts(&agreed.ada).await, [] as [Value; 0]);
    shore.finish().await;
}

async fn a_call_entered_anew_has_the_agreed_job_again(shore: Shore) {
    let agreed = Agreed::new(&shore).await;
    let withdrawn = format!("{}/withdraw", agreed.call);
    agreed.ada.post(&withdrawn, &json!({})).await.good();
    assert_eq!(agreed.seen().await["call_fit"], "no_call");
    // One at another port, or at another time, is none of the job's.
    enter(&agreed.ada, &agreed.nao, "NLRTM", 18).await;
    assert_eq!(agreed.seen().await["call_fit"], "no_call");
    let call = enter(&agreed.ada, &agreed.nao, "NLRTM", 14).await;
    let order = agreed.seen().await;
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
    // So it is in a file that withdraws a call, and in a later one that has it again.
    let file = async |text: &str| {
        let path = format!("{}.csv?replace=true", port_calls::path(&agreed.nao));
        let request = agreed
            .ada
            .request(Method::POST, &path)
            .body(text.to_owned());
        Answer::of(request.header("content-type", "text/csv"))
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
    assert_eq!(agreed.seen().await["call_fit"], "no_call");
    file("id,port,eta,etd\nx,NLRTM,2026-12-14T06:00:00Z,2026-12-15T18:00:00Z\n").await;
    assert_eq!(agreed.seen().await["call_fit"], "fits");
    shore.finish().await;
}
