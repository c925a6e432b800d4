//! The end of an adjustment: the adjuster's word, the record that it stands in, and
//! what follows ashore and on board.
//!
//! What always holds: completion is one transaction. The record, the binnacle as it
//! stands now, the logbook's entry at the moment of the adjustment and the model that
//! is foretold from then on all come about, or none of them.

use crate::completion::record::{self, VesselAndCompass};
use crate::work_orders::log_entry::{OrderEvent, sha256_hex};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::order_update::Change;
use crate::work_orders::store::{self, StoredOrder};
use binnacle_adjustment::adjust::UpdatedPrediction;
use binnacle_adjustment::binnacle::Setting;
use binnacle_compass::model::Model;
use binnacle_fleet::binnacles;
use binnacle_fleet::logbook;
use binnacle_fleet::models::{self, ModelJson, StoredModel};
use binnacle_platform::ed25519;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::events::Kind;
use binnacle_platform::http::text;
use binnacle_platform::ids::{BinnacleId, EntryId, FirmId, KeyId, ModelId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The name under which foretold models are stored.
pub const PREDICTED_BY_PLAN: &str = "adjustment-plan-1";

/// The adjuster's word that it is done.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = Completion, example = json!({
    "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114",
    "firm": "Nervión Compass", "signature": "M. Etxeberria"
}))]
pub struct SignOff {
    /// The moment of the adjustment; now where it is not said.
    #[serde(default)]
    pub at: Option<Time>,
    /// The adjuster.
    #[schema(min_length = 1, max_length = 200)]
    pub adjuster_name: String,
    /// The number of their licence.
    #[schema(min_length = 1, max_length = 200)]
    pub adjuster_licence: String,
    /// Their firm.
    #[serde(default)]
    #[schema(max_length = 200)]
    pub firm: Option<String>,
    /// Their name once more, typed as a signature.
    #[schema(min_length = 1, max_length = 200)]
    pub signature: String,
}

/// A completion as the log has it.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = CompletionMade)]
pub struct Completion {
    /// The moment of the adjustment.
    pub at: Time,
    /// The adjuster.
    pub adjuster_name: String,
    /// The number of their licence.
    pub adjuster_licence: String,
    /// Their firm.
    #[schema(required)]
    pub firm: Option<String>,
    /// Their name, typed as a signature.
    pub signature: String,
    /// SHA-256 of the record, hexadecimal: what a firm's key signs.
    pub record_sha256: String,
    /// The logbook's entry of the adjustment.
    pub logbook_entry: EntryId,
    /// The model that holds from then on, foretold.
    pub model_id: ModelId,
    /// The same, whole.
    #[serde(rename = "model")]
    #[schema(value_type = binnacle_fleet::models::ModelSchema)]
    pub model_after: Model,
}

/// A signature by a firm's key.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = RecordSignature)]
pub struct SubmittedSignature {
    /// The Ed25519 public key (RFC 8032), 64 hexadecimal digits.
    #[schema(min_length = 64, max_length = 64)]
    pub public_key: String,
    /// Its signature over the 32 octets of the record's SHA-256, 128 hexadecimal digits.
    #[schema(min_length = 128, max_length = 128)]
    pub signature: String,
}

/// A signature with what is known of its key.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RecordedSignature {
    /// The signature.
    #[serde(flatten)]
    pub signed: SubmittedSignature,
    /// Whose key it is; none for a key that the order's firm has not registered.
    #[serde(default)]
    pub key: Option<KnownKey>,
}

/// A key that a firm had registered when it signed.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub struct KnownKey {
    /// The key's id.
    pub id: KeyId,
    /// What the firm calls it.
    pub name: String,
    /// The firm.
    pub firm_id: FirmId,
    /// The firm's name then.
    pub firm_name: String,
}

impl SignOff {
    /// The word, its words trimmed, at a moment that can be.
    pub(crate) fn checked(self, whole: &StoredOrder, now: Time) -> Result<(SignOff, Time)> {
        let standing = whole.standing();
        let at = self.at.unwrap_or(now);
        let again = standing.again.as_ref().map(|again| again.given.at);
        let read = standing.read.as_ref().map(|read| read.given.at);
        let read_at = again.or(read).map(Time);
        if at > now || read_at.is_some_and(|read_at| at < read_at) {
            return Err(Error::Invalid {
                field: "at",
                detail: "lies in the future, or before the last reading at the berth".to_owned(),
            });
        }
        require_after_last_step(whole, at)?;
        let word = SignOff {
            at: Some(at),
            adjuster_name: text("adjuster_name", &self.adjuster_name)?,
            adjuster_licence: text("adjuster_licence", &self.adjuster_licence)?,
            firm: binnacle_platform::http::optional_text("firm", self.firm.as_deref())?,
            signature: text("signature", &self.signature)?,
        };
        if word.signature.to_lowercase() != word.adjuster_name.to_lowercase() {
            return Err(Error::Invalid {
                field: "signature",
                detail: "is not the adjuster's name".to_owned(),
            });
        }
        Ok((word, at))
    }
}

/// What is done without a connection is sent so much later at most, seconds.
const MAX_SEND_DELAY_S: f64 = 12.0 * 3600.0;

/// Refuses a moment long before correctors were moved for the last time.
pub(crate) fn require_after_last_step(whole: &StoredOrder, at: Time) -> Result<()> {
    let moved = whole.log.iter().rev().find(|entry| {
        matches!(
            entry.content,
            OrderEvent::Step(_) | OrderEvent::CorrectorSettings(_)
        )
    });
    if moved.is_some_and(|moved| moved.at.0.seconds_since(at.0) > MAX_SEND_DELAY_S) {
        return Err(Error::Invalid {
            field: "at",
            detail: "lies long before the last step".to_owned(),
        });
    }
    Ok(())
}

/// The plan's setting, if it stands so.
pub(crate) fn require_planned_setting(standing: &OrderState) -> Result<&Setting> {
    let wrong = |detail: String| Err(Error::WrongState(detail));
    let Some(plan) = &standing.plan else {
        return wrong("there is no plan for how the correctors stand: choose one".to_owned());
    };
    if let Some(again) = standing.disproof() {
        return wrong(format!(
            "the second reading does not confirm it: {}",
            again.said.words
        ));
    }
    if let Some(step) = standing.next_step() {
        let number = step.number;
        return wrong(format!(
            "step {number} is not done: do it, or plan from how they stand"
        ));
    }
    Ok(&plan.plan.setting)
}

/// Completes an order.
pub(crate) async fn complete(
    change: &mut Change<'_>,
    aboard: &VesselAndCompass,
    learnt: UpdatedPrediction,
    word: SignOff,
    at: Time,
) -> Result<()> {
    let standing = change.whole.standing();
    let setting = require_planned_setting(&standing)?.clone();
    let (Some(basis), Some(binnacle)) = (
        standing.read.as_ref().and_then(|read| read.basis.as_ref()),
        standing.binnacle.as_ref(),
    ) else {
        return Err(Error::WrongState("there is no plan".to_owned()));
    };
    let after = binnacle
        .with_setting(setting)
        .map_err(binnacle_fleet::binnacles::invalid_binnacle)?;
    let account = &change.author.name;
    let record = record::text(aboard, &change.whole, &learnt, &word, account, &after)?;
    let (vessel, compass) = (
        change.whole.summary.vessel_id,
        change.whole.summary.compass_id,
    );
    let completed = Completion {
        at,
        adjuster_name: word.adjuster_name.clone(),
        adjuster_licence: word.adjuster_licence.clone(),
        firm: word.firm.clone(),
        signature: word.signature.clone(),
        record_sha256: sha256_hex(record.as_bytes()),
        logbook_entry: EntryId::new(),
        model_id: ModelId::new(),
        model_after: learnt.model_after,
    };
    change.whole.summary.adjuster_name = Some(word.adjuster_name);
    change.whole.summary.adjuster_licence = Some(word.adjuster_licence);
    change.whole.summary.firm = word.firm;
    change.whole.summary.completed_at = Some(at);
    let read_at = standing
        .read
        .as_ref()
        .map_or(at, |read| Time(read.given.at));
    let place = standing
        .read
        .as_ref()
        .map(|read| (read.given.lat, read.given.lon));
    let (lat, lon) = place.unwrap_or_default();
    let model = StoredModel {
        vessel_id: vessel,
        id: completed.model_id,
        compass_id: compass,
        version: 0,
        created_at: change.now,
        input_hash: completed.record_sha256.clone(),
        estimator: PREDICTED_BY_PLAN.to_owned(),
        epoch_from: Some(at),
        epoch_to: None,
        epoch_begun_by: Some("adjustment".to_owned()),
        data_from: read_at,
        data_until: at,
        place_at: at,
        lat,
        lon,
        variation_deg: basis.variation_deg,
        h_nt: basis.h_nt,
        z_nt: basis.z_nt,
        model: ModelJson(completed.model_after.clone()),
        foretold_by: Some(change.whole.summary.id),
    };
    models::insert(&mut change.tx, &model).await?;
    write_binnacle(change, &after, "adjusted").await?;
    let port = change.whole.summary.port.clone();
    write_logbook(change, completed.logbook_entry, at, &port).await?;
    let summary = change.whole.summary.clone();
    let when = (at, change.now);
    store::complete(&mut change.tx, &summary, when, &record).await?;
    change
        .append(OrderEvent::Completion(Box::new(completed)))
        .await?;
    change.tell(Kind::Model).await?;
    change.tell(Kind::Logbook).await
}

/// Writes how the binnacle's correctors stand now.
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
    let summary = &change.whole.summary;
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

/// Writes the adjustment into the vessel's logbook, and has her analysed anew.
pub(crate) async fn write_logbook(
    change: &mut Change<'_>,
    id: EntryId,
    at: Time,
    port: &str,
) -> Result<()> {
    let summary = &change.whole.summary;
    let note = format!("work order {}", summary.id);
    let written = logbook::Adjusted {
        id,
        vessel: summary.vessel_id,
        compass: summary.compass_id,
        at,
        port,
        note: &note,
        author_id: change.author.id.unwrap_or_default(),
        author_name: &change.author.name,
        now: change.now,
    };
    logbook::write_adjustment(&mut change.tx, &written).await
}

impl SubmittedSignature {
    /// Whether the key signed this record.
    ///
    /// # Errors
    /// Names what is no key or no signature, or does not fit.
    pub fn checked(&self, record_sha256: &str) -> Result<()> {
        let key = ed25519::key(&self.public_key)?;
        let record = ed25519::from_hex(record_sha256).unwrap_or_default();
        let signature = ("signature", self.signature.as_str());
        ed25519::must_be_signed(&key, signature, &record, "the record's SHA-256")
    }
}
