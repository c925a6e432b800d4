//! Departures of the corrected compass from its references, and their medians.

use crate::alert::record::AlertRecord;
use crate::sampler::{WINDOW_S, median};
use binnacle_compass::angle::wrap_180;
use binnacle_wire::alert::{ShipAlert, Suspect};
use std::collections::VecDeque;

/// Largest gap between windows that are compared: half an hour.
const MAX_GAP_WINDOWS: i64 = 1800 / WINDOW_S;
/// Degrees of reference heading per bit of [`AlertRecord::departed_sectors`].
///
/// The deviation of a magnet vanishes on two courses and is largest a quarter circle from them, so
/// agreement on one course says little about the next. A magnet that turns the compass by 14° does
/// almost nothing within 10° of either null.
pub(super) const SECTOR_DEG: f64 = 10.0;
pub(super) const SECTORS: u32 = 36;

/// Departure of the corrected compass from its references in one settled window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Departure {
    pub(super) index: i64,
    /// Corrected compass minus gyro.
    pub(super) gyro_deg: Option<f64>,
    /// Corrected compass minus satellite compass.
    pub(super) satellite_deg: Option<f64>,
    /// 95 % band of the model on this heading.
    pub(super) band_deg: f64,
    /// Band of the model plus the usual error of a sound reference.
    pub(super) limit_deg: f64,
    pub(super) sector: u32,
}

/// The departures of the latest windows, oldest first.
#[derive(Debug)]
pub(super) struct RecentDepartures {
    windows: VecDeque<Departure>,
    capacity: usize,
}

impl RecentDepartures {
    /// Creates an empty buffer for the given number of windows.
    pub(super) fn new(capacity: usize) -> RecentDepartures {
        RecentDepartures {
            windows: VecDeque::new(),
            capacity,
        }
    }

    /// Removes all windows.
    pub(super) fn clear(&mut self) {
        self.windows.clear();
    }

    /// Adds the departure of the latest window.
    pub(super) fn push(&mut self, departure: Departure) {
        let is_continuous = self.windows.back().is_none_or(|last| {
            (last.index + 1..=last.index + MAX_GAP_WINDOWS).contains(&departure.index)
        });
        if !is_continuous {
            self.windows.clear();
        }
        self.windows.push_back(departure);
        if self.windows.len() > self.capacity {
            self.windows.pop_front();
        }
    }

    /// Returns the window that lies `windows - 1` before the latest one.
    pub(super) fn nth_latest(&self, windows: usize) -> Option<&Departure> {
        self.windows.iter().rev().nth(windows.saturating_sub(1))
    }

    /// Returns the median departures of the latest windows, `None` when there are fewer. At least
    /// half of the windows must have a reference, and both references are compared over the same
    /// ones.
    pub(super) fn median_over(&self, windows: usize) -> Option<MedianDeparture> {
        let from = self.windows.len().checked_sub(windows)?;
        let last = self.windows.back()?;
        let middle = |departures: Vec<f64>| {
            let origin = *departures.first()?;
            let middle = median(departures.iter().map(|deg| wrap_180(deg - origin)));
            (departures.len() * 2 >= windows).then(|| wrap_180(origin + middle))
        };
        let of = |departure: fn(&Departure) -> Option<f64>| {
            middle(self.windows.range(from..).filter_map(departure).collect())
        };
        let both = || {
            let both = self.windows.range(from..);
            both.filter_map(|departure| departure.gyro_deg.zip(departure.satellite_deg))
        };
        let gyro_deg = middle(both().map(|(gyro, _)| gyro).collect());
        let satellite_deg = middle(both().map(|(_, satellite)| satellite).collect());
        let (gyro_deg, satellite_deg) =
            match gyro_deg.or_else(|| of(|departure| departure.gyro_deg)) {
                Some(gyro_deg) => (Some(gyro_deg), satellite_deg),
                None => (None, of(|departure| departure.satellite_deg)),
            };
        Some(MedianDeparture {
            gyro_deg,
            satellite_deg,
            band_deg: last.band_deg,
            limit_deg: last.limit_deg,
            sector: last.sector,
        })
    }

    /// Counts the latest windows since the limit began to be exceeded more often than not.
    pub(super) fn count_departed_windows(&self, limit_deg: f64) -> usize {
        let (mut sum, mut most, mut windows) = (0, 0, 0);
        for (before, departure) in self.windows.iter().rev().enumerate() {
            let departure = departure.gyro_deg.or(departure.satellite_deg);
            let beyond = departure.is_some_and(|deg| deg.abs() > limit_deg);
            sum += if beyond { 1 } else { -1 };
            if sum > most {
                (most, windows) = (sum, before + 1);
            }
        }
        windows
    }

    /// Returns whether the latest windows are all on one course, apart from yaw.
    pub(super) fn is_on_course(&self, windows: usize, sector: u32) -> bool {
        let is_near = |departure: &Departure| {
            let turned = (departure.sector + SECTORS - sector) % SECTORS;
            turned <= 1 || turned == SECTORS - 1
        };
        self.windows.iter().rev().take(windows).all(is_near)
    }
}

/// Median departures of several windows, with band, limit and sector of the latest one.
#[derive(Clone, Copy, Debug)]
pub(super) struct MedianDeparture {
    pub(super) gyro_deg: Option<f64>,
    pub(super) satellite_deg: Option<f64>,
    pub(super) band_deg: f64,
    pub(super) limit_deg: f64,
    pub(super) sector: u32,
}

impl MedianDeparture {
    /// Departure from the gyro, or from the satellite compass where there is no gyro.
    fn main_deg(&self) -> Option<f64> {
        self.gyro_deg.or(self.satellite_deg)
    }

    pub(super) fn exceeds_limit(&self) -> bool {
        self.main_deg()
            .is_some_and(|deg| deg.abs() > self.limit_deg)
    }

    /// Returns the departure that decides whether the alert is over, and the other one if it must
    /// agree as well: both where an instrument was cleared.
    pub(super) fn assessed_deg(&self, record: &AlertRecord) -> (Option<f64>, Option<f64>) {
        let (gyro_deg, satellite_deg) = (self.gyro_deg, self.satellite_deg);
        match record.alert.suspect() {
            Suspect::Gyro => (gyro_deg, satellite_deg),
            Suspect::Satellite => (satellite_deg, gyro_deg),
            _ if record.clearance_revoked => (self.main_deg(), satellite_deg),
            _ if record.alert.gyro_departure_deg.is_none() => (satellite_deg.or(gyro_deg), None),
            _ => (self.main_deg(), None),
        }
    }

    /// Returns the alert with these figures.
    pub(super) fn apply_to(&self, alert: &ShipAlert) -> ShipAlert {
        ShipAlert {
            gyro_departure_deg: self.gyro_deg.map(round_to_tenth),
            satellite_departure_deg: self.satellite_deg.map(round_to_tenth),
            limit_deg: round_to_tenth(self.limit_deg),
            ..*alert
        }
    }
}

/// Rounds degrees to a tenth.
pub(super) fn round_to_tenth(degrees: f64) -> f64 {
    (degrees * 10.0).round() / 10.0
}
