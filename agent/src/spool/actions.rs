//! Record of what people altered on board: on the page, and by the command line.

use super::database::Spool;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use sqlx::SqliteConnection;

/// Number of actions that are kept: some years of a usual ship.
const MAX_KEPT: i64 = 10_000;

/// Action of a person on board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BoardAction {
    /// Time on board.
    pub(crate) at: Timestamp,
    /// Address of the browser, or `command line`.
    pub(crate) address: String,
    /// Description of the action.
    pub(crate) action: String,
    /// `done`, or the reason why not.
    pub(crate) result: String,
}

#[derive(sqlx::FromRow)]
pub(super) struct Row {
    at_micros: i64,
    address: String,
    action: String,
    result: String,
}

impl Row {
    pub(super) fn read(self) -> sqlx::Result<BoardAction> {
        let at = Timestamp::from_micros(self.at_micros);
        Ok(BoardAction {
            at: at.map_err(|error| sqlx::Error::Decode(error.into()))?,
            address: self.address,
            action: self.action,
            result: self.result,
        })
    }
}

impl Spool {
    /// Records an action.
    pub(crate) async fn record_action(
        &self,
        at: Timestamp,
        address: &str,
        action: &str,
        result: &str,
    ) -> sqlx::Result<()> {
        let action = BoardAction {
            at,
            address: address.to_owned(),
            action: action.to_owned(),
            result: result.to_owned(),
        };
        let mut tx = self.write().await?;
        put(&mut tx, &action).await?;
        sqlx::query("DELETE FROM actions WHERE number <= (SELECT MAX(number) FROM actions) - $1")
            .bind(MAX_KEPT)
            .execute(&mut *tx)
            .await?;
        tx.commit().await
    }

    /// Lists the last actions, the latest first.
    pub(crate) async fn actions(&self, limit: u32) -> sqlx::Result<Vec<BoardAction>> {
        let rows: Vec<Row> = sqlx::query_as(
            "SELECT at_micros, address, action, result FROM actions
             ORDER BY number DESC LIMIT $1",
        )
        .bind(limit)
        .fetch_all(&self.pool)
        .await?;
        rows.into_iter().map(Row::read).collect()
    }
}

pub(super) async fn put(
    connection: &mut SqliteConnection,
    action: &BoardAction,
) -> sqlx::Result<()> {
    sqlx::query("INSERT INTO actions (at_micros, address, action, result) VALUES ($1, $2, $3, $4)")
        .bind(action.at.micros())
        .bind(&action.address)
        .bind(&action.action)
        .bind(&action.result)
        .execute(connection)
        .await?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    #[tokio::test]
    async fn actions_are_kept_in_their_order() {
        let directory = TempDir::new().unwrap();
        let spool = Spool::open(directory.path()).await.unwrap();
        let at = Timestamp::parse("2026-11-21T07:00:00Z").unwrap();
        for action in ["hold: berthed", "hold ended"] {
            let recorded = spool.record_action(at, "192.168.1.9", action, "done");
            recorded.await.unwrap();
        }
        let last = spool.actions(1).await.unwrap();
        assert_eq!(last.len(), 1);
        assert_eq!((last[0].at, last[0].action.as_str()), (at, "hold ended"));
        assert_eq!(spool.actions(9).await.unwrap().len(), 2);
    }
}
