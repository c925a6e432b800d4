//! Notices of an analysis, a sentence each.

use super::cargo_entries::{self, ContradictedEntry};
use super::voyage::Voyage;
use crate::constants::{DETECTED_SD, WATCHED_FOR_NT};
use crate::state_space::ship_state::ShipState;
use binnacle_analysis::readings::reading::Reading;
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::model::{Model, ReferenceGrade};
use binnacle_compass::result::Epoch;
use binnacle_compass::ship::{EarthField, PARAMETERS};

/// Notice while a change would not be noticed.
const UNWATCHED: &str = "too little is known of the vessel so far to detect a change of its \
                         magnetism: one would not be noticed. Steady courses on more \
                         headings, by gyro or satellite compass, are needed";
/// Number of headings at which the uncertainty is evaluated.
const HEADINGS: u32 = 24;

/// Returns the notices of an analysis.
pub(super) fn notices(
    voyage: &Voyage,
    readings: &[Reading],
    logbook: &[LogbookEntry],
    epochs: &[Epoch],
    contradicted: &[ContradictedEntry],
) -> Vec<String> {
    let mut notices = cargo_entries::notices(readings, &voyage.past, logbook, contradicted);
    if is_unwatched(voyage, readings, epochs) {
        notices.push(UNWATCHED.to_owned());
    }
    if voyage.azimuths_unread > 0 {
        notices.push(format!(
            "{} azimuths are more than six hours from any sample and are not used",
            voyage.azimuths_unread
        ));
    }
    notices
}

/// Returns true if the present epoch has samples, and a large step would not be detected.
fn is_unwatched(voyage: &Voyage, readings: &[Reading], epochs: &[Epoch]) -> bool {
    let has_data = epochs.last().is_some_and(|last| last.data_from.is_some());
    if !has_data {
        return false;
    }
    let here = readings.iter().rev().find_map(|reading| reading.earth);
    let ship = voyage.tracker.current_ship();
    here.zip(ship)
        .is_none_or(|(earth, ship)| smallest_step_nt(&ship, earth) > WATCHED_FOR_NT)
}

/// Returns the smallest step of (bx, by) that would be detected on most headings, nT: some
/// standard errors of the deviation as it is known.
fn smallest_step_nt(ship: &ShipState, earth: EarthField) -> f64 {
    let seen = ship.in_compass_axes();
    let mut covariance = seen.covariance;
    // The constant is the same before and after a step.
    for row in &mut covariance {
        row[PARAMETERS] = 0.0;
    }
    covariance[PARAMETERS] = [0.0; PARAMETERS + 1];
    let model = Model {
        parameters_over_lambda: seen.parameters(),
        constant_deg: 0.0,
        covariance: Some(covariance),
        identifiable: None,
        rms_deg: None,
        samples_used: 0,
        samples_rejected: 0,
        quality: None,
        reference_grade: ReferenceGrade::Heading,
        mean_h_nt: None,
        needles: None,
    };
    let errors = (0..HEADINGS).map(|k| {
        let compass_deg = f64::from(k * 360 / HEADINGS);
        let compass = CompassHeading::new(compass_deg)?;
        model.deviation(compass, earth).ok()?.standard_error_deg
    });
    let mut errors: Vec<f64> = errors.map(|error| error.unwrap_or(f64::INFINITY)).collect();
    errors.sort_by(f64::total_cmp);
    let middle_deg = errors[errors.len() / 2];
    DETECTED_SD * middle_deg.to_radians() * earth.h_nt
}
