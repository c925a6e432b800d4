//! The analysis as a fold over segments, with a cache of the log: whatever is in it, the result is
//! that of the whole log.

use super::A_WHILE_S;
use binnacle_compass::model::Model;
use binnacle_compass::sample::Sample;
use binnacle_fleet::analysis_queue;
use binnacle_platform::db::Connection;
use binnacle_platform::ids::VesselId;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{Person, Ship, TestServer, days_at_sea};
use serde_json::{Value, json};

on_both!(
    months_analysed_as_they_come_give_what_one_analysis_gives,
    a_damaged_state_is_noticed_and_derived_again,
    damaged_diagnoses_are_noticed_and_derived_again,
    a_repeated_batch_of_months_ago_is_read_once,
);

const FROM: &str = "2026-07-20T00:00:00Z";

/// Returns the batches of a hundred days, a sample each forty minutes, a week each.
fn weeks() -> Vec<Vec<Sample>> {
    let model: Model = serde_json::from_value(json!({
        "parameters_over_lambda": {
            "bx_nt": 1500.0, "chi13": 0.0, "by_nt": -900.0, "chi23": 0.0,
            "chi11_minus_chi22": 0.02, "chi12": 0.0, "chi21": 0.0,
        },
        "covariance": null,
    }))
    .unwrap();
    let samples = days_at_sea(&model, FROM, 100.0);
    let kept: Vec<Sample> = samples.into_iter().step_by(4).collect();
    kept.chunks(7 * 36).map(<[Sample]>::to_vec).collect()
}

async fn analyse(server: &TestServer) {
    server.advance(A_WHILE_S);
    server.work().await;
}

/// Sends weeks and analyses the log after some of them.
async fn send(server: &TestServer, ship: &Ship, weeks: &[(usize, Vec<Sample>)], every: usize) {
    for (nth, (week, samples)) in weeks.iter().enumerate() {
        ship.put(*week as u64 + 1, samples).await.good();
        if nth % every == every - 1 {
            analyse(server).await;
        }
    }
    analyse(server).await;
}

/// Returns what the API shows of an analysis.
async fn shown(ada: &Person, ship: &Ship) -> Value {
    let mut shown = json!({
        "samples": ada.get(&ship.path("/samples.csv")).await.text,
    });
    for path in ["model", "changes", "coverage"] {
        let mut found = ada.get(&ship.path(&format!("/{path}"))).await.good();
        remove_names(&mut found);
        shown[path] = found;
    }
    shown
}

/// Removes what depends on the ship's id, and on when one looked.
fn remove_names(value: &mut Value) {
    const NAMES: [&str; 6] = [
        "id",
        "compass_id",
        "version",
        "model_version",
        "created_at",
        "analysed_at",
    ];
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| !NAMES.contains(&name.as_str()));
            fields.values_mut().for_each(remove_names);
        }
        Value::Array(items) => items.iter_mut().for_each(remove_names),
        _ => {}
    }
}

/// Checks what the API shows of an analysis. Names the first line that differs.
async fn assert_shown(ada: &Person, ship: &Ship, expected: &Value) {
    let found = shown(ada, ship).await;
    for (name, expected) in expected.as_object().unwrap() {
        let lines = |value: &Value| match value {
            Value::String(text) => text.clone(),
            other => serde_json::to_string_pretty(other).unwrap(),
        };
        let (found, expected) = (lines(&found[name]), lines(expected));
        for (found, expected) in found.lines().zip(expected.lines()) {
            assert_eq!(found, expected, "{name}");
        }
        assert_eq!(found.lines().count(), expected.lines().count(), "{name}");
    }
}

/// Queues the analysis of a ship and runs it.
async fn analyse_again(server: &TestServer, ship: &Ship) {
    let vessel: VesselId = serde_json::from_value(json!(ship.id)).unwrap();
    let mut tx = server.app.db.begin().await.unwrap();
    let now = server.app.clock.now().into();
    analysis_queue::enqueue(&mut tx, vessel, now, 0.0)
        .await
        .unwrap();
    tx.commit().await.unwrap();
    server.work().await;
}

async fn count(server: &TestServer, ship: &Ship) -> (usize, usize) {
    let vessel: VesselId = serde_json::from_value(json!(ship.id)).unwrap();
    let mut rows = Vec::new();
    let compasses = binnacle_fleet::compasses::of_vessel(&server.app.db, vessel)
        .await
        .unwrap();
    for compass in compasses {
        let known = binnacle_fleet::analysis::segments::list(&server.app.db, vessel, compass.id);
        rows.extend(known.await.unwrap());
    }
    let states = rows.iter().filter(|row| row.has_state).count();
    (rows.len(), states)
}

async fn months_analysed_as_they_come_give_what_one_analysis_gives(server: TestServer) {
    // Each ship is alone in her fleet: others' models would inform her.
    let [ada, ben, eva] = ["ada", "ben", "eva"].map(|name| server.admin(name));
    let (ada, ben, eva) = (ada.await, ben.await, eva.await);
    let weeks: Vec<(usize, Vec<Sample>)> = weeks().into_iter().enumerate().collect();
    let at_once = server.ship(&ada, "Nao").await;
    send(&server, &at_once, &weeks, weeks.len()).await;
    let expected = shown(&ada, &at_once).await;

    // In order, a look each week.
    let weekly = server.ship(&ben, "Nao").await;
    send(&server, &weekly, &weeks, 1).await;
    assert_shown(&ben, &weekly, &expected).await;
    assert_eq!(count(&server, &weekly).await, (11, 2));

    // The third week comes last, and others in pairs and reversed.
    let late = server.ship(&eva, "Nao").await;
    let mut order = weeks.clone();
    let third = order.remove(2);
    for pair in order.chunks_mut(2) {
        pair.reverse();
    }
    order.push(third);
    send(&server, &late, &order, 3).await;
    assert_shown(&eva, &late, &expected).await;

    // The cache may be removed.
    server.run_sql("DELETE FROM segments").await;
    analyse_again(&server, &late).await;
    assert_shown(&eva, &late, &expected).await;
    assert_eq!(count(&server, &late).await, (11, 2));

    // So may be a part of it.
    server
        .run_sql("DELETE FROM segments WHERE state IS NULL")
        .await;
    analyse_again(&server, &late).await;
    assert_shown(&eva, &late, &expected).await;
    server.finish().await;
}

/// Flips a bit in a column of the cache.
async fn flip(server: &TestServer, column: &'static str, rows: &'static str) {
    let db = &server.app.db;
    let found: Vec<(i64, Vec<u8>)> = {
        let mut tx = db.begin().await.unwrap();
        let sql = format!(
            "SELECT segment, {column} FROM segments WHERE {column} IS NOT NULL AND {rows}
             ORDER BY segment"
        );
        let sql = sqlx::AssertSqlSafe(sql);
        match tx.connection() {
            Connection::Sqlite(tx) => sqlx::query_as(sql).fetch_all(&mut **tx).await.unwrap(),
            Connection::Postgres(tx) => sqlx::query_as(sql).fetch_all(&mut **tx).await.unwrap(),
        }
    };
    assert!(!found.is_empty());
    let mut tx = db.begin().await.unwrap();
    for (segment, mut bytes) in found {
        let middle = bytes.len() / 2;
        bytes[middle] ^= 8;
        let sql = sqlx::AssertSqlSafe(format!(
            "UPDATE segments SET {column} = $2 WHERE segment = $1"
        ));
        match tx.connection() {
            Connection::Sqlite(tx) => {
                let query = sqlx::query(sql).bind(segment).bind(bytes);
                query.execute(&mut **tx).await.map(drop).unwrap();
            }
            Connection::Postgres(tx) => {
                let query = sqlx::query(sql).bind(segment).bind(bytes);
                query.execute(&mut **tx).await.map(drop).unwrap();
            }
        }
    }
    tx.commit().await.unwrap();
}

async fn a_damaged_state_is_noticed_and_derived_again(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let weeks: Vec<(usize, Vec<Sample>)> = weeks().into_iter().enumerate().collect();
    let (last, before) = weeks.split_last().unwrap();
    send(&server, &nao, before, before.len()).await;
    flip(&server, "state", "1 = 1").await;
    send(&server, &nao, std::slice::from_ref(last), 1).await;
    let found = shown(&ada, &nao).await;
    let sound = server.ship(&ada, "Nao").await;
    send(&server, &sound, &weeks, weeks.len()).await;
    assert_shown(&ada, &sound, &found).await;
    server.finish().await;
}

async fn damaged_diagnoses_are_noticed_and_derived_again(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let weeks: Vec<(usize, Vec<Sample>)> = weeks().into_iter().enumerate().collect();
    send(&server, &nao, &weeks, weeks.len()).await;
    let expected = shown(&ada, &nao).await;
    flip(&server, "diagnoses", "first_sample_at IS NOT NULL").await;
    // Each look finds one that is damaged, and has it made again.
    for _ in 0..count(&server, &nao).await.0 {
        if ada.get(&nao.path("/samples.csv")).await.status == 200 {
            break;
        }
        server.work().await;
    }
    assert_shown(&ada, &nao, &expected).await;
    server.finish().await;
}

async fn a_repeated_batch_of_months_ago_is_read_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let weeks: Vec<(usize, Vec<Sample>)> = weeks().into_iter().enumerate().collect();
    send(&server, &nao, &weeks, weeks.len()).await;
    let expected = shown(&ada, &nao).await;
    nao.put(100, &weeks[1].1).await.good();
    analyse(&server).await;
    assert_shown(&ada, &nao, &expected).await;
    // Each segment has the hash of the batches that it has now.
    let vessel: VesselId = serde_json::from_value(json!(nao.id)).unwrap();
    let db = &server.app.db;
    let compass = binnacle_fleet::compasses::of_vessel(db, vessel)
        .await
        .unwrap()[0]
        .id;
    let rows = binnacle_fleet::analysis::segments::list(db, vessel, compass);
    let logged = binnacle_fleet::analysis::input::load(db, vessel, compass, server.app.clock.now());
    let (rows, logged) = (rows.await.unwrap(), logged.await.unwrap());
    let known: Vec<_> = rows.iter().map(|row| row.batches).collect();
    let found: Vec<_> = logged
        .segments
        .iter()
        .map(|segment| segment.batches)
        .collect();
    assert_eq!(known, found);
    server.finish().await;
}
