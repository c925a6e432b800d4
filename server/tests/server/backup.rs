//! Backups: nothing that was acknowledged is lost, and nothing that is there is replaced.

use binnacle_platform::db::Pools;
use binnacle_server::backup::{back_up, restore};
use binnacle_server_testing::{Engine, HOUR_S, TestServer, on_both, passage};
use std::fs::{OpenOptions, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

on_both!(
    a_backup_taken_under_load_has_all_that_was_acknowledged_before,
    a_damaged_backup_is_refused_and_leaves_nothing,
    nothing_is_replaced,
);

fn engine(server: &TestServer) -> Engine {
    match server.app.db.pools() {
        Pools::Sqlite { .. } => Engine::Sqlite,
        Pools::Postgres(_) => Engine::Postgres,
    }
}

fn count(folder: &Path) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}

async fn a_backup_taken_under_load_has_all_that_was_acknowledged_before(server: TestServer) {
    let ada = server.admin("ada").await;
    let mut ship = server.ship(&ada, "Nao").await;
    let samples = passage("2026-11-15T00:00:00Z", 400);
    let batches: Vec<_> = samples.chunks(4).collect();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("nightly.backup");
    let acknowledged = AtomicU64::new(0);
    let upload = async {
        for (seq, batch) in (1..).zip(&batches) {
            ship.put(seq, batch).await.good();
            acknowledged.store(seq, Ordering::SeqCst);
        }
    };
    let backup = async {
        while acknowledged.load(Ordering::SeqCst) < 10 {
            tokio::task::yield_now().await;
        }
        let before = acknowledged.load(Ordering::SeqCst);
        let bytes = back_up(server.database_url(), &file).await.unwrap();
        (before, bytes)
    };
    let ((), (before, bytes)) = tokio::join!(upload, backup);
    let written = file.metadata().unwrap();
    assert_eq!(written.len(), bytes);
    assert_eq!(written.permissions().mode() & 0o777, 0o600);
    assert_eq!(count(folder.path()), 1);
    let engine = engine(&server);
    server.finish().await;

    let restored = TestServer::restored(engine, &file).await;
    ship.reconnect(&restored);
    let ada = ada.reconnect(&restored);
    let known = ship.downlink("").await["contiguous_seq"].as_u64().unwrap();
    assert!(known >= before, "{known} of {before}");
    // The agent sends the rest again, and all is there as if nothing had happened.
    for (seq, batch) in (1..).zip(&batches).skip(known as usize) {
        ship.put(seq, batch).await.good();
    }
    restored.app.clock.advance(HOUR_S);
    restored.work().await;
    let page = ada.get(&ship.path("/samples.csv")).await;
    assert_eq!(page.text.lines().count(), 1 + samples.len());
    restored.finish().await;
}

async fn a_damaged_backup_is_refused_and_leaves_nothing(server: TestServer) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("half.backup");
    let bytes = back_up(server.database_url(), &file).await.unwrap();
    let half = OpenOptions::new().write(true).open(&file).unwrap();
    half.set_len(bytes / 2).unwrap();
    let place = folder.path().join("new.db");
    let url = match engine(&server) {
        Engine::Sqlite => format!("sqlite://{}", place.display()),
        Engine::Postgres => server.database_url().to_owned(),
    };
    let error = format!("{:#}", restore(&url, &file).await.unwrap_err());
    assert!(error.contains("half.backup is damaged"), "{error}");
    std::fs::write(&file, "time,lat,lon\n").unwrap();
    let error = format!("{:#}", restore(&url, &file).await.unwrap_err());
    assert!(error.contains("is no backup"), "{error}");
    assert_eq!(count(folder.path()), 1);
    server.finish().await;
}

#[tokio::test]
async fn a_restored_file_is_its_owners_though_all_may_read_the_backup() {
    let server = TestServer::start(Engine::Sqlite).await;
    let folder = tempfile::tempdir().unwrap();
    let (file, place) = (
        folder.path().join("nightly.backup"),
        folder.path().join("new.db"),
    );
    back_up(server.database_url(), &file).await.unwrap();
    std::fs::set_permissions(&file, Permissions::from_mode(0o644)).unwrap();
    let url = format!("sqlite://{}", place.display());
    restore(&url, &file).await.unwrap();
    assert_eq!(
        place.metadata().unwrap().permissions().mode() & 0o777,
        0o600
    );
    server.finish().await;
}

async fn nothing_is_replaced(server: TestServer) {
    let ada = server.admin("ada").await;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("nightly.backup");
    back_up(server.database_url(), &file).await.unwrap();
    let again = back_up(server.database_url(), &file).await.unwrap_err();
    assert!(again.to_string().contains("exists already"), "{again}");
    let error = restore(server.database_url(), &file).await.unwrap_err();
    assert!(error.to_string().contains("already"), "{error}");
    let other = match engine(&server) {
        Engine::Sqlite => "postgres://binnacle@127.0.0.1/other",
        Engine::Postgres => "sqlite://other.db",
    };
    let error = restore(other, &file).await.unwrap_err();
    assert!(error.to_string().contains("is a backup of"), "{error}");
    ada.get("/fleet").await.good();
    assert_eq!(count(folder.path()), 1);
    server.finish().await;
}
