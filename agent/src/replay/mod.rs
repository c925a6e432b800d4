//! Replay of recordings through the same roles and sampler as live instruments.
//!
//! Invariants:
//!
//! - Several recordings are read as one, merged by the times of their lines.
//! - Nothing is written before everything was read, so an existing table is complete.
//! - What was not understood, and why there are no samples, is said in notes.

mod findings;
mod merge;
mod planning;
mod table;

#[cfg(test)]
mod tests;

use crate::acquisition::Acquisition;
use crate::sampler::Tally;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_instruments::config::{RolesConfig, SilenceConfig};
use binnacle_observation::recording::NotUnderstood;
use binnacle_observation::signalk::DeltaCounts;
use binnacle_wire::messages::Settings;
use findings::Findings;
use merge::{Finished, merge};
use planning::{Planned, plan};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use tokio::time::Instant;

/// Recordings, and how to read them.
#[derive(Debug)]
pub(crate) struct Recordings<'a> {
    /// Files in any order.
    pub(crate) files: &'a [PathBuf],
    pub(crate) roles: &'a RolesConfig,
    pub(crate) silence: &'a SilenceConfig,
    /// Cycles of 1,024 weeks that are added to the dates of receivers.
    pub(crate) roll_overs: i64,
    /// Present time: no recording is younger.
    pub(crate) now: Timestamp,
}

/// Result of replayed recordings.
#[derive(Clone, Debug, Default)]
pub(crate) struct Replayed {
    /// Samples in the order in which they were finished.
    pub(crate) samples: Vec<Sample>,
    /// Remarks about the recordings, each one line.
    notes: Vec<String>,
    /// Ten-second windows by outcome.
    windows: Tally,
    /// Sentences that were read.
    sentences: binnacle_nmea::Tally,
    /// Signal K values that were read.
    values: DeltaCounts,
    not_understood: Vec<NotUnderstoodLines>,
}

/// Lines of a file that were not understood for one reason.
#[derive(Clone, Debug, Serialize)]
struct NotUnderstoodLines {
    file: String,
    reason: &'static str,
    count: u64,
    line: u64,
    example: String,
}

/// The tally as it is printed.
#[derive(Debug, Serialize)]
struct Report<'a> {
    notes: &'a [String],
    samples: usize,
    windows: BTreeMap<String, u64>,
    sentences: BTreeMap<&'static str, u64>,
    rejected: BTreeMap<&'static str, u64>,
    not_understood: &'a [NotUnderstoodLines],
}

/// Reads recordings as one voyage. Inputs have no names in a recording: sources are distinguished
/// by talker and sentence.
///
/// # Errors
/// Fails when a file cannot be opened, or nothing in any of them can be read.
pub(crate) fn replay(recordings: &Recordings<'_>) -> anyhow::Result<Replayed> {
    let mut replayed = Replayed::default();
    let planned = replayed.drop_untimed(plan(recordings.files, recordings.roll_overs)?);
    let is_stamped = planned.iter().any(|recording| recording.is_stamped);
    let unchecked = planned.iter().filter_map(findings::lack_of_checksums);
    let ahead = planned.iter().filter_map(findings::logger_error);
    let of_plan: Vec<_> = unchecked.chain(ahead).collect();
    let mut acquisition = Acquisition::new(
        &recordings.roles.without_input_names(),
        recordings.silence,
        Settings::default(),
        None,
    );
    acquisition.set_recorded();
    let heard = Instant::now();
    let finished = merge(planned, |seen| {
        acquisition.observe(seen, heard);
        if acquisition.sampler.has_samples() {
            replayed.samples.extend(acquisition.sampler.take_samples());
        }
        // Recordings raise no alerts.
        drop(acquisition.sampler.take_settled());
    })?;
    acquisition.sampler.finish();
    replayed.samples.extend(acquisition.sampler.take_samples());
    replayed.note_reckoned();
    replayed.windows = acquisition.sampler.take_tally();
    replayed.notes.extend(of_plan);
    for recording in &finished {
        replayed.add(recording);
    }
    anyhow::ensure!(
        replayed.has_content(),
        "{}",
        findings::unreadable(&finished)
    );
    let findings = Findings {
        acquisition: &acquisition,
        now: recordings.now,
        is_stamped,
        samples: replayed.samples.len(),
        windows: &replayed.windows,
        sentences: &replayed.sentences,
    };
    replayed.notes.extend(findings.notes());
    Ok(replayed)
}

impl Replayed {
    /// Notes the samples whose position is by dead reckoning: no estimate uses them.
    fn note_reckoned(&mut self) {
        let reckoned = self
            .samples
            .iter()
            .filter(|sample| sample.position_reckoned);
        let count = reckoned.count();
        if count > 0 {
            self.notes.push(format!(
                "{count} samples under GNSS interference: their position is by dead reckoning, \
                 and no estimate uses them"
            ));
        }
    }

    /// Leaves out recordings that cannot be merged with the others for want of any time.
    fn drop_untimed(&mut self, planned: Vec<Planned>) -> Vec<Planned> {
        if planned.iter().all(|recording| recording.start.is_none()) {
            return planned;
        }
        let (timed, untimed): (Vec<_>, Vec<_>) = planned
            .into_iter()
            .partition(|recording| recording.start.is_some());
        self.notes.extend(untimed.iter().map(|recording| {
            let path = recording.path.display();
            format!("{path}: not used: it has no times by which it could be merged with the others")
        }));
        timed
    }

    /// Adds the counts of a recording, and notes about it.
    fn add(&mut self, recording: &Finished) {
        self.sentences.add(&recording.sentences);
        self.values.add(&recording.values);
        let file = recording.path.display().to_string();
        for (reason, lines) in recording.not_understood.iter() {
            self.not_understood.push(NotUnderstoodLines {
                file: file.clone(),
                reason,
                count: lines.count,
                line: lines.line,
                example: lines.example.clone(),
            });
        }
        self.notes.extend(findings::of_recording(recording));
    }

    /// Returns whether anything was read, in use or not.
    fn has_content(&self) -> bool {
        let unused = |lines: &&NotUnderstoodLines| NotUnderstood::is_of_no_use(lines.reason);
        self.sentences.total_read() > 0
            || !self.values.values.is_empty()
            || self.not_understood.iter().any(|lines| unused(&lines))
    }

    /// Returns notes and tally as JSON, each note on a line.
    pub(crate) fn report(&self) -> String {
        let mut sentences: BTreeMap<_, _> = self.sentences.sentences().collect();
        sentences.extend(&self.values.values);
        let mut rejected: BTreeMap<_, _> = self.sentences.rejected().collect();
        rejected.extend(&self.values.rejected);
        let report = Report {
            notes: &self.notes,
            samples: self.samples.len(),
            windows: self.windows.by_name(),
            sentences,
            rejected,
            not_understood: &self.not_understood,
        };
        serde_json::to_string_pretty(&report).expect("counts and names are always JSON")
    }

    /// Returns the samples as the table that `fit` reads.
    pub(crate) fn csv(&self) -> anyhow::Result<Vec<u8>> {
        table::write(&self.samples)
    }
}
