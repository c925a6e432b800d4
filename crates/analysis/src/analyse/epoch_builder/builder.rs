//! Builder of epochs, one epoch of the logbook after the other.
//!
//! Every reading belongs to one epoch. An epoch is fitted once all its events are known,
//! and after those before it.

use crate::analyse::cargo_entries::{ContradictedEntry, include_contradicted, is_laden};
use crate::analyse::changes::{
    ChangeFindings, MISTIMED_S, PriorKnowledge, find_changes, refine_size,
};
use crate::analyse::epoch::{
    FitInput, Reference, empty_epoch, fit_epoch, prior, reference, refuse_epoch,
};
use crate::analyse::reading::Reading;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{Cause, CauseProbability, Change, Epoch, SampleReason};
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// Time after work in the logbook up to which samples may date it later: a day, and two for
/// a change to show.
const LATER_WORK_S: f64 = MISTIMED_S + 2.0 * 86_400.0;
/// Smallest time difference that is reported, seconds.
const SAME_TIME_S: f64 = 3600.0;

/// Epochs so far, with the readings of each.
#[derive(Default)]
pub(crate) struct EpochBuilder {
    pub(crate) epochs: Vec<Epoch>,
    /// Places of the readings within the epoch of the logbook.
    pub(crate) ranges: Vec<Range<usize>>,
    pub(crate) changes: Vec<Change>,
    /// Open cargo entries that the samples contradict.
    pub(crate) contradicted: Vec<ContradictedEntry>,
    /// True if a change in the last epoch would not be detected.
    pub(crate) is_unwatched: bool,
}

impl EpochBuilder {
    /// Makes a builder before the first epoch, with the changes of the compass alone.
    pub(crate) fn after(changes: Vec<Change>) -> EpochBuilder {
        EpochBuilder {
            changes,
            ..EpochBuilder::default()
        }
    }

    /// Adds one epoch of the logbook with the changes that its samples show. Returns its
    /// end, if the samples date that otherwise than the logbook.
    pub(crate) fn add_logbook_epoch(
        &mut self,
        epoch: Epoch,
        readings: &mut [Reading],
        logbook: &[LogbookEntry],
        settings: &AnalysisSettings,
    ) -> Option<Timestamp> {
        let later = self.later_work_time(&epoch, readings, logbook, settings);
        let to = later.or(epoch.to);
        let earlier = self.add_epoch_until(Epoch { to, ..epoch }, readings, logbook, settings);
        earlier.or(later)
    }

    /// Returns the time of the work that ended an epoch, if it was later than the logbook
    /// says.
    fn later_work_time(
        &self,
        epoch: &Epoch,
        readings: &[Reading],
        logbook: &[LogbookEntry],
        settings: &AnalysisSettings,
    ) -> Option<Timestamp> {
        let logged = epoch.to?;
        let place = |time: Timestamp| readings.partition_point(|r| r.sample().time < time);
        let begin = epoch.from.map_or(0, place);
        let entries = logbook.iter().filter(|entry| entry.kind.ends_an_epoch());
        let next = entries
            .map(|entry| entry.from)
            .filter(|from| *from > logged);
        let latest = logged.plus_seconds(LATER_WORK_S);
        let end = place(next.min().map_or(latest, |next| next.min(latest)));
        if end <= place(logged).max(begin) {
            return None;
        }
        let mut own = readings[begin..end].to_vec();
        let reference_sd_deg = settings.reference_constant_sd_deg;
        let reference = reference(&own, reference_sd_deg).ok()?;
        let known = self.known(epoch, reference_sd_deg);
        find_changes(&mut own, &reference, logbook, &known).reported_early(logged)
    }

    /// Returns the prior knowledge for the next epoch.
    fn known(&self, epoch: &Epoch, reference_sd_deg: f64) -> PriorKnowledge {
        let before = self.epochs.last();
        PriorKnowledge {
            prior: prior(epoch, before, reference_sd_deg),
            levels: before.and_then(|before| before.noise),
        }
    }

    /// Adds one epoch that ends at the logbook's time or earlier.
    fn add_epoch_until(
        &mut self,
        epoch: Epoch,
        readings: &mut [Reading],
        logbook: &[LogbookEntry],
        settings: &AnalysisSettings,
    ) -> Option<Timestamp> {
        let place = |time: Timestamp| readings.partition_point(|r| r.sample().time < time);
        let begin = epoch.from.map_or(0, place);
        let end = epoch.to.map_or(readings.len(), place);
        let reference_sd_deg = settings.reference_constant_sd_deg;
        let logged_change = self.logged_change(&epoch, begin, end, logbook);
        let first = self.epochs.len();
        let own = &mut readings[begin..end];
        match reference(own, reference_sd_deg) {
            Ok(reference) => {
                let known = self.known(&epoch, reference_sd_deg);
                let found = find_changes(own, &reference, logbook, &known);
                let late = epoch.to.and_then(|logged| found.reported_late(logged));
                if let Some(at) = late.filter(|at| epoch.from.is_none_or(|from| from < *at)) {
                    let to = Some(at);
                    let epoch = Epoch { to, ..epoch };
                    let earlier = self.add_epoch_until(epoch, readings, logbook, settings);
                    return earlier.or(late);
                }
                self.is_unwatched = !own.is_empty() && !found.is_watched;
                self.fit_parts(epoch, found, own, &reference, logbook);
            }
            Err(refusal) => {
                let mut epoch = epoch;
                refuse_epoch(&mut epoch, own, refusal);
                self.push(epoch, 0..own.len());
            }
        }
        if let Some(mut change) = logged_change {
            let sides = first.checked_sub(1).map(|i| &self.epochs[i]);
            if let Some((old, new)) = sides.zip(self.epochs.get(first)) {
                refine_size(&mut change, old, new, readings);
            }
            self.changes.push(change);
        }
        None
    }

    /// Fits the parts into which changes divide an epoch of the logbook.
    fn fit_parts(
        &mut self,
        mut epoch: Epoch,
        mut found: ChangeFindings,
        readings: &mut [Reading],
        reference: &Reference,
        logbook: &[LogbookEntry],
    ) {
        let until = epoch.to;
        self.contradicted
            .extend(include_contradicted(&epoch, &found, readings, logbook));
        let boundaries = std::mem::take(&mut found.boundaries);
        let last = boundaries.last().filter(|last| !last.resumes);
        let alignment_probability =
            last.and_then(|last| other_alignment_probability(&found.changes[last.change]));
        // Epoch that each change ended.
        let mut happened_in = vec![None; found.changes.len()];
        let mut from = 0;
        for boundary in boundaries {
            let at = boundary.at;
            let is_later = epoch.from.is_none_or(|begun| begun < at);
            if !is_later || until.is_some_and(|until| until <= at) {
                continue;
            }
            let to = readings.partition_point(|r| r.sample().time < at).max(from);
            let mut next = empty_epoch(Some(at), None);
            next.begun_by_change = Some(found.changes[boundary.change].cause);
            epoch.to = Some(at);
            self.fit_and_push(epoch, from..to, readings, reference);
            if boundary.resumes {
                next.resumes = happened_in[boundary.change];
            } else {
                happened_in[boundary.change] = Some(self.epochs.len() - 1);
            }
            (epoch, from) = (next, to);
        }
        epoch.to = until;
        self.fit_and_push(epoch, from..readings.len(), readings, reference);
        if let Some(ended) = &found.possible_return {
            let base = happened_in[ended.change];
            self.widen_for_end(ended, base, readings, reference);
        }
        for (change, happened_in) in found.changes.iter_mut().zip(happened_in) {
            let sides = happened_in.and_then(|i| self.epochs.get(i).zip(self.epochs.get(i + 1)));
            if let Some((old, new)) = sides {
                refine_size(change, old, new, readings);
            }
        }
        if let Some(undetected) = found.undetected_step.as_ref().filter(|_| until.is_none()) {
            self.widen_for_undetected_change(undetected, readings, reference);
        }
        if let Some(probability) = alignment_probability.filter(|_| until.is_none()) {
            self.widen_for_alignment(probability, readings, reference);
        }
        if let Some(possible_alignment) = found
            .possible_alignment
            .as_ref()
            .filter(|_| until.is_none())
        {
            self.widen_for_alignment_or_reference(possible_alignment);
        }
        if let Some(variance_nt2) = found.undecided_step_nt2.filter(|_| until.is_none()) {
            self.widen_for_large_step(variance_nt2);
        }
        self.changes.append(&mut found.changes);
    }

    /// Fits one more epoch, together with the one that it resumes.
    fn fit_and_push(
        &mut self,
        mut epoch: Epoch,
        own: Range<usize>,
        readings: &mut [Reading],
        reference: &Reference,
    ) {
        if is_laden(&epoch, &readings[own.clone()]) {
            // These readings show the vessel with its cargo, and belong to this epoch.
            for reading in &mut readings[own.clone()] {
                let reason = &mut reading.diagnostic.reason;
                *reason = reason.filter(|reason| *reason != SampleReason::MagneticCargo);
            }
        }
        let fit_input = self.fit_input(&epoch, own.clone(), reference);
        fit_epoch(&mut epoch, readings, &fit_input);
        self.push(epoch, own);
    }

    /// Returns the input of the next epoch's fit.
    pub(crate) fn fit_input<'a>(
        &self,
        epoch: &Epoch,
        own: Range<usize>,
        reference: &'a Reference,
    ) -> FitInput<'a> {
        let mut earlier = Vec::new();
        let mut root = None;
        let mut same = epoch.resumes;
        while let Some(place) = same {
            earlier.insert(0, self.ranges[place].clone());
            root = Some(place);
            same = self.epochs[place].resumes;
        }
        // Prior knowledge before the first epoch with the same state.
        let (first, before) = match root {
            Some(root) => (&self.epochs[root], root.checked_sub(1)),
            None => (epoch, self.epochs.len().checked_sub(1)),
        };
        // An epoch too short for a model says nothing; the one before it does.
        let before = before.and_then(|last| {
            let mut back = self.epochs[..=last].iter().rev();
            back.find(|epoch| epoch.model.is_some() || epoch.begun_by_change.is_none())
        });
        FitInput {
            earlier,
            own,
            prior: prior(first, before, reference.check.constant_sd_deg),
            is_alignment_changed: first.begun_by_change == Some(Cause::Alignment),
            has_strike: first.begun_by_change == Some(Cause::LightningOrShock),
            is_known: first.begun_by_change.is_some() && before.is_some_and(|b| b.model.is_some()),
            reference,
        }
    }

    pub(crate) fn push(&mut self, epoch: Epoch, own: Range<usize>) {
        self.epochs.push(epoch);
        self.ranges.push(own);
    }

    /// Returns the logged change at the beginning of an epoch, if there are samples on both
    /// sides.
    fn logged_change(
        &self,
        epoch: &Epoch,
        begin: usize,
        end: usize,
        logbook: &[LogbookEntry],
    ) -> Option<Change> {
        let (at, kind) = (epoch.from?, epoch.begun_by?);
        let mut evidence = vec![format!("recorded in the logbook: {}", kind.description())];
        let logged = logbook.iter().filter(|entry| entry.kind == kind);
        let later_s = logged.map(|entry| at.seconds_since(entry.from));
        let later_s = later_s.min_by(|a, b| a.abs().total_cmp(&b.abs()));
        if let Some(later_s) = later_s.filter(|later_s| later_s.abs() > SAME_TIME_S) {
            let side = if later_s > 0.0 { "later" } else { "earlier" };
            evidence.push(format!(
                "by the samples it was done {:.0} hours {side} than the logbook says",
                later_s.abs() / 3600.0
            ));
        }
        let has_before = self.ranges.last().is_some_and(|range| !range.is_empty());
        (has_before && begin < end).then(|| Change {
            from: at,
            from_earliest: at,
            from_latest: at,
            detected_at: at,
            confirmed: true,
            withdrawn: false,
            cause: Cause::AdjustmentOrRepair,
            causes: vec![CauseProbability {
                cause: Cause::AdjustmentOrRepair,
                probability: 1.0,
            }],
            evidence,
            deviation_change_deg: None,
            step: None,
            ended: None,
        })
    }
}

/// Returns the probability of an alignment change behind a change with another cause.
fn other_alignment_probability(change: &Change) -> Option<f64> {
    let causes = change.causes.iter().filter(|c| c.cause != change.cause);
    let mut zero = causes.filter(|c| c.cause == Cause::Alignment);
    zero.next().map(|zero| zero.probability)
}
