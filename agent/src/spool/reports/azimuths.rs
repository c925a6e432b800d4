//! Officers' azimuths, until they are delivered and for a while after.
//!
//! Invariants: an azimuth keeps the id and the observation it was given on board. It may only be
//! withdrawn, which makes it wait again.

use super::{ReportState, Row, SaveReportError, WITHDRAWN_BY_SERVER};
use crate::spool::Spool;
use binnacle_compass::time::Timestamp;
use binnacle_wire::messages::{BoardAzimuth, BoardAzimuthResponse};
use serde::Serialize;
use sqlx::SqliteConnection;
use uuid::Uuid;

/// Number of listed azimuths; older delivered ones are deleted.
const MAX_LISTED: i64 = 100;
/// Limit on waiting azimuths: one a watch for half a year.
const MAX_WAITING: i64 = 1000;

/// An azimuth and its delivery.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct SpooledAzimuth {
    pub(crate) id: Uuid,
    #[serde(flatten)]
    pub(crate) sent: BoardAzimuth,
    /// Time of the last change.
    pub(crate) written_at: Timestamp,
    #[serde(rename = "standing")]
    pub(crate) state: ReportState,
    /// Reason for a refusal, or its withdrawal on the server.
    pub(crate) problem: Option<String>,
}

impl Spool {
    /// Stores an azimuth, or its withdrawal; an identical one changes nothing.
    pub(crate) async fn save_azimuth(
        &self,
        id: Uuid,
        sent: BoardAzimuth,
        now: Timestamp,
    ) -> Result<SpooledAzimuth, SaveReportError> {
        let mut tx = self.write().await?;
        let before = find(&mut tx, id).await?;
        if let Some(before) = before {
            let changes = before.sent.withdrawn != sent.withdrawn;
            if before.sent.report != sent.report || (before.sent.withdrawn && changes) {
                return Err(SaveReportError::Withdrawn);
            }
            if !changes {
                return Ok(before);
            }
        } else if count_waiting(&mut tx).await? >= MAX_WAITING {
            return Err(SaveReportError::TooMany);
        }
        let stored = SpooledAzimuth {
            id,
            sent,
            written_at: now,
            state: ReportState::Waiting,
            problem: None,
        };
        put(&mut tx, &stored).await?;
        tx.commit().await?;
        Ok(stored)
    }

    /// Returns the latest azimuths, newest first.
    pub(crate) async fn azimuths(&self) -> sqlx::Result<Vec<SpooledAzimuth>> {
        let rows: Vec<Row> = sqlx::query_as(
            "SELECT id, azimuth AS report, written_micros, standing, problem FROM azimuths
             ORDER BY number DESC LIMIT $1",
        )
        .bind(MAX_LISTED)
        .fetch_all(&self.pool)
        .await?;
        Ok(rows.into_iter().filter_map(read).collect())
    }

    /// Returns the first azimuth that waits to be sent.
    pub(crate) async fn next_azimuth(&self) -> sqlx::Result<Option<SpooledAzimuth>> {
        let rows: Vec<Row> = sqlx::query_as(
            "SELECT id, azimuth AS report, written_micros, standing, problem FROM azimuths
             WHERE standing = 'waiting' ORDER BY number",
        )
        .fetch_all(&self.pool)
        .await?;
        Ok(rows.into_iter().find_map(read))
    }

    /// Marks an azimuth as delivered.
    pub(crate) async fn mark_azimuth_delivered(
        &self,
        sent: &SpooledAzimuth,
        response: &BoardAzimuthResponse,
    ) -> sqlx::Result<()> {
        let withdrawn = response.withdrawn && !sent.sent.withdrawn;
        let problem = withdrawn.then_some(WITHDRAWN_BY_SERVER);
        self.set_azimuth_state(sent, ReportState::Ashore, problem)
            .await
    }

    /// Marks an azimuth as refused for good.
    pub(crate) async fn mark_azimuth_refused(
        &self,
        sent: &SpooledAzimuth,
        problem: &str,
    ) -> sqlx::Result<()> {
        self.set_azimuth_state(sent, ReportState::Refused, Some(problem))
            .await
    }

    async fn set_azimuth_state(
        &self,
        sent: &SpooledAzimuth,
        state: ReportState,
        problem: Option<&str>,
    ) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        // An azimuth withdrawn meanwhile is not the one that was sent.
        if find(&mut tx, sent.id).await?.as_ref() == Some(sent) {
            let stored = SpooledAzimuth {
                state,
                problem: problem.map(str::to_owned),
                ..sent.clone()
            };
            put(&mut tx, &stored).await?;
        }
        sqlx::query(
            "DELETE FROM azimuths WHERE standing = 'ashore'
             AND number <= (SELECT MAX(number) FROM azimuths) - $1",
        )
        .bind(MAX_LISTED)
        .execute(&mut *tx)
        .await?;
        tx.commit().await
    }
}

/// Inserts or replaces an azimuth.
pub(in crate::spool) async fn put(
    tx: &mut SqliteConnection,
    stored: &SpooledAzimuth,
) -> sqlx::Result<()> {
    let azimuth = serde_json::to_string(&stored.sent).map_err(|e| sqlx::Error::Encode(e.into()))?;
    sqlx::query(
        "INSERT INTO azimuths (id, azimuth, written_micros, standing, problem)
         VALUES ($1, $2, $3, $4, $5)
         ON CONFLICT (id) DO UPDATE
         SET azimuth = excluded.azimuth, written_micros = excluded.written_micros,
             standing = excluded.standing, problem = excluded.problem",
    )
    .bind(stored.id.to_string())
    .bind(azimuth)
    .bind(stored.written_at.micros())
    .bind(stored.state)
    .bind(&stored.problem)
    .execute(tx)
    .await?;
    Ok(())
}

/// Refuses the waiting azimuths of another vessel: they must not go into this one's book.
pub(in crate::spool) async fn refuse_waiting(
    tx: &mut SqliteConnection,
    ship: &str,
) -> sqlx::Result<()> {
    sqlx::query(
        "UPDATE azimuths SET standing = 'refused', problem = $1 WHERE standing = 'waiting'",
    )
    .bind(format!("observed on board {ship}"))
    .execute(tx)
    .await?;
    Ok(())
}

async fn find(tx: &mut SqliteConnection, id: Uuid) -> sqlx::Result<Option<SpooledAzimuth>> {
    let row: Option<Row> = sqlx::query_as(
        "SELECT id, azimuth AS report, written_micros, standing, problem FROM azimuths WHERE id = $1",
    )
    .bind(id.to_string())
    .fetch_optional(tx)
    .await?;
    Ok(row.and_then(read))
}

async fn count_waiting(tx: &mut SqliteConnection) -> sqlx::Result<i64> {
    sqlx::query_scalar("SELECT COUNT(*) FROM azimuths WHERE standing = 'waiting'")
        .fetch_one(tx)
        .await
}

/// Reads a row. An unreadable one is logged and skipped, because it must not block the rest.
pub(in crate::spool) fn read(row: Row) -> Option<SpooledAzimuth> {
    let Row {
        id,
        report: azimuth,
        written_micros,
        standing: state,
        problem,
    } = row;
    let read = || -> anyhow::Result<SpooledAzimuth> {
        Ok(SpooledAzimuth {
            id: id.parse()?,
            sent: serde_json::from_str(&azimuth)?,
            written_at: Timestamp::from_micros(written_micros)?,
            state,
            problem,
        })
    };
    let result = read();
    if let Err(error) = &result {
        tracing::error!(id, %error, "an azimuth in the spool cannot be read");
    }
    result.ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spool::Identity;
    use crate::spool::tests::identity;
    use serde_json::json;
    use tempfile::TempDir;

    const ID: Uuid = Uuid::from_u128(0xa2);

    fn time() -> Timestamp {
        Timestamp::parse("2026-11-21T11:00:00Z").unwrap()
    }

    fn sun(observer: &str, withdrawn: bool) -> BoardAzimuth {
        serde_json::from_value(json!({
            "time": "2026-11-21T10:00:00Z", "lat": 43.4, "lon": -3.1, "kind": "sun_azimuth",
            "compass_heading_deg": 92.0, "compass_bearing_deg": 150.0, "observer": observer,
            "withdrawn": withdrawn,
        }))
        .unwrap()
    }

    #[tokio::test]
    async fn an_azimuth_outlives_the_agent_and_never_changes() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        let first = spool
            .save_azimuth(ID, sun("LW", false), time())
            .await
            .unwrap();
        let same = spool
            .save_azimuth(ID, sun("LW", false), time())
            .await
            .unwrap();
        assert_eq!(same, first);
        let other = spool.save_azimuth(ID, sun("AB", false), time()).await;
        assert!(matches!(other, Err(SaveReportError::Withdrawn)));
        spool.close().await;
        let spool = Spool::open(directory.path()).await.unwrap();
        assert_eq!(spool.next_azimuth().await.unwrap(), Some(first));
    }

    #[tokio::test]
    async fn an_azimuth_that_is_withdrawn_waits_again_and_stays_withdrawn() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        let sent = spool
            .save_azimuth(ID, sun("LW", false), time())
            .await
            .unwrap();
        let back = spool
            .save_azimuth(ID, sun("LW", true), time())
            .await
            .unwrap();
        let stands = BoardAzimuthResponse { withdrawn: false };
        spool.mark_azimuth_delivered(&sent, &stands).await.unwrap();
        assert_eq!(spool.next_azimuth().await.unwrap(), Some(back.clone()));
        let again = spool.save_azimuth(ID, sun("LW", false), time()).await;
        assert!(matches!(again, Err(SaveReportError::Withdrawn)));
        let gone = BoardAzimuthResponse { withdrawn: true };
        spool.mark_azimuth_delivered(&back, &gone).await.unwrap();
        assert_eq!(spool.next_azimuth().await.unwrap(), None);
        assert_eq!(spool.azimuths().await.unwrap()[0].problem, None);
    }

    #[tokio::test]
    async fn an_azimuth_does_not_go_into_another_ships_book() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        spool.enrol(&identity(7)).await.unwrap();
        spool
            .save_azimuth(ID, sun("LW", false), time())
            .await
            .unwrap();
        let other = Identity {
            vessel_name: "Kogge".to_owned(),
            ..identity(9)
        };
        spool.enrol(&other).await.unwrap();
        assert_eq!(spool.next_azimuth().await.unwrap(), None);
        let problem = spool.azimuths().await.unwrap()[0].problem.clone();
        assert_eq!(problem.as_deref(), Some("observed on board Txori"));
    }
}
