//! Predictions of watches: rows on one heading, four hours at most, predicted together from all
//! that was known before.
//!
//! A row minutes after another on the same heading is predicted from it, and says of the ship
//! what that one said. The first rows on another heading are what tests her model: so the mean
//! of a watch is held against its prediction by a filter that stands still meanwhile.

use super::band_scale::{Error, scale};
use super::frozen_filter::{FrozenFilter, ShipLoad};
use crate::state_space::filter::Innovation;
use crate::weighing::records::{Class, Detected};
use crate::weighing::tracker::{Tracked, Tracker};
use binnacle_analysis::estimate::weight;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::result::{PredictionCoverage, expected_inside};
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Greatest length of a watch, and of a gap in it, seconds.
const WATCH_S: f64 = 4.0 * 3600.0;
const GAP_S: f64 = 3600.0;
/// Change of heading that ends a watch, degrees: another sector of a card.
const TURN_DEG: f64 = 15.0;
/// Latest watches that count: a month of a ship that is half of it at sea.
const LATEST: usize = 100;
const DAY_MICROS: i64 = 86_400_000_000;
/// Half the width of a 95 % band, standard deviations.
const BAND_SD: f64 = 1.96;

/// Watch that is over, with its mean less its prediction.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Watch {
    from: Timestamp,
    until: Timestamp,
    mean: Innovation,
    load: ShipLoad,
}

/// Watch that goes on.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct OpenWatch {
    filter: FrozenFilter,
    compass_deg: f64,
    from: Timestamp,
    until: Timestamp,
}

/// Predictions of an analysis so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct WatchPredictions {
    open: Option<OpenWatch>,
    watches: Vec<Watch>,
    rows: u64,
    rows_inside: u64,
}

impl WatchPredictions {
    /// Ends the watch where a sample begins another, before the sample is read.
    pub(crate) fn before(&mut self, sample: &Sample, tracker: &Tracker) {
        if self.open.as_ref().is_some_and(|open| open.has(sample)) {
            return;
        }
        self.interrupt();
        self.open = FrozenFilter::new(&tracker.bank).map(|filter| OpenWatch {
            filter,
            compass_deg: sample.compass.degrees(),
            from: sample.time,
            until: sample.time,
        });
    }

    /// Adds the sample as it was read.
    pub(crate) fn after(&mut self, tracked: &Tracked, tracker: &Tracker) {
        let z_squared = tracked.read.deviation.z_squared();
        self.rows += 1;
        self.rows_inside += u64::from(z_squared <= BAND_SD * BAND_SD);
        if let Some(open) = &mut self.open {
            let row = &tracked.row;
            open.filter.add(row, tracker.levels(), weight(z_squared));
            open.until = row.time;
        }
    }

    /// Rounds the filter of the watch that goes on to what is kept of it.
    pub(crate) fn round(&mut self) {
        if let Some(open) = &mut self.open {
            open.filter.round();
        }
    }

    /// Ends the watch: what follows is predicted anew.
    pub(crate) fn interrupt(&mut self) {
        let Some(open) = self.open.take() else { return };
        if let Some(mean) = open.filter.mean() {
            self.watches.push(Watch {
                from: open.from,
                until: open.until,
                mean,
                load: open.filter.ship_load(),
            });
        }
    }

    /// Returns the check of the predictions up to a time, or of all.
    pub(crate) fn coverage(
        &self,
        until: Option<Timestamp>,
        detected: &[Detected],
    ) -> PredictionCoverage {
        let known = self
            .watches
            .partition_point(|watch| until.is_none_or(|until| watch.until <= until));
        let (mut latest, mut watches_disturbed) = (Vec::new(), 0);
        for watch in self.watches[..known].iter().rev() {
            if latest.len() == LATEST {
                break;
            }
            if detected.iter().any(|detected| disturbs(detected, watch)) {
                watches_disturbed += 1;
            } else {
                latest.push(watch.error());
            }
        }
        let inside = |error: &&Error| error.deviations.abs() <= BAND_SD;
        let watches = latest.len() as u32;
        let expected = expected_inside(watches);
        let scale = scale(&latest);
        PredictionCoverage {
            rows: self.rows,
            rows_inside: self.rows_inside,
            watches,
            watches_inside: latest.iter().filter(inside).count() as u32,
            expected_from: *expected.start(),
            expected_to: *expected.end(),
            watches_disturbed,
            mean_square: scale.mean_square,
            widening: scale.widening,
        }
    }
}

impl WatchPredictions {
    /// Forgets the watches before those that count at some time.
    pub(crate) fn forget(&mut self, until: Timestamp, detected: &[Detected]) {
        let known = self.watches.partition_point(|watch| watch.until <= until);
        let counting = self.watches[..known].iter().enumerate().rev();
        let mut counting =
            counting.filter(|(_, watch)| !detected.iter().any(|d| disturbs(d, watch)));
        if let Some((oldest, _)) = counting.nth(LATEST - 1) {
            self.watches.drain(..oldest);
        }
    }
}

impl Watch {
    fn error(&self) -> Error {
        let sd = self.mean.variance.sqrt();
        Error {
            day: self.from.micros().div_euclid(DAY_MICROS),
            deviations: self.mean.value / sd,
            load: self.load.map(|x| x / sd),
        }
    }
}

impl OpenWatch {
    fn has(&self, sample: &Sample) -> bool {
        let turned_deg = wrap_180(sample.compass.degrees() - self.compass_deg);
        sample.time.seconds_since(self.from) < WATCH_S
            && sample.time.seconds_since(self.until) < GAP_S
            && turned_deg.abs() <= TURN_DEG
    }
}

/// Returns true if the watch lies between an event that lasts and its detection. What passes by
/// counts: whoever steers by the band meets it, and a detector must not excuse itself by it.
fn disturbs(detected: &Detected, watch: &Watch) -> bool {
    detected.class != Class::Passing
        && detected.withdrawn.is_none()
        && watch.until >= detected.event.from
        && watch.from <= detected.at
}
