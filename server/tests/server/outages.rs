//! A database that is away, busy, or out of space: requests fail soon, clearly and for a while.

use binnacle_platform::db::{Pools, Workload};
use binnacle_server::health::disk;
use binnacle_server_testing::{
    ApiResponse, Engine, Person, Relay, Ship, TestServer, mail, on_both, passage,
};
use std::time::Duration;
use tokio::time::timeout;

on_both!(
    a_full_disk_is_reported_until_something_can_be_written,
    people_are_served_while_every_connection_for_agents_is_taken,
);

const DAY: &str = "2026-11-20T00:00:00Z";
/// Half of the time that a request for a lost database took when it waited for it.
const SOON: Duration = Duration::from_secs(15);

async fn put(ship: &Ship, seq: u64) -> ApiResponse {
    let response = timeout(SOON, ship.put(seq, &passage(DAY, 500))).await;
    response.expect("a response soon")
}

fn assert_retry_after(response: &ApiResponse) {
    let seconds: u64 = response.headers["retry-after"]
        .to_str()
        .unwrap()
        .parse()
        .unwrap();
    assert!((1..=300).contains(&seconds), "{seconds}");
}

async fn readiness(server: &TestServer) -> (u16, String) {
    let url = format!("{}/readyz", server.url);
    let response = timeout(SOON, server.http.get(url).send()).await;
    let response = response.expect("a response soon").unwrap();
    (response.status().as_u16(), response.text().await.unwrap())
}

/// Lets the database have no more space, or enough again.
async fn limit_disk(server: &TestServer, is_full: bool) {
    match server.app.db.pools() {
        Pools::Sqlite { writer, .. } => {
            // A connection whose transaction failed is replaced when the next one begins.
            drop(server.app.db.begin().await.unwrap());
            // Not below its present size.
            let pages = if is_full { 1 } else { 1_000_000 };
            let limit = sqlx::AssertSqlSafe(format!("PRAGMA max_page_count = {pages}"));
            sqlx::query(limit).execute(writer).await.unwrap();
        }
        Pools::Postgres(_) if is_full => {
            server
                .run_sql(
                    "CREATE FUNCTION fail_on_space() RETURNS trigger LANGUAGE plpgsql AS
                     'BEGIN RAISE EXCEPTION USING ERRCODE = ''disk_full''; END'",
                )
                .await;
            for trigger in [
                "CREATE TRIGGER full_disk BEFORE INSERT ON batches
                 EXECUTE FUNCTION fail_on_space()",
                "CREATE TRIGGER full_disk BEFORE INSERT ON disk_probes
                 EXECUTE FUNCTION fail_on_space()",
            ] {
                server.run_sql(trigger).await;
            }
        }
        Pools::Postgres(_) => server.run_sql("DROP FUNCTION fail_on_space CASCADE").await,
    }
}

async fn a_full_disk_is_reported_until_something_can_be_written(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    limit_disk(&server, true).await;
    let mut seq = 1;
    let refused = loop {
        let response = put(&nao, seq).await;
        if response.status != 200 {
            break response;
        }
        seq += 1;
        assert!(seq < 100, "it never gets full");
    };
    assert_eq!(refused.status, 507, "{refused:?}");
    assert_eq!(refused.problem(), "disk-full");
    assert_retry_after(&refused);
    let (status, text) = readiness(&server).await;
    assert_eq!(status, 503);
    assert!(text.contains("disk"), "{text}");
    if matches!(server.app.db.pools(), Pools::Sqlite { .. }) {
        limit_disk(&server, true).await;
    }
    assert!(disk::probe(&server.app).await.is_err());
    assert_eq!(readiness(&server).await.0, 503);
    // Reading goes on.
    ada.get("/vessels").await.good();

    limit_disk(&server, false).await;
    disk::probe(&server.app).await.unwrap();
    assert_eq!(readiness(&server).await.0, 200);
    assert_eq!(put(&nao, seq).await.good()["contiguous_seq"], seq);
    server.finish().await;
}

async fn people_are_served_while_every_connection_for_agents_is_taken(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    put(&nao, 1).await.good();
    let ingest = server.app.db.for_workload(Workload::Ingest);
    let refused = match ingest.pools() {
        Pools::Sqlite { readers, .. } => {
            let mut taken = Vec::new();
            for _ in 0..readers.options().get_max_connections() {
                taken.push(readers.acquire().await.unwrap());
            }
            refused_meanwhile(&nao, &ada).await
        }
        Pools::Postgres(pool) => {
            let mut taken = Vec::new();
            for _ in 0..pool.options().get_max_connections() {
                taken.push(pool.acquire().await.unwrap());
            }
            refused_meanwhile(&nao, &ada).await
        }
    };
    assert_eq!(refused.problem(), "unavailable");
    assert_retry_after(&refused);
    assert_eq!(put(&nao, 2).await.good()["contiguous_seq"], 2);
    server.finish().await;
}

/// Returns the response to a batch that is refused while a person is served.
async fn refused_meanwhile(ship: &Ship, person: &Person) -> ApiResponse {
    let (refused, listed) = tokio::join!(put(ship, 2), person.get("/vessels"));
    listed.good();
    assert_eq!(refused.status, 503, "{refused:?}");
    refused
}

#[tokio::test]
async fn without_its_database_the_server_refuses_soon_and_then_goes_on() {
    let (server, mut proxy) = TestServer::start_behind_proxy().await;
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    put(&nao, 1).await.good();
    proxy.cut().await;
    let (refused, listed, (status, _)) =
        tokio::join!(put(&nao, 2), ada.get("/vessels"), readiness(&server));
    for response in [&refused, &listed] {
        assert_eq!(response.status, 503, "{response:?}");
        assert_eq!(response.problem(), "unavailable");
        assert_retry_after(response);
    }
    assert_eq!(status, 503);
    proxy.mend().await;
    // A connection that broke is found out when it is used.
    let mut attempts = 0;
    let stored = loop {
        let response = put(&nao, 2).await;
        if response.status != 503 {
            break response.good();
        }
        attempts += 1;
        assert!(attempts < 50, "it never goes on");
    };
    assert_eq!(stored["contiguous_seq"], 2);
    server.finish().await;
}

#[tokio::test]
async fn the_platforms_admins_get_a_letter_about_a_full_disk() {
    let server = TestServer::start(Engine::Sqlite).await;
    let ada = server.admin("ada").await;
    ada.platform_admin(&server).await;
    let relay = Relay::start().await;
    let written = disk::alert_admins(&server.app, &mail::mailer(&relay)).await;
    assert_eq!(written.unwrap(), 1);
    let letter = relay.letters().remove(0);
    assert_eq!(letter.to, ["<root@example.com>"]);
    let read = mail::read(&letter);
    assert_eq!(read["subject"], "Binnacle: the database's disk is full");
    server.finish().await;
}
