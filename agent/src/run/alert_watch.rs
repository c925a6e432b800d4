//! The alert, from settled windows to the spool.

use super::Agent;
use super::bridge_alerts::new_id;
use crate::alert::ActiveCard;
use binnacle_wire::alert::ShipAlert;

impl Agent {
    /// Passes newly settled windows to the alert monitor; a revision ends the current sample.
    pub(super) fn update_alert(&mut self) {
        let withdrawn = self.card_withdrawal();
        let model = self.uplink_handle.model.borrow();
        let card = ActiveCard {
            model: model.as_ref(),
            withdrawn: withdrawn.as_ref(),
        };
        let settled = self.acquisition.sampler.take_settled();
        let revisions = settled
            .iter()
            .filter_map(|w| self.alert_monitor.observe(w, card, new_id));
        let mut revisions: Vec<ShipAlert> = revisions.collect();
        let now = self.acquisition.time();
        revisions.extend(now.and_then(|now| self.alert_monitor.update_card(card, now)));
        if revisions.is_empty() {
            return;
        }
        if let Some(record) = self.alert_monitor.record() {
            tracing::warn!("{}", record.status().summary);
        }
        self.acquisition.sampler.cut_sample();
        self.unstored.alerts.extend(revisions);
    }

    /// Stores the parts of the alert that only matter on board.
    pub(super) async fn save_alert(&mut self) {
        let Some(record) = self.alert_monitor.record().copied() else {
            return;
        };
        if self.stored_alert == Some(record) || !self.unstored.alerts.is_empty() {
            return;
        }
        match self.spool.save_alert(&record).await {
            Ok(()) => self.stored_alert = Some(record),
            Err(error) => tracing::error!(%error, "the alert cannot be stored"),
        }
    }
}
