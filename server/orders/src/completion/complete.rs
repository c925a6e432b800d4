//! Completion of an adjustment: its record and the consequences for server and vessel.
//!
//! Invariants: completion is one transaction. It writes the record, the revision of the binnacle,
//! the entry in the logbook and the predicted model, or none of them.

use crate::completion::record;
use crate::completion::record::VesselAndCompass;
use crate::completion::sign_off::SignOff;
use crate::work_orders::events::OrderEvent;
use crate::work_orders::log::canonical_json::sha256_hex;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::order_update::Change;
use crate::work_orders::payload::signed_record::Completion;
use crate::work_orders::store;
use binnacle_adjustment::adjust::UpdatedPrediction;
use binnacle_adjustment::binnacle::Setting;
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::model::Model;
use binnacle_fleet::binnacles;
use binnacle_fleet::event_kinds;
use binnacle_fleet::logbook;
use binnacle_fleet::models::{self, ModelJson, StoredModel};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{BinnacleId, EntryId, ModelId};
use binnacle_platform::signing_keys;
use binnacle_platform::time::Time;

/// Estimator name of predicted models.
pub const PREDICTED_BY_PLAN: &str = "adjustment-plan-1";

/// Returns the plan's setting, if the correctors have it.
pub(crate) fn require_planned_setting(state: &OrderState) -> Result<&Setting> {
    let wrong = |detail: String| Err(Error::WrongState(detail));
    let Some(plan) = &state.plan else {
        return wrong(
            "there is no plan for the present settings of the correctors: choose one".to_owned(),
        );
    };
    if let Some(second) = state.contradicting_reading() {
        return wrong(format!(
            "the second reading does not confirm it: {}",
            second.result.words
        ));
    }
    if let Some(step) = state.next_step() {
        let number = step.number;
        return wrong(format!(
            "step {number} is not done: do it, or plan from the present settings"
        ));
    }
    if state.has_unexplained_step {
        return wrong(
            "nothing explains the compass after the last step: report how the correctors stand, \
                under corrector-settings"
                .to_owned(),
        );
    }
    Ok(&plan.plan.setting)
}

/// Completes an order.
pub(crate) async fn complete(
    change: &mut Change<'_>,
    vessel_and_compass: &VesselAndCompass,
    prediction: UpdatedPrediction,
    sign_off: SignOff,
    at: Time,
) -> Result<()> {
    let state = change.stored.state();
    let setting = require_planned_setting(&state)?.clone();
    let Some(binnacle) = state.binnacle.as_ref() else {
        return Err(Error::WrongState("there is no plan".to_owned()));
    };
    let after = binnacle
        .with_setting(setting)
        .map_err(binnacle_fleet::binnacles::invalid_binnacle)?;
    let account = &change.author.name;
    let key = signing_keys::current(&mut change.tx, change.now).await?;
    let record = record::make_record(
        vessel_and_compass,
        &change.stored,
        &prediction,
        &sign_off,
        account,
        &after,
        &key.public_key(),
    )?;
    let completed = Completion {
        at,
        adjuster_name: sign_off.adjuster_name.clone(),
        adjuster_licence: sign_off.adjuster_licence.clone(),
        firm: sign_off.firm.clone(),
        signature: sign_off.signature.clone(),
        record_sha256: sha256_hex(record.as_bytes()),
        logbook_entry: EntryId::new(),
        model_id: ModelId::new(),
        model_after: prediction.model_after,
    };
    change.stored.summary.adjuster_name = Some(sign_off.adjuster_name);
    change.stored.summary.adjuster_licence = Some(sign_off.adjuster_licence);
    change.stored.summary.firm = sign_off.firm;
    change.stored.summary.completed_at = Some(at);
    let predicted = PredictedModel {
        id: completed.model_id,
        at,
        begun_by: LogbookKind::Adjustment,
        input_hash: completed.record_sha256.clone(),
        model: completed.model_after.clone(),
    };
    write_model(change, &state, predicted).await?;
    write_binnacle(change, &after, "adjusted").await?;
    let entry = completed.logbook_entry;
    write_logbook(change, LogbookKind::Adjustment, entry, at).await?;
    let summary = change.stored.summary.clone();
    store::store_completion(&mut change.tx, &summary, at, change.now, &record).await?;
    change
        .append(OrderEvent::Completion(Box::new(completed)))
        .await?;
    change.add_live_event(event_kinds::LOGBOOK).await
}

/// Model of the compass as an order leaves it.
pub(crate) struct PredictedModel {
    /// Id of the model.
    pub(crate) id: ModelId,
    /// Time from which it holds.
    pub(crate) at: Time,
    /// Kind of the logbook's entry that begins its epoch.
    pub(crate) begun_by: LogbookKind,
    /// SHA-256 of everything that it was made from.
    pub(crate) input_hash: String,
    /// The model.
    pub(crate) model: Model,
}

/// Writes the model of the compass as the order leaves it, for the place of the reading.
///
/// # Errors
/// [`Error::WrongState`] before the berth was read.
pub(crate) async fn write_model(
    change: &mut Change<'_>,
    state: &OrderState,
    predicted: PredictedModel,
) -> Result<()> {
    let read = state.reading.as_ref();
    let Some((read, basis)) = read.and_then(|read| Some((read, read.basis.as_ref()?))) else {
        return Err(Error::WrongState("there is no plan".to_owned()));
    };
    let begun_by = serde_json::to_value(predicted.begun_by)?;
    let model = StoredModel {
        vessel_id: change.stored.summary.vessel_id,
        id: predicted.id,
        compass_id: change.stored.summary.compass_id,
        version: 0,
        created_at: change.now,
        input_hash: predicted.input_hash,
        estimator: PREDICTED_BY_PLAN.to_owned(),
        epoch_from: Some(predicted.at),
        epoch_to: None,
        epoch_begun_by: begun_by.as_str().map(str::to_owned),
        data_from: Time(read.given.at),
        data_until: predicted.at,
        place_at: predicted.at,
        lat: read.given.lat,
        lon: read.given.lon,
        variation_deg: basis.variation_deg,
        h_nt: basis.h_nt,
        z_nt: basis.z_nt,
        model: ModelJson(predicted.model),
        sent_at: None,
        foretold_by: Some(change.stored.summary.id),
    };
    models::insert(&mut change.tx, &model).await?;
    change.add_live_event(event_kinds::MODEL).await
}

/// Writes the present settings as a revision of the binnacle.
pub(crate) async fn write_binnacle(
    change: &mut Change<'_>,
    binnacle: &binnacle_adjustment::binnacle::Binnacle,
    what: &str,
) -> Result<()> {
    let author = binnacles::Author {
        id: change.author.id.unwrap_or_default(),
        name: change.author.name.clone(),
        at: change.now,
    };
    let summary = &change.stored.summary;
    let reason = format!("{what} by work order {}", summary.id);
    binnacles::insert(
        &mut change.tx,
        summary.vessel_id,
        summary.compass_id,
        BinnacleId::new(),
        binnacle,
        Some(&reason),
        &author,
    )
    .await
}

/// Writes the order's work on the compass into the vessel's logbook, and requests a new analysis.
pub(crate) async fn write_logbook(
    change: &mut Change<'_>,
    kind: LogbookKind,
    id: EntryId,
    at: Time,
) -> Result<()> {
    let summary = &change.stored.summary;
    let note = format!("work order {}", summary.id);
    let written = logbook::CompassWork {
        kind,
        id,
        vessel: summary.vessel_id,
        compass: summary.compass_id,
        at,
        port: &summary.port,
        note: &note,
        author_id: change.author.id.unwrap_or_default(),
        author_name: &change.author.name,
        now: change.now,
    };
    logbook::write_compass_work(&mut change.tx, &written).await
}
