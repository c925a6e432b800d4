//! Reading of a voyage, part by part: samples, logbook and azimuths in order of time.

use super::epochs::NEEDED_SAMPLES;
use super::input::Part;
use super::kept::{KeptReading, LoggedWork, TrackedRow, settled_readings};
use super::marked_readings::MarkedReadings;
use super::past::Past;
use super::predictions::WatchPredictions;
use super::row_times::RowTime;
use crate::state_space::row::Placed;
use crate::weighing::tracker::Tracker;
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_analysis::readings::reading::{Reading, readings};
use binnacle_compass::azimuth::Azimuth;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::model::{Directions, ReferenceGrade};
use binnacle_compass::result::SampleReason;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// Voyage so far: all that the reading of the next sample needs, and what was found.
///
/// A plain value: kept and read again, it goes on as if it had never been put away. It grows with
/// what happened to the ship, and not with her samples.
#[derive(Serialize, Deserialize)]
pub struct Voyage {
    settings: AnalysisSettings,
    pub(super) grade: ReferenceGrade,
    /// Directions of the samples so far.
    directions: Directions,
    pub(super) tracker: Tracker,
    /// Work on ship or compass by the logbook, in order of time.
    pub(super) works: Vec<LoggedWork>,
    /// Number of azimuths with no sample near them in time.
    pub(super) azimuths_unread: usize,
    pub(super) predictions: WatchPredictions,
    /// Notes and azimuths later than the last reading, the first last.
    notes: Vec<Note>,
    azimuths: Vec<Azimuth>,
    /// End of the last part: earlier notes and azimuths are known.
    known_until: Option<Timestamp>,
    /// Readings that are not settled, and the rows that were read of them.
    pub(super) kept: Vec<KeptReading>,
    pub(super) rows: Vec<TrackedRow>,
    pub(super) past: Past,
}

/// Note of the logbook at its time.
#[derive(Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
struct Note {
    at: Timestamp,
    kind: LogbookKind,
    is_end: bool,
}

/// Returns the notes of a logbook.
fn notes(logbook: &[LogbookEntry]) -> impl Iterator<Item = Note> {
    let begins = logbook.iter().map(|entry| Note {
        at: entry.from,
        kind: entry.kind,
        is_end: false,
    });
    let ends = logbook.iter().filter_map(|entry| {
        Some(Note {
            at: entry.to?,
            kind: entry.kind,
            is_end: true,
        })
    });
    begins.chain(ends)
}

impl Voyage {
    /// Begins before the first sample, with the operator's settings, what is known of ships like
    /// her, and the grade that [`ReferenceGrade::of`] gives of all her samples.
    pub fn begin(settings: &AnalysisSettings, prior: &ShipPrior, grade: ReferenceGrade) -> Voyage {
        Voyage {
            settings: *settings,
            grade,
            directions: Directions::default(),
            tracker: Tracker::new(settings.reference_constant_sd_deg, prior),
            works: Vec::new(),
            azimuths_unread: 0,
            predictions: WatchPredictions::default(),
            notes: Vec::new(),
            azimuths: Vec::new(),
            known_until: None,
            kept: Vec::new(),
            rows: Vec::new(),
            past: Past::default(),
        }
    }

    pub(super) fn reference_sd_deg(&self) -> f64 {
        self.settings.reference_constant_sd_deg
    }

    /// Returns the grade of the ship by the samples so far and later ones. If it is not the one
    /// that the voyage began with, another has to be begun.
    pub fn grade_with(&self, later: &[Sample]) -> ReferenceGrade {
        let mut directions = self.directions;
        directions.note(later);
        directions.grade()
    }

    /// Returns the grade that it began with.
    pub fn grade(&self) -> ReferenceGrade {
        self.grade
    }

    /// Reads the readings of a part, and what of logbook and azimuths is earlier than the last.
    /// Returns the readings that are not settled.
    pub(super) fn read_part(&mut self, part: &Part<'_>) -> MarkedReadings {
        let known_until = self.known_until;
        let is_new = |time: Timestamp| known_until.is_none_or(|until| time >= until);
        let new = notes(&part.logbook).filter(|note| is_new(note.at));
        self.notes.extend(new);
        self.notes
            .sort_by(|a, b| b.partial_cmp(a).unwrap_or(Ordering::Equal));
        let azimuths = part.azimuths.iter().filter(|a| is_new(a.time()));
        self.azimuths.extend(azimuths.cloned());
        self.azimuths.sort_by(|a, b| in_order(b, a));
        self.known_until = part.end;
        self.directions.note(part.samples);

        let mut all = self.kept_readings();
        let begin = all.len();
        all.extend(readings(
            part.samples,
            &part.logbook,
            &self.settings,
            self.grade,
        ));
        self.kept.extend(all[begin..].iter().map(KeptReading::of));
        let sampled = settled_readings(&self.past.sampled, &self.settings, self.grade);
        let marked = MarkedReadings::new(all, self.grade, sampled, &part.logbook, &self.settings);
        for (place, reading) in marked.readings.iter().enumerate().skip(begin) {
            let time = reading.sample().time;
            while let Some(note) = self.notes.pop_if(|note| note.at <= time) {
                self.note(note);
            }
            let row = self.read(place, reading);
            self.rows.extend(row);
            while let Some(azimuth) = self.azimuths.pop_if(|azimuth| azimuth.time() <= time) {
                self.read_azimuth(&azimuth);
            }
        }
        marked
    }

    /// Returns the readings that are kept, without marks.
    fn kept_readings(&self) -> Vec<Reading> {
        let samples: Vec<Sample> = self.kept.iter().map(|kept| kept.sample).collect();
        let mut readings = readings(&samples, &[], &self.settings, self.grade);
        for (reading, kept) in readings.iter_mut().zip(&self.kept) {
            reading.diagnostic.reason = kept.reason;
        }
        readings
    }

    /// Ends the voyage with what is later than the last reading.
    pub(super) fn finish(&mut self) {
        // Work after the last sample ends the present epoch all the same.
        let notes = std::mem::take(&mut self.notes);
        for note in notes.into_iter().rev().filter(|note| !note.is_end) {
            if note.kind.ends_an_epoch() {
                self.note(note);
            }
        }
        let azimuths = std::mem::take(&mut self.azimuths);
        for azimuth in azimuths.iter().rev() {
            self.read_azimuth(azimuth);
        }
        self.predictions.interrupt();
    }

    /// Returns the times of the rows that were read of some readings, and of earlier ones next to
    /// a date.
    pub(super) fn row_times(&self, readings: &[Reading]) -> Vec<RowTime> {
        let of_row = |place: usize, after_port: bool| {
            let reading = &readings[place];
            Some(RowTime {
                time: reading.sample().time,
                after_port,
                earth: reading.earth?,
            })
        };
        let rows = self.rows.iter();
        let rows = rows.filter_map(|row| of_row(row.place, row.after_port));
        self.past.rows.iter().copied().chain(rows).collect()
    }

    pub(super) fn prior(&self) -> &ShipPrior {
        self.tracker.prior()
    }

    fn note(&mut self, note: Note) {
        if note.is_end {
            if note.kind == LogbookKind::MagneticCargo {
                self.tracker.note_discharge();
            }
            return;
        }
        // The first kind of several at once names the epoch.
        let is_new = self.works.last().is_none_or(|last| last.at != note.at);
        if note.kind.ends_an_epoch() && is_new {
            self.works.push(LoggedWork {
                at: note.at,
                kind: note.kind,
                ship_before: self.tracker.current_ship(),
            });
        }
        self.predictions.interrupt();
        self.tracker.note(note.kind);
    }

    fn read(&mut self, place: usize, reading: &Reading) -> Option<TrackedRow> {
        let excluded = reading.diagnostic.reason;
        if excluded.is_some_and(|reason| reason != SampleReason::MagneticCargo) {
            return None;
        }
        let (variation, earth) = reading.variation.zip(reading.earth)?;
        let placed = Placed {
            sample: reading.sample(),
            gyro: reading.gyro,
            variation,
            earth,
        };
        let is_predicted = self.tracker.count as u64 >= NEEDED_SAMPLES;
        if is_predicted {
            self.predictions.before(placed.sample, &self.tracker);
        }
        let tracked = self.tracker.read(&placed)?;
        if is_predicted {
            self.predictions.after(&tracked, &self.tracker);
        }
        Some(TrackedRow {
            place,
            innovation_deg: tracked.read.deviation.value as f32,
            z_squared: tracked.read.deviation.z_squared() as f32,
            after_port: tracked.row.after_port,
        })
    }

    fn read_azimuth(&mut self, azimuth: &Azimuth) {
        self.azimuths_unread += usize::from(!self.tracker.read_azimuth(azimuth));
    }
}

/// Orders azimuths by time, and those of one time by what they showed.
fn in_order(a: &Azimuth, b: &Azimuth) -> Ordering {
    let shown = |azimuth: &Azimuth| azimuth.result().deviation_deg.degrees_east();
    let heading = |azimuth: &Azimuth| azimuth.compass_heading().degrees();
    a.time()
        .cmp(&b.time())
        .then(heading(a).total_cmp(&heading(b)))
        .then(shown(a).total_cmp(&shown(b)))
}
