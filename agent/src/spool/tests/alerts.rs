//! Alerts and their evidence in the spool.

use super::*;

fn record(revision: u32) -> AlertRecord {
    AlertRecord {
        alert: alert(revision),
        acknowledged: false,
        followed_up: false,
        departed_sectors: 8,
        raised_limit_deg: None,
        clearance_revoked: false,
    }
}

#[tokio::test]
async fn an_alert_is_kept_with_the_batch_that_carries_it_and_hurries_the_one_before() {
    let (directory, spool) = enrolled().await;
    for minute in [0, 10, 20] {
        seal(&spool, minute..minute + 1).await;
    }
    let known = record(1);
    let stored = spool
        .store_evidence(&[sample(30)], &accepted(60), &[alert(1)], Some(&known))
        .await;
    assert_eq!(stored.unwrap(), (Pending::default(), 1));
    drop(spool);
    let spool = Spool::open(directory.path()).await.unwrap();
    assert_eq!(spool.alert().await.unwrap(), Some(known));
    let mut order = Vec::new();
    while let Some(sent) = next_sent(&spool).await {
        let batch = binnacle_wire::decode(&sent.bytes).unwrap();
        order.push((sent.seq, sent.urgent, batch.alerts.len()));
        spool
            .acknowledge(identity(7).stream, &sent, &downlink(0))
            .await
            .unwrap()
            .unwrap();
    }
    let wanted = [(4, true, 1), (3, true, 0), (1, false, 0), (2, false, 0)];
    assert_eq!(order, wanted);
}

#[tokio::test]
async fn an_alert_goes_without_samples_and_behind_more_than_one_batch_of_them() {
    let (_directory, spool) = enrolled().await;
    let none = BTreeMap::new();
    let alone = spool.store_evidence(&[], &none, &[alert(1)], None).await;
    assert_eq!(alone.unwrap().1, 1);
    let samples: Vec<Sample> = (0..800).map(sample).collect();
    let many = spool
        .store_evidence(&samples, &none, &[alert(2)], None)
        .await;
    assert_eq!(many.unwrap(), (Pending::default(), 2));
    let newest = spool.next_batch().await.unwrap().unwrap();
    let batch = binnacle_wire::decode(&newest.bytes).unwrap();
    assert_eq!((newest.seq, batch.samples.len()), (3, 288));
    assert_eq!(batch.alerts, [alert(2)]);
}

#[tokio::test]
async fn evidence_stays_evidence_in_another_stream_and_an_alert_of_another_ship_goes() {
    let (_directory, spool) = enrolled().await;
    let none = BTreeMap::new();
    spool
        .store_evidence(&[], &none, &[alert(1)], Some(&record(1)))
        .await
        .unwrap();
    seal(&spool, 1..2).await;
    let stream = StreamId(Uuid::from_u128(8));
    spool.move_to_stream(stream).await.unwrap();
    assert!(spool.next_batch().await.unwrap().unwrap().urgent);
    assert!(spool.alert().await.unwrap().is_some());
    let other = Identity {
        vessel_name: "Arrano".to_owned(),
        ..identity(9)
    };
    spool.enrol(&other).await.unwrap();
    assert_eq!(spool.alert().await.unwrap(), None);
}
