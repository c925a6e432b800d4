//! Single values of the spool: the downlink, the alert, the budget, clocks and exclusions.

use super::account::BudgetAccount;
use super::database::{Spool, forget, put, text};
use super::keys::{
    ACCOUNT, ALERT, CLOCK_CHECKPOINT, EXCLUSION, HEADING_DIFFERENCE, LAST_CONTACT, MODEL,
    PLACE_CHECKPOINT, SETTINGS, WITHDRAWN,
};
use crate::alert::{AlertRecord, HeadingDifference};
use crate::sampler::Exclusion;
use binnacle_compass::time::Timestamp;
use binnacle_instruments::{ClockCheckpoint, PlaceCheckpoint};
use binnacle_wire::messages::{CardWithdrawn, Downlink, ModelDownlink, Settings};
use sqlx::SqliteConnection;

impl Spool {
    /// Returns the last model from the server.
    pub(crate) async fn model(&self) -> sqlx::Result<Option<ModelDownlink>> {
        self.get(MODEL).await
    }

    /// Returns the withdrawal of that model.
    pub(crate) async fn card_withdrawn(&self) -> sqlx::Result<Option<CardWithdrawn>> {
        self.get(WITHDRAWN).await
    }

    /// Returns the last settings from the server, or the defaults.
    pub(crate) async fn settings(&self) -> sqlx::Result<Settings> {
        Ok(self.get(SETTINGS).await?.unwrap_or_default())
    }

    /// Saves a response of the server.
    pub(crate) async fn save_downlink(&self, downlink: &Downlink) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        save_downlink(&mut tx, downlink).await?;
        tx.commit().await
    }

    /// Returns the agent's own last alert.
    pub(crate) async fn alert(&self) -> sqlx::Result<Option<AlertRecord>> {
        self.get(ALERT).await
    }

    /// Saves the parts of the alert that only matter on board.
    pub(crate) async fn save_alert(&self, record: &AlertRecord) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, ALERT, record).await?;
        tx.commit().await
    }

    /// Returns the last heading-difference alarm.
    pub(crate) async fn heading_difference(&self) -> sqlx::Result<Option<HeadingDifference>> {
        self.get(HEADING_DIFFERENCE).await
    }

    /// Saves the heading-difference alarm.
    pub(crate) async fn save_heading_difference(
        &self,
        alarm: &HeadingDifference,
    ) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, HEADING_DIFFERENCE, alarm).await?;
        tx.commit().await
    }

    /// Returns the balance of the budget.
    pub(crate) async fn account(&self) -> sqlx::Result<Option<BudgetAccount>> {
        self.get(ACCOUNT).await
    }

    /// Saves the balance of the budget.
    pub(crate) async fn save_account(&self, account: &BudgetAccount) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, ACCOUNT, account).await?;
        tx.commit().await
    }

    /// Returns the last saved readings of both clocks.
    pub(crate) async fn clock_checkpoint(&self) -> sqlx::Result<Option<ClockCheckpoint>> {
        self.get(CLOCK_CHECKPOINT).await
    }

    /// Saves the readings of both clocks.
    pub(crate) async fn save_clock_checkpoint(
        &self,
        clock_checkpoint: &ClockCheckpoint,
    ) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, CLOCK_CHECKPOINT, clock_checkpoint).await?;
        tx.commit().await
    }

    /// Returns the last saved place of the ship.
    pub(crate) async fn place_checkpoint(&self) -> sqlx::Result<Option<PlaceCheckpoint>> {
        self.get(PLACE_CHECKPOINT).await
    }

    /// Saves the place of the ship.
    pub(crate) async fn save_place_checkpoint(&self, place: &PlaceCheckpoint) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, PLACE_CHECKPOINT, place).await?;
        tx.commit().await
    }

    /// Returns the time of the server's last response, by its clock.
    pub(crate) async fn last_contact(&self) -> sqlx::Result<Option<Timestamp>> {
        self.get(LAST_CONTACT).await
    }

    /// Returns the crew's exclusion. An unreadable one still excludes: better one sample less than
    /// one disturbed by the quay.
    pub(crate) async fn exclusion(&self) -> sqlx::Result<Option<Exclusion>> {
        let mut connection = self.pool.acquire().await?;
        let Some(text) = text(&mut connection, EXCLUSION).await? else {
            return Ok(None);
        };
        Ok(serde_json::from_str(&text).unwrap_or_else(|error| {
            tracing::error!(%error, "the hold in the spool cannot be read and counts as berthed");
            Some(Exclusion::Berthed)
        }))
    }

    /// Saves the crew's exclusion.
    pub(crate) async fn set_exclusion(&self, exclusion: Option<Exclusion>) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, EXCLUSION, &exclusion).await?;
        tx.commit().await
    }
}

/// Saves a response except the contiguous number, which only the response to a batch is sure to
/// know.
pub(super) async fn save_downlink(
    connection: &mut SqliteConnection,
    downlink: &Downlink,
) -> sqlx::Result<()> {
    put(connection, LAST_CONTACT, &downlink.server_time).await?;
    if let Some(model) = &downlink.model {
        put(connection, MODEL, model).await?;
    }
    match &downlink.card_withdrawn {
        Some(withdrawn) => put(connection, WITHDRAWN, withdrawn).await?,
        None => forget(connection, WITHDRAWN).await?,
    }
    if let Some(settings) = &downlink.settings {
        put(connection, SETTINGS, settings).await?;
    }
    Ok(())
}
