//! Batches, whatever server and link do.

use super::*;

#[tokio::test]
async fn every_batch_is_sent_and_then_forgotten() {
    let mut rig = rig(3, Fake::default()).await;
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1, 2, 3]);
    seal(&rig.spool, 3).await;
    rig.sealed.notify_one();
    rig.link.mark_unchanged();
    rig.all_sent().await;
    let status = rig.spool.status().await.unwrap();
    assert_eq!((status.acknowledged_samples, status.contiguous_seq), (4, 4));
    assert_eq!(status.waiting_batches, 0);
    assert_eq!(rig.link.borrow().last_contact, Some(time()));
}

#[tokio::test]
async fn no_failure_of_the_link_loses_a_batch() {
    let login = "<html>Welcome to Harbour Wi-Fi</html>";
    let responses = [
        (StatusCode::OK, login).into_response(),
        (StatusCode::FOUND, [("location", "http://portal/")]).into_response(),
        (StatusCode::FORBIDDEN, login).into_response(),
        (StatusCode::OK, "{\"contiguous_seq\":").into_response(),
        (StatusCode::BAD_GATEWAY, "nginx").into_response(),
        problem(StatusCode::SERVICE_UNAVAILABLE, "busy"),
    ];
    let fake = Fake {
        responses: responses.into(),
        ..Fake::default()
    };
    let mut rig = rig(2, fake).await;
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1, 2]);
    assert_eq!(rig.fake.lock().unwrap().requests, 6 + 2);
    assert_eq!(rig.spool.status().await.unwrap().acknowledged_batches, 2);
}

#[tokio::test]
async fn no_json_of_a_proxy_passes_for_the_servers_word() {
    let says = |status: u16, body: Value| {
        let status = StatusCode::from_u16(status).unwrap();
        (status, Json(body)).into_response()
    };
    let mut rig = rig(3, Fake::default()).await;
    rig.all_sent().await;
    let responses = [
        says(400, json!({ "error": "bad request" })),
        says(401, json!({ "error": "login required" })),
        says(403, json!({ "captive": true })),
        says(404, json!({ "message": "no route matched" })),
        says(404, json!({ "type": "about:blank", "title": "Not Found" })),
        says(409, json!({ "type": "stream-forked" })),
        says(410, json!({})),
    ];
    rig.fake.lock().unwrap().responses.extend(responses);
    seal(&rig.spool, 3).await;
    rig.link.mark_unchanged();
    rig.sealed.notify_one();
    let says = |link: &LinkStatus| {
        let problem = link.problem.as_deref();
        problem.is_some_and(|problem| problem.contains("not from the server"))
    };
    rig.link.wait_for(says).await.unwrap();
    rig.all_sent().await;
    // It was neither parked nor sent with all the others, nor in another stream.
    assert_eq!(rig.seqs(STREAM), [1, 2, 3, 4]);
    let fake = rig.fake.lock().unwrap();
    assert_eq!((fake.requests, fake.streams), (3 + 7 + 1, 0));
}

#[tokio::test]
async fn a_response_that_acknowledges_what_was_never_sent_deletes_nothing() {
    let claim = json!({ "contiguous_seq": 9, "server_time": time() });
    let fake = Fake {
        responses: [Json(claim).into_response()].into(),
        ..Fake::default()
    };
    let mut rig = rig(2, fake).await;
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [2], "the first one is parked");
    let status = rig.spool.status().await.unwrap();
    assert_eq!((status.parked_batches, status.acknowledged_batches), (1, 1));
    assert_eq!(
        status.parked_because.as_deref(),
        Some("batches up to 9 were acknowledged, but only 1 have been sent")
    );
    // It is offered again as any parked batch is, and a right response counts.
    rig.spool.unpark_first().await.unwrap();
    rig.link.mark_unchanged();
    rig.sealed.notify_one();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1, 2]);
    assert_eq!(rig.spool.status().await.unwrap().contiguous_seq, 2);
}

#[tokio::test]
async fn the_server_is_given_the_time_it_asks_for() {
    let busy = (
        StatusCode::TOO_MANY_REQUESTS,
        [("retry-after", "1")],
        "slow down",
    );
    let fake = Fake {
        responses: [busy.into_response()].into(),
        ..Fake::default()
    };
    let before = Instant::now();
    let mut rig = rig(1, fake).await;
    rig.all_sent().await;
    assert!(before.elapsed() >= Duration::from_secs(1));
}

#[tokio::test]
async fn a_forked_stream_is_left_for_a_new_one() {
    let mut fake = Fake::default();
    fake.batches.insert((STREAM, 1), b"other bytes".to_vec());
    let mut rig = rig(2, fake).await;
    rig.all_sent().await;
    let new = Uuid::from_u128(1001);
    assert_eq!(rig.seqs(new), [1, 2]);
    let fake = rig.fake.lock().unwrap();
    for seq in [1, 2] {
        let batch = binnacle_wire::decode(&fake.batches[&(new, seq)]).unwrap();
        assert_eq!(
            (batch.stream.0, batch.seq, batch.samples.len()),
            (new, seq, 1)
        );
    }
}

#[tokio::test]
async fn a_server_that_lost_its_batches_gets_them_again() {
    let mut rig = rig(3, Fake::default()).await;
    rig.all_sent().await;
    rig.fake.lock().unwrap().batches.clear();
    seal(&rig.spool, 3).await;
    rig.link.mark_unchanged();
    rig.sealed.notify_one();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1, 2, 3, 4]);
}

#[tokio::test]
async fn a_server_that_lost_what_is_not_kept_gets_a_new_stream() {
    let mut rig = rig(3, Fake::default()).await;
    rig.all_sent().await;
    rig.spool.shrink_to_limit(1).await.unwrap();
    rig.fake.lock().unwrap().batches.clear();
    seal(&rig.spool, 3).await;
    seal(&rig.spool, 4).await;
    rig.link.mark_unchanged();
    rig.sealed.notify_one();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [4]);
    assert_eq!(rig.seqs(Uuid::from_u128(1001)), [1]);
}

#[tokio::test]
async fn a_server_that_lost_the_stream_gets_all_of_it_in_a_new_one() {
    let mut rig = rig(3, Fake::default()).await;
    rig.all_sent().await;
    let lost = problem(StatusCode::NOT_FOUND, "not-found");
    rig.fake.lock().unwrap().responses.push_back(lost);
    seal(&rig.spool, 3).await;
    rig.link.mark_unchanged();
    rig.sealed.notify_one();
    rig.all_sent().await;
    assert_eq!(rig.seqs(Uuid::from_u128(1001)), [1, 2, 3, 4]);
}

#[tokio::test]
async fn a_refused_batch_is_kept_aside_and_does_not_block_the_next() {
    let fake = Fake {
        responses: [problem(StatusCode::UNPROCESSABLE_ENTITY, "undecodable")].into(),
        ..Fake::default()
    };
    let mut rig = rig(2, fake).await;
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [2]);
    let status = rig.spool.status().await.unwrap();
    assert_eq!((status.parked_batches, status.contiguous_seq), (1, 0));
    assert_eq!(
        status.parked_because.as_deref(),
        Some("422 undecodable: why")
    );
}

#[tokio::test]
async fn what_was_refused_goes_when_the_server_takes_the_first_of_it() {
    let refusal = || problem(StatusCode::UNPROCESSABLE_ENTITY, "undecodable");
    let fake = Fake {
        responses: [refusal(), refusal(), refusal()].into(),
        ..Fake::default()
    };
    let mut rig = rig(3, fake).await;
    rig.all_sent().await;
    assert_eq!(rig.spool.status().await.unwrap().parked_batches, 3);
    rig.spool.unpark_first().await.unwrap();
    rig.link.mark_unchanged();
    rig.sealed.notify_one();
    while rig.seqs(STREAM) != [1, 2, 3] {
        rig.link.changed().await.unwrap();
    }
}

#[tokio::test]
async fn a_batch_that_the_disk_has_damaged_keeps_no_number_open() {
    let fake = Fake {
        responses: [problem(StatusCode::BAD_REQUEST, "bad-request")].into(),
        ..Fake::default()
    };
    let mut rig = rig(0, fake).await;
    rig.all_sent().await;
    seal(&rig.spool, 1).await;
    rig.spool.damage(1).await;
    seal(&rig.spool, 2).await;
    rig.link.mark_unchanged();
    rig.sealed.notify_one();
    rig.all_sent().await;
    let status = rig.spool.status().await.unwrap();
    assert_eq!((status.parked_batches, status.contiguous_seq), (0, 2));
    let fake = rig.fake.lock().unwrap();
    let samples =
        |seq| binnacle_wire::decode(&fake.batches[&(STREAM, seq)]).map(|b| b.samples.len());
    assert_eq!((samples(1), samples(2)), (Ok(0), Ok(1)));
}

#[tokio::test]
async fn a_token_that_is_not_known_keeps_the_data_and_says_so() {
    let fake = Fake {
        responses: [
            problem(StatusCode::UNAUTHORIZED, "unauthorized"),
            problem(StatusCode::FORBIDDEN, "forbidden"),
        ]
        .into(),
        ..Fake::default()
    };
    let mut rig = rig(1, fake).await;
    let refused = rig.link.wait_for(|link| link.state == LinkState::Refused);
    let problem = refused.await.unwrap().problem.clone().unwrap();
    assert!(problem.contains("enrol it again"), "{problem}");
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1]);
}
