//! Entry of a deviation book: an observed deviation, beside the card's.

use super::select::{Occasion, select_entries};
use crate::adjustments::CompletedOrder;
use crate::card;
use crate::models::StoredModel;
use binnacle_compass::angle::{TrueHeading, wrap_180};
use binnacle_compass::deviation::Prediction;
use binnacle_compass::result::{SampleDiagnostic, SampleReason};
use binnacle_compass::ship::EarthField;
use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// A compass error that was observed under way.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = DeviationBookEntry)]
pub(super) struct Entry {
    /// The middle of the stretch.
    pub(super) time: Time,
    /// Occasion of the entry.
    pub(super) occasion: Occasion,
    /// Degrees north.
    #[schema(example = 43.4)]
    pub(super) lat: f64,
    /// Degrees east.
    #[schema(example = -3.1)]
    pub(super) lon: f64,
    /// Mean raw compass heading.
    #[schema(example = 92.4)]
    pub(super) compass_deg: f64,
    /// Reference of the true heading.
    pub(super) reference: Reference,
    /// The true heading, with the corrections of the vessel's settings.
    #[schema(example = 95.1)]
    pub(super) true_deg: f64,
    /// The gyro's heading, as it gave it.
    #[schema(required, example = 95.0)]
    pub(super) gyro_deg: Option<f64>,
    /// The satellite compass's heading.
    #[schema(required)]
    pub(super) satellite_deg: Option<f64>,
    /// Variation there, degrees, east positive.
    #[schema(example = 0.4)]
    pub(super) variation_deg: f64,
    /// Observed deviation, degrees, east positive.
    #[schema(example = 2.3)]
    pub(super) deviation_deg: f64,
    /// The version of the model that was in force then; none without a model, or after its
    /// withdrawal.
    #[schema(required, example = 12)]
    pub(super) model_version: Option<i64>,
    /// Status of its card then; none where there was none.
    #[schema(required)]
    pub(super) card_status: Option<card::CardStatus>,
    /// Deviation by the card of that model, degrees, east positive.
    #[schema(required, example = 2.1)]
    pub(super) card_deviation_deg: Option<f64>,
    /// Half the width of its 95 % band, degrees.
    #[schema(required, example = 0.6)]
    pub(super) card_band95_deg: Option<f64>,
    /// Observed less card, degrees.
    #[schema(required, example = 0.2)]
    pub(super) difference_deg: Option<f64>,
    /// Number of settled ten-second windows in the means.
    #[schema(example = 60)]
    pub(super) windows: u16,
    /// Standard deviation of compass less reference among them, degrees.
    #[schema(required, example = 0.3)]
    pub(super) spread_deg: Option<f64>,
    /// Reason for which the observation has less weight, or none, in the model.
    #[schema(required)]
    pub(super) reason: Option<SampleReason>,
    /// Its observer.
    pub(super) observer: Observer,
}

/// Reference of a true heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = BookReference)]
pub(super) enum Reference {
    /// The gyro.
    Gyro,
    /// The satellite compass.
    Satellite,
    /// Both.
    GyroAndSatellite,
}

/// Observer of a compass error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = BookObserver)]
pub(super) enum Observer {
    /// The agent on board, by itself.
    Automatic,
}

/// Times at which cards ended before another model replaced them.
#[derive(Clone, Debug, Default)]
pub(super) struct CardEnds {
    /// Work on compass or ship that the logbook reports.
    pub(super) work: Vec<Time>,
    /// Time from which there is no card at all.
    pub(super) withdrawn: Option<Time>,
}

/// Makes the entries of samples, with the cards of `models` in order of version, and their
/// verification at that time.
pub(super) fn entries(
    samples: Vec<SampleDiagnostic>,
    models: &[StoredModel],
    ends: &CardEnds,
    completed: &[CompletedOrder],
) -> Vec<Entry> {
    let chosen = select_entries(samples).into_iter();
    chosen
        .filter_map(|(occasion, sample)| {
            let at = Time(sample.sample.time);
            let last = models.iter().rev().find(|model| model.created_at <= at);
            entry(
                occasion,
                &sample,
                last.filter(|model| ends.leaves_valid(model, at)),
                completed,
            )
        })
        .collect()
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

/// Returns `None` for a sample without a deviation.
fn entry(
    occasion: Occasion,
    found: &SampleDiagnostic,
    model: Option<&StoredModel>,
    completed: &[CompletedOrder],
) -> Option<Entry> {
    let sample = &found.sample;
    let (deviation_deg, variation_deg) = found.deviation_deg.zip(found.variation_deg)?;
    let reference = match (sample.gyro, sample.satellite) {
        (Some(_), Some(_)) => Reference::GyroAndSatellite,
        (Some(_), None) => Reference::Gyro,
        (None, _) => Reference::Satellite,
    };
    let card = model.and_then(|model| Some((model, predicted(found, model)?)));
    let card_deviation_deg = card.map(|(_, card)| card.deviation.degrees_east());
    let compass_deg = sample.compass.degrees();
    Some(Entry {
        time: Time(sample.time),
        occasion,
        lat: sample.position.lat_deg(),
        lon: sample.position.lon_deg(),
        compass_deg,
        reference,
        true_deg: (compass_deg + deviation_deg + variation_deg).rem_euclid(360.0),
        gyro_deg: sample.gyro.map(TrueHeading::degrees),
        satellite_deg: sample.satellite.map(TrueHeading::degrees),
        variation_deg,
        deviation_deg,
        model_version: card.map(|(model, _)| model.version),
        card_status: card.map(|(model, _)| status(model, completed, Time(sample.time))),
        card_deviation_deg,
        card_band95_deg: card.and_then(|(_, card)| card.band95_deg),
        difference_deg: card_deviation_deg.map(|card_deg| wrap_180(deviation_deg - card_deg)),
        windows: sample.windows,
        spread_deg: sample.spread_deg,
        reason: found.reason,
        observer: Observer::Automatic,
    })
}

/// Returns the status of a model's card at a time.
fn status(model: &StoredModel, completed: &[CompletedOrder], at: Time) -> card::CardStatus {
    let mut bearing = completed.iter().filter(|order| order.is_source_of(model));
    let was_verified =
        bearing.any(|order| order.at_sea.is_some_and(|at_sea| at_sea.verified_at <= at));
    if was_verified {
        card::CardStatus::Verified
    } else {
        card::CardStatus::Predicted
    }
}

/// Returns the deviation on the model's card for the heading, at the vessel's place.
fn predicted(found: &SampleDiagnostic, model: &StoredModel) -> Option<Prediction> {
    let (h_nt, z_nt) = found.h_nt.zip(found.z_nt)?;
    let earth = EarthField { h_nt, z_nt };
    model.model.0.deviation(found.sample.compass, earth).ok()
}
