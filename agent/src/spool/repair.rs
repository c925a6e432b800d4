//! Repair of a damaged spool: it is quarantined, and its readable rows are carried over. A vessel
//! must not have to wait in port for somebody to delete a file.

use super::actions;
use super::database::{Spool, connect, create_private};
use super::reports::{self, azimuths};
use super::seal::insert_batch;
use anyhow::Context;
use sqlx::{FromRow, Row, SqlitePool};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// Lock held while an agent runs: two agents on one spool would fork its stream.
#[derive(Debug)]
pub(crate) struct Lock {
    _file: File,
}

/// SQLite's primary result codes for a file that is damaged, or no database.
const CORRUPT: i32 = 11;
const NOT_A_DATABASE: i32 = 26;

impl Spool {
    /// Opens the spool for the agent itself: exclusively, and repaired if necessary.
    pub(crate) async fn open_for_agent(directory: &Path) -> anyhow::Result<(Spool, Lock)> {
        create_private(directory, &directory.join("spool.db"))
            .with_context(|| format!("{}: cannot create the spool", directory.display()))?;
        let lock = lock(directory)?;
        let error = match open_checked(directory).await {
            Ok(spool) => return Ok((spool, lock)),
            Err(error) => error,
        };
        if !error.downcast_ref::<sqlx::Error>().is_some_and(is_damage) {
            return Err(error);
        }
        let aside = quarantine(directory)?;
        let name = aside.display().to_string();
        tracing::error!(
            aside = name,
            error = format!("{error:#}"),
            "the spool is damaged"
        );
        let spool = Spool::open(directory).await?;
        carry_over(&aside, &spool).await;
        Ok((spool, lock))
    }
}

/// Returns whether an agent runs on the spool of a directory.
pub(crate) fn is_agent_running(directory: &Path) -> bool {
    let file = File::open(directory.join("agent.lock"));
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

fn lock(directory: &Path) -> anyhow::Result<Lock> {
    let path = directory.join("agent.lock");
    let name = path.display();
    let file = File::create(&path).with_context(|| format!("{name}: cannot be written"))?;
    match file.try_lock() {
        Ok(()) => Ok(Lock { _file: file }),
        Err(TryLockError::WouldBlock) => anyhow::bail!("{name}: another agent is running here"),
        Err(TryLockError::Error(error)) => {
            Err(error).with_context(|| format!("{name}: cannot be locked"))
        }
    }
}

async fn open_checked(directory: &Path) -> anyhow::Result<Spool> {
    let spool = Spool::open(directory).await?;
    let check: sqlx::Result<String> = sqlx::query_scalar("PRAGMA quick_check(1)")
        .fetch_one(&spool.pool)
        .await;
    let problem = match check {
        Ok(outcome) if outcome == "ok" => return Ok(spool),
        Ok(outcome) => sqlx::Error::Decode(outcome.into()),
        Err(error) => error,
    };
    spool.close().await;
    Err(problem).context("quick_check")
}

fn is_damage(error: &sqlx::Error) -> bool {
    match error {
        // A result of `quick_check`, or invalid text.
        sqlx::Error::Decode(_) | sqlx::Error::ColumnDecode { .. } => true,
        sqlx::Error::Database(error) => {
            let code = error.code().and_then(|code| code.parse::<i32>().ok());
            code.is_some_and(|code| matches!(code & 0xff, CORRUPT | NOT_A_DATABASE))
        }
        _ => false,
    }
}

/// Renames the database and its journal. Returns the new path.
fn quarantine(directory: &Path) -> anyhow::Result<PathBuf> {
    let free = |number: &u32| !directory.join(format!("damaged-{number}.db")).exists();
    let number = (1..1000_u32).find(free).unwrap_or_default();
    let aside = directory.join(format!("damaged-{number}.db"));
    for suffix in ["", "-wal", "-shm"] {
        let from = directory.join(format!("spool.db{suffix}"));
        let to = directory.join(format!("damaged-{number}.db{suffix}"));
        match std::fs::rename(&from, &to) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(error).with_context(|| from.display().to_string());
            }
            _ => {}
        }
    }
    Ok(aside)
}

/// Copies the readable rows one by one. The server notices numbers that are used again, and gives
/// the agent a new stream.
async fn carry_over(aside: &Path, spool: &Spool) {
    let damaged = match connect(aside).await {
        Ok(damaged) => damaged,
        Err(error) => {
            tracing::error!(%error, "nothing of the damaged spool can be read");
            return;
        }
    };
    let (mut state, mut samples, mut batches) = (0, 0, 0);
    for row in rows(&damaged, "SELECT name, value FROM state").await {
        let (name, value) = (row.try_get::<String, _>(0), row.try_get::<String, _>(1));
        let (Ok(name), Ok(value)) = (name, value) else {
            continue;
        };
        let copied = sqlx::query("INSERT OR REPLACE INTO state (name, value) VALUES ($1, $2)")
            .bind(name)
            .bind(value)
            .execute(&spool.pool)
            .await;
        state += usize::from(copied.is_ok());
    }
    for row in rows(&damaged, "SELECT time_micros, sample FROM pending_samples").await {
        let (time, sample) = (row.try_get::<i64, _>(0), row.try_get::<String, _>(1));
        let (Ok(time), Ok(sample)) = (time, sample) else {
            continue;
        };
        let copied =
            sqlx::query("INSERT INTO pending_samples (time_micros, sample) VALUES ($1, $2)")
                .bind(time)
                .bind(sample)
                .execute(&spool.pool)
                .await;
        samples += usize::from(copied.is_ok());
    }
    let sealed = "SELECT seq, bytes FROM batches WHERE standing <> 'acknowledged'";
    for row in rows(&damaged, sealed).await {
        let (seq, bytes) = (row.try_get::<i64, _>(0), row.try_get::<Vec<u8>, _>(1));
        let (Ok(seq), Ok(bytes)) = (seq, bytes) else {
            continue;
        };
        // The frame has a checksum of its own.
        let Ok(batch) = binnacle_wire::decode(&bytes) else {
            continue;
        };
        let Ok(mut connection) = spool.pool.acquire().await else {
            continue;
        };
        let count = batch.samples.len();
        let (seq, urgent) = (seq.cast_unsigned(), !batch.alerts.is_empty());
        let copied = insert_batch(&mut connection, seq, &bytes, count, urgent).await;
        batches += usize::from(copied.is_ok());
    }
    // Any of them may have been sent.
    let tried = sqlx::query("UPDATE batches SET tried = TRUE");
    if let Err(error) = tried.execute(&spool.pool).await {
        tracing::error!(%error, "the batches carried over cannot be marked as tried");
    }
    let reports = carry_reports_over(&damaged, spool).await;
    let azimuths = carry_azimuths_over(&damaged, spool).await;
    let actions = carry_actions_over(&damaged, spool).await;
    damaged.close().await;
    tracing::warn!(
        state,
        samples,
        batches,
        reports,
        azimuths,
        actions,
        "carried over from the damaged spool"
    );
}

async fn carry_reports_over(damaged: &SqlitePool, spool: &Spool) -> usize {
    let mut carried = 0;
    let all = "SELECT id, report, written_micros, standing, problem FROM reports ORDER BY number";
    for row in rows(damaged, all).await {
        let Some(report) = reports::Row::from_row(&row).ok().and_then(reports::read) else {
            continue;
        };
        let Ok(mut connection) = spool.pool.acquire().await else {
            continue;
        };
        carried += usize::from(reports::put(&mut connection, &report).await.is_ok());
    }
    carried
}

async fn carry_azimuths_over(damaged: &SqlitePool, spool: &Spool) -> usize {
    let mut carried = 0;
    let all = "SELECT id, azimuth AS report, written_micros, standing, problem FROM azimuths
               ORDER BY number";
    for row in rows(damaged, all).await {
        let Some(azimuth) = reports::Row::from_row(&row).ok().and_then(azimuths::read) else {
            continue;
        };
        let Ok(mut connection) = spool.pool.acquire().await else {
            continue;
        };
        carried += usize::from(azimuths::put(&mut connection, &azimuth).await.is_ok());
    }
    carried
}

async fn carry_actions_over(damaged: &SqlitePool, spool: &Spool) -> usize {
    let mut carried = 0;
    let all = "SELECT at_micros, address, action, result FROM actions ORDER BY number";
    for row in rows(damaged, all).await {
        let Some(action) = actions::Row::from_row(&row)
            .ok()
            .and_then(|row| row.read().ok())
        else {
            continue;
        };
        let Ok(mut connection) = spool.pool.acquire().await else {
            continue;
        };
        carried += usize::from(actions::put(&mut connection, &action).await.is_ok());
    }
    carried
}

/// Returns the rows of a query up to the first unreadable one.
async fn rows(damaged: &SqlitePool, query: &'static str) -> Vec<sqlx::sqlite::SqliteRow> {
    use futures_util::StreamExt;
    let mut stream = sqlx::query(query).fetch(damaged);
    let mut rows = Vec::new();
    while let Some(Ok(row)) = stream.next().await {
        rows.push(row);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::super::tests::{accepted, identity, sample};
    use super::*;
    use crate::spool::Seal;
    use tempfile::TempDir;

    /// Creates a spool with rows in every table; closed, so that it is one file.
    async fn closed_spool(directory: &Path) -> Vec<u8> {
        let spool = Spool::open(directory).await.unwrap();
        spool.enrol(&identity(7)).await.unwrap();
        for minute in 0..40 {
            spool
                .store(&[sample(minute)], &accepted(1), Seal::All)
                .await
                .unwrap();
        }
        let report = serde_json::from_str(r#"{"kind":"shock","from":"2026-11-21T06:00:00Z"}"#);
        let (id, report) = (uuid::Uuid::from_u128(1), report.unwrap());
        let kept = spool.save_report(id, report, String::new(), false, sample(0).time);
        kept.await.unwrap();
        let rest: Vec<_> = (100..140).map(sample).collect();
        spool.store(&rest, &accepted(1), Seal::Full).await.unwrap();
        spool.close().await;
        std::fs::read(directory.join("spool.db")).unwrap()
    }

    #[tokio::test]
    async fn whichever_page_is_damaged_the_agent_goes_on_with_the_rest() {
        const PAGE: usize = 4096;
        let directory = TempDir::new().unwrap();
        let whole = closed_spool(directory.path()).await;
        let (mut kept_identity, mut kept_batches, mut kept_reports) = (0, 0, 0);
        let pages = whole.len() / PAGE;
        for page in 0..pages {
            let directory = TempDir::new().unwrap();
            let mut bytes = whole.clone();
            bytes[page * PAGE..(page + 1) * PAGE].fill(0xA5);
            std::fs::write(directory.path().join("spool.db"), bytes).unwrap();
            let (spool, _lock) = Spool::open_for_agent(directory.path()).await.unwrap();
            kept_identity += usize::from(spool.identity().await.unwrap().is_some());
            kept_batches += usize::from(spool.next_batch().await.unwrap().is_some());
            kept_reports += usize::from(spool.next_report().await.unwrap().is_some());
            spool
                .store(&[sample(500)], &accepted(1), Seal::All)
                .await
                .unwrap();
            spool.close().await;
        }
        assert!(pages > 5, "{pages}");
        assert!(kept_identity >= pages - 3, "{kept_identity} of {pages}");
        assert!(kept_batches >= pages - 4, "{kept_batches} of {pages}");
        assert!(kept_reports >= pages - 4, "{kept_reports} of {pages}");
    }

    #[tokio::test]
    async fn a_file_that_is_no_database_is_put_aside() {
        let directory = TempDir::new().unwrap();
        std::fs::write(directory.path().join("spool.db"), [7; 9000]).unwrap();
        let (spool, _lock) = Spool::open_for_agent(directory.path()).await.unwrap();
        assert_eq!(spool.identity().await.unwrap(), None);
        assert!(directory.path().join("damaged-1.db").exists());
    }

    #[tokio::test]
    async fn a_second_agent_is_turned_away_until_the_first_has_gone() {
        let directory = TempDir::new().unwrap();
        let first = Spool::open_for_agent(directory.path()).await.unwrap();
        let error = Spool::open_for_agent(directory.path()).await.unwrap_err();
        assert!(
            error.to_string().contains("another agent is running"),
            "{error}"
        );
        drop(first);
        Spool::open_for_agent(directory.path()).await.unwrap();
    }
}
