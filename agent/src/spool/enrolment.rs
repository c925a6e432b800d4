//! Enrolment of the agent for a compass.

use super::database::{Spool, get, put};
use super::identity::Identity;
use super::keys::{ALERT, IDENTITY, MODEL, SETTINGS, WITHDRAWN};
use super::reports::azimuths;
use super::{batches, reports};

impl Spool {
    /// Enrols the agent in another stream: batches that were not acknowledged are renumbered in it.
    /// Model and settings of another compass are deleted, because nobody must steer by them.
    pub(crate) async fn enrol(&self, identity: &Identity) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        let before = get::<Identity>(&mut tx, IDENTITY).await?;
        if let Some(before) = &before
            && before.vessel_name != identity.vessel_name
        {
            reports::refuse_waiting(&mut tx, &before.vessel_name).await?;
            azimuths::refuse_waiting(&mut tx, &before.vessel_name).await?;
        }
        if before.is_some_and(|before| !before.is_same_compass(identity)) {
            sqlx::query("DELETE FROM state WHERE name IN ($1, $2, $3, $4)")
                .bind(MODEL)
                .bind(WITHDRAWN)
                .bind(SETTINGS)
                .bind(ALERT)
                .execute(&mut *tx)
                .await?;
        }
        batches::renumber(&mut tx, identity.stream).await?;
        put(&mut tx, IDENTITY, identity).await?;
        tx.commit().await
    }
}
