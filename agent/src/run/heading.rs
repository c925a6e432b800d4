//! The corrected heading, from the latest readings to the outputs.

use super::Agent;
use crate::alert::AlertRecord;
use crate::corrected_heading::{self, CardRow, CorrectedHeading, CorrectionInputs};
use crate::instruments::{Latest, SentHeading};
use crate::output::Quality;
use crate::status::ModelStatus;
use crate::{card_invalidation, clock};
use binnacle_wire::messages::CardWithdrawn;
use tokio::time::Instant;

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

    pub(super) fn correct(&mut self) -> (CorrectedHeading, Vec<CardRow>) {
        let place = self.acquisition.place(Instant::now());
        let withdrawn = self.card_withdrawal();
        let model = self.uplink_handle.model.borrow();
        let now = Instant::now();
        let readings = &self.acquisition.readings;
        let compass_age = self.silence.compass_steering(readings.compass_interval());
        let is_silent = self
            .silence
            .position_steering()
            .is_some_and(|age| Latest::within(readings.position, age, now).is_none());
        let inputs = CorrectionInputs {
            compass: Latest::within(readings.compass, compass_age, now),
            compass_is_mixed: readings.compass_is_mixed,
            place: place.filter(|_| !is_silent),
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
        self.acquisition.note_corrected(corrected.true_deg);
        let quality = self.model_status().map(|model| Quality {
            version: model.version,
            age_days: model.age_days.unwrap_or_default(),
        });
        if let Some(sent) = sent_heading(&corrected) {
            self.acquisition.note_sent(sent, Instant::now());
        }
        let mut sentences = self.sentences.due(&corrected, quality, Instant::now());
        if let Some(alarm) = &mut self.alarm {
            let due = alarm.due(self.alert_monitor.record(), Instant::now());
            sentences.extend(due.into_iter().flatten());
        }
        if !sentences.is_empty() {
            self.outputs.send(sentences);
        }
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

/// Returns the content of HDG, if it has all three angles.
fn sent_heading(corrected: &CorrectedHeading) -> Option<SentHeading> {
    corrected.magnetic_deg?;
    Some(SentHeading {
        raw: corrected.compass_deg?,
        deviation: corrected.deviation_deg?,
        variation: corrected.variation_deg?,
    })
}
