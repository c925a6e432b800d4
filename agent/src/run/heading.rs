//! The corrected heading, from the latest readings to the outputs.

use super::Agent;
use crate::alert::AlertRecord;
use crate::corrected_heading::{self, CardRow, CorrectedHeading, CorrectionInputs};
use crate::instruments::Latest;
use crate::output::{Quality, heading_sentences};
use crate::status::ModelStatus;
use crate::{card_invalidation, clock};
use binnacle_wire::messages::CardWithdrawn;
use std::time::Duration;
use tokio::time::Instant;

/// Age up to which a position serves: variation at twenty knots changes by less than a tenth of a
/// degree meanwhile.
const POSITION_MAX_AGE: Duration = Duration::from_mins(10);

impl Agent {
    /// Returns the withdrawal of the card, by the server or by officers' reports.
    pub(super) fn card_withdrawal(&self) -> Option<CardWithdrawn> {
        let by_shore = self.uplink_handle.withdrawn.borrow().clone();
        by_shore.or_else(|| {
            let model = self.uplink_handle.model.borrow();
            let now = self.acquisition.time().unwrap_or_else(clock::now);
            card_invalidation::find_invalidation(model.as_ref()?, &self.reports, now)
        })
    }

    pub(super) fn correct(&self) -> (CorrectedHeading, Vec<CardRow>) {
        let withdrawn = self.card_withdrawal();
        let model = self.uplink_handle.model.borrow();
        let now = Instant::now();
        let readings = &self.acquisition.readings;
        let inputs = CorrectionInputs {
            compass: Latest::within(readings.compass, self.silence.stale_s.duration(), now),
            position: Latest::within(readings.position, POSITION_MAX_AGE, now),
            time: self.acquisition.time(),
            model: model.as_ref(),
            withdrawn: withdrawn.as_ref(),
            compass_suspected: self
                .alert_monitor
                .record()
                .is_some_and(AlertRecord::suspects_compass),
            withheld: self.withheld,
        };
        (
            corrected_heading::correct(inputs),
            corrected_heading::card(inputs),
        )
    }

    pub(super) fn send_heading(&mut self) {
        let (corrected, _) = self.correct();
        self.withheld = corrected.is_withheld();
        let quality = self.model_status().map(|model| Quality {
            version: model.version,
            age_days: model.age_days.unwrap_or_default(),
        });
        let mut sentences = heading_sentences(&corrected, quality);
        if let Some(alarm) = &mut self.alarm {
            let due = alarm.due(self.alert_monitor.record(), Instant::now());
            sentences.extend(due.into_iter().flatten());
        }
        self.outputs.send(sentences);
    }

    pub(super) fn model_status(&self) -> Option<ModelStatus> {
        let withdrawn = self.card_withdrawal();
        let model = self.uplink_handle.model.borrow();
        let model = model.as_ref()?;
        let now = self.acquisition.time().unwrap_or_else(clock::now);
        Some(ModelStatus {
            version: model.version,
            data_until: model.data_until,
            age_days: Some(now.seconds_since(model.data_until).max(0.0) / 86_400.0),
            withdrawn,
            replaces: model.replaces.clone(),
            reference_grade: model.model.reference_grade,
        })
    }
}
