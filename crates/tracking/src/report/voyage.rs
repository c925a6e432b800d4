//! Reading of a voyage: samples, logbook and azimuths in order of time.

use super::input::Input;
use super::predictions::WatchPredictions;
use crate::state_space::row::Placed;
use crate::state_space::ship_state::ShipState;
use crate::weighing::tracker::Tracker;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::azimuth::Azimuth;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::result::SampleReason;
use binnacle_compass::time::Timestamp;
use std::cmp::Ordering;

/// Least number of samples of an epoch of a ship that is not known.
pub(super) const NEEDED_SAMPLES: usize = 12;

/// Voyage after all has been read.
pub(super) struct Voyage {
    pub(super) tracker: Tracker,
    /// Rows that were read, in order.
    pub(super) rows: Vec<TrackedRow>,
    /// Work on ship or compass by the logbook, in order of time.
    pub(super) works: Vec<LoggedWork>,
    /// Number of azimuths with no sample near them in time.
    pub(super) azimuths_unread: usize,
    pub(super) predictions: WatchPredictions,
}

/// Row that was read.
#[derive(Clone, Copy)]
pub(super) struct TrackedRow {
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
pub(super) struct LoggedWork {
    pub(super) at: Timestamp,
    pub(super) kind: LogbookKind,
    /// Ship until then; none before the first row.
    pub(super) ship_before: Option<ShipState>,
}

/// Note of the logbook at its time.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Note {
    at: Timestamp,
    kind: LogbookKind,
    is_end: bool,
}

/// Reads a voyage.
pub(super) fn read_voyage(input: &Input<'_>, readings: &[Reading]) -> Voyage {
    let mut notes = notes(input.logbook);
    let mut azimuths = input.azimuths.to_vec();
    azimuths.sort_by(|a, b| in_order(b, a));
    let mut voyage = Voyage {
        tracker: Tracker::new(input.settings.reference_constant_sd_deg, input.prior),
        rows: Vec::new(),
        works: Vec::new(),
        azimuths_unread: 0,
        predictions: WatchPredictions::default(),
    };
    for (place, reading) in readings.iter().enumerate() {
        let time = reading.sample().time;
        while let Some(note) = notes.pop_if(|note| note.at <= time) {
            voyage.note(note);
        }
        voyage.read(place, reading);
        while let Some(azimuth) = azimuths.pop_if(|azimuth| azimuth.time() <= time) {
            voyage.read_azimuth(&azimuth);
        }
    }
    // Work after the last sample ends the present epoch all the same.
    for note in notes.into_iter().rev().filter(|note| !note.is_end) {
        if note.kind.ends_an_epoch() {
            voyage.note(note);
        }
    }
    for azimuth in azimuths.iter().rev() {
        voyage.read_azimuth(azimuth);
    }
    voyage.predictions.interrupt();
    voyage
}

/// Returns the notes of the logbook, the first last.
fn notes(logbook: &[LogbookEntry]) -> Vec<Note> {
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
    let mut notes: Vec<Note> = begins.chain(ends).collect();
    notes.sort_by(|a, b| b.partial_cmp(a).unwrap_or(Ordering::Equal));
    notes
}

impl Voyage {
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

    fn read(&mut self, place: usize, reading: &Reading) {
        let excluded = reading.diagnostic.reason;
        if excluded.is_some_and(|reason| reason != SampleReason::MagneticCargo) {
            return;
        }
        let Some((variation, earth)) = reading.variation.zip(reading.earth) else {
            return;
        };
        let placed = Placed {
            sample: reading.sample(),
            gyro: reading.gyro,
            variation,
            earth,
        };
        let is_predicted = self.rows.len() >= NEEDED_SAMPLES;
        if is_predicted {
            self.predictions.before(placed.sample, &self.tracker);
        }
        if let Some(tracked) = self.tracker.read(&placed) {
            if is_predicted {
                self.predictions.after(&tracked, &self.tracker);
            }
            self.rows.push(TrackedRow {
                place,
                time: reading.sample().time,
                innovation_deg: tracked.read.deviation.value,
                z_squared: tracked.read.deviation.z_squared(),
                after_port: tracked.row.after_port,
            });
        }
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
