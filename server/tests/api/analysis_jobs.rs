//! The queue of analyses: when one is due, who does it, and what if it fails.

use crate::analysis::{A_WHILE_S, DAY};
use crate::on_both;
use crate::support::{Shore, passage};
use binnacle_fleet::analysis_queue;
use binnacle_server::worker::{self, Worked};
use serde_json::json;

on_both!(
    many_batches_make_one_job_that_waits_for_more,
    the_same_input_makes_no_second_version,
    another_estimator_analyses_every_vessel_again_at_the_start,
    a_lease_that_ended_goes_to_another_worker,
    a_lease_that_is_renewed_is_not_taken,
    a_job_that_fails_is_tried_again_and_then_given_up,
);

/// Takes a job as a worker does that then dies.
async fn claim(shore: &Shore) -> bool {
    let now = shore.app.clock.now().into();
    let job = analysis_queue::claim(&shore.app.db, now).await.unwrap();
    job.is_some()
}

async fn many_batches_make_one_job_that_waits_for_more(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    for seq in 1..=10 {
        nao.put(seq, &passage(DAY, 4)).await.good();
    }
    assert_eq!(shore.work().await, [], "before the delay is over");
    shore.advance(A_WHILE_S);
    assert_eq!(shore.work().await.len(), 1);
    assert_eq!(shore.work().await, []);
    shore.finish().await;
}

async fn the_same_input_makes_no_second_version(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    let samples = passage(DAY, 300);
    nao.put(1, &samples).await.good();
    shore.advance(A_WHILE_S);
    shore.work().await;
    // The same samples come again in a batch of their own.
    nao.put(2, &samples).await.good();
    shore.advance(A_WHILE_S);
    let worked = shore.work().await;
    assert!(matches!(worked[..], [Worked::Analysed(_, 0)]), "{worked:?}");
    let versions = ada.get(&nao.path("/models")).await.good();
    assert_eq!(versions["items"].as_array().unwrap().len(), 1);

    nao.put(3, &passage("2026-11-20T00:00:00Z", 10))
        .await
        .good();
    shore.advance(A_WHILE_S);
    shore.work().await;
    let versions = ada.get(&nao.path("/models?limit=1")).await.good();
    assert_eq!(versions["items"][0]["version"], 2);
    let rest = format!("/models?after={}", versions["next"].as_str().unwrap());
    let older = ada.get(&nao.path(&rest)).await.good();
    assert_eq!(older["items"][0]["version"], 1);
    assert_eq!(older["next"], json!(null));
    shore.finish().await;
}

async fn another_estimator_analyses_every_vessel_again_at_the_start(shore: Shore) {
    // It has started once it answers.
    async fn restart(shore: Shore) -> Shore {
        let shore = shore.restart().await;
        let health = format!("{}/healthz", shore.url);
        assert!(
            shore
                .http
                .get(health)
                .send()
                .await
                .unwrap()
                .status()
                .is_success()
        );
        shore
    }
    let ada = shore.admin("ada").await;
    let mut nao = shore.ship(&ada, "Nao").await;
    let gaviota = shore.ship(&ada, "Gaviota").await;
    nao.put(1, &passage(DAY, 30)).await.good();
    gaviota.put(1, &passage(DAY, 30)).await.good();
    shore.advance(A_WHILE_S);
    assert_eq!(shore.work().await.len(), 2);
    let shore = restart(shore).await;
    assert_eq!(shore.work().await, [], "the estimator is the same");

    // As an earlier version left it; for one of the two a job waits already.
    shore
        .sql("UPDATE analyses SET estimator = 'older', input_hash = 'older'")
        .await;
    nao.at(&shore);
    nao.put(2, &passage("2026-11-20T00:00:00Z", 3)).await.good();
    let shore = restart(shore).await;
    let worked = shore.work().await;
    let [Worked::Analysed(first, 1), Worked::Analysed(second, 1)] = worked[..] else {
        panic!("{worked:?}");
    };
    assert_ne!(first, second);
    let shore = restart(shore).await;
    assert_eq!(shore.work().await, []);
    shore.finish().await;
}

async fn a_lease_that_ended_goes_to_another_worker(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 300)).await.good();
    shore.advance(A_WHILE_S);
    // A worker takes the job and is never heard of again.
    assert!(claim(&shore).await);
    assert_eq!(shore.work().await, []);
    // A batch that comes meanwhile waits: a vessel is analysed by one at a time.
    nao.put(2, &passage("2026-11-20T00:00:00Z", 3)).await.good();
    shore.advance(A_WHILE_S);
    assert_eq!(shore.work().await, []);
    shore.advance(600.0);
    let other = shore.second().await;
    let worked = worker::step(&other).await.unwrap();
    assert!(matches!(worked, Some(Worked::Analysed(_, 1))), "{worked:?}");
    assert_eq!(ada.get(&nao.path("/model")).await.status, 200);
    other.db.close().await;
    shore.finish().await;
}

async fn a_lease_that_is_renewed_is_not_taken(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 30)).await.good();
    shore.advance(A_WHILE_S);
    let now = || shore.app.clock.now().into();
    let job = analysis_queue::claim(&shore.app.db, now())
        .await
        .unwrap()
        .unwrap();
    for _ in 0..3 {
        shore.advance(50.0);
        analysis_queue::renew(&shore.app.db, job, now())
            .await
            .unwrap();
    }
    assert_eq!(shore.work().await, []);
    // The worker was killed: within a minute another takes its job.
    shore.advance(60.0);
    assert!(matches!(shore.work().await[..], [Worked::Analysed(_, 1)]));
    // Whoever comes back late renews nothing.
    analysis_queue::renew(&shore.app.db, job, now())
        .await
        .unwrap();
    let left = analysis_queue::count(&shore.app.db).await.unwrap();
    assert_eq!(left, [("queued", 0), ("running", 0), ("dead", 0)]);
    shore.finish().await;
}

async fn a_job_that_fails_is_tried_again_and_then_given_up(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = shore.ship(&ada, "Nao").await;
    nao.put(1, &passage(DAY, 30)).await.good();
    for _ in 0..6 {
        shore.advance(1000.0);
        claim(&shore).await;
    }
    shore.advance(1000.0);
    let worked = shore.work().await;
    assert!(matches!(worked[..], [Worked::Failed(_)]), "{worked:?}");
    let metrics = shore
        .http
        .get(format!("{}/metrics", shore.url))
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
    // A later batch starts afresh, and its success clears the dead one away.
    nao.put(2, &passage("2026-11-20T00:00:00Z", 3)).await.good();
    shore.advance(A_WHILE_S);
    assert!(matches!(shore.work().await[..], [Worked::Analysed(_, 1)]));
    let left = analysis_queue::count(&shore.app.db).await.unwrap();
    assert_eq!(left, [("queued", 0), ("running", 0), ("dead", 0)]);
    shore.finish().await;
}
