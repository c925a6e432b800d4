//! Concurrent requests on one order: exactly one succeeds.

use binnacle_orders::dispatch::lapse;
use binnacle_server_testing::HOUR_S;
use binnacle_server_testing::TestServer;
use binnacle_server_testing::offers::OfferParties;
use binnacle_server_testing::on_both;
use serde_json::json;

on_both!(
    one_of_two_firms_accepting_at_once_gets_the_order,
    concurrent_acceptance_and_cancellation_leave_a_consistent_log,
    an_offer_checked_by_many_servers_lapses_once,
    concurrent_response_and_expiry_leave_a_consistent_log,
    an_unreadable_order_does_not_block_expiry_of_others,
);

async fn one_of_two_firms_accepting_at_once_gets_the_order(server: TestServer) {
    let parties = OfferParties::planned(&server, 3).await;
    let mut offer = parties.offer();
    offer["at_once"] = json!(true);
    parties.post(&parties.ada, "/offer", &offer).await.good();
    assert_eq!(parties.offers().await, ["open", "open", "open"]);
    let yes = json!({});
    let accept = |index: usize| parties.post(&parties.firms[index].1, "/accept", &yes);
    let (a, b, c) = tokio::join!(accept(0), accept(1), accept(2));
    let answers = [a, b, c];
    let won: Vec<usize> = (0..3)
        .filter(|index| answers[*index].status == 200)
        .collect();
    assert_eq!(won.len(), 1, "{answers:?}");
    for (index, response) in answers.iter().enumerate() {
        let (_, adjuster) = &parties.firms[index];
        if won.contains(&index) {
            assert_eq!(
                adjuster.get(&parties.path("")).await.good()["state"],
                "accepted"
            );
            continue;
        }
        assert_eq!(response.problem(), "wrong-state");
        assert!(response.text.contains("another has it"), "{response:?}");
        assert_eq!(adjuster.get(&parties.path("")).await.problem(), "not-found");
    }
    let kinds = parties.kinds(&parties.ada).await;
    let accepted = kinds.iter().filter(|kind| *kind == "accepted");
    assert_eq!(accepted.count(), 1, "{kinds:?}");
    server.finish().await;
}

async fn concurrent_acceptance_and_cancellation_leave_a_consistent_log(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    let (yes, why) = (json!({}), json!({ "text": "sold" }));
    let (accepted, cancelled) = tokio::join!(
        parties.post(&parties.firms[0].1, "/accept", &yes),
        parties.post(&parties.ada, "/cancel", &why),
    );
    let kinds = parties.kinds(&parties.ada).await;
    let outcome: Vec<&str> = kinds[3..].iter().map(String::as_str).collect();
    match (accepted.status, cancelled.status) {
        (200, 409) => assert_eq!(outcome, ["accepted"]),
        (409, 200) => assert_eq!(outcome, ["cancelled"]),
        // The operator cancelled the accepted order.
        (200 | 404, 200) => assert_eq!(outcome, ["accepted", "cancelled"]),
        _ => panic!("{accepted:?} {cancelled:?}"),
    }
    server.finish().await;
}

async fn an_offer_checked_by_many_servers_lapses_once(server: TestServer) {
    let parties = OfferParties::offered(&server, 2).await;
    let second = server.second_server().await;
    server.advance(HOUR_S + 1.0);
    let (here, there) = tokio::join!(lapse(&server.app), lapse(&second));
    assert_eq!(here.unwrap() + there.unwrap(), 1);
    assert_eq!(parties.offers().await, ["lapsed", "open"]);
    let kinds = parties.kinds(&parties.ada).await;
    assert_eq!(kinds[3..], ["lapsed", "asked"]);
    second.db.close().await;
    server.finish().await;
}

async fn concurrent_response_and_expiry_leave_a_consistent_log(server: TestServer) {
    let parties = OfferParties::offered(&server, 2).await;
    // The last moment: the response is in time, whatever the expiry does meanwhile.
    server.advance(HOUR_S);
    let yes = json!({});
    let (accepted, lapsed) = tokio::join!(
        parties.post(&parties.firms[0].1, "/accept", &yes),
        lapse(&server.app)
    );
    assert_eq!(accepted.status, 200, "{accepted:?}");
    assert_eq!(lapsed.unwrap(), 0);
    assert_eq!(parties.offers().await, ["accepted", "waiting"]);
    server.finish().await;
}

async fn an_unreadable_order_does_not_block_expiry_of_others(server: TestServer) {
    let parties = OfferParties::offered(&server, 1).await;
    server
        .run_sql("UPDATE work_order_entries SET line = '{' WHERE seq = 1")
        .await;
    // Offered after that one, and overdue after it.
    server.advance(1.0);
    let other = parties.ada.create_vessel("Pinta").await;
    let mut order = parties.new_order();
    order["vessel_id"] = other["id"].clone();
    order["compass_id"] = other["compasses"][0]["id"].clone();
    order["offer"] = parties.offer();
    let order = parties.ada.post("/work-orders", &order).await.good();
    server.advance(HOUR_S + 1.0);
    assert_eq!(lapse(&server.app).await.unwrap(), 1);
    let path = format!("/work-orders/{}", order["id"].as_str().unwrap());
    let seen = parties.ada.get(&path).await.good();
    assert_eq!(seen["state"], "declined");
    server.finish().await;
}
