//! Entry of a deviation book: an observed deviation, beside the card's.

use super::cards::{CardReading, Cards};
use super::select::{Occasion, select_entries};
use crate::card;
use binnacle_compass::angle::{GyroError, GyroHeading, TrueHeading, wrap_180};
use binnacle_compass::azimuth::AzimuthKind;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::result::{SampleDiagnostic, SampleReason};
use binnacle_compass::ship::EarthField;
use binnacle_fleet::azimuths::StoredAzimuth;
use binnacle_platform::ids::AzimuthId;
use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

/// A compass error that was observed.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = DeviationBookEntry)]
pub(super) struct Entry {
    /// The middle of the stretch; for an azimuth, its moment.
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
    /// Compass error: deviation plus variation, degrees, east positive.
    #[schema(example = 2.7)]
    pub(super) compass_error_deg: f64,
    /// Gyro error by an azimuth: true less gyro, degrees, east positive.
    #[schema(required, example = 0.2)]
    pub(super) gyro_error_deg: Option<f64>,
    /// Initials of the officer who observed an azimuth.
    #[schema(required, example = "LW")]
    pub(super) initials: Option<String>,
    /// Remark of that officer.
    #[schema(required)]
    pub(super) remark: Option<String>,
    /// The azimuth.
    #[schema(required)]
    pub(super) azimuth_id: Option<AzimuthId>,
}

/// Place of an entry in the book: its time, and then the azimuth, which a sample has none of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct EntryKey {
    pub(super) time: Time,
    pub(super) azimuth: Uuid,
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
    /// The course over ground, less what current and wind are estimated to set her.
    CourseOverGround,
    /// The sun's true azimuth.
    SunAzimuth,
    /// The sun's amplitude at the horizon.
    SunAmplitude,
    /// Another body.
    Body,
    /// A transit of charted marks.
    Transit,
    /// A charted quay.
    Quay,
}

/// Observer of a compass error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = BookObserver)]
pub(super) enum Observer {
    /// The agent on board, by itself.
    Automatic,
    /// An officer, by an azimuth.
    Officer,
}

/// Makes the entries of samples.
pub(super) fn of_samples(samples: Vec<SampleDiagnostic>, cards: Cards<'_>) -> Vec<Entry> {
    let chosen = select_entries(samples).into_iter();
    chosen
        .filter_map(|(occasion, sample)| of_sample(occasion, &sample, cards))
        .collect()
}

/// Returns `None` for a sample without a deviation.
fn of_sample(occasion: Occasion, found: &SampleDiagnostic, cards: Cards<'_>) -> Option<Entry> {
    let sample = &found.sample;
    let (deviation_deg, variation_deg) = found.deviation_deg.zip(found.variation_deg)?;
    let reference = match (sample.gyro, sample.satellite) {
        (Some(_), Some(_)) => Reference::GyroAndSatellite,
        (Some(_), None) => Reference::Gyro,
        (None, Some(_)) => Reference::Satellite,
        (None, None) => Reference::CourseOverGround,
    };
    let time = Time(sample.time);
    let earth = found.h_nt.zip(found.z_nt);
    let earth = earth.map(|(h_nt, z_nt)| EarthField { h_nt, z_nt });
    let card = earth.and_then(|earth| cards.read(time, sample.compass, earth));
    let compass_deg = sample.compass.degrees();
    let compass_error_deg = wrap_180(deviation_deg + variation_deg);
    let observed = Entry {
        time,
        occasion,
        lat: sample.position.lat_deg(),
        lon: sample.position.lon_deg(),
        compass_deg,
        reference,
        true_deg: (compass_deg + compass_error_deg).rem_euclid(360.0),
        gyro_deg: sample.gyro.map(TrueHeading::degrees),
        satellite_deg: sample.satellite.map(TrueHeading::degrees),
        variation_deg,
        deviation_deg,
        model_version: None,
        card_status: None,
        card_deviation_deg: None,
        card_band95_deg: None,
        difference_deg: None,
        windows: sample.windows,
        spread_deg: sample.spread_deg,
        reason: found.reason,
        observer: Observer::Automatic,
        compass_error_deg,
        gyro_error_deg: None,
        initials: None,
        remark: None,
        azimuth_id: None,
    };
    Some(observed.beside(card))
}

/// Makes the entry of an azimuth.
pub(super) fn of_azimuth(stored: &StoredAzimuth, cards: Cards<'_>) -> Entry {
    let (azimuth, result) = (&stored.azimuth, stored.azimuth.result());
    let (time, position) = (azimuth.time(), azimuth.position());
    let heading = azimuth.compass_heading();
    let earth = field(FieldModel::Igrf14, position, 0.0, time).ok();
    let card = earth.and_then(|earth| cards.read(Time(time), heading, earth.for_ship()));
    let observed = Entry {
        time: Time(time),
        occasion: Occasion::Azimuth,
        lat: position.lat_deg(),
        lon: position.lon_deg(),
        compass_deg: heading.degrees(),
        reference: Reference::from(azimuth.kind()),
        true_deg: result.true_heading_deg.degrees(),
        gyro_deg: azimuth.gyro_heading().map(GyroHeading::degrees),
        satellite_deg: None,
        variation_deg: result.variation_deg.degrees_east(),
        deviation_deg: result.deviation_deg.degrees_east(),
        model_version: None,
        card_status: None,
        card_deviation_deg: None,
        card_band95_deg: None,
        difference_deg: None,
        windows: 0,
        spread_deg: None,
        reason: None,
        observer: Observer::Officer,
        compass_error_deg: result.compass_error_deg.degrees_east(),
        gyro_error_deg: result.gyro_error_deg.map(GyroError::degrees_east),
        initials: Some(stored.observer.clone()),
        remark: Some(stored.remark.clone()).filter(|remark| !remark.is_empty()),
        azimuth_id: Some(stored.id),
    };
    observed.beside(card)
}

impl Entry {
    /// Returns the entry beside the reading of a card.
    fn beside(self, card: Option<CardReading>) -> Entry {
        let Some(card) = card else { return self };
        let card_deg = card.prediction.deviation.degrees_east();
        Entry {
            model_version: Some(card.model_version),
            card_status: Some(card.status),
            card_deviation_deg: Some(card_deg),
            card_band95_deg: card.prediction.band95_deg,
            difference_deg: Some(wrap_180(self.deviation_deg - card_deg)),
            ..self
        }
    }

    /// Returns the entry's place in the book. No two entries have the same.
    pub(super) fn key(&self) -> EntryKey {
        EntryKey {
            time: self.time,
            azimuth: self.azimuth_id.map_or(Uuid::nil(), |id| id.0),
        }
    }
}

impl From<AzimuthKind> for Reference {
    fn from(kind: AzimuthKind) -> Reference {
        match kind {
            AzimuthKind::SunAzimuth => Reference::SunAzimuth,
            AzimuthKind::SunAmplitude => Reference::SunAmplitude,
            AzimuthKind::Body => Reference::Body,
            AzimuthKind::Transit => Reference::Transit,
            AzimuthKind::Quay => Reference::Quay,
        }
    }
}
