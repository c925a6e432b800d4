//! Port calls: their places, times and uncertainties.
//!
//! Invariants of a call that passed [`PortCall::checked`]: it ends after it
//! begins, within [`MAX_STAY_DAYS`], and is not over; its uncertainties are
//! hours in a credible range.

mod berth;
pub mod csv;
mod csv_rows;
mod file_error;
pub mod ics;

pub use berth::{BerthHeading, HeadingSource, Observed, berth_heading};
pub use csv_rows::{CsvRow, CsvRows, escape_formula};
pub use file_error::{FileError, FileErrors, MAX_LISTED};

use crate::ports::PortCode;
use crate::time::Instant;
use serde::{Deserialize, Serialize};

/// Maximum stay of a call, days; a ship that stays longer is laid up.
pub const MAX_STAY_DAYS: f64 = 120.0;
/// Maximum number of days to the arrival.
const MAX_DAYS_AHEAD: f64 = 730.0;

/// A ship's call at a port.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PortCall {
    /// Id in this file.
    pub id: String,
    /// Name for people, if other than the id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The ship.
    pub vessel: String,
    /// The port.
    pub port: PortCode,
    /// The berth, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub berth: Option<String>,
    /// Expected time of arrival alongside.
    pub eta: Instant,
    /// Half-width of the 95 % interval of the arrival, hours.
    #[serde(default)]
    pub eta_uncertainty_h: f64,
    /// Expected time of departure.
    pub etd: Instant,
    /// Half-width of the 95 % interval of the departure, hours.
    #[serde(default)]
    pub etd_uncertainty_h: f64,
    /// The ship's heading alongside, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub berth_heading_deg: Option<f64>,
}

/// A call that was read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Located {
    /// The line on which it begins, from 1.
    pub line: usize,
    /// The call.
    pub call: PortCall,
}

/// The reason for refusing a call.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {detail}")]
pub struct CallError {
    /// The field at fault.
    pub field: &'static str,
    /// The fault in it.
    pub detail: String,
}

impl PortCall {
    /// Checks what can be checked of one call alone.
    ///
    /// # Errors
    /// [`CallError`] with the first bad field.
    pub fn checked(&self, now: Instant) -> Result<(), CallError> {
        let wrong = |field, detail| Err(CallError { field, detail });
        if self.etd <= self.eta {
            return wrong(
                "etd",
                format!("{} is not after eta, {}", self.etd, self.eta),
            );
        }
        if self.etd.hours_since(self.eta) > MAX_STAY_DAYS * 24.0 {
            return wrong(
                "etd",
                format!("{} is more than {MAX_STAY_DAYS} days after eta", self.etd),
            );
        }
        if self.etd <= now {
            return wrong("etd", format!("{} is in the past: it is {now}", self.etd));
        }
        for (field, hours) in [
            ("eta_uncertainty_h", self.eta_uncertainty_h),
            ("etd_uncertainty_h", self.etd_uncertainty_h),
        ] {
            if !(0.0..=720.0).contains(&hours) {
                return wrong(field, format!("{hours} is not within 0 to 720"));
            }
        }
        match self.berth_heading_deg {
            Some(heading) if !(0.0..=360.0).contains(&heading) => wrong(
                "berth_heading_deg",
                format!("{heading} is not within 0 to 360"),
            ),
            _ => Ok(()),
        }
    }

    /// Refuses a call beyond the planning horizon, whose year is likely wrong.
    ///
    /// # Errors
    /// [`CallError`] of its ETA.
    pub fn check_horizon(&self, now: Instant) -> Result<(), CallError> {
        if self.eta.hours_since(now) <= MAX_DAYS_AHEAD * 24.0 {
            return Ok(());
        }
        Err(CallError {
            field: "eta",
            detail: format!("{} is more than {MAX_DAYS_AHEAD} days ahead", self.eta),
        })
    }

    /// Returns the name for people.
    pub fn display_name(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.id)
    }

    /// Returns the probability that the ship is not alongside for `job_h` hours
    /// between two instants.
    ///
    /// Arrival and departure are taken as normal and independent. The three
    /// failures (too late an arrival, too early a departure, too short a stay)
    /// are treated as independent too.
    pub fn chance_of_missing(&self, begins: Instant, ends: Instant, job_h: f64) -> f64 {
        let (arrival, departure) = (self.eta_uncertainty_h / 1.96, self.etd_uncertainty_h / 1.96);
        let in_time = below(ends.hours_since(self.eta) - job_h, arrival);
        let long_enough = below(self.etd.hours_since(begins) - job_h, departure);
        let stays = below(
            self.etd.hours_since(self.eta) - job_h,
            arrival.hypot(departure),
        );
        1.0 - in_time * long_enough * stays
    }
}

/// Finds the first two calls of one ship that overlap: the indices of the later
/// one, and of the one that has not ended by then.
pub fn find_overlap(calls: &[PortCall]) -> Option<(usize, usize)> {
    find_overlaps(calls).into_iter().next()
}

/// Finds all calls of one ship that begin before an earlier one has ended, with
/// that one.
pub fn find_overlaps(calls: &[PortCall]) -> Vec<(usize, usize)> {
    let mut order: Vec<usize> = (0..calls.len()).collect();
    order.sort_by_key(|at| (&calls[*at].vessel, calls[*at].eta, *at));
    let pairs = order.windows(2).map(|pair| (pair[1], pair[0]));
    let overlapping = pairs.filter(|(next, first)| {
        calls[*next].vessel == calls[*first].vessel && calls[*next].eta < calls[*first].etd
    });
    overlapping.collect()
}

/// Returns the probability that a normal error of this size is below a margin; 1 or 0
/// without an error.
fn below(margin: f64, sigma: f64) -> f64 {
    if sigma <= 0.0 {
        return f64::from(u8::from(margin >= 0.0));
    }
    let z = margin / sigma;
    let tail = half_erfc(z.abs() / std::f64::consts::SQRT_2);
    if z >= 0.0 { 1.0 - tail } else { tail }
}

/// Returns half the complementary error function of a non-negative number (Abramowitz
/// and Stegun 1964, 7.1.26: within 1.5e-7).
fn half_erfc(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let series = 0.254_829_592
        + t * (-0.284_496_736 + t * (1.421_413_741 + t * (-1.453_152_027 + t * 1.061_405_429)));
    0.5 * t * series * (-x * x).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Instant {
        Instant::parse(text).unwrap()
    }

    fn call(eta_uncertainty_h: f64) -> PortCall {
        PortCall {
            id: "c".to_owned(),
            name: None,
            vessel: "v".to_owned(),
            port: PortCode::parse("NLRTM").unwrap(),
            berth: None,
            eta: at("2026-12-01T06:00:00Z"),
            eta_uncertainty_h,
            etd: at("2026-12-03T06:00:00Z"),
            etd_uncertainty_h: 0.0,
            berth_heading_deg: None,
        }
    }

    #[test]
    fn at_the_bounds_of_the_uncertainty_one_call_in_forty_is_missed() {
        // Latest start 15:00, nine hours after an ETA good to nine hours: 2.5
        // %.
        let (begins, ends) = (at("2026-12-01T08:00:00Z"), at("2026-12-01T18:00:00Z"));
        let missed = call(9.0).chance_of_missing(begins, ends, 3.0);
        assert!((missed - 0.025).abs() < 1e-4, "{missed}");
        assert!(call(0.0).chance_of_missing(begins, ends, 3.0).abs() < 1e-12);
        let noon = at("2026-12-01T08:30:00Z");
        assert!((call(0.0).chance_of_missing(begins, noon, 3.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn calls_of_one_ship_that_overlap_are_found_whatever_their_order() {
        let (first, mut next, mut other) = (call(0.0), call(0.0), call(0.0));
        (next.eta, next.etd) = (first.etd, at("2026-12-05T06:00:00Z"));
        other.vessel = "w".to_owned();
        let calls = [next.clone(), other.clone(), first.clone()];
        assert_eq!(find_overlap(&calls), None);
        next.eta = at("2026-12-03T05:59:59Z");
        assert_eq!(find_overlap(&[next, other, first]), Some((0, 2)));
    }

    #[test]
    fn a_call_that_is_over_or_ends_before_it_begins_is_refused_by_field() {
        let over = call(0.0).checked(at("2026-12-03T06:00:00Z")).unwrap_err();
        assert_eq!(over.field, "etd");
        assert!(over.detail.contains("in the past"));
        let mut backwards = call(0.0);
        backwards.etd = backwards.eta;
        assert_eq!(
            backwards
                .checked(at("2026-11-01T00:00:00Z"))
                .unwrap_err()
                .field,
            "etd"
        );
    }
}
