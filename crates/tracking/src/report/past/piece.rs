//! Settled readings of one epoch, in sums.

use super::tally::Tally;
use crate::report::diagnostics::observation;
use crate::report::faults::Faults;
use crate::report::kept::is_offered;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::result::SampleReason;
use binnacle_compass::time::Timestamp;
use serde::{Deserialize, Serialize};

/// Settled readings of one epoch that followed each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Piece {
    /// Times of the first and of the last.
    pub(crate) from: Timestamp,
    pub(crate) until: Timestamp,
    pub(crate) readings: u64,
    /// Readings without a reason against their use, those with little weight apart, and readings
    /// with magnetic cargo on board by the logbook.
    pub(crate) free: u64,
    pub(crate) laden: u64,
    /// Readings that the logbook leaves out, because of cargo and because of a berth.
    pub(crate) left_out_laden: u64,
    pub(crate) left_out_alongside: u64,
    /// Readings of gyro and satellite compass that were at fault.
    pub(crate) gyro_dropped: u64,
    pub(crate) satellite_dropped: u64,
    /// True if one has both references.
    pub(crate) has_both: bool,
    /// Readings offered to the model.
    pub(crate) offered: Tally,
    /// Number of those with weight, and the sum of the squares of their residuals.
    pub(crate) used: u64,
    /// Number of rows that a model judged.
    pub(crate) judged: u64,
    pub(crate) squares: f64,
    /// Strongest of the fields that are too weak for a compass, nT.
    pub(crate) strongest_weak_nt: Option<f64>,
}

impl Piece {
    /// Sums up readings with their outcome; none without any. `marks` are the reasons against
    /// their use before the analysis, and `judged` is the number of rows that a model judged.
    pub(crate) fn of(
        readings: &[Reading],
        marks: &[Option<SampleReason>],
        faults: &Faults,
        judged: u64,
    ) -> Option<Piece> {
        let times = readings.first().zip(readings.last());
        let (from, until) = times.map(|(a, b)| (a.sample().time, b.sample().time))?;
        let mut piece = Piece {
            from,
            until,
            readings: readings.len() as u64,
            free: 0,
            laden: 0,
            left_out_laden: 0,
            left_out_alongside: 0,
            gyro_dropped: 0,
            satellite_dropped: 0,
            has_both: false,
            offered: Tally::default(),
            used: 0,
            judged,
            squares: 0.0,
            strongest_weak_nt: None,
        };
        for (reading, mark) in readings.iter().zip(marks) {
            piece.add(reading, *mark, faults);
        }
        Some(piece)
    }

    fn add(&mut self, reading: &Reading, mark: Option<SampleReason>, faults: &Faults) {
        let diagnostic = &reading.diagnostic;
        let is_laden = mark == Some(SampleReason::MagneticCargo);
        let outcome = diagnostic.reason;
        let is_offered = is_offered(outcome);
        self.laden += u64::from(is_laden);
        self.free += u64::from(is_offered && !is_laden);
        self.left_out_laden += u64::from(outcome == Some(SampleReason::MagneticCargo));
        self.left_out_alongside += u64::from(outcome == Some(SampleReason::Berth));
        let (gyro, satellite) = faults.dropped(reading);
        self.gyro_dropped += u64::from(gyro);
        self.satellite_dropped += u64::from(satellite);
        self.has_both |= reading.gyro.is_some() && reading.sample().satellite.is_some();
        if is_offered && let Some(observation) = observation(reading) {
            self.offered.add(&observation);
        }
        if diagnostic.used {
            self.used += 1;
            self.squares += diagnostic
                .residual_deg
                .map_or(0.0, |residual| residual * residual);
        }
        if outcome == Some(SampleReason::FieldTooWeak) {
            let here_nt = reading.earth.map(|earth| earth.h_nt);
            self.strongest_weak_nt = stronger(self.strongest_weak_nt, here_nt);
        }
    }
}

/// Returns the stronger of two fields, where there are any.
pub(crate) fn stronger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).reduce(f64::max)
}
