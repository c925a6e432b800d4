//! Results of an analysis in the database.

use super::disturbances::store_disturbances;
use super::findings::Findings;
use super::interference::store_interference;
use super::segments::{self, NewSegment};
use super::track::track;
use crate::binnacles;
use crate::event_kinds;
use crate::models::{self, ModelJson, StoredModel};
use binnacle_adjustment::corrector::needles_of_model;
use binnacle_compass::coverage::Coverage;
use binnacle_compass::result::{Analysis, Epoch, PredictionCoverage, ReferenceCheck, SailNext};
use binnacle_platform::db::{Db, Tx, execute, row};
use binnacle_platform::error::Result;
use binnacle_platform::events::{self, Event};
use binnacle_platform::ids::{CompassId, ModelId, VesselId};
use binnacle_platform::time::Time;
use binnacle_wire::messages::CardWithdrawn;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Results of one compass's analysis.
pub struct AnalysisResult {
    /// The vessel.
    pub vessel_id: VesselId,
    /// The compass.
    pub compass_id: CompassId,
    /// Hash of the input.
    pub input_hash: String,
    /// The analysis, with the samples of two months at least.
    pub analysis: Analysis,
    /// Segments that were derived anew.
    pub segments: Vec<NewSegment>,
    /// Headings and latitudes that its samples cover.
    pub covered: Covered,
    /// Findings that alerts rest on.
    pub findings: Findings,
}

/// Coverage of a compass's samples, with advice, and checks of the references and of the band.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = Coverage)]
pub struct Covered {
    /// Counts of samples.
    #[serde(flatten)]
    #[schema(inline)]
    pub coverage: Coverage,
    /// Advice on the headings and waters that narrow the 95 % band most; none without a model.
    #[serde(default)]
    #[schema(required)]
    pub sail_next: Option<SailNext>,
    /// Comparison of gyro and satellite compass over the samples since the last change of the ship
    /// or the compass. None before the first analysis, and where a model is refused because they
    /// disagree.
    #[serde(default)]
    #[schema(required)]
    pub references: Option<ReferenceCheck>,
    /// Predictions of readings before their use, and the share that the 95 % band held. None
    /// before the first analysis.
    #[serde(default)]
    #[schema(required)]
    pub predictions: Option<PredictionCoverage>,
}

/// Returns the hash of the input of a compass's last analysis.
pub async fn last_hash(db: &Db, vessel: VesselId, compass: CompassId) -> Result<Option<String>> {
    let found = row!(
        db,
        (String,),
        "SELECT input_hash FROM analyses WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY compass_id",
        vessel,
        compass
    )?;
    Ok(found.map(|(hash,)| hash))
}

/// Returns the coverage of a compass's samples; empty before the first analysis.
pub async fn coverage(db: &Db, vessel: VesselId, compass: CompassId) -> Result<Covered> {
    let found = row!(
        db,
        (String,),
        "SELECT coverage FROM analyses WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY compass_id",
        vessel,
        compass
    )?;
    let Some((text,)) = found else {
        return Ok(Covered {
            coverage: binnacle_compass::coverage::coverage([]),
            sail_next: None,
            references: None,
            predictions: None,
        });
    };
    Ok(serde_json::from_str(&text)?)
}

/// Stores a result in place of the previous one. A new model becomes the compass's current one.
/// Returns an event if the model, or the withdrawal of the card, changed.
pub async fn save(tx: &mut Tx, found: &AnalysisResult, now: Time) -> Result<Option<Event>> {
    let analysis = &found.analysis;
    let withdrawn_before = models::card_withdrawn_in(tx, found.vessel_id, found.compass_id).await?;
    // The prediction of an adjustment holds from its moment on, and through its epoch.
    let predicted = models::find_prediction(tx, found.vessel_id, found.compass_id).await?;
    let predicted = predicted.filter(|model| {
        let from = analysis.current_epoch().and_then(|epoch| epoch.from);
        from.map(Time) <= model.epoch_from
    });
    let withdrawn = match predicted {
        Some(_) => None,
        None => withdrawal(analysis)?,
    };
    execute!(
        &mut *tx,
        "INSERT INTO analyses (vessel_id, compass_id, input_hash, estimator, analysed_at, epochs,
                               coverage, findings, card_withdrawn_at, card_withdrawn_by, track)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)
         ON CONFLICT (vessel_id, compass_id) DO UPDATE
         SET input_hash = excluded.input_hash, estimator = excluded.estimator,
             analysed_at = excluded.analysed_at,
             epochs = excluded.epochs, coverage = excluded.coverage,
             findings = excluded.findings, card_withdrawn_at = excluded.card_withdrawn_at,
             card_withdrawn_by = excluded.card_withdrawn_by, track = excluded.track",
        found.vessel_id,
        found.compass_id,
        found.input_hash.as_str(),
        analysis.estimator.as_str(),
        now,
        serde_json::to_string(&analysis.epochs)?,
        serde_json::to_string(&found.covered)?,
        serde_json::to_string(&found.findings)?,
        withdrawn.as_ref().map(|withdrawn| Time(withdrawn.since)),
        withdrawn
            .as_ref()
            .map(|withdrawn| withdrawn.reason.as_str()),
        serde_json::to_string(&track(&analysis.samples))?
    )?;
    segments::save(tx, found.vessel_id, found.compass_id, &found.segments).await?;
    let (vessel, compass) = (found.vessel_id, found.compass_id);
    store_disturbances(tx, vessel, compass, &found.findings, now).await?;
    store_interference(tx, vessel, compass, &found.findings).await?;
    let next = next_model(found, now)?;
    let next = next.filter(|next| {
        predicted.is_none_or(|known| {
            // A model of the vessel before the adjustment says nothing about it now.
            next.epoch_from >= known.epoch_from && next.replaces_prediction(&known)
        })
    });
    let Some(mut model) = next else {
        if withdrawn == withdrawn_before {
            return Ok(None);
        }
        let event = events::insert(tx, found.vessel_id, event_kinds::MODEL, now).await?;
        return Ok(Some(event));
    };
    // The needles' part of D changes with the horizontal field, and only the correctors tell it.
    let binnacle = binnacles::current_in(tx, found.vessel_id, found.compass_id).await?;
    model.model.0.needles =
        binnacle.and_then(|known| needles_of_model(&known.binnacle.0, &model.model.0));
    models::insert_analysed(tx, &model).await?;
    let event = events::insert(tx, found.vessel_id, event_kinds::MODEL, now).await?;
    Ok(Some(event))
}

/// Returns the withdrawal of an earlier epoch's card while the current epoch has no model.
fn withdrawal(analysis: &Analysis) -> Result<Option<CardWithdrawn>> {
    let Some(epoch) = analysis.current_epoch() else {
        return Ok(None);
    };
    let Some(since) = epoch.from.filter(|_| epoch.model.is_none()) else {
        return Ok(None);
    };
    let reason = begun_by(epoch)?.unwrap_or_else(|| "change".to_owned());
    Ok(Some(CardWithdrawn { since, reason }))
}

/// Returns the kind of logbook entry, or the detected cause, that began an epoch.
fn begun_by(epoch: &Epoch) -> Result<Option<String>> {
    let word = match (epoch.begun_by, epoch.begun_by_change) {
        (Some(reported), _) => serde_json::to_value(reported)?,
        (None, Some(_)) if epoch.resumes.is_some() => "ship_as_before".into(),
        (None, found) => serde_json::to_value(found)?,
    };
    Ok(word.as_str().map(str::to_owned))
}

/// Returns the current epoch's model as a row, or `None` if it was refused.
fn next_model(found: &AnalysisResult, now: Time) -> Result<Option<StoredModel>> {
    let epoch = found.analysis.current_epoch();
    let model = epoch.and_then(|epoch| epoch.model.clone());
    let (Some(epoch), Some(model)) = (epoch, model) else {
        return Ok(None);
    };
    let (Some(place), Some(data_from), Some(data_until)) =
        (found.analysis.last_place, epoch.data_from, epoch.data_until)
    else {
        return Ok(None);
    };
    Ok(Some(StoredModel {
        vessel_id: found.vessel_id,
        id: ModelId::new(),
        compass_id: found.compass_id,
        version: 0,
        created_at: now,
        input_hash: found.input_hash.clone(),
        estimator: found.analysis.estimator.clone(),
        epoch_from: epoch.from.map(Time),
        epoch_to: epoch.to.map(Time),
        epoch_begun_by: begun_by(epoch)?,
        data_from: Time(data_from),
        data_until: Time(data_until),
        place_at: Time(place.time),
        lat: place.position.lat_deg(),
        lon: place.position.lon_deg(),
        variation_deg: place.variation_deg,
        h_nt: place.h_nt,
        z_nt: place.z_nt,
        model: ModelJson(model),
        sent_at: None,
        foretold_by: None,
    }))
}
