//! Officers' reports for the logbook, until they are delivered and for a while after.
//!
//! Invariants: a report keeps the id it was given on board. A change raises its revision and makes
//! it wait again. A response counts only for the revision that was sent.

pub(super) mod azimuths;

use super::database::Spool;
use binnacle_compass::time::Timestamp;
use binnacle_wire::logbook::Report;
use binnacle_wire::messages::{LogbookReport, LogbookResponse};
use serde::{Deserialize, Serialize};
use sqlx::SqliteConnection;
use uuid::Uuid;

/// Number of listed reports; older delivered ones are deleted.
const MAX_LISTED: i64 = 100;
/// Limit on waiting reports: more than anybody writes on a voyage, so more means abuse.
const MAX_WAITING: i64 = 1000;
/// Problem of a report that was withdrawn on the server.
const WITHDRAWN_BY_SERVER: &str = "withdrawn ashore";

/// A report and its delivery.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredReport {
    pub(crate) id: Uuid,
    #[serde(flatten)]
    pub(crate) sent: LogbookReport,
    /// Time of the last change.
    pub(crate) written_at: Timestamp,
    #[serde(rename = "standing")]
    pub(crate) state: ReportState,
    /// Reason for a refusal, or its withdrawal on the server.
    pub(crate) problem: Option<String>,
}

impl StoredReport {
    /// Returns whether the report is withdrawn, on board or on the server.
    pub(crate) fn is_withdrawn(&self) -> bool {
        self.sent.withdrawn || self.problem.as_deref() == Some(WITHDRAWN_BY_SERVER)
    }
}

/// Delivery of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(rename_all = "snake_case")]
pub(crate) enum ReportState {
    /// Waiting to be sent.
    Waiting,
    /// In the logbook.
    Ashore,
    /// Refused by the server: the officer must change it.
    Refused,
}

/// Reason that a report was not stored.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SaveReportError {
    /// The report is withdrawn.
    #[error("this report was withdrawn; write a new one")]
    Withdrawn,
    /// Too many reports are waiting.
    #[error("{MAX_WAITING} reports are already waiting for the link")]
    TooMany,
    /// The spool failed.
    #[error("the report cannot be stored")]
    Spool(#[from] sqlx::Error),
}

/// Row of a report, or of an azimuth under the same names.
#[derive(sqlx::FromRow)]
pub(super) struct Row {
    id: String,
    report: String,
    written_micros: i64,
    standing: ReportState,
    problem: Option<String>,
}

impl Spool {
    /// Stores a report, or a change of one; an identical report changes nothing.
    pub(crate) async fn save_report(
        &self,
        id: Uuid,
        report: Report,
        reporter: String,
        withdrawn: bool,
        now: Timestamp,
    ) -> Result<StoredReport, SaveReportError> {
        let mut tx = self.write().await?;
        let before = find(&mut tx, id).await?;
        let revision = before.as_ref().map_or(0, |before| before.sent.revision) + 1;
        let sent = LogbookReport {
            revision,
            reporter,
            withdrawn,
            report,
        };
        if let Some(before) = before {
            let same = LogbookReport {
                revision: before.sent.revision,
                ..sent.clone()
            };
            if before.sent == same {
                return Ok(before);
            }
            if before.sent.withdrawn {
                return Err(SaveReportError::Withdrawn);
            }
        } else if count_waiting(&mut tx).await? >= MAX_WAITING {
            return Err(SaveReportError::TooMany);
        }
        let stored = StoredReport {
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

    /// Returns the latest reports, newest first.
    pub(crate) async fn reports(&self) -> sqlx::Result<Vec<StoredReport>> {
        let rows: Vec<Row> = sqlx::query_as(
            "SELECT id, report, written_micros, standing, problem FROM reports
             ORDER BY number DESC LIMIT $1",
        )
        .bind(MAX_LISTED)
        .fetch_all(&self.pool)
        .await?;
        Ok(rows.into_iter().filter_map(read).collect())
    }

    /// Returns the first report that waits to be sent.
    pub(crate) async fn next_report(&self) -> sqlx::Result<Option<StoredReport>> {
        let rows: Vec<Row> = sqlx::query_as(
            "SELECT id, report, written_micros, standing, problem FROM reports
             WHERE standing = 'waiting' ORDER BY number",
        )
        .fetch_all(&self.pool)
        .await?;
        Ok(rows.into_iter().find_map(read))
    }

    /// Marks a revision of a report as delivered.
    pub(crate) async fn mark_report_delivered(
        &self,
        sent: &StoredReport,
        response: &LogbookResponse,
    ) -> sqlx::Result<()> {
        let withdrawn = response.withdrawn && !sent.sent.withdrawn;
        let problem = withdrawn.then_some(WITHDRAWN_BY_SERVER);
        self.set_report_state(sent, ReportState::Ashore, problem)
            .await
    }

    /// Marks a revision of a report as refused for good.
    pub(crate) async fn mark_report_refused(
        &self,
        sent: &StoredReport,
        problem: &str,
    ) -> sqlx::Result<()> {
        self.set_report_state(sent, ReportState::Refused, Some(problem))
            .await
    }

    async fn set_report_state(
        &self,
        sent: &StoredReport,
        state: ReportState,
        problem: Option<&str>,
    ) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        // A report changed meanwhile is not the one that was sent.
        if find(&mut tx, sent.id).await?.as_ref() == Some(sent) {
            let stored = StoredReport {
                state,
                problem: problem.map(str::to_owned),
                ..sent.clone()
            };
            put(&mut tx, &stored).await?;
        }
        sqlx::query(
            "DELETE FROM reports WHERE standing = 'ashore'
             AND number <= (SELECT MAX(number) FROM reports) - $1",
        )
        .bind(MAX_LISTED)
        .execute(&mut *tx)
        .await?;
        tx.commit().await
    }
}

/// Inserts or replaces a report.
pub(super) async fn put(tx: &mut SqliteConnection, stored: &StoredReport) -> sqlx::Result<()> {
    let report = serde_json::to_string(&stored.sent).map_err(|e| sqlx::Error::Encode(e.into()))?;
    sqlx::query(
        "INSERT INTO reports (id, report, written_micros, standing, problem)
         VALUES ($1, $2, $3, $4, $5)
         ON CONFLICT (id) DO UPDATE
         SET report = excluded.report, written_micros = excluded.written_micros,
             standing = excluded.standing, problem = excluded.problem",
    )
    .bind(stored.id.to_string())
    .bind(report)
    .bind(stored.written_at.micros())
    .bind(stored.state)
    .bind(&stored.problem)
    .execute(tx)
    .await?;
    Ok(())
}

/// Refuses the waiting reports of another vessel: they must not go into this one's logbook.
pub(super) async fn refuse_waiting(tx: &mut SqliteConnection, ship: &str) -> sqlx::Result<()> {
    sqlx::query("UPDATE reports SET standing = 'refused', problem = $1 WHERE standing = 'waiting'")
        .bind(format!("reported on board {ship}"))
        .execute(tx)
        .await?;
    Ok(())
}

async fn find(tx: &mut SqliteConnection, id: Uuid) -> sqlx::Result<Option<StoredReport>> {
    let row: Option<Row> = sqlx::query_as(
        "SELECT id, report, written_micros, standing, problem FROM reports WHERE id = $1",
    )
    .bind(id.to_string())
    .fetch_optional(tx)
    .await?;
    Ok(row.and_then(read))
}

async fn count_waiting(tx: &mut SqliteConnection) -> sqlx::Result<i64> {
    sqlx::query_scalar("SELECT COUNT(*) FROM reports WHERE standing = 'waiting'")
        .fetch_one(tx)
        .await
}

/// Reads a row. An unreadable one is logged and skipped, because it must not block the rest.
pub(super) fn read(row: Row) -> Option<StoredReport> {
    let Row {
        id,
        report,
        written_micros,
        standing: state,
        problem,
    } = row;
    let read = || -> anyhow::Result<StoredReport> {
        Ok(StoredReport {
            id: id.parse()?,
            sent: serde_json::from_str(&report)?,
            written_at: Timestamp::from_micros(written_micros)?,
            state,
            problem,
        })
    };
    let result = read();
    if let Err(error) = &result {
        tracing::error!(id, %error, "a report in the spool cannot be read");
    }
    result.ok()
}

#[cfg(test)]
mod tests {
    use super::super::tests::identity;
    use super::*;
    use crate::spool::Identity;
    use serde_json::json;
    use tempfile::TempDir;

    const ID: Uuid = Uuid::from_u128(0xb1);

    fn time() -> Timestamp {
        Timestamp::parse("2026-11-21T07:00:00Z").unwrap()
    }

    fn lightning(note: &str) -> Report {
        serde_json::from_value(json!({
            "kind": "lightning", "from": "2026-11-21T06:00:00Z", "note": note,
        }))
        .unwrap()
    }

    async fn keep(
        spool: &Spool,
        note: &str,
        withdrawn: bool,
    ) -> Result<StoredReport, SaveReportError> {
        let report = lightning(note);
        spool
            .save_report(ID, report, "Li".to_owned(), withdrawn, time())
            .await
    }

    fn accepted_response(revision: u32) -> LogbookResponse {
        LogbookResponse {
            revision,
            withdrawn: false,
        }
    }

    #[tokio::test]
    async fn a_report_outlives_the_agent_and_the_same_again_is_one() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        let first = keep(&spool, "a", false).await.unwrap();
        assert_eq!(keep(&spool, "a", false).await.unwrap(), first);
        spool.close().await;
        let spool = Spool::open(directory.path()).await.unwrap();
        assert_eq!(spool.next_report().await.unwrap(), Some(first.clone()));
        assert_eq!(spool.reports().await.unwrap(), [first]);
    }

    #[tokio::test]
    async fn a_report_that_was_changed_while_it_was_sent_waits_again() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        let sent = keep(&spool, "a", false).await.unwrap();
        let changed = keep(&spool, "b", false).await.unwrap();
        assert_eq!(changed.sent.revision, 2);
        spool
            .mark_report_delivered(&sent, &accepted_response(1))
            .await
            .unwrap();
        assert_eq!(spool.next_report().await.unwrap(), Some(changed.clone()));
        spool
            .mark_report_delivered(&changed, &accepted_response(2))
            .await
            .unwrap();
        assert_eq!(spool.next_report().await.unwrap(), None);
        assert_eq!(spool.reports().await.unwrap()[0].state, ReportState::Ashore);
    }

    #[tokio::test]
    async fn what_was_taken_back_stays_so() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        keep(&spool, "a", false).await.unwrap();
        let back = keep(&spool, "a", true).await.unwrap();
        assert_eq!(keep(&spool, "a", true).await.unwrap(), back);
        let error = keep(&spool, "b", false).await.unwrap_err();
        assert!(matches!(error, SaveReportError::Withdrawn));
        assert_eq!(spool.next_report().await.unwrap(), Some(back));
    }

    #[tokio::test]
    async fn a_report_does_not_go_into_another_ships_logbook() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        spool.enrol(&identity(7)).await.unwrap();
        keep(&spool, "a", false).await.unwrap();
        spool.enrol(&identity(8)).await.unwrap();
        assert!(
            spool.next_report().await.unwrap().is_some(),
            "the same ship"
        );
        let other = Identity {
            vessel_name: "Kogge".to_owned(),
            ..identity(9)
        };
        spool.enrol(&other).await.unwrap();
        assert_eq!(spool.next_report().await.unwrap(), None);
        let problem = spool.reports().await.unwrap()[0].problem.clone();
        assert_eq!(problem.as_deref(), Some("reported on board Txori"));
    }

    #[tokio::test]
    async fn reports_that_are_ashore_are_forgotten_in_time_and_others_never() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        keep(&spool, "waits", false).await.unwrap();
        for number in 0..120 {
            let (id, reporter) = (Uuid::from_u128(1000 + number), String::new());
            let report = lightning("x");
            let stored = spool.save_report(id, report, reporter, false, time());
            spool
                .mark_report_delivered(&stored.await.unwrap(), &accepted_response(1))
                .await
                .unwrap();
        }
        assert_eq!(spool.reports().await.unwrap().len(), 100);
        assert_eq!(spool.next_report().await.unwrap().unwrap().id, ID);
    }
}
