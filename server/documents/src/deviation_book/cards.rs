//! Cards that were in force at a time.

use crate::card::CardStatus;
use binnacle_compass::angle::CompassHeading;
use binnacle_compass::deviation::Prediction;
use binnacle_compass::ship::EarthField;
use binnacle_fleet::adjustments::CompletedOrder;
use binnacle_fleet::models::StoredModel;
use binnacle_platform::time::Time;

/// Cards of a compass over a range of time.
#[derive(Clone, Copy)]
pub(super) struct Cards<'a> {
    /// Models in order of version.
    pub(super) models: &'a [StoredModel],
    /// Times at which cards ended.
    pub(super) ends: &'a CardEnds,
    /// Completed orders, which may have verified a card.
    pub(super) completed: &'a [CompletedOrder],
}

/// Times at which cards ended before another model replaced them.
#[derive(Clone, Debug, Default)]
pub(super) struct CardEnds {
    /// Work on compass or ship that the logbook reports.
    pub(super) work: Vec<Time>,
    /// Time from which there is no card at all.
    pub(super) withdrawn: Option<Time>,
}

/// Reading of the card in force.
pub(super) struct CardReading {
    pub(super) model_version: i64,
    pub(super) status: CardStatus,
    pub(super) prediction: Prediction,
}

impl Cards<'_> {
    /// Reads the card of a time for a heading; none where there was no card.
    pub(super) fn read(
        &self,
        at: Time,
        heading: CompassHeading,
        earth: EarthField,
    ) -> Option<CardReading> {
        let last = self
            .models
            .iter()
            .rev()
            .find(|model| model.created_at <= at);
        let model = last.filter(|model| self.ends.leaves_valid(model, at))?;
        Some(CardReading {
            model_version: model.version,
            status: self.status(model, at),
            prediction: model.model.0.deviation(heading, earth).ok()?,
        })
    }

    /// Returns the status of a model's card at a time.
    fn status(&self, model: &StoredModel, at: Time) -> CardStatus {
        let mut bearing = self
            .completed
            .iter()
            .filter(|order| order.is_source_of(model));
        let was_verified =
            bearing.any(|order| order.at_sea.is_some_and(|at_sea| at_sea.verified_at <= at));
        if was_verified {
            CardStatus::Verified
        } else {
            CardStatus::Predicted
        }
    }
}

impl CardEnds {
    /// Tells whether a model's card was still valid at a time.
    fn leaves_valid(&self, model: &StoredModel, at: Time) -> bool {
        let mut work = self.work.iter();
        let worked = work.any(|begun| {
            // The adjustment that a model was predicted for does not end its card.
            model.epoch_from != Some(*begun) && (model.data_until..=at).contains(begun)
        });
        !worked && self.withdrawn.is_none_or(|since| at < since)
    }
}
