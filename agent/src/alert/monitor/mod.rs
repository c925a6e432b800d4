//! Detection of a disagreement between compass and references. Pure: windows in, revisions out.
//!
//! The limit is the model's 95 % band on this heading plus the usual error of a gyro. That error
//! grows as 1 / cos(latitude), like everything that pulls a gyro to the meridian.
//!
//! A Schuler oscillation of 0.35°, a slow bias of 0.3°, and 0.3° for the compass's own swing and
//! the variation's error add up to 0.55° (one standard deviation). During a few hours of the year
//! they reach four times that. For tens of minutes after a manoeuvre a gyro may be off by one or
//! two degrees. 2.5° at the equator lies above both.

mod departures;
mod verdict;

use super::record::AlertRecord;
use crate::config::AlertConfig;
use crate::corrected_heading::{CorrectionInputs, predict};
use crate::sampler::{WINDOW_S, Window};
use binnacle_compass::angle::{CompassHeading, wrap_180};
use binnacle_compass::time::Timestamp;
use binnacle_instruments::ReckonedPlace;
use binnacle_wire::alert::{ShipAlert, ShipAlertState};
use binnacle_wire::messages::{CardWithdrawn, ModelDownlink};
use departures::{
    Departure, MedianDeparture, RecentDepartures, SECTOR_DEG, SECTORS, round_to_tenth,
};
use uuid::Uuid;
use verdict::{clears_compass, has_lost_reference, reassess_alert};

/// Band assumed where the model has no covariance.
const DEFAULT_BAND_DEG: f64 = 2.0;
/// Latitude above which the gyro error is no longer increased.
const MAX_LAT_DEG: f64 = 75.0;
/// Share of the limit below which compass and references agree again.
const AGREEMENT_SHARE: f64 = 0.75;
/// Settled windows after which the follow-up revision is made: half an hour.
const FOLLOW_WINDOWS: usize = 1800 / WINDOW_S as usize;
/// Settled windows of agreement that close an alert on any heading: a day.
const AGREE_ON_ANY_HEADING_WINDOWS: usize = 24 * 3600 / WINDOW_S as usize;
/// Spacing, in sectors, of three courses whose agreement covers all others. Neither a magnet with
/// its two nulls nor soft iron with its four has little effect on all of them.
const COURSE_SPACING_SECTORS: std::ops::RangeInclusive<u32> = 4..=8;
/// Lag of the GNSS clock behind the model's data above which clock and variation count as wrong.
const MAX_CLOCK_LAG_S: f64 = 86_400.0;

/// Card in use on board.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ActiveCard<'a> {
    pub(crate) model: Option<&'a ModelDownlink>,
    pub(crate) withdrawn: Option<&'a CardWithdrawn>,
}

/// Detector state between two windows.
#[derive(Debug)]
pub(crate) struct AlertMonitor {
    config: AlertConfig,
    /// Latest windows, oldest first: twice as many as raise an alert.
    recent: RecentDepartures,
    /// Model that the windows were compared with.
    model: Option<Uuid>,
    record: Option<AlertRecord>,
    /// Settled windows since the alert was raised, or since the agent was started.
    since_raised: usize,
    /// Consecutive settled windows of agreement, and a bit for each sector they were in.
    agreed_windows: usize,
    agreed_sectors: u64,
}

impl AlertMonitor {
    /// Creates a monitor that continues with a stored alert and the model in use then.
    pub(crate) fn new(
        config: AlertConfig,
        record: Option<AlertRecord>,
        model: Option<Uuid>,
    ) -> AlertMonitor {
        AlertMonitor {
            config,
            recent: RecentDepartures::new(2 * settled_windows(&config)),
            model,
            record,
            since_raised: 0,
            agreed_windows: 0,
            agreed_sectors: 0,
        }
    }

    /// Returns the last alert, open or closed.
    pub(crate) fn record(&self) -> Option<&AlertRecord> {
        self.record.as_ref()
    }

    /// Marks the alert as acknowledged by an officer.
    pub(crate) fn acknowledge(&mut self, id: Uuid) {
        let alert = self.record.as_mut().filter(|record| record.alert.id == id);
        if let Some(record) = alert {
            record.acknowledged = true;
        }
    }

    /// Updates the card. Another card discards all comparisons with the last one; without a card
    /// the open alert ends. Returns that revision.
    pub(crate) fn update_card(
        &mut self,
        card: ActiveCard<'_>,
        now: Timestamp,
    ) -> Option<ShipAlert> {
        let model = card.in_use().map(|model| model.id);
        if model != self.model {
            self.model = model;
            self.recent.clear();
            self.reset_agreement();
        }
        if model.is_some() {
            return None;
        }
        self.revise(ShipAlertState::NotJudged, now)
    }

    /// Applies a settled window. Returns the revision that it causes.
    pub(crate) fn observe(
        &mut self,
        window: &Window,
        card: ActiveCard<'_>,
        new_id: impl FnOnce() -> Uuid,
    ) -> Option<ShipAlert> {
        let now = end_of(window.index)?;
        if let Some(ended) = self.update_card(card, now) {
            return Some(ended);
        }
        let departure = self.compare(window, card, now)?;
        self.recent.push(departure);
        self.since_raised = self.since_raised.saturating_add(1);
        let raise = settled_windows(&self.config);
        let median = self.recent.median_over(raise)?;
        if median.exceeds_limit() {
            self.mark_sector(median.sector);
        }
        if !self.record.is_some_and(|record| record.is_open()) {
            let version = card.in_use()?.version;
            return median
                .exceeds_limit()
                .then(|| self.raise(median, version, now, new_id()));
        }
        if self.check_agreement(raise) {
            return self.revise(ShipAlertState::Agree, now);
        }
        self.reassess(raise, now)
            .or_else(|| self.follow_up(median, now))
    }

    fn compare(&self, window: &Window, card: ActiveCard<'_>, now: Timestamp) -> Option<Departure> {
        let model = card.in_use()?;
        // A course over ground alone checks nothing: current sets her as far as the band is wide.
        let reference_deg = window.gyro_deg.or(window.satellite_deg)?;
        if now.seconds_since(model.data_until) < -MAX_CLOCK_LAG_S {
            return None;
        }
        let corrected = predict(CorrectionInputs {
            compass: CompassHeading::new(window.compass_deg),
            compass_is_mixed: false,
            place: Some(ReckonedPlace::exactly(window.position)),
            time: Some(now),
            model: Some(model),
            withdrawn: None,
            // The compass is checked even while the alert suspects it.
            compass_suspected: false,
            withheld: false,
        });
        let true_deg = corrected.true_deg?.degrees();
        let departure = |heading_deg: f64| wrap_180(true_deg - heading_deg);
        // Heading of the reference: a faulty compass reads another heading on the same course.
        let heading_deg = reference_deg;
        let lat_deg = window.position.lat_deg().abs().min(MAX_LAT_DEG);
        let gyro_error_deg = self.config.gyro_error_deg.0 / lat_deg.to_radians().cos();
        let band_deg = corrected.band95_deg.unwrap_or(DEFAULT_BAND_DEG);
        Some(Departure {
            index: window.index,
            gyro_deg: window.gyro_deg.map(departure),
            satellite_deg: window.satellite_deg.map(departure),
            band_deg,
            limit_deg: band_deg + gyro_error_deg,
            sector: (heading_deg.rem_euclid(360.0) / SECTOR_DEG) as u32 % SECTORS,
        })
    }

    fn raise(
        &mut self,
        median: MedianDeparture,
        model_version: u32,
        now: Timestamp,
        id: Uuid,
    ) -> ShipAlert {
        let departed = self.recent.count_departed_windows(median.limit_deg);
        let first = self.recent.nth_latest(departed);
        let since = first.and_then(|departure| start_of(departure.index));
        let median = self.recent.median_over(departed).unwrap_or(median);
        let alert = ShipAlert {
            id,
            revision: 1,
            state: ShipAlertState::Open,
            since: since.unwrap_or(now),
            at: now,
            gyro_departure_deg: median.gyro_deg.map(round_to_tenth),
            satellite_departure_deg: median.satellite_deg.map(round_to_tenth),
            limit_deg: round_to_tenth(median.limit_deg),
            model_version,
        };
        self.record = Some(AlertRecord {
            alert,
            acknowledged: false,
            followed_up: false,
            departed_sectors: 1 << median.sector,
            raised_limit_deg: Some(alert.limit_deg),
            clearance_revoked: false,
        });
        self.since_raised = 0;
        self.reset_agreement();
        // Agreement before the alert is no sign of its end.
        self.recent.clear();
        alert
    }

    fn mark_sector(&mut self, sector: u32) {
        self.reset_agreement();
        if let Some(record) = self.record.as_mut().filter(|record| record.is_open()) {
            record.departed_sectors |= 1 << sector;
        }
    }

    fn reset_agreement(&mut self) {
        (self.agreed_windows, self.agreed_sectors) = (0, 0);
    }

    /// Returns whether the open alert is over.
    ///
    /// It is over when compass and references agree on every heading on which they disagreed, on
    /// three courses that cover all others, or for long enough. A band wider than at the start
    /// cannot hide the disagreement, and a far wider one decides nothing. Readings from before a
    /// turn belong to another course and are not used.
    fn check_agreement(&mut self, raise: usize) -> bool {
        let median = self.recent.median_over(2 * raise);
        let on_course = median.filter(|median| self.recent.is_on_course(2 * raise, median.sector));
        let Some((median, record)) = on_course.zip(self.record.as_mut()) else {
            return false;
        };
        let alert = &record.alert;
        let raised_limit_deg = record.raised_limit_deg.unwrap_or(alert.limit_deg);
        // A model that hardly knows the heading agrees with anything.
        if median.band_deg > raised_limit_deg {
            return false;
        }
        let limit_deg = AGREEMENT_SHARE * median.limit_deg.min(raised_limit_deg);
        let is_near = |deg: f64| deg.abs() <= limit_deg;
        let (assessed_deg, other_deg) = median.assessed_deg(record);
        if !assessed_deg.is_some_and(is_near) || !other_deg.is_none_or(is_near) {
            self.reset_agreement();
            return false;
        }
        let is_sound = clears_compass(alert.suspect());
        record.departed_sectors &= !(1 << median.sector);
        let is_settled = record.departed_sectors == 0 || is_sound;
        self.agreed_windows = self.agreed_windows.saturating_add(1);
        self.agreed_sectors |= 1 << median.sector;
        is_settled
            || covers_all_courses(self.agreed_sectors)
            || self.agreed_windows >= AGREE_ON_ANY_HEADING_WINDOWS
    }

    /// Reassesses the open alert: a reference that returns may show which instrument is at fault,
    /// and another instrument may fail as well. Readings from before a turn are not used.
    fn reassess(&mut self, raise: usize, now: Timestamp) -> Option<ShipAlert> {
        let median = self.recent.median_over(2 * raise)?;
        if !self.recent.is_on_course(2 * raise, median.sector) {
            return None;
        }
        let record = self.record.as_mut()?;
        let before = record.alert.suspect();
        let updated = reassess_alert(record, median.apply_to(&record.alert))?;
        record.clearance_revoked |= clears_compass(before);
        record.alert = updated;
        self.revise(ShipAlertState::Open, now)
    }

    fn follow_up(&mut self, median: MedianDeparture, now: Timestamp) -> Option<ShipAlert> {
        let record = self.record.as_mut()?;
        if record.followed_up || self.since_raised < FOLLOW_WINDOWS {
            return None;
        }
        record.followed_up = true;
        let updated = median.apply_to(&record.alert);
        let is_of_same = !has_lost_reference(&record.alert, &updated)
            && updated.suspect() == record.alert.suspect();
        if median.exceeds_limit() && is_of_same {
            record.alert = updated;
        }
        self.revise(ShipAlertState::Open, now)
    }

    /// Makes the next revision of the open alert, if there is one.
    fn revise(&mut self, state: ShipAlertState, now: Timestamp) -> Option<ShipAlert> {
        let record = self.record.as_mut().filter(|record| record.is_open())?;
        record.alert.revision = record.alert.revision.saturating_add(1);
        record.alert.state = state;
        record.alert.at = now;
        Some(record.alert)
    }
}

/// Returns the number of windows in [`AlertConfig::settled_s`]: at least a minute, at most a day.
fn settled_windows(config: &AlertConfig) -> usize {
    let windows = config.settled_s.0 / WINDOW_S as f64;
    windows.round().clamp(6.0, 8640.0) as usize
}

impl<'a> ActiveCard<'a> {
    fn in_use(self) -> Option<&'a ModelDownlink> {
        self.model.filter(|_| self.withdrawn.is_none())
    }
}

/// Returns whether three of the sectors are spaced so that they cover all courses.
fn covers_all_courses(sectors: u64) -> bool {
    let is_in = |sector: u32| sectors & (1 << (sector % SECTORS)) != 0;
    let next = |one: u32| {
        COURSE_SPACING_SECTORS
            .map(move |far| one + far)
            .filter(|two| is_in(*two))
    };
    (0..SECTORS).any(|one| is_in(one) && next(one).any(|two| next(two).next().is_some()))
}

fn start_of(window: i64) -> Option<Timestamp> {
    Timestamp::from_micros(window.checked_mul(WINDOW_S * 1_000_000)?).ok()
}

fn end_of(window: i64) -> Option<Timestamp> {
    start_of(window.checked_add(1)?)
}

#[cfg(test)]
mod tests;
