//! Reading of a voyage: samples, logbook and azimuths in order of time.

use super::input::Input;
use super::marked_readings::MarkedReadings;
use super::predictions::WatchPredictions;
use crate::state_space::row::Placed;
use crate::state_space::ship_state::ShipState;
use crate::weighing::tracker::Tracker;
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::azimuth::Azimuth;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::SampleReason;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// Least number of samples of an epoch of a ship that is not known.
pub(super) const NEEDED_SAMPLES: usize = 12;

/// Voyage so far: all that the reading of the next sample needs, and what was found.
///
/// A plain value: kept and read again, it goes on as if it had never been put away.
#[derive(Serialize, Deserialize)]
pub struct Voyage {
    pub(super) tracker: Tracker,
    /// Work on ship or compass by the logbook, in order of time.
    pub(super) works: Vec<LoggedWork>,
    /// Number of azimuths with no sample near them in time.
    pub(super) azimuths_unread: usize,
    pub(super) predictions: WatchPredictions,
    /// Readings so far.
    places: usize,
    /// Notes and azimuths later than the last reading, the first last.
    notes: Vec<Note>,
    azimuths: Vec<Azimuth>,
}

/// Row that was read.
#[derive(Clone, Copy)]
pub(crate) struct TrackedRow {
    /// Place among the readings.
    pub(super) place: usize,
    pub(super) time: Timestamp,
    /// Innovation, degrees, and its square in standard deviations.
    pub(super) innovation_deg: f64,
    pub(super) z_squared: f64,
    /// True if the vessel was in port since the row before.
    pub(super) after_port: bool,
}

/// Work on ship or compass by the logbook.
#[derive(Serialize, Deserialize)]
pub(crate) struct LoggedWork {
    pub(super) at: Timestamp,
    pub(super) kind: LogbookKind,
    /// Ship until then; none before the first row.
    pub(super) ship_before: Option<ShipState>,
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
    /// Begins before the first sample, with the operator's settings and what is known of ships
    /// like her.
    pub fn begin(settings: &AnalysisSettings, prior: &ShipPrior) -> Voyage {
        Voyage {
            tracker: Tracker::new(settings.reference_constant_sd_deg, prior),
            works: Vec::new(),
            azimuths_unread: 0,
            predictions: WatchPredictions::default(),
            places: 0,
            notes: Vec::new(),
            azimuths: Vec::new(),
        }
    }

    /// Reads the next part of the voyage: samples later than all before, and the logbook entries
    /// and azimuths that came meanwhile. A sample counts as stuck or alongside by those of its
    /// own part.
    pub fn sail_on(&mut self, part: &Input<'_>) {
        let _rows = self.read_part(part, &MarkedReadings::new(part).readings);
    }

    /// Reads the readings of a part, and what of logbook and azimuths is earlier than the last.
    /// Returns the rows that were read, in order.
    pub(super) fn read_part(&mut self, part: &Input<'_>, readings: &[Reading]) -> Vec<TrackedRow> {
        let mut rows = Vec::new();
        self.notes.extend(notes(part.logbook));
        self.notes
            .sort_by(|a, b| b.partial_cmp(a).unwrap_or(Ordering::Equal));
        self.azimuths.extend_from_slice(part.azimuths);
        self.azimuths.sort_by(|a, b| in_order(b, a));
        for reading in readings {
            let time = reading.sample().time;
            while let Some(note) = self.notes.pop_if(|note| note.at <= time) {
                self.note(note);
            }
            rows.extend(self.read(reading));
            while let Some(azimuth) = self.azimuths.pop_if(|azimuth| azimuth.time() <= time) {
                self.read_azimuth(&azimuth);
            }
        }
        rows
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

    fn read(&mut self, reading: &Reading) -> Option<TrackedRow> {
        let place = self.places;
        self.places += 1;
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
        let is_predicted = self.tracker.count >= NEEDED_SAMPLES;
        if is_predicted {
            self.predictions.before(placed.sample, &self.tracker);
        }
        let tracked = self.tracker.read(&placed)?;
        if is_predicted {
            self.predictions.after(&tracked, &self.tracker);
        }
        Some(TrackedRow {
            place,
            time: reading.sample().time,
            innovation_deg: tracked.read.deviation.value,
            z_squared: tracked.read.deviation.z_squared(),
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
