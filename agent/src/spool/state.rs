//! Single values of the spool: the downlink, the alert, the budget, clocks and exclusions.

use super::account::BudgetAccount;
use super::database::{Spool, forget, put, text};
use super::keys::{
    ACCOUNT, ALERT, CLOCK_CHECKPOINT, EXCLUSION, LAST_CONTACT, MODEL, PAGE, SETTINGS, WITHDRAWN,
};
use crate::alert::AlertRecord;
use crate::instruments::ClockCheckpoint;
use crate::sampler::Exclusion;
use binnacle_magnetics::time::Timestamp;
use binnacle_wire::messages::{CardWithdrawn, Downlink, ModelDownlink, Settings};
use sqlx::SqliteConnection;
use std::net::SocketAddr;

impl Spool {
    /// The last model from shore.
    pub(crate) async fn model(&self) -> sqlx::Result<Option<ModelDownlink>> {
        self.get(MODEL).await
    }

    /// Why that model holds no more.
    pub(crate) async fn card_withdrawn(&self) -> sqlx::Result<Option<CardWithdrawn>> {
        self.get(WITHDRAWN).await
    }

    /// The last settings from shore, or the built-in ones.
    pub(crate) async fn settings(&self) -> sqlx::Result<Settings> {
        Ok(self.get(SETTINGS).await?.unwrap_or_default())
    }

    /// Keeps what the shore sent.
    pub(crate) async fn save_downlink(&self, downlink: &Downlink) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        save_downlink(&mut tx, downlink).await?;
        tx.commit().await
    }

    /// The last alert of the agent's own.
    pub(crate) async fn alert(&self) -> sqlx::Result<Option<AlertRecord>> {
        self.get(ALERT).await
    }

    /// Keeps what is known of the alert aboard alone.
    pub(crate) async fn save_alert(&self, record: &AlertRecord) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, ALERT, record).await?;
        tx.commit().await
    }

    /// What is left of the budget of the link.
    pub(crate) async fn account(&self) -> sqlx::Result<Option<BudgetAccount>> {
        self.get(ACCOUNT).await
    }

    /// Keeps what is left of the budget.
    pub(crate) async fn save_account(&self, account: &BudgetAccount) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, ACCOUNT, account).await?;
        tx.commit().await
    }

    /// What both clocks said when it was last noted.
    pub(crate) async fn clock_checkpoint(&self) -> sqlx::Result<Option<ClockCheckpoint>> {
        self.get(CLOCK_CHECKPOINT).await
    }

    /// Notes what both clocks say.
    pub(crate) async fn save_clock_checkpoint(
        &self,
        clock_checkpoint: &ClockCheckpoint,
    ) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, CLOCK_CHECKPOINT, clock_checkpoint).await?;
        tx.commit().await
    }

    /// When the shore last answered, by its clock.
    pub(crate) async fn last_contact(&self) -> sqlx::Result<Option<Timestamp>> {
        self.get(LAST_CONTACT).await
    }

    /// The crew's hold. One that cannot be read is still a hold: a sample less
    /// is better than one of the quay.
    pub(crate) async fn exclusion(&self) -> sqlx::Result<Option<Exclusion>> {
        let mut connection = self.pool.acquire().await?;
        let Some(text) = text(&mut connection, EXCLUSION).await? else {
            return Ok(None);
        };
        Ok(serde_json::from_str(&text).unwrap_or_else(|error| {
            tracing::error!(%error, "the hold in the spool cannot be read; it counts as berthed");
            Some(Exclusion::Berthed)
        }))
    }

    /// Keeps the crew's hold.
    pub(crate) async fn set_exclusion(&self, exclusion: Option<Exclusion>) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, EXCLUSION, &exclusion).await?;
        tx.commit().await
    }

    /// Where the running agent's page is, for the command line.
    pub(crate) async fn page_address(&self) -> sqlx::Result<Option<SocketAddr>> {
        Ok(self.get(PAGE).await?.flatten())
    }

    /// Notes where the page is, or that there is none.
    pub(crate) async fn set_page_address(&self, address: Option<SocketAddr>) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        put(&mut tx, PAGE, &address).await?;
        tx.commit().await
    }
}

/// All but how far the shore has come, which only the answer to a batch is sure to know.
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
