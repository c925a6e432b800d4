//! The agent's alerts towards the bridge, and its commands to them.

use super::Agent;
use crate::alert::{Comparison, DifferenceReference};
use crate::corrected_heading::{CorrectionInputs, correct};
use binnacle_instruments::Latest;
use binnacle_nmea::sentence::Acn;
use binnacle_observation::{Observation, Reading};
use binnacle_output::{AlertCondition, AlertConditions, Trigger};
use rand::RngExt;
use tokio::time::Instant;
use uuid::Uuid;

impl Agent {
    /// Compares the corrected heading with gyro or satellite compass.
    pub(super) fn compare_headings(&mut self, now: Instant) {
        let comparison = self.comparison(now);
        if !self.difference_monitor.observe(comparison, now, new_id) {
            return;
        }
        if let Some(alarm) = self.difference_monitor.last() {
            tracing::warn!("{}", alarm.status().summary);
        }
    }

    /// Raises or ends the alert of GNSS interference. Returns whether it did.
    pub(super) fn watch_interference(&mut self) -> bool {
        let found = self.acquisition.interference();
        let has_changed = self.interference_monitor.observe(found, new_id);
        match self.interference_monitor.status() {
            Some(open) if has_changed => tracing::warn!("{}", open.summary),
            None if has_changed => tracing::info!("the GNSS interference is over"),
            _ => {}
        }
        has_changed
    }

    /// Stores the heading-difference alarm when its state has changed.
    pub(super) async fn save_difference(&mut self) {
        let Some(alarm) = self.difference_monitor.last().copied() else {
            return;
        };
        let stored = self.stored_difference.as_ref();
        if stored.is_some_and(|stored| alarm.is_stored_as(stored)) {
            return;
        }
        match self.spool.save_heading_difference(&alarm).await {
            Ok(()) => self.stored_difference = Some(alarm),
            Err(error) => tracing::error!(%error, "the heading-difference alarm cannot be stored"),
        }
    }

    fn comparison(&mut self, now: Instant) -> Option<Comparison> {
        let corrected = self.with_correction_inputs(|inputs| {
            correct(CorrectionInputs {
                // Compared even while an alert suspects the compass: it must not end the alarm.
                compass_suspected: false,
                ..inputs
            })
        });
        let readings = &self.acquisition.readings;
        let stale = self.silence.stale_s.duration();
        let gyro = Latest::within(readings.gyro, stale, now);
        let satellite = Latest::within(readings.satellite, stale, now);
        let (reference_heading, reference) = match (gyro, satellite) {
            (Some(heading), _) => (heading, DifferenceReference::Gyro),
            (None, heading) => (heading?, DifferenceReference::SatelliteCompass),
        };
        Some(Comparison {
            corrected: corrected.true_deg?,
            reference_heading,
            reference,
        })
    }

    /// Acknowledges an alert of the agent.
    pub(super) fn acknowledge_alert(&mut self, id: Uuid) {
        self.alert_monitor.acknowledge(id);
        self.difference_monitor.acknowledge(id);
        self.interference_monitor.acknowledge(id);
    }

    /// Applies the commands among observations.
    pub(super) fn apply_commands(&mut self, observations: &[Observation]) {
        for observation in observations {
            if let Reading::AlertCommand(command) = &observation.reading {
                self.command_alert(command);
            }
        }
    }

    /// Applies a command of the bridge, and sends what follows from it.
    pub(super) fn command_alert(&mut self, command: &Acn) {
        let now = Instant::now();
        self.update_alert_sentences(now);
        let time = self.acquisition.time();
        let Some(sentences) = &mut self.alert_sentences else {
            return;
        };
        if let Some(id) = sentences.command(command, time, now) {
            tracing::info!(%id, "the bridge acknowledged an alert");
            self.acknowledge_alert(id);
        }
        self.send_heading(Trigger::Timer);
    }

    /// Passes the alerts as they are now to their sentences.
    pub(super) fn update_alert_sentences(&mut self, now: Instant) {
        let Some(sentences) = &mut self.alert_sentences else {
            return;
        };
        let conditions = AlertConditions {
            compass: self.alert_monitor.record().map(AlertCondition::from),
            difference: self.difference_monitor.last().map(AlertCondition::from),
            interference: self.interference_monitor.last().map(AlertCondition::from),
        };
        sentences.update(conditions, self.acquisition.time(), now);
    }
}

pub(super) fn new_id() -> Uuid {
    uuid::Builder::from_random_bytes(rand::rng().random()).into_uuid()
}
