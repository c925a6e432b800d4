//! Lightning strikes the compass of a vessel under way: the real agent, on board and towards the
//! server.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use binnacle_wire::alert::ShipAlertState;
use common::agent::Agent;
use common::bridge::{Bridge, START_S};
use common::server::TestServer;
use std::collections::BTreeSet;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::net::TcpStream;
use tokio::time::timeout;

const PATIENCE: Duration = Duration::from_mins(2);
const HOUR_S: i64 = 3600;
/// Twenty minutes after a turn, when the compass has long come to rest.
const STRUCK_S: i64 = 5 * HOUR_S + 1200;

#[tokio::test]
async fn without_a_link_it_is_said_on_board_and_with_one_it_goes_first() {
    let bridge = Bridge::struck(8 * HOUR_S, STRUCK_S, 25.0).await;
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(bridge.address);
    agent.configure("[output]", "alarm_sentence = true");
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    common::status_when(&running, |status| status["link"]["state"] == "up").await;
    server.stored.lock().unwrap().down = true;
    let stream = TcpStream::connect(running.output).await.unwrap();
    let mut lines = BufReader::new(stream).lines();
    bridge.sail();

    let alarm = timeout(PATIENCE, async {
        loop {
            let line = lines.next_line().await.unwrap().unwrap();
            if line.starts_with("$IIALR") && line.contains(",001,A,") {
                return line;
            }
        }
    });
    let alarm = alarm.await.unwrap();
    assert!(
        alarm.contains(",001,A,V,COMPASS AND GYRO PARTED*"),
        "{alarm}"
    );
    let open = common::status_when(&running, |status| status["alert"]["state"] == "open").await;
    let alert = &open["alert"];
    let advice = alert["advice"].as_str().unwrap();
    assert!(advice.starts_with("Steer by gyro"), "{advice}");
    let departure = alert["gyro_departure_deg"].as_f64().unwrap();
    assert!((departure + 25.0).abs() < 2.0, "{departure}");
    let said = agent.call(&["status"]).await;
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(
        said.contains("ALERT      compass and gyro parted"),
        "{said}"
    );

    // It is acknowledged, and still the same alert after a kill.
    let id = alert["id"].as_str().unwrap();
    common::post(
        running.page,
        "/api/alert/acknowledge",
        &format!(r#"{{"id":"{id}"}}"#),
    )
    .await;
    common::status_when(&running, |status| status["alert"]["revision"] == 2).await;
    running.kill().await;
    let running = agent.run().await;
    let again = common::status_when(&running, |status| !status["alert"].is_null()).await;
    assert_eq!(again["alert"]["id"].as_str(), Some(id));
    assert_eq!(again["alert"]["acknowledged"], true);

    server.stored.lock().unwrap().down = false;
    let waiting = again["spool"]["waiting_batches"].as_u64().unwrap();
    assert!(waiting > 3, "{waiting}");
    timeout(PATIENCE, server.has(waiting)).await.unwrap();
    let order = server.stored.lock().unwrap().order.clone();
    let batches = server.decoded();
    let of = |seq: u64| &batches[usize::try_from(seq).unwrap() - 1];
    let evidence = order.iter().take_while(|seq| **seq != 1).count();
    assert_eq!(of(order[0]).alerts[0].revision, 2);
    assert!(order[..evidence].is_sorted_by(|a, b| a > b), "{order:?}");
    assert!(order[evidence..].is_sorted(), "{order:?}");
    let revisions: Vec<u32> = order[..evidence]
        .iter()
        .flat_map(|seq| of(*seq).alerts.iter().map(|alert| alert.revision))
        .collect();
    assert_eq!(revisions, [2, 1]);
    let sent = batches.iter().flat_map(|batch| &batch.alerts);
    for alert in sent {
        assert_eq!(alert.id.to_string(), id);
        let since_s = alert.since.micros() / 1_000_000 - START_S;
        assert!(
            (STRUCK_S - 10..STRUCK_S + 60).contains(&since_s),
            "{since_s}"
        );
    }
    // The samples on either side of the strike are among the evidence.
    let times: Vec<i64> = order[..evidence]
        .iter()
        .flat_map(|seq| &of(*seq).samples)
        .map(|sample| sample.time.micros() / 1_000_000 - START_S - STRUCK_S)
        .collect();
    assert!(times.iter().any(|s| (-3600..0).contains(s)), "{times:?}");
    assert!(times.iter().any(|s| (0..3600).contains(s)), "{times:?}");
}

#[tokio::test]
async fn killed_around_the_strike_it_raises_one_alert_and_sends_each_revision_once() {
    let bridge = Bridge::struck(10 * 24 * HOUR_S, STRUCK_S, 25.0).await;
    let server = TestServer::start(Some(common::model()), Some(5)).await;
    let agent = Agent::new(bridge.address);
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    common::status_when(&running, |status| status["model"]["version"] == 3).await;
    bridge.sail();
    running.kill().await;
    for round in 1..=8 {
        let running = agent.run().await;
        let wanted = *server.stored_batches.borrow() + 1 + round % 3;
        timeout(PATIENCE, server.has(wanted)).await.unwrap();
        running.kill().await;
    }
    let running = agent.run().await;
    common::status_when(&running, |status| {
        status["spool"]["waiting_batches"] == 0
            && status["alert"]["revision"].as_u64() > Some(1)
            && status["spool"]["acknowledged_batches"].as_u64() > Some(45)
    })
    .await;
    running.kill().await;

    assert_eq!(server.stored.lock().unwrap().forks, 0);
    let batches = server.decoded();
    let alerts: Vec<_> = batches.iter().flat_map(|batch| &batch.alerts).collect();
    let ids: BTreeSet<_> = alerts.iter().map(|alert| alert.id).collect();
    assert_eq!(ids.len(), 1, "{alerts:?}");
    let revisions: Vec<u32> = alerts.iter().map(|alert| alert.revision).collect();
    assert_eq!(revisions, [1, 2]);
    assert!(
        alerts
            .iter()
            .all(|alert| alert.state == ShipAlertState::Open)
    );
    let times: Vec<_> = batches
        .iter()
        .flat_map(|b| &b.samples)
        .map(|s| s.time)
        .collect();
    let distinct: BTreeSet<_> = times.iter().copied().collect();
    assert_eq!(times.len(), distinct.len(), "a sample was sent twice");
}
