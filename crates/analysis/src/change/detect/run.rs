//! The search: one filter runs forward over the rows, a bank of what else may have
//! happened beside it, and what proves likelier by far takes its place.
//!
//! What always holds: a row is read once in order of time and nothing later than it
//! decides what it tells; every event lies between two rows; the search ends.

use super::state::{Detector, LearningSchedule, LearntNoise, earlier};
use crate::change::thresholds::{
    FIRST_TRANSIENT_ROW, FORK_AFTER_GAP_S, FORK_INNOVATION_MIN_ROWS, FORK_INNOVATION_SD,
    FORK_INTERVAL_ROWS, SUSPICION_LOG_LIKELIHOOD_RATIO,
};

use crate::change::detection::{Detection, DetectionInput, PossibleReturn};
use crate::change::event::EventKind;
use crate::change::filter::Measurement;
use crate::change::hypotheses::Lead;
use crate::change::hypothesis_kind::HypothesisKind;
use crate::estimate::are_times_believed;
use crate::observation::Observation;

/// Searches rows, which are in order of time and all have one; where most share theirs
/// nothing can be dated.
pub(crate) fn detect(observations: &[Observation], given: &DetectionInput<'_>) -> Detection {
    if !are_times_believed(observations) {
        return Detection::default();
    }
    let Some(learnt) = LearntNoise::first(observations, given.prior, given.levels) else {
        return Detection::default();
    };
    let mut search = Detector::new(observations, given, learnt);
    for k in 0..observations.len() {
        search.step(k);
    }
    search.finish()
}

impl Detector<'_> {
    fn step(&mut self, k: usize) {
        if k >= self.lesson.at {
            self.learn(k);
        }
        if k == self.first() {
            self.bank.forget_lasting();
        }
        let is_due = k >= FIRST_TRANSIENT_ROW && self.is_due(k);
        if is_due {
            self.settle_burst(k);
        }
        let m = self.next(k);
        if is_due || (k >= FIRST_TRANSIENT_ROW && self.is_astray(k, &m)) {
            let earlier = earlier(
                self.misled.as_ref(),
                self.apply_alignment_step.as_ref(),
                &self.calls,
            );
            let known = (earlier, self.is_call(k));
            self.bank.spawn(k, &self.null, &self.noise, known);
            self.spawned = k;
        }
        if self.is_call(k) || self.is_said_discharged(k) {
            let said = self.said_at(k);
            self.calls.call(k, &self.null, usize::MAX, said);
        }
        if self.is_call(k) {
            self.ports.call(k, &self.null);
        }
        let surprise = self.null.take(&m, &self.noise, None);
        let mut calls = std::mem::take(&mut self.calls);
        calls.take(|at| self.measure(k, at), &self.noise, &self.null);
        self.calls = calls;
        self.take_in_rivals(k);
        self.take_in_doubt(k);
        let earlier = earlier(
            self.misled.as_ref(),
            self.apply_alignment_step.as_ref(),
            &self.calls,
        );
        let null = (&self.null, surprise);
        self.bank.take(k, m, &self.noise, null, earlier);
        let mut bank = std::mem::take(&mut self.bank);
        bank.take_large(k, &self.noise, |row, at| self.measure(row, at));
        self.bank = bank;
        if k >= FIRST_TRANSIENT_ROW {
            self.judge(k);
            self.settle_faint(k, false);
        }
    }

    fn is_due(&self, k: usize) -> bool {
        let reported = || {
            let Some((before, now)) = k
                .checked_sub(1)
                .and_then(|j| self.observations[j].time)
                .zip(self.observations[k].time)
            else {
                return false;
            };
            self.reported.iter().any(|t| before < *t && *t <= now)
        };
        k >= self.spawned + FORK_INTERVAL_ROWS
            || (k > 0 && self.seconds(k) > FORK_AFTER_GAP_S)
            || reported()
    }

    /// Whether something may have happened just before this row.
    fn is_astray(&self, k: usize, m: &Measurement) -> bool {
        k >= self.spawned + FORK_INNOVATION_MIN_ROWS
            && self.null.z_squared(m) > FORK_INNOVATION_SD * FORK_INNOVATION_SD
    }

    /// The sizes of noise again, from the longer stretch there is now.
    fn learn(&mut self, k: usize) {
        let rows = self.learn_from..k;
        if let Some(learnt) =
            LearntNoise::of(self.observations, rows, self.prior, Some(&self.levels))
        {
            self.levels = learnt.levels;
            self.noise = learnt.noise;
        }
        self.learnt_days = self.lesson.days;
        self.lesson = LearningSchedule::next(self.observations, self.learn_from, k, 0.0);
    }

    /// What is suspected when the rows end.
    fn finish(mut self) -> Detection {
        let leads = self.leads();
        let perhaps = self.candidate(&leads).map(|candidate| PossibleReturn {
            of: candidate.event,
            first: candidate.at,
            probability: candidate.any,
        });
        let returned = perhaps.map_or(0.0, |perhaps| perhaps.probability);
        let unnoticed = self.unnoticed(&leads, returned);
        let open_nt2 = self.open_nt2(&leads);
        self.note_zeros();
        self.suspect();
        self.settle_faint(self.observations.len().saturating_sub(1), true);
        Detection {
            events: self.events,
            perhaps,
            unnoticed,
            open_nt2,
            is_watched: true,
        }
    }

    fn suspect(&mut self) {
        let Some(k) = self.observations.len().checked_sub(1) else {
            return;
        };
        if let Some(event) = self.burst {
            let last = self.last_astray(self.events[event].first, k + 1);
            self.events[event].last = (last + FORK_INTERVAL_ROWS < k).then_some(last);
            return;
        }
        let leads = self.leads();
        let nats = |kind: HypothesisKind| leads[kind as usize].map_or(0.0, |lead| lead.nats);
        let likeliest = [
            HypothesisKind::Step,
            HypothesisKind::ReferenceStep,
            HypothesisKind::Transient,
        ]
        .into_iter()
        .max_by(|a, b| nats(*a).total_cmp(&nats(*b)))
        .filter(|kind| nats(*kind) > SUSPICION_LOG_LIKELIHOOD_RATIO);
        // A burst that has had its time keeps its lead.
        let is_news = |lead: Lead| self.has_time_left(self.bank.spawns[lead.spawn].at, k);
        let Some((kind, lead)) = likeliest.and_then(|kind| Some((kind, leads[kind as usize]?)))
        else {
            return;
        };
        if k < self.young() || (kind == HypothesisKind::Transient && !is_news(lead)) {
            return;
        }
        let what = match kind {
            HypothesisKind::ReferenceStep => EventKind::ReferenceFault,
            HypothesisKind::Transient => EventKind::Transient,
            _ => EventKind::Step,
        };
        let spawn = &self.bank.spawns[lead.spawn];
        let first = spawn.at;
        let filters = spawn
            .copy(lead.kind)
            .map(|f| (spawn.origin().clone(), f.clone()));
        let change = filters.as_ref().map(|(before, after)| (before, after));
        self.push(k, what, first, (first, first), leads, change);
        if let Some(event) = self.events.last_mut() {
            event.confirmed = false;
        }
    }
}
