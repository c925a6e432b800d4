//! Construction of a card from a model, or its refusal.
//!
//! Invariant: a card is a function of the stored records and of the requested place and time. The
//! time of the request only decides whether the model is too old.

use super::check::CardContent;
use super::contents::{
    Card, CardAdjuster, CardCoefficients, CardCorrectors, CardModel, CardNotRecorded, CardPlace,
    CardRow, CardStatus, CardVerification, CardVessel, MagneticCargo, PREDICTED,
    predicted_at_berth, verified,
};
use super::due::{self, next_due};
use super::observed::Observed;
use super::refusal::Refusal;
use super::tables::{NO_BAND_DEG, Tables, tables};
use binnacle_compass::deviation::{Coefficients as Exact, DeviationError};
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_compass::model::Model;
use binnacle_compass::ship::EarthField;
use binnacle_fleet::adjustments::CompletedOrder;
use binnacle_fleet::alerts::{CardEffect, OpenAlert};
use binnacle_fleet::binnacles::StoredRevision;
use binnacle_fleet::compasses::Compass;
use binnacle_fleet::deviation::{self, DeviationRow};
use binnacle_fleet::models::StoredModel;
use binnacle_platform::error::{self, Error};
use binnacle_platform::signing_keys::ServerKey;
use binnacle_platform::time::Time;

/// Records that a card is made from.
pub(super) struct CardInput {
    pub(super) vessel: CardVessel,
    pub(super) compass: Compass,
    pub(super) place: CardPlace,
    pub(super) model: StoredModel,
    /// The first and the last sample that it rests on.
    pub(super) data: (Time, Time),
    /// The binnacle as it is recorded.
    pub(super) binnacle: Option<StoredRevision>,
    /// Entries of the logbook, without withdrawn ones.
    pub(super) logbook: Vec<LogbookEntry>,
    /// Open alerts of this compass.
    pub(super) alerts: Vec<OpenAlert>,
    /// The compass's adjustments by work orders, in order of time.
    pub(super) completed: Vec<CompletedOrder>,
    /// Observations near each line.
    pub(super) observed: [Observed; 24],
    /// The widest half of a band that makes a card, degrees.
    pub(super) limit_deg: f64,
    /// The greatest deviation within the vessel's own limits, degrees.
    pub(super) own_limit_deg: f64,
    /// Time of the request.
    pub(super) now: Time,
    /// Key that signs the card's code.
    pub(super) key: ServerKey,
    /// Public address of the server.
    pub(super) public_url: Option<String>,
}

/// Makes the card, or returns the reason for refusing it.
pub(super) fn make(input: CardInput) -> error::Result<Card> {
    let CardInput { model, place, .. } = &input;
    not_suspected(&input.alerts)?;
    let earth = EarthField {
        h_nt: place.h_nt,
        z_nt: place.z_nt,
    };
    let ship = &model.model.0;
    let Tables {
        curve,
        lines,
        widest_band95_deg,
    } = tables(model, earth, input.limit_deg, place.at.max(input.now))?;
    let coefficients = coefficients(ship, earth)?;
    let at = place.at;
    let cargo = cargo_at(&input.logbook, at);
    let adjusted_at = last(&input.logbook, LogbookKind::Adjustment, at);
    let adjusted_by = adjusted_by(&input.completed, adjusted_at);
    let worst = deviation::worst_of(&curve).ok_or(Refusal::from(DeviationError::NotFinite))?;
    let check_code = content(&input, &lines).code(&input.key);
    let check_code = check_code.map_err(|error| Error::Internal(error.into()))?;
    let verified_by = verified_by(model, &input.completed);
    let unverified = unverified(model, &input.completed);
    let next_due = next_due(&due::Facts {
        flag: input.vessel.flag.as_deref(),
        // An adjustment without support at sea starts no period.
        adjusted_at: adjusted_at.filter(|_| unverified.is_none()),
        logbook: &input.logbook,
        at,
        worst_deviation_deg: worst.deviation_deg,
        own_limit_deg: input.own_limit_deg,
    });
    Ok(Card {
        status: verified_by.map_or(CardStatus::Predicted, |_| CardStatus::Verified),
        statement: match (&verified_by, unverified, model.foretold_by) {
            (Some(by), _, _) => verified(by),
            (None, Some(order), Some(_)) => predicted_at_berth(order.at, order.order),
            (None, _, _) => PREDICTED.to_owned(),
        },
        verified: verified_by,
        unverified_order: unverified.map(|order| order.order),
        rows: lines
            .iter()
            .zip(input.observed)
            .map(|(row, observed)| line(row, observed))
            .collect(),
        worst,
        widest_band95_deg,
        coefficients,
        replaces: model.replaces(),
        notes: notes(model, &input.alerts, &cargo),
        cargo,
        not_recorded: missing([
            (CardNotRecorded::Correctors, input.binnacle.is_none()),
            (
                CardNotRecorded::DegaussingCoils,
                input.vessel.degaussing.is_none(),
            ),
            (CardNotRecorded::Adjuster, adjusted_by.is_none()),
            (CardNotRecorded::Signature, true),
            (
                CardNotRecorded::NextDue,
                next_due.is_none() && unverified.is_none(),
            ),
        ]),
        correctors: input.binnacle.as_ref().map(correctors),
        degaussed_at: last(&input.logbook, LogbookKind::Degaussing, at),
        degaussing: input.vessel.degaussing.clone(),
        adjusted_at,
        adjusted_by,
        next_due,
        model: CardModel {
            id: model.id,
            version: model.version,
            fitted_at: model.created_at,
            foretold_by: model.foretold_by,
            data_from: input.data.0,
            data_until: input.data.1,
            samples_used: ship.samples_used,
            rms_deg: ship.rms_deg,
            estimator: model.estimator.clone(),
            input_hash: model.input_hash.clone(),
        },
        check_url: input
            .public_url
            .map(|url| format!("{}/check/{check_code}", url.trim_end_matches('/'))),
        check_code,
        curve,
        vessel: input.vessel,
        compass: input.compass,
        place: input.place,
    })
}

fn coefficients(ship: &Model, earth: EarthField) -> Result<CardCoefficients, Refusal> {
    Ok(CardCoefficients {
        exact: Exact::new(&ship.parameters_at(earth), earth)?.to_degrees(),
        constant_deg: ship.constant_deg,
        handbook: ship.approximate_coefficients(earth)?,
    })
}

/// Returns what the card's code says.
fn content(input: &CardInput, lines: &[DeviationRow]) -> CardContent {
    let CardInput { model, place, .. } = input;
    let tenths = |row: &DeviationRow| (10.0 * row.deviation_deg).round() as i16;
    CardContent {
        vessel: input.vessel.id,
        compass: input.compass.id,
        version: model.version,
        epoch_from_us: model.replaces().map(|change| change.since.micros()),
        at_us: place.at.0.micros(),
        h_nt: place.h_nt.round() as u32,
        z_nt: place.z_nt.round() as i32,
        deviation_tenths: lines.iter().map(tenths).collect(),
    }
}

/// Returns the verification of the adjustment that the model comes from.
fn verified_by(model: &StoredModel, completed: &[CompletedOrder]) -> Option<CardVerification> {
    let by = completed
        .iter()
        .rev()
        .find(|order| order.is_source_of(model))?;
    let at_sea = by.at_sea?;
    Some(CardVerification {
        order: by.order,
        adjusted_at: by.at,
        verified_at: at_sea.verified_at,
        headings: at_sea.headings,
        samples: at_sea.samples,
        until: at_sea.until,
        rms_deg: at_sea.rms_deg,
    })
}

/// Returns the adjustment that the model comes from, while no headings at sea have verified it.
fn unverified<'a>(
    model: &StoredModel,
    completed: &'a [CompletedOrder],
) -> Option<&'a CompletedOrder> {
    let by = completed
        .iter()
        .rev()
        .find(|order| order.is_source_of(model))?;
    Some(by).filter(|order| order.at_sea.is_none())
}

/// Fails while an alert blocks the card: no model describes a stuck compass, or one that has parted
/// from the gyro.
fn not_suspected(alerts: &[OpenAlert]) -> Result<(), Refusal> {
    let blocks = |alert: &&OpenAlert| alert.cause.effect_on_card() == CardEffect::Block;
    match alerts.iter().find(blocks) {
        Some(alert) => Err(Refusal::CompassSuspected {
            summary: alert.summary.clone(),
        }),
        None => Ok(()),
    }
}

fn line(row: &DeviationRow, observed: Observed) -> CardRow {
    CardRow {
        compass_deg: row.compass_deg,
        magnetic_deg: row.magnetic_deg,
        deviation_deg: row.deviation_deg,
        band95_deg: row.band95_deg.unwrap_or(NO_BAND_DEG),
        samples: observed.samples,
        residual_deg: observed.residual_deg,
    }
}

/// Returns the adjuster of the last adjustment, where it was by a work order.
fn adjusted_by(completed: &[CompletedOrder], adjusted_at: Option<Time>) -> Option<CardAdjuster> {
    let by = completed
        .iter()
        .rev()
        .find(|order| Some(order.at) == adjusted_at)?;
    Some(CardAdjuster {
        order: by.order,
        adjuster: by.adjuster_name.clone(),
        licence: by.adjuster_licence.clone(),
        firm: by.firm.clone(),
    })
}

fn missing<const N: usize>(known: [(CardNotRecorded, bool); N]) -> Vec<CardNotRecorded> {
    let missing = known.into_iter().filter(|(_, is_missing)| *is_missing);
    missing.map(|(item, _)| item).collect()
}

fn correctors(found: &StoredRevision) -> CardCorrectors {
    let binnacle = &found.binnacle.0;
    let design = &binnacle.design;
    CardCorrectors {
        revision: found.revision,
        at: found.at,
        binnacle: format!("{} {}, no. {}", design.maker, design.model, binnacle.serial),
        shape: binnacle.setting.quadrantal.as_ref().and_then(|pair| {
            let sizes = &design.quadrantal.as_ref()?.sizes;
            Some(sizes.iter().find(|size| size.name == pair.size)?.shape)
        }),
        setting: binnacle.setting.clone(),
    }
}

fn cargo_at(logbook: &[LogbookEntry], at: Time) -> Vec<MagneticCargo> {
    let on_board = logbook.iter().filter(|entry| {
        entry.kind == LogbookKind::MagneticCargo
            && entry.from <= at.0
            && entry.to.is_none_or(|to| to >= at.0)
    });
    let words = |entry: &LogbookEntry| {
        let cargo = serde_json::to_value(entry.cargo?).ok()?;
        cargo.as_str().map(str::to_owned)
    };
    on_board
        .map(|entry| MagneticCargo {
            since: Time(entry.from),
            cargo: words(entry),
        })
        .collect()
}

fn last(logbook: &[LogbookEntry], kind: LogbookKind, at: Time) -> Option<Time> {
    let of_kind = logbook.iter().filter(|entry| entry.kind == kind);
    let before = of_kind.map(|entry| Time(entry.to.unwrap_or(entry.from)));
    before.filter(|time| *time <= at).max()
}

fn notes(model: &StoredModel, alerts: &[OpenAlert], cargo: &[MagneticCargo]) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(replaced) = model.replaces() {
        notes.push(sentence(&replaced.of_older_cards()));
    }
    notes.extend(
        alerts
            .iter()
            .filter(|alert| alert.cause.effect_on_card() == CardEffect::Note)
            .map(|alert| alert.summary.clone()),
    );
    if !model.model.0.reference_grade.is_heading() {
        notes.push(
            "By course over ground alone, less an estimated drift by current and wind: no gyro \
             and no satellite compass checks this card. Compare it with azimuths."
                .to_owned(),
        );
    }
    if !cargo.is_empty() {
        notes.push(
            "The logbook has magnetic cargo on board at this date: observe the deviation before \
             this card is used."
                .to_owned(),
        );
    }
    let quality = model.model.0.quality.as_ref();
    let cautions = quality.iter().flat_map(|quality| &quality.cautions);
    notes.extend(cautions.map(|caution| sentence(&caution.to_string())));
    notes
}

fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    format!("{}{}.", first.collect::<String>(), letters.as_str())
}
