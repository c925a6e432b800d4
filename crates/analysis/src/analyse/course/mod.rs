//! The way through the epochs of the logbook, one after the other.
//!
//! What always holds: every reading is of one epoch; an epoch is fitted once all that
//! happened in it is known, and after those before it.

mod allow;

use super::cargo::{Idle, is_laden, take_idle};
use super::changes::{Found, Known, MISTIMED_S, find, sharpen};
use super::epoch::{Reference, Stretch, empty_epoch, fit_epoch, prior, reference, refuse};
use super::reading::Reading;
use allow::zero_besides;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{Cause, CauseProbability, Change, Epoch, SampleReason};
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// So long after the time that the logbook has for work the samples are asked whether it
/// was done later: a day, and two for a change to show.
const ASKED_S: f64 = MISTIMED_S + 2.0 * 86_400.0;
/// Less than this is not worth a word, seconds.
const SAME_TIME_S: f64 = 3600.0;

/// The epochs so far, with the readings of each.
#[derive(Default)]
pub(super) struct Course {
    pub(super) epochs: Vec<Epoch>,
    /// Places among those of the epoch of the logbook.
    ranges: Vec<Range<usize>>,
    pub(super) changes: Vec<Change>,
    /// Entries of cargo that the samples no longer bear out.
    pub(super) idle: Vec<Idle>,
    /// Whether a change in the last of them would not have been noticed.
    pub(super) is_unwatched: bool,
}

impl Course {
    /// Before the first epoch, with what the compass alone has shown.
    pub(super) fn after(changes: Vec<Change>) -> Course {
        Course {
            changes,
            ..Course::default()
        }
    }

    /// One epoch of the logbook, with the changes that its samples show. Where the samples
    /// show that it ended at another time than the logbook says, that time.
    pub(super) fn follow(
        &mut self,
        epoch: Epoch,
        readings: &mut [Reading],
        logbook: &[LogbookEntry],
        settings: &AnalysisSettings,
    ) -> Option<Timestamp> {
        let done = self.done_later(&epoch, readings, logbook, settings);
        let to = done.or(epoch.to);
        let earlier = self.follow_until(Epoch { to, ..epoch }, readings, logbook, settings);
        earlier.or(done)
    }

    /// When the work that ended an epoch was done, if that was after the time in the
    /// logbook.
    fn done_later(
        &self,
        epoch: &Epoch,
        readings: &[Reading],
        logbook: &[LogbookEntry],
        settings: &AnalysisSettings,
    ) -> Option<Timestamp> {
        let said = epoch.to?;
        let place = |time: Timestamp| readings.partition_point(|r| r.sample().time < time);
        let begin = epoch.from.map_or(0, place);
        let entries = logbook.iter().filter(|entry| entry.kind.ends_an_epoch());
        let next = entries.map(|entry| entry.from).filter(|from| *from > said);
        let asked = said.plus_seconds(ASKED_S);
        let end = place(next.min().map_or(asked, |next| next.min(asked)));
        if end <= place(said).max(begin) {
            return None;
        }
        let mut own = readings[begin..end].to_vec();
        let one_sd_deg = settings.reference_constant_sd_deg;
        let reference = reference(&own, one_sd_deg).ok()?;
        let known = self.known(epoch, one_sd_deg);
        find(&mut own, &reference, logbook, &known).reported_early(said)
    }

    /// What is known before an epoch that follows the last.
    fn known(&self, epoch: &Epoch, one_sd_deg: f64) -> Known {
        let before = self.epochs.last();
        Known {
            prior: prior(epoch, before, one_sd_deg),
            levels: before.and_then(|before| before.noise),
        }
    }

    /// One epoch that ends when the logbook says, or before.
    fn follow_until(
        &mut self,
        epoch: Epoch,
        readings: &mut [Reading],
        logbook: &[LogbookEntry],
        settings: &AnalysisSettings,
    ) -> Option<Timestamp> {
        let place = |time: Timestamp| readings.partition_point(|r| r.sample().time < time);
        let begin = epoch.from.map_or(0, place);
        let end = epoch.to.map_or(readings.len(), place);
        let one_sd_deg = settings.reference_constant_sd_deg;
        let expected = self.expect(&epoch, begin, end, logbook);
        let first = self.epochs.len();
        let own = &mut readings[begin..end];
        match reference(own, one_sd_deg) {
            Ok(reference) => {
                let known = self.known(&epoch, one_sd_deg);
                let found = find(own, &reference, logbook, &known);
                let late = epoch.to.and_then(|said| found.reported_late(said));
                if let Some(at) = late.filter(|at| epoch.from.is_none_or(|from| from < *at)) {
                    let to = Some(at);
                    let epoch = Epoch { to, ..epoch };
                    let earlier = self.follow_until(epoch, readings, logbook, settings);
                    return earlier.or(late);
                }
                self.is_unwatched = !own.is_empty() && !found.is_watched;
                self.split(epoch, found, own, (&reference, logbook));
            }
            Err(refusal) => {
                let mut epoch = epoch;
                refuse(&mut epoch, own, refusal);
                self.push(epoch, 0..own.len());
            }
        }
        if let Some(mut change) = expected {
            let sides = first.checked_sub(1).map(|i| &self.epochs[i]);
            if let Some((old, new)) = sides.zip(self.epochs.get(first)) {
                sharpen(&mut change, old, new, readings);
            }
            self.changes.push(change);
        }
        None
    }

    /// Fits the parts into which changes divide an epoch of the logbook.
    fn split(
        &mut self,
        mut epoch: Epoch,
        mut found: Found,
        readings: &mut [Reading],
        (reference, logbook): (&Reference, &[LogbookEntry]),
    ) {
        let until = epoch.to;
        self.idle
            .extend(take_idle(&epoch, &found, readings, logbook));
        let boundaries = std::mem::take(&mut found.boundaries);
        let last = boundaries.last().filter(|last| !last.resumes);
        let zero_moved = last.and_then(|last| zero_besides(&found.changes[last.change]));
        // The epoch in which each change happened.
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
            self.add(epoch, from..to, readings, reference);
            if boundary.resumes {
                next.resumes = happened_in[boundary.change];
            } else {
                happened_in[boundary.change] = Some(self.epochs.len() - 1);
            }
            (epoch, from) = (next, to);
        }
        epoch.to = until;
        self.add(epoch, from..readings.len(), readings, reference);
        if let Some(ended) = &found.perhaps {
            let base = happened_in[ended.change];
            self.allow_for_end(ended, base, readings, reference);
        }
        for (change, happened_in) in found.changes.iter_mut().zip(happened_in) {
            let sides = happened_in.and_then(|i| self.epochs.get(i).zip(self.epochs.get(i + 1)));
            if let Some((old, new)) = sides {
                sharpen(change, old, new, readings);
            }
        }
        if let Some(begun) = found.unnoticed.as_ref().filter(|_| until.is_none()) {
            self.allow_for_change(begun, readings, reference);
        }
        if let Some(probability) = zero_moved.filter(|_| until.is_none()) {
            self.allow_for_zero(probability, readings, reference);
        }
        if let Some(misled) = found.misled.as_ref().filter(|_| until.is_none()) {
            self.allow_for_misled(misled);
        }
        if let Some(variance_nt2) = found.open_nt2.filter(|_| until.is_none()) {
            self.allow_for_step(variance_nt2);
        }
        self.changes.append(&mut found.changes);
    }

    /// Fits one more epoch, together with the one that it resumes.
    fn add(
        &mut self,
        mut epoch: Epoch,
        own: Range<usize>,
        readings: &mut [Reading],
        reference: &Reference,
    ) {
        if is_laden(&epoch, &readings[own.clone()]) {
            // They tell of nothing but the ship with her cargo: of this epoch.
            for reading in &mut readings[own.clone()] {
                let reason = &mut reading.diagnostic.reason;
                *reason = reason.filter(|reason| *reason != SampleReason::MagneticCargo);
            }
        }
        let stretch = self.stretch(&epoch, own.clone(), reference);
        fit_epoch(&mut epoch, readings, &stretch);
        self.push(epoch, own);
    }

    /// What an epoch that follows the last is to be fitted to.
    fn stretch<'a>(
        &self,
        epoch: &Epoch,
        own: Range<usize>,
        reference: &'a Reference,
    ) -> Stretch<'a> {
        let mut earlier = Vec::new();
        let mut root = None;
        let mut same = epoch.resumes;
        while let Some(place) = same {
            earlier.insert(0, self.ranges[place].clone());
            root = Some(place);
            same = self.epochs[place].resumes;
        }
        // What was known before the first of the epochs in which she was the same.
        let (first, before) = match root {
            Some(root) => (&self.epochs[root], root.checked_sub(1)),
            None => (epoch, self.epochs.len().checked_sub(1)),
        };
        // One that was too short for a model tells nothing; the one before it does.
        let before = before.and_then(|last| {
            let mut back = self.epochs[..=last].iter().rev();
            back.find(|epoch| epoch.model.is_some() || epoch.begun_by_change.is_none())
        });
        Stretch {
            earlier,
            own,
            prior: prior(first, before, reference.check.constant_sd_deg),
            is_turned: first.begun_by_change == Some(Cause::Alignment),
            is_struck: first.begun_by_change == Some(Cause::LightningOrShock),
            is_known: first.begun_by_change.is_some() && before.is_some_and(|b| b.model.is_some()),
            reference,
        }
    }

    fn push(&mut self, epoch: Epoch, own: Range<usize>) {
        self.epochs.push(epoch);
        self.ranges.push(own);
    }

    /// The change that the logbook tells of where an epoch begins, if there are
    /// samples on both sides.
    fn expect(
        &self,
        epoch: &Epoch,
        begin: usize,
        end: usize,
        logbook: &[LogbookEntry],
    ) -> Option<Change> {
        let (at, kind) = (epoch.from?, epoch.begun_by?);
        let mut evidence = vec![format!("the logbook says so: {}", kind.description())];
        let said = logbook.iter().filter(|entry| entry.kind == kind);
        let later_s = said.map(|entry| at.seconds_since(entry.from));
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
