//! Findings about recordings in plain words: what was not understood, and why there are no samples.

use super::merge::Finished;
use super::planning::Planned;
use crate::acquisition::Acquisition;
use crate::sampler::Tally;
use binnacle_compass::time::Timestamp;
use binnacle_observation::recording::NotUnderstood;
use binnacle_observation::{Reading, Source};
use std::fmt::Write;
use tokio::time::Instant;

/// Period of the week numbers of GPS.
const ROLL_OVER_S: f64 = 1_024.0 * 7.0 * 86_400.0;
/// Sources that a note names.
const NAMED_SOURCES: usize = 6;

/// Instruments without which there are no samples.
const INSTRUMENTS: [Instrument; 3] = [
    Instrument {
        absence: "no compass heading in the recording",
        unused: "no compass: no role uses the headings of",
        sentences: &["HDG", "HDM"],
        roles: &["compass"],
        gives: |reading| matches!(reading, Reading::Compass { .. } | Reading::Magnetic { .. }),
    },
    Instrument {
        absence: "no reference: no true heading in the recording",
        unused: "no reference: no role uses the true headings of",
        sentences: &["HDT", "THS"],
        roles: &["gyro", "satellite"],
        gives: |reading| matches!(reading, Reading::True(_)),
    },
    Instrument {
        absence: "no position in the recording",
        unused: "no position: no role uses the positions of",
        sentences: &["RMC", "GGA", "GLL"],
        roles: &["position"],
        gives: |reading| matches!(reading, Reading::Fix { .. }),
    },
];

/// An instrument, and the words for its absence.
struct Instrument {
    absence: &'static str,
    unused: &'static str,
    sentences: &'static [&'static str],
    roles: &'static [&'static str],
    gives: fn(&Reading) -> bool,
}

/// State at the end of a replay.
pub(super) struct Findings<'a> {
    pub(super) acquisition: &'a Acquisition,
    pub(super) now: Timestamp,
    /// Set if a logger gave lines their times.
    pub(super) is_stamped: bool,
    pub(super) samples: usize,
    pub(super) windows: &'a Tally,
    /// Sentences that were read.
    pub(super) sentences: &'a binnacle_nmea::Tally,
}

impl Findings<'_> {
    /// Returns notes on all recordings together.
    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        notes.extend(self.date());
        notes.extend(
            INSTRUMENTS
                .iter()
                .filter_map(|instrument| self.absence(instrument)),
        );
        let problems = self.acquisition.source_problems(Instant::now()).into_iter();
        notes.extend(problems.map(|problem| problem.replace("replay ", "")));
        if self.samples == 0 {
            notes.push(self.no_samples());
        }
        notes
    }

    fn date(&self) -> Option<String> {
        let Some(time) = self.acquisition.time() else {
            let what = "no date in the recording: no date in RMC or ZDA of a position source, and \
                        none before its lines";
            return Some(what.to_owned());
        };
        let is_suspect = !self.is_stamped && self.now.seconds_since(time) > ROLL_OVER_S;
        is_suspect.then(|| {
            let younger = time.plus_seconds(ROLL_OVER_S);
            format!(
                "the receiver's dates are as old as {time}: if the recording is of {younger}, its \
                 week count has rolled over, and --roll-over 1 adds the 1024 weeks"
            )
        })
    }

    /// Describes the absence of an instrument.
    fn absence(&self, instrument: &Instrument) -> Option<String> {
        let heard = self.acquisition.heard.sorted().into_iter();
        let sources: Vec<&Source> = heard
            .filter(|(_, heard)| {
                heard
                    .values
                    .iter()
                    .any(|seen| (instrument.gives)(&seen.reading))
            })
            .map(|(source, _)| source)
            .collect();
        if sources.is_empty() {
            return Some(self.missing(instrument));
        }
        let reports = self.acquisition.sources(Instant::now());
        let is_used = reports.iter().any(|report| {
            let roles = instrument.roles.iter();
            roles
                .clone()
                .any(|role| report.serves.iter().any(|serves| serves == role))
        });
        if is_used {
            return None;
        }
        let names: Vec<String> = sources
            .iter()
            .take(NAMED_SOURCES)
            .map(|source| name(source))
            .collect();
        let more = if sources.len() > names.len() {
            " and others"
        } else {
            ""
        };
        Some(format!(
            "{} {}{more}: name one under [roles] in a configuration, and give it with --config",
            instrument.unused,
            names.join(", ")
        ))
    }

    /// Describes an instrument that has given no reading: sentences may be there without a value.
    fn missing(&self, instrument: &Instrument) -> String {
        let is_its_own = |kind: &str| instrument.sentences.contains(&kind);
        let counts = self.sentences.sentences();
        let empty: Vec<String> = counts
            .filter(|(kind, _)| is_its_own(kind))
            .map(|(kind, count)| format!("{count} {kind}"))
            .collect();
        if empty.is_empty() {
            return format!(
                "{} ({})",
                instrument.absence,
                instrument.sentences.join(", ")
            );
        }
        format!(
            "{}: {} without a valid value",
            instrument.absence,
            empty.join(", ")
        )
    }

    fn no_samples(&self) -> String {
        let mut counts: Vec<_> = self.windows.by_name().into_iter().collect();
        counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let total: u64 = counts.iter().map(|(_, count)| count).sum();
        if total == 0 {
            return "no samples: the recording has no whole window of ten seconds".to_owned();
        }
        let mut note = format!("no samples from {total} windows of ten seconds:");
        for (place, (outcome, count)) in counts.iter().enumerate() {
            let comma = if place == 0 { "" } else { "," };
            let words = outcome.replace('_', " ");
            write!(note, "{comma} {count} {words}").expect("a String takes every write");
        }
        note
    }
}

/// Returns the name of a source without that of the replay.
fn name(source: &Source) -> String {
    let name = source.to_string();
    name.strip_prefix("replay ").unwrap_or(&name).to_owned()
}

/// Returns notes on one recording.
pub(super) fn of_recording(recording: &Finished) -> Vec<String> {
    let path = recording.path.display();
    let mut notes = Vec::new();
    for (reason, lines) in recording.not_understood.iter() {
        if NotUnderstood::is_of_no_use(reason) {
            continue;
        }
        let (count, line, example) = (lines.count, lines.line, &lines.example);
        let times = if count == 1 {
            "once".to_owned()
        } else {
            format!("{count} times")
        };
        notes.push(format!(
            "{path}:{line}: {reason}, {times}, first: {example}"
        ));
    }
    if let Some(found) = recording.roll_over {
        notes.push(format!(
            "{path}: the receiver's date is 1024 weeks behind, after a roll-over of the GPS weeks: \
             {} is read as {}",
            found.stated, found.corrected
        ));
    }
    if let Some(problem) = &recording.problem {
        notes.push(format!("{path}: not read to its end: {problem}"));
    }
    notes
}

/// Describes the error of a logger's clock.
pub(super) fn logger_error(recording: &Planned) -> Option<String> {
    let ahead_s = recording.plan.logger_ahead_micros / 1_000_000;
    if ahead_s == 0 || !recording.is_stamped {
        return None;
    }
    let (seconds, side) = (
        ahead_s.abs(),
        if ahead_s > 0 { "ahead of" } else { "behind" },
    );
    Some(format!(
        "{}: the times of its lines are {seconds} s {side} the receivers' UTC, and corrected",
        recording.path.display()
    ))
}

/// Describes a recording whose sentences have no checksums.
pub(super) fn lack_of_checksums(recording: &Planned) -> Option<String> {
    recording.plan.without_checksums.then(|| {
        format!(
            "{}: no sentence has a checksum: they are read without, and damaged ones are not noticed",
            recording.path.display()
        )
    })
}

/// Describes recordings in which nothing can be read, in one line.
pub(super) fn unreadable(recordings: &[Finished]) -> String {
    let mut words = String::new();
    for recording in recordings {
        let path = recording.path.display();
        let separator = if words.is_empty() { "" } else { "; " };
        let first = recording
            .not_understood
            .iter()
            .min_by_key(|(_, lines)| lines.line);
        let why = match (&recording.problem, first) {
            (Some(problem), _) => problem.clone(),
            (None, None) => "there is no line in it".to_owned(),
            (None, Some((reason, lines))) => format!(
                "none of its lines can be read, line {}: {reason}: {}",
                lines.line, lines.example
            ),
        };
        write!(words, "{separator}{path}: {why}").expect("a String takes every write");
    }
    words
}
