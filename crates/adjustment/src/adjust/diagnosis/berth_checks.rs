//! Checks of a berth before a plan.

use super::card_check::CardCheck;
use super::misreadings::find_misreadings;
use super::refusal::Refusal;
use super::vertical_check::{VerticalCheck, find_swapped_axes};
use crate::adjust::inputs::{AdjustError, Adjustment, Unit};
use crate::adjust::needle_part::without_needles;
use crate::berth::BerthError;

impl Adjustment<'_> {
    /// Compares the vertical field with the earth's.
    pub(crate) fn vertical_check(&self) -> Option<VerticalCheck> {
        let judged = |read| VerticalCheck::new(read, self.earth, self.binnacle);
        self.vertical.map(judged)
    }

    /// Compares the compass with the measured field, while the correctors are in the
    /// setting of both readings.
    pub(crate) fn card(&self) -> Option<CardCheck> {
        if *self.standing() != self.binnacle.setting {
            return None;
        }
        let constant_deg = self.model.constant_deg;
        let card = |read_deg| {
            CardCheck::new(
                read_deg,
                self.reading,
                self.earth,
                self.binnacle,
                constant_deg,
            )
        };
        self.compass_deg.map(card)
    }
}

/// Collects the refusals that need no calculation.
pub(crate) fn check_preconditions(adjustment: &Adjustment<'_>) -> Vec<Refusal> {
    let mut refusals = Vec::new();
    if adjustment.model.covariance.is_none() {
        refusals.push(Refusal::NoCovariance);
    }
    let limit_days = adjustment.limits.model_age_days;
    if let Some(days) = adjustment.circumstances.model_age_days
        && days > limit_days
    {
        refusals.push(Refusal::ModelTooOld { days, limit_days });
    }
    if adjustment.circumstances.cargo_on_board {
        refusals.push(Refusal::CargoOnBoard);
    }
    refusals
}

/// Converts a failed check of the berth to a refusal; invalid input stays an error.
pub(crate) fn refuse_berth(
    adjustment: &Adjustment<'_>,
    error: BerthError,
) -> Result<Refusal, AdjustError> {
    let reading = adjustment.reading;
    let misreadings = || {
        let earth = adjustment.earth;
        let model = &without_needles(adjustment.model, adjustment.binnacle, earth);
        let mut found = find_misreadings(
            model,
            earth,
            reading.magnetic(),
            reading.field_nt(),
            Unit::Nanotesla,
            reading.errors(),
            reading.alignment(),
        );
        let with =
            |vertical| find_swapped_axes(model, earth, reading, vertical, adjustment.binnacle);
        found.extend(adjustment.vertical.map(with).unwrap_or_default());
        found
    };
    match error {
        BerthError::Inconsistent(_) | BerthError::Implausible(_) => {
            Ok(Refusal::from_berth_error(&error, misreadings()))
        }
        BerthError::NoDirectiveForce { .. } => Ok(Refusal::from_berth_error(&error, Vec::new())),
        error => Err(error.into()),
    }
}
