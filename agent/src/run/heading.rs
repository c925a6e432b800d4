//! The corrected heading, from the latest readings to the outputs.

use super::{Agent, CHANNEL_CAPACITY};
use crate::alert::AlertRecord;
use crate::corrected_heading::{self, CardRow, CorrectedHeading, CorrectionInputs};
use crate::status::ModelStatus;
use crate::{card_invalidation, clock};
use binnacle_instruments::{Latest, SentHeading};
use binnacle_output::config::SentenceKind;
use binnacle_output::{Heading, Line, Quality, Trigger};
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

    /// Corrects the latest reading, and makes the card.
    pub(super) fn correct(&mut self) -> (CorrectedHeading, Vec<CardRow>) {
        self.with_correction_inputs(|inputs| {
            (
                corrected_heading::correct(inputs),
                corrected_heading::card(inputs),
            )
        })
    }

    pub(super) fn with_correction_inputs<R>(
        &mut self,
        with: impl FnOnce(CorrectionInputs<'_>) -> R,
    ) -> R {
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
        with(CorrectionInputs {
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
        })
    }

    /// Returns the time at which a heading is sent unless a reading causes it before.
    pub(super) fn next_output(&self) -> Instant {
        let interval = self.acquisition.readings.compass_interval();
        let now = Instant::now();
        let sentences = self.sentences.next_timer(interval, now);
        let shared = self.shared_outputs.next_timer(interval, now);
        shared.map_or(sentences, |shared| shared.min(sentences))
    }

    /// Sends the heading without a new reading; those that wait are taken first.
    pub(super) async fn run_output_timer(&mut self) {
        for _ in 0..CHANNEL_CAPACITY {
            let Ok(observations) = self.observations.try_recv() else {
                break;
            };
            self.observe(&observations).await;
        }
        self.send_heading(Trigger::Timer);
    }

    /// Sends the heading of a new reading, unless a newer one may be waiting.
    pub(super) fn send_new_reading(&mut self) {
        let reading = self.acquisition.readings.compass;
        if reading == self.offered_reading || !self.observations.is_empty() {
            return;
        }
        self.offered_reading = reading;
        self.send_heading(Trigger::Reading);
    }

    /// Sends what is due.
    pub(super) fn send_heading(&mut self, trigger: Trigger) {
        let now = Instant::now();
        let corrected = self.with_correction_inputs(corrected_heading::correct);
        self.withheld = corrected.is_withheld();
        self.acquisition.note_corrected(corrected.true_deg);
        let quality = self.model_status().map(|model| Quality {
            version: model.version,
            age_days: model.age_days.unwrap_or_default(),
        });
        let interval = self.acquisition.readings.compass_interval();
        let heading = output_heading(&corrected);
        self.shared_outputs.send(&heading, trigger, interval, now);
        let mut lines = self
            .sentences
            .due(&heading, quality, trigger, interval, now);
        if let Some(sent) = sent_heading(&corrected).filter(|_| !lines.is_empty()) {
            self.acquisition.note_sent(sent, now);
        }
        if let Some(alarm) = &mut self.alarm {
            let due = alarm.due(self.alert_monitor.record(), now);
            let due = due.unwrap_or_default();
            lines.extend(Line::split(SentenceKind::Alr, &due));
        }
        self.update_alert_sentences(now);
        if let Some(alerts) = &mut self.alert_sentences {
            lines.extend(alerts.due(now));
        }
        if !lines.is_empty() {
            self.outputs.send(&lines);
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

/// Returns the heading as its sentences carry it.
fn output_heading(corrected: &CorrectedHeading) -> Heading {
    Heading {
        compass: corrected.compass_deg,
        deviation: corrected.deviation_deg,
        variation: corrected.variation_deg,
        true_heading: corrected.true_deg,
        standard_error_deg: corrected.standard_error_deg,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corrected_heading::correct;
    use crate::corrected_heading::tests::model;
    use binnacle_compass::angle::CompassHeading;
    use binnacle_compass::position::Position;
    use binnacle_compass::time::Timestamp;
    use binnacle_instruments::ReckonedPlace;
    use binnacle_nmea::Data;
    use binnacle_nmea::sentence::ThsMode;
    use binnacle_output::HeadingSentences;
    use std::time::Duration;

    fn at(lat_deg: f64, lon_deg: f64) -> Option<ReckonedPlace> {
        let position = Position::new(lat_deg, lon_deg).ok();
        position.map(ReckonedPlace::exactly)
    }

    /// Inputs of a heading that is given, and of one that is withheld for each reason.
    fn with_each_reason(mut each: impl FnMut(&str, CorrectionInputs<'_>)) {
        let (good, wide) = (model(2_400.0, None), model(0.0, Some(36.0)));
        let ambiguous = model(1e6, None);
        let withdrawn = CardWithdrawn {
            since: Timestamp::parse("2026-11-21T06:00:00Z").unwrap(),
            reason: "corrector_change".to_owned(),
        };
        let given = CorrectionInputs {
            compass: CompassHeading::new(77.7),
            place: at(43.3, -3.0),
            time: Timestamp::parse("2026-11-21T07:00:00Z").ok(),
            model: Some(&good),
            ..CorrectionInputs::default()
        };
        each("", given);
        let compass = None;
        each("silent", CorrectionInputs { compass, ..given });
        let compass_is_mixed = true;
        each(
            "two sensors",
            CorrectionInputs {
                compass_is_mixed,
                ..given
            },
        );
        let place = None;
        each("position", CorrectionInputs { place, ..given });
        let place = at(-64.0, 136.0);
        each("too weak", CorrectionInputs { place, ..given });
        let time = None;
        each("time", CorrectionInputs { time, ..given });
        let model = None;
        each("no model", CorrectionInputs { model, ..given });
        let model = Some(&wide);
        each("known only to", CorrectionInputs { model, ..given });
        let model = Some(&ambiguous);
        each("", CorrectionInputs { model, ..given });
        let withdrawn = Some(&withdrawn);
        each("has not held", CorrectionInputs { withdrawn, ..given });
        let compass_suspected = true;
        each(
            "suspects",
            CorrectionInputs {
                compass_suspected,
                ..given
            },
        );
    }

    #[test]
    fn while_a_heading_is_withheld_for_whatever_reason_nothing_can_be_read_as_one() {
        let mut given = 0;
        with_each_reason(|reason, inputs| {
            let corrected = correct(inputs);
            let config = toml::from_str("hdt = true").unwrap();
            let mut sentences = HeadingSentences::new(&config);
            let now = Instant::now();
            let lines = sentences.due(
                &output_heading(&corrected),
                None,
                Trigger::Timer,
                Duration::ZERO,
                now,
            );
            let said = format!("{lines:?}");
            if corrected.true_deg.is_some() {
                given += 1;
                assert_eq!(lines.len(), 4, "{said}");
                return;
            }
            let problem = corrected.problem.unwrap();
            assert!(problem.contains(reason), "{problem}");
            assert_eq!(lines.len(), 3, "{problem}: {said}");
            for line in lines {
                match binnacle_nmea::parse(&line.text).map(|read| read.data) {
                    Ok(Data::Hdg(hdg)) => {
                        assert_eq!((hdg.reading_deg, hdg.deviation_deg_east), (None, None));
                    }
                    Ok(Data::Ths(ths)) => {
                        assert_eq!((ths.heading_deg_true, ths.mode), (None, ThsMode::NotValid));
                    }
                    _ => assert!(line.text.starts_with(b"$PBINQ,V,"), "{said}"),
                }
            }
        });
        assert_eq!(given, 1);
    }
}
