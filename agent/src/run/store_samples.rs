//! Storage of settled samples in the spool, sealed when due, and upkeep of the spool.

use super::Agent;
use crate::clock;
use crate::sampler::Tally;
use crate::spool::{MAX_PENDING, Seal, is_disk_full};
use crate::uplink::LinkState;
use binnacle_compass::time::Timestamp;
use binnacle_instruments::ClockCheckpoint;
use binnacle_wire::messages::Settings;
use tokio::time::Instant;

/// Interval of batches without samples, by GNSS time.
const TALLY_INTERVAL_S: f64 = 86_400.0;
/// Limit on samples in memory while the disk accepts nothing.
const MAX_UNSTORED: usize = 20_000;

impl Agent {
    /// Returns whether a batch is due by GNSS time, in either direction after a jump.
    pub(super) fn seal_due(&self) -> Seal {
        let Some(now) = self.acquisition.time() else {
            return Seal::Full;
        };
        let seal_s = f64::from(self.seal_s());
        let older = |since: Option<Timestamp>, seconds: f64| {
            since.is_some_and(|since| now.seconds_since(since).abs() >= seconds)
        };
        let first = self.unstored.samples.first().map(|sample| sample.time);
        let due = older(self.unstored.pending.since, seal_s)
            || older(first, seal_s)
            || older(self.unstored.tally_since, TALLY_INTERVAL_S.max(seal_s));
        if due { Seal::All } else { Seal::Full }
    }

    /// Returns the profile's upload interval, unless the server sets another than the default.
    fn seal_s(&self) -> u32 {
        let asked = self.uplink_handle.settings.borrow().seal_s;
        if asked == Settings::default().seal_s {
            self.plan.seal_s
        } else {
            asked
        }
    }

    pub(super) async fn store(&mut self, seal: Seal) {
        self.uplink_handle
            .ship_time
            .send_replace(self.acquisition.time());
        let unstored = &mut self.unstored;
        let tally = unstored.tally.by_name();
        let has_evidence = !unstored.alerts.is_empty();
        let stored = if has_evidence {
            let record = self.alert_monitor.record();
            let (samples, alerts) = (&unstored.samples, &unstored.alerts);
            let spool = &self.spool;
            spool.store_evidence(samples, &tally, alerts, record).await
        } else {
            self.spool.store(&unstored.samples, &tally, seal).await
        };
        match stored {
            Ok((pending, sealed)) => {
                unstored.problem = None;
                if has_evidence {
                    self.stored_alert = self.alert_monitor.record().copied();
                    unstored.alerts.clear();
                    self.uplink_handle.urgent.notify_one();
                }
                unstored.samples.clear();
                unstored.tally = Tally::default();
                unstored.pending = pending;
                if has_evidence || seal == Seal::All {
                    unstored.tally_since = self.acquisition.time();
                }
                if sealed > 0 || unstored.pending.samples > MAX_PENDING {
                    self.limit_spool().await;
                }
                if sealed > 0 {
                    self.save_checkpoints().await;
                    self.uplink_handle.sealed.notify_one();
                }
            }
            Err(error) => {
                let problem = error.to_string();
                if unstored.problem.as_ref() != Some(&problem) {
                    let waiting = unstored.samples.len();
                    tracing::error!(problem, waiting, "samples cannot be stored");
                }
                unstored.problem = Some(problem);
                if is_disk_full(&error) {
                    self.raw_log
                        .release_disk(&error.to_string(), Instant::now());
                }
                let excess = unstored.samples.len().saturating_sub(MAX_UNSTORED);
                unstored.samples.drain(..excess);
            }
        }
    }

    /// Saves both clocks and the place for the first fix after a restart.
    pub(super) async fn save_checkpoints(&self) {
        if let Err(error) = self.store_checkpoints().await {
            tracing::error!(%error, "clocks and place cannot be stored");
        }
    }

    async fn store_checkpoints(&self) -> sqlx::Result<()> {
        let computer = clock::now();
        if let Some(ship) = self.acquisition.reliable_time() {
            let clocks = ClockCheckpoint { ship, computer };
            self.spool.save_clock_checkpoint(&clocks).await?;
        }
        if let Some(place) = self.acquisition.place_checkpoint(computer) {
            self.spool.save_place_checkpoint(&place).await?;
        }
        Ok(())
    }

    /// Merges and thins batches to the limits of disk, messages and budget.
    async fn limit_spool(&self) {
        let merged = if self.batches_wait() {
            self.spool.merge_last_two().await
        } else {
            Ok(())
        };
        let within_disk = self.spool.shrink_to_limit(self.spool_limit_bytes).await;
        let within_messages = match self.plan.max_batch_bytes() {
            Some(bytes) => self.spool.thin_batches_to(bytes).await,
            None => Ok(()),
        };
        let within_budget = match self.plan.max_backlog_bytes() {
            Some(bytes) => self.spool.thin_backlog(bytes).await,
            None => Ok(()),
        };
        if let Err(error) = merged
            .and(within_messages)
            .and(within_disk)
            .and(within_budget)
        {
            tracing::error!(%error, "the spool cannot be merged or thinned");
        }
    }

    /// Returns whether batches wait before they are sent, other than for messages.
    fn batches_wait(&self) -> bool {
        let is_up = self.uplink_handle.link.borrow().state == LinkState::Up;
        self.plan.max_batch_bytes().is_none() && (!is_up || self.plan.daily_bytes.is_some())
    }
}
