//! The queue of analysis jobs: delay, lease, retries.

use super::{A_WHILE_S, DAY};
use binnacle_fleet::analysis_queue;
use binnacle_platform::db::Pools;
use binnacle_platform::time::Time;
use binnacle_server::worker::{self, Worked};
use binnacle_server_testing::on_both;
use binnacle_server_testing::{TestServer, passage};
use serde_json::json;
use sqlx::AssertSqlSafe;

on_both!(
    many_batches_make_one_job_that_waits_for_more,
    the_same_input_makes_no_second_version,
    a_new_estimator_version_reanalyses_every_vessel_at_startup,
    an_expired_lease_goes_to_another_worker,
    a_renewed_lease_stays_with_its_worker,
    a_failing_job_is_retried_and_then_dead,
    several_workers_claim_each_job_once,
    a_clock_that_is_set_back_delays_no_job,
    a_lease_ends_although_the_clock_is_set_back,
    the_oldest_job_is_shown,
    a_claim_among_many_jobs_uses_indexes,
);

/// Claims a job as a worker that then dies.
async fn claim(server: &TestServer) -> bool {
    let now = server.app.clock.now().into();
    let job = analysis_queue::claim(&server.app.db, now).await.unwrap();
    job.is_some()
}

async fn many_batches_make_one_job_that_waits_for_more(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    for seq in 1..=10 {
        nao.put(seq, &passage(DAY, 4)).await.good();
    }
    assert_eq!(server.work().await, [], "before the delay is over");
    server.advance(A_WHILE_S);
    assert_eq!(server.work().await.len(), 1);
    assert_eq!(server.work().await, []);
    server.finish().await;
}

async fn the_same_input_makes_no_second_version(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let samples = passage(DAY, 300);
    nao.put(1, &samples).await.good();
    server.advance(A_WHILE_S);
    server.work().await;
    // The same samples come again in a batch of their own.
    nao.put(2, &samples).await.good();
    server.advance(A_WHILE_S);
    let worked = server.work().await;
    assert!(matches!(worked[..], [Worked::Analysed(_, 0)]), "{worked:?}");
    let versions = ada.get(&nao.path("/models")).await.good();
    assert_eq!(versions["items"].as_array().unwrap().len(), 1);

    nao.put(3, &passage("2026-11-20T00:00:00Z", 10))
        .await
        .good();
    server.advance(A_WHILE_S);
    server.work().await;
    let versions = ada.get(&nao.path("/models?limit=1")).await.good();
    assert_eq!(versions["items"][0]["version"], 2);
    let rest = format!("/models?after={}", versions["next"].as_str().unwrap());
    let older = ada.get(&nao.path(&rest)).await.good();
    assert_eq!(older["items"][0]["version"], 1);
    assert_eq!(older["next"], json!(null));
    server.finish().await;
}

async fn a_new_estimator_version_reanalyses_every_vessel_at_startup(server: TestServer) {
    // It has started once it responds.
    async fn restart(server: TestServer) -> TestServer {
        let server = server.restart().await;
        let health = format!("{}/healthz", server.url);
        assert!(
            server
                .http
                .get(health)
                .send()
                .await
                .unwrap()
                .status()
                .is_success()
        );
        server
    }
    let ada = server.admin("ada").await;
    let mut nao = server.ship(&ada, "Nao").await;
    let gaviota = server.ship(&ada, "Gaviota").await;
    nao.put(1, &passage(DAY, 30)).await.good();
    gaviota.put(1, &passage(DAY, 30)).await.good();
    server.advance(A_WHILE_S);
    assert_eq!(server.work().await.len(), 2);
    let server = restart(server).await;
    assert_eq!(server.work().await, [], "the estimator is the same");

    // As an earlier version left it; one of the two has a waiting job already.
    server
        .run_sql("UPDATE analyses SET estimator = 'older', input_hash = 'older'")
        .await;
    nao.reconnect(&server);
    nao.put(2, &passage("2026-11-20T00:00:00Z", 3)).await.good();
    let server = restart(server).await;
    let worked = server.work().await;
    let [Worked::Analysed(first, 1), Worked::Analysed(second, 1)] = worked[..] else {
        panic!("{worked:?}");
    };
    assert_ne!(first, second);
    let server = restart(server).await;
    assert_eq!(server.work().await, []);
    server.finish().await;
}

async fn an_expired_lease_goes_to_another_worker(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 300)).await.good();
    server.advance(A_WHILE_S);
    // A worker claims the job and dies.
    assert!(claim(&server).await);
    assert_eq!(server.work().await, []);
    // A batch that arrives meanwhile waits: only one worker analyses a vessel.
    nao.put(2, &passage("2026-11-20T00:00:00Z", 3)).await.good();
    server.advance(A_WHILE_S);
    assert_eq!(server.work().await, []);
    server.advance(600.0);
    let other = server.second_server().await;
    let worked = worker::step(&other).await.unwrap();
    assert!(matches!(worked, Some(Worked::Analysed(_, 1))), "{worked:?}");
    assert_eq!(ada.get(&nao.path("/model")).await.status, 200);
    other.db.close().await;
    server.finish().await;
}

async fn a_renewed_lease_stays_with_its_worker(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 30)).await.good();
    server.advance(A_WHILE_S);
    let now = || server.app.clock.now().into();
    let job = analysis_queue::claim(&server.app.db, now())
        .await
        .unwrap()
        .unwrap();
    for _ in 0..3 {
        server.advance(50.0);
        analysis_queue::renew(&server.app.db, job, now())
            .await
            .unwrap();
    }
    assert_eq!(server.work().await, []);
    // The worker was killed: within a minute another one claims the job.
    server.advance(60.0);
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 1)]));
    // A worker that comes back late cannot renew the lease.
    analysis_queue::renew(&server.app.db, job, now())
        .await
        .unwrap();
    let left = analysis_queue::count(&server.app.db).await.unwrap();
    assert_eq!(left, [("queued", 0), ("running", 0), ("dead", 0)]);
    server.finish().await;
}

async fn a_failing_job_is_retried_and_then_dead(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 30)).await.good();
    for _ in 0..6 {
        server.advance(1000.0);
        claim(&server).await;
    }
    server.advance(1000.0);
    let worked = server.work().await;
    assert!(matches!(worked[..], [Worked::Failed(_)]), "{worked:?}");
    let metrics = server
        .http
        .get(format!("{}/metrics", server.url))
        .send()
        .await
        .unwrap();
    assert!(
        metrics
            .text()
            .await
            .unwrap()
            .contains("binnacle_jobs{state=\"dead\"}")
    );
    // A later batch makes a new job, and its success removes the dead one.
    nao.put(2, &passage("2026-11-20T00:00:00Z", 3)).await.good();
    server.advance(A_WHILE_S);
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 1)]));
    let left = analysis_queue::count(&server.app.db).await.unwrap();
    assert_eq!(left, [("queued", 0), ("running", 0), ("dead", 0)]);
    server.finish().await;
}

async fn several_workers_claim_each_job_once(server: TestServer) {
    let ada = server.admin("ada").await;
    for name in ["Nao", "Kogge", "Gaviota", "Bounty", "Fram", "Vasa"] {
        let ship = server.ship(&ada, name).await;
        ship.put(1, &passage(DAY, 3)).await.good();
    }
    server.advance(A_WHILE_S);
    let workers = (0..4).map(|_| async {
        let mut claimed = Vec::new();
        while let Some(job) = analysis_queue::claim(&server.app.db, server.app.clock.now().into())
            .await
            .unwrap()
        {
            claimed.push(job.vessel_id);
        }
        claimed
    });
    let mut claimed = futures_util::future::join_all(workers).await.concat();
    assert_eq!(claimed.len(), 6);
    claimed.sort_unstable();
    claimed.dedup();
    assert_eq!(claimed.len(), 6);
    server.finish().await;
}

async fn a_clock_that_is_set_back_delays_no_job(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 30)).await.good();
    server.advance(-3600.0);
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 1)]));
    server.finish().await;
}

async fn a_lease_ends_although_the_clock_is_set_back(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 30)).await.good();
    server.advance(A_WHILE_S);
    // A worker claims the job and dies.
    assert!(claim(&server).await);
    server.advance(-30.0);
    assert_eq!(
        server.work().await,
        [],
        "the clocks of two servers may differ"
    );
    server.advance(-3600.0);
    assert!(matches!(server.work().await[..], [Worked::Analysed(_, 1)]));
    server.finish().await;
}

async fn the_oldest_job_is_shown(server: TestServer) {
    let read = async |path: &str| {
        let url = format!("{}{path}", server.url);
        let response = server.http.get(url).send().await.unwrap();
        assert_eq!(response.status(), 200);
        response.text().await.unwrap()
    };
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 30)).await.good();
    assert_eq!(read("/readyz").await, "ready");
    // It is due after five seconds.
    server.advance(905.0);
    assert_eq!(
        read("/readyz").await,
        "ready, but an analysis has waited for 900 s"
    );
    let metrics = read("/metrics").await;
    assert!(
        metrics.contains("binnacle_oldest_job_seconds 900"),
        "{metrics}"
    );
    server.finish().await;
}

async fn a_claim_among_many_jobs_uses_indexes(server: TestServer) {
    let ada = server.admin("ada").await;
    ada.create_vessel("Nao").await;
    let is_postgres = matches!(server.app.db.pools(), Pools::Postgres(_));
    let (fill, analyze) = if is_postgres {
        (
            "INSERT INTO vessels (id, operator_id, name, created_at)
             SELECT gen_random_uuid(), v.operator_id, 'Ship', v.created_at
             FROM vessels v, generate_series(1, 100000)",
            "ANALYZE jobs",
        )
    } else {
        (
            "INSERT INTO vessels (id, operator_id, name, created_at)
             SELECT randomblob(16), v.operator_id, 'Ship', v.created_at
             FROM vessels v, (WITH RECURSIVE n (i) AS
                              (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 100000)
                              SELECT i FROM n)",
            "ANALYZE",
        )
    };
    server.run_sql(fill).await;
    server
        .run_sql(
            "INSERT INTO jobs (vessel_id, id, kind, state, created_at, not_before, attempts)
             SELECT id, id, 'analyse', 'queued', 0, 1, 0 FROM vessels",
        )
        .await;
    server.run_sql(analyze).await;
    let plan = plan(&server).await;
    assert!(plan.contains("jobs_by_due"), "{plan}");
    for scan in ["Seq Scan on jobs", "SCAN jobs", "SCAN r"] {
        let lines = plan.lines().filter(|line| line.contains(scan));
        let unindexed = lines.filter(|line| !line.contains("INDEX")).count();
        assert_eq!(unindexed, 0, "{plan}");
    }
    assert!(claim(&server).await);
    server.finish().await;
}

/// Returns the database's plan for finding a job to claim.
async fn plan(server: &TestServer) -> String {
    let candidates = analysis_queue::CANDIDATES;
    let now = Time(server.app.clock.now());
    let lines: Vec<String> = match server.app.db.pools() {
        Pools::Sqlite { readers, .. } => {
            let explain = AssertSqlSafe(format!("EXPLAIN QUERY PLAN {candidates}"));
            let rows = sqlx::query_as::<_, (i64, i64, i64, String)>(explain);
            let rows = rows.bind(now).bind(now).fetch_all(readers).await.unwrap();
            rows.into_iter().map(|(_, _, _, line)| line).collect()
        }
        Pools::Postgres(pool) => {
            let explain = AssertSqlSafe(format!("EXPLAIN {candidates}"));
            let rows = sqlx::query_scalar(explain).bind(now).bind(now);
            rows.fetch_all(pool).await.unwrap()
        }
    };
    lines.join("\n")
}
