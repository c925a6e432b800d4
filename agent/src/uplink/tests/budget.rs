//! The daily budget, and its balance over a restart.

use super::alerts::seal_evidence;
use super::*;

fn left(bytes: f64) -> BudgetAccount {
    BudgetAccount {
        profile: Profile::Metered,
        daily_bytes: Some(8_000.0),
        remaining_bytes: bytes,
        ship_time: Some(time()),
        connection_bytes: None,
        total_bytes: 0.0,
    }
}

#[tokio::test]
async fn what_cannot_be_afforded_waits_until_the_ships_clock_has_earned_it() {
    let plan = Profile::Metered.plan(None);
    let mut rig = rig_with(2, Fake::default(), &plan, Some(left(0.0))).await;
    seal_evidence(&rig.spool, 2).await;
    rig.urgent.notify_one();
    rig.sealed.notify_one();
    let up = rig.link.wait_for(|link| link.state == LinkState::Up);
    up.await.unwrap();
    assert_eq!(rig.seqs(STREAM), [3], "the evidence, on credit");
    let overdrawn = rig.spool.account().await.unwrap().unwrap();
    assert!(overdrawn.remaining_bytes < 0.0, "{overdrawn:?}");
    rig.ship_time
        .send_replace(Some(time().plus_seconds(2.0 * 86_400.0)));
    rig.sealed.notify_one();
    rig.link.mark_unchanged();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1, 2, 3]);
}

#[tokio::test]
async fn waiting_batches_are_reported_and_the_budget_where_it_is_short() {
    let said = |rig: &Rig| -> Vec<[Option<String>; 3]> {
        let of = |query: &HashMap<String, String>| {
            ["waits", "wait", "budget"].map(|name| query.get(name).cloned())
        };
        let fake = rig.fake.lock().unwrap();
        fake.queries.iter().map(of).collect()
    };
    let word = |said: &str| Some(said.to_owned());

    let plenty = Profile::Metered.plan(None);
    let mut rig = rig_with(3, Fake::default(), &plenty, Some(left(24_000.0))).await;
    rig.all_sent().await;
    let nothing_short = [
        [word("2"), None, None],
        [word("1"), None, None],
        [None, word("20"), None],
    ];
    assert_eq!(said(&rig), nothing_short);

    let mut rig = rig_with(1, Fake::default(), &plenty, Some(left(6_000.0))).await;
    rig.all_sent().await;
    let [[waiting_batches, wait, budget]]: &[[Option<String>; 3]; 1] =
        &said(&rig).try_into().unwrap();
    assert_eq!((waiting_batches, wait), (&None, &word("20")));
    // Less than a day's, and a connection with its request is charged.
    let budget: i32 = budget.as_ref().expect("it is short").parse().unwrap();
    assert!((40..50).contains(&budget), "{budget} %");
}

#[tokio::test]
async fn what_the_socket_carried_is_paid_for() {
    let plan = Profile::Metered.plan(None);
    let mut rig = rig_with(1, Fake::default(), &plan, Some(left(8_000.0))).await;
    rig.all_sent().await;
    let kept = rig.spool.account().await.unwrap().unwrap();
    let fake = rig.fake.lock().unwrap();
    let sent = fake.batches[&(STREAM, 1)].len() as f64;
    // Without TLS a connection is seven packets.
    let connection = kept.connection_bytes.unwrap();
    assert!((350.0..450.0).contains(&connection), "{kept:?}");
    let request = 8_000.0 - kept.remaining_bytes - connection - sent;
    // Both heads, the acknowledgement, and the headers of some packets.
    assert!((350.0..700.0).contains(&request), "{request}");
}

#[tokio::test]
async fn a_request_is_charged_before_it_is_made() {
    let plan = Profile::Metered.plan(None);
    let (_answers, answered) = tokio::sync::oneshot::channel::<()>();
    let later = futures_util::stream::once(async move {
        answered.await.ok();
        Ok::<_, axum::Error>("")
    });
    let fake = Fake {
        responses: [axum::body::Body::from_stream(later).into_response()].into(),
        ..Fake::default()
    };
    let rig = rig_with(1, fake, &plan, Some(left(8_000.0))).await;
    while rig.fake.lock().unwrap().requests == 0 {
        tokio::task::yield_now().await;
    }
    let kept = rig.spool.account().await.unwrap().unwrap();
    assert!(kept.remaining_bytes < 8_000.0 - 1_700.0 - 389.0, "{kept:?}");
}

#[tokio::test]
async fn an_ordinary_exchange_is_one_request() {
    let settings = other_settings();
    let mut rig = rig(1, Fake::with_settings(&settings)).await;
    rig.all_sent().await;
    let status = rig.spool.status().await.unwrap();
    assert_eq!(
        (status.acknowledged_batches, status.waiting_batches),
        (1, 0)
    );
    assert_eq!(*rig.settings.borrow(), settings);
    let fake = rig.fake.lock().unwrap();
    assert_eq!((fake.requests, fake.polls), (1, 0));
}
