//! Two who want the same at the same moment: one has it.

use binnacle_orders::dispatch::lapse;
use binnacle_server_testing::HOUR_S;
use binnacle_server_testing::Shore;
use binnacle_server_testing::offers::Trade;
use binnacle_server_testing::on_both;
use serde_json::json;

on_both!(
    of_two_firms_that_accept_at_once_one_has_it,
    an_acceptance_and_a_cancellation_at_once_leave_one_story,
    an_offer_lapses_once_however_many_look,
    an_answer_and_the_clock_at_once_leave_one_story,
    an_order_that_cannot_be_read_holds_up_no_other_orders_clock,
);

async fn of_two_firms_that_accept_at_once_one_has_it(shore: Shore) {
    let trade = Trade::planned(&shore, 3).await;
    let mut offer = trade.offer();
    offer["at_once"] = json!(true);
    trade.post(&trade.ada, "/offer", &offer).await.good();
    assert_eq!(trade.offers().await, ["open", "open", "open"]);
    let yes = json!({});
    let accept = |index: usize| trade.post(&trade.firms[index].1, "/accept", &yes);
    let (a, b, c) = tokio::join!(accept(0), accept(1), accept(2));
    let answers = [a, b, c];
    let won: Vec<usize> = (0..3)
        .filter(|index| answers[*index].status == 200)
        .collect();
    assert_eq!(won.len(), 1, "{answers:?}");
    for (index, answer) in answers.iter().enumerate() {
        let (_, adjuster) = &trade.firms[index];
        if won.contains(&index) {
            assert_eq!(
                adjuster.get(&trade.path("")).await.good()["state"],
                "accepted"
            );
            continue;
        }
        assert_eq!(answer.problem(), "wrong-state");
        assert!(answer.text.contains("another has it"), "{answer:?}");
        assert_eq!(adjuster.get(&trade.path("")).await.problem(), "not-found");
    }
    let kinds = trade.kinds(&trade.ada).await;
    let accepted = kinds.iter().filter(|kind| *kind == "accepted");
    assert_eq!(accepted.count(), 1, "{kinds:?}");
    shore.finish().await;
}

async fn an_acceptance_and_a_cancellation_at_once_leave_one_story(shore: Shore) {
    let trade = Trade::offered(&shore, 1).await;
    let (yes, why) = (json!({}), json!({ "text": "sold" }));
    let (accepted, cancelled) = tokio::join!(
        trade.post(&trade.firms[0].1, "/accept", &yes),
        trade.post(&trade.ada, "/cancel", &why),
    );
    let kinds = trade.kinds(&trade.ada).await;
    let told: Vec<&str> = kinds[3..].iter().map(String::as_str).collect();
    match (accepted.status, cancelled.status) {
        (200, 409) => assert_eq!(told, ["accepted"]),
        (409, 200) => assert_eq!(told, ["cancelled"]),
        // The operator saw it accepted, and cancelled it all the same.
        (200 | 404, 200) => assert_eq!(told, ["accepted", "cancelled"]),
        _ => panic!("{accepted:?} {cancelled:?}"),
    }
    shore.finish().await;
}

async fn an_offer_lapses_once_however_many_look(shore: Shore) {
    let trade = Trade::offered(&shore, 2).await;
    let second = shore.second().await;
    shore.advance(HOUR_S + 1.0);
    let (here, there) = tokio::join!(lapse(&shore.app), lapse(&second));
    assert_eq!(here.unwrap() + there.unwrap(), 1);
    assert_eq!(trade.offers().await, ["lapsed", "open"]);
    let kinds = trade.kinds(&trade.ada).await;
    assert_eq!(kinds[3..], ["lapsed", "asked"]);
    second.db.close().await;
    shore.finish().await;
}

async fn an_answer_and_the_clock_at_once_leave_one_story(shore: Shore) {
    let trade = Trade::offered(&shore, 2).await;
    // The last moment: the answer is in time, whatever the clock does meanwhile.
    shore.advance(HOUR_S);
    let yes = json!({});
    let (accepted, lapsed) = tokio::join!(
        trade.post(&trade.firms[0].1, "/accept", &yes),
        lapse(&shore.app)
    );
    assert_eq!(accepted.status, 200, "{accepted:?}");
    assert_eq!(lapsed.unwrap(), 0);
    assert_eq!(trade.offers().await, ["accepted", "waiting"]);
    shore.finish().await;
}

async fn an_order_that_cannot_be_read_holds_up_no_other_orders_clock(shore: Shore) {
    let trade = Trade::offered(&shore, 1).await;
    shore
        .sql("UPDATE work_order_entries SET line = '{' WHERE seq = 1")
        .await;
    // Asked after that one, and overdue after it.
    shore.advance(1.0);
    let other = trade.ada.create_vessel("Pinta").await;
    let mut order = trade.new_order();
    order["vessel_id"] = other["id"].clone();
    order["compass_id"] = other["compasses"][0]["id"].clone();
    order["offer"] = trade.offer();
    let order = trade.ada.post("/work-orders", &order).await.good();
    shore.advance(HOUR_S + 1.0);
    assert_eq!(lapse(&shore.app).await.unwrap(), 1);
    let path = format!("/work-orders/{}", order["id"].as_str().unwrap());
    let seen = trade.ada.get(&path).await.good();
    assert_eq!(seen["state"], "declined");
    shore.finish().await;
}
