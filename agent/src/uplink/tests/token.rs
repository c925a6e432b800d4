//! Two tokens, one of which the server knows.

use super::*;

#[tokio::test]
async fn an_agent_that_did_not_hear_whether_its_token_was_replaced_tries_both() {
    let unknown = || problem(StatusCode::UNAUTHORIZED, "unauthorized");
    let fake = Fake {
        responses: [unknown()].into(),
        ..Fake::default()
    };
    let mut rig = rig(0, fake).await;
    let up = rig.link.wait_for(|link| link.state == LinkState::Up);
    up.await.unwrap();
    rig.spool.save_other_token("new").await.unwrap();
    seal(&rig.spool, 1).await;
    rig.sealed.notify_one();
    rig.link.mark_unchanged();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1]);
    let identity = rig.spool.identity().await.unwrap().unwrap();
    assert_eq!(identity.token, "new");
    assert_eq!(identity.other_token.as_deref(), Some("t"));
    let shown = format!("{identity:?}");
    assert!(!shown.contains("new"), "{shown}");
}

#[tokio::test]
async fn an_agent_of_whose_tokens_none_is_known_says_that_it_must_be_enrolled_again() {
    let unknown = || problem(StatusCode::UNAUTHORIZED, "unauthorized");
    let mut rig = rig(0, Fake::default()).await;
    rig.all_sent().await;
    rig.spool.save_other_token("before").await.unwrap();
    let responses = [unknown(), unknown(), unknown()];
    rig.fake.lock().unwrap().responses.extend(responses);
    seal(&rig.spool, 1).await;
    rig.sealed.notify_one();
    let says = |link: &LinkStatus| {
        let problem = link.problem.as_deref();
        problem.is_some_and(|problem| problem.contains("enrol it again"))
    };
    rig.link.wait_for(says).await.unwrap();
    // It goes on trying either, and recovers when one is known.
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1]);
    assert_eq!(rig.fake.lock().unwrap().requests, 3 + 1);
}

#[tokio::test]
async fn a_token_that_is_replaced_while_a_batch_is_on_its_way_costs_no_second_one() {
    let mut rig = rig(0, Fake::default()).await;
    rig.all_sent().await;
    let (is_replaced, replaced) = tokio::sync::oneshot::channel::<()>();
    let acknowledged = json!({ "contiguous_seq": 1, "server_time": time() }).to_string();
    let later = futures_util::stream::once(async move {
        replaced
            .await
            .map(|()| acknowledged)
            .map_err(axum::Error::new)
    });
    let response = axum::body::Body::from_stream(later).into_response();
    rig.fake.lock().unwrap().responses.push_back(response);
    seal(&rig.spool, 1).await;
    rig.link.mark_unchanged();
    rig.sealed.notify_one();
    while rig.fake.lock().unwrap().requests == 0 {
        tokio::task::yield_now().await;
    }
    rig.spool.save_other_token("new").await.unwrap();
    assert!(rig.spool.swap_tokens("t").await.unwrap());
    is_replaced.send(()).unwrap();
    rig.all_sent().await;
    assert_eq!(rig.fake.lock().unwrap().requests, 1);
    let status = rig.spool.status().await.unwrap();
    assert_eq!(status.acknowledged_batches, 1);
}
