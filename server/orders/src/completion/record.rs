//! Adjustment record: everything that an inspector may need, as canonical JSON.
//!
//! Invariants: it is made once, at completion, and kept as that text; signatures cover its hash.
//! It states that it is not a certificate.

use crate::completion::sign_off::SignOff;
use crate::work_orders::events::OrderEvent;
use crate::work_orders::log::canonical_json::canonical;
use crate::work_orders::log::entry::Entry;
use crate::work_orders::order::NOT_A_CERTIFICATE;
use crate::work_orders::payload::hours::local_time;
use crate::work_orders::store::StoredOrder;
use binnacle_adjustment::adjust::{HeelingPlan, UpdatedPrediction};
use binnacle_adjustment::binnacle::Binnacle;
use binnacle_fleet::compasses::Compass;
use binnacle_platform::error::Result;
use binnacle_platform::time::Time;
use serde_json::json;

/// Vessel and compass of a record.
pub(crate) struct VesselAndCompass {
    pub(crate) vessel_name: String,
    pub(crate) imo_number: Option<String>,
    pub(crate) call_sign: Option<String>,
    pub(crate) flag: Option<String>,
    pub(crate) compass: Compass,
}

/// Makes the record of an order that is being completed.
pub(crate) fn make_record(
    vessel: &VesselAndCompass,
    stored: &StoredOrder,
    prediction: &UpdatedPrediction,
    sign_off: &SignOff,
    account: &str,
    after: &Binnacle,
    server_key: &str,
) -> Result<String> {
    let (summary, state) = (&stored.summary, stored.state());
    let read = state.first_reading.as_deref().or(state.reading.as_ref());
    let basis = read.and_then(|read| read.basis.as_ref());
    let plan = state.plan.as_ref();
    let before = state.before_adjustment.as_ref();
    let second_readings: Vec<_> = stored.log.iter().filter_map(second_reading).collect();
    let hidden = state.unconfirmed_steps();
    let found: Vec<_> = stored.log.iter().filter_map(settings).collect();
    let as_found: Vec<_> = stored.log.iter().filter_map(as_found).collect();
    let steps: Vec<_> = stored.log.iter().filter_map(step).collect();
    let photos: Vec<_> = stored.log.iter().filter_map(photo).collect();
    canonical(&json!({
        "version": 1,
        "what": "record of a magnetic compass adjusted at the berth",
        "standing": NOT_A_CERTIFICATE,
        "order": summary.id,
        "vessel": {
            "id": summary.vessel_id, "name": vessel.vessel_name, "imo_number": vessel.imo_number,
            "call_sign": vessel.call_sign, "flag": vessel.flag,
        },
        "compass": {
            "id": vessel.compass.id, "name": vessel.compass.name, "role": vessel.compass.role,
            "make": vessel.compass.make, "serial_number": vessel.compass.serial_number,
        },
        "port": summary.port,
        "berth": summary.berth,
        "adjusted_at": sign_off.at,
        "adjusted_at_local": sign_off.at.and_then(|at| local_time(&summary.port, at)),
        "agreed_hours": {
            "from": summary.planned_at, "until": summary.planned_until,
            "words": summary.hours().describe(&summary.port),
        },
        "adjuster": {
            "name": sign_off.adjuster_name, "licence": sign_off.adjuster_licence, "firm": sign_off.firm,
            "signature": sign_off.signature, "account": account,
        },
        "data": basis.map(|basis| json!({
            "sha256": basis.model.input_hash, "estimator": basis.model.estimator,
            "until": basis.model.data_until, "headings_until": basis.model.headings_until,
            "model_version": basis.model.version,
        })),
        "model_before": basis.map(|basis| &basis.model.model),
        "earth_at_berth": basis.map(|basis| json!({
            "variation_deg": basis.variation_deg, "h_nt": basis.h_nt, "z_nt": basis.z_nt,
            "model": basis.field_model,
        })),
        "limits": state.limits,
        "waters": basis.map(|basis| &basis.waters),
        "reading": read.map(|read| &read.given),
        "berth_check": read.map(|read| &read.checked),
        "binnacle_before": basis.map(|basis| json!({
            "revision": basis.binnacle_revision, "binnacle": basis.binnacle,
        })),
        "setting_before": basis.map(|basis| &basis.binnacle.setting),
        "setting_after": after.setting,
        "binnacle_after": after,
        "plan": plan.map(|plan| json!({
            "moves": plan.plan.moves, "worst_residual_deg": plan.plan.worst_residual_deg,
            "widest_band_deg": plan.plan.widest_band_deg,
            "heeling": HeelingPlan {
                before_deg_per_deg: before.and_then(|before| before.heeling_deg_per_deg),
                ..plan.plan.heeling
            },
            "optimality": plan.optimality, "offered": plan.offered, "notes": plan.notes,
        })),
        "as_found": as_found,
        "steps_as_read": steps,
        "settings_as_said": found,
        "second_readings": second_readings,
        "not_shown": (!hidden.is_empty()).then(|| json!({ "steps": hidden, "words": NOT_SHOWN })),
        "predicted_before": before.map(|before| &before.deviations),
        "predicted_after": prediction.after,
        "model_after": prediction.model_after,
        "photos": photos,
        "log": {
            "entries": summary.last_seq, "last_sha256": summary.last_sha256,
            "server_key": server_key,
        },
    }))
}

/// Note on steps that neither compass nor magnetometer confirms.
const NOT_SHOWN: &str = "the compass does not show these steps on the berth's heading, and no \
    second reading of the magnetometer confirms them: a slip in one of them can only be found \
    by headings at sea";

fn as_found(entry: &Entry) -> Option<serde_json::Value> {
    let OrderEvent::AsFound(found) = &entry.content else {
        return None;
    };
    Some(json!({
        "at": at(entry.at), "setting": found.setting, "dockside": found.dockside,
        "difference": found.difference, "photos": found.photos,
    }))
}

fn second_reading(entry: &Entry) -> Option<serde_json::Value> {
    let OrderEvent::SecondReading(read) = &entry.content else {
        return None;
    };
    Some(json!({ "at": at(entry.at), "given": read.given, "said": read.result }))
}

fn step(entry: &Entry) -> Option<serde_json::Value> {
    let OrderEvent::Step(done) = &entry.content else {
        return None;
    };
    Some(json!({
        "at": at(entry.at), "said": done.result, "words": done.step.words,
        "moved": done.setting.is_some(),
    }))
}

fn settings(entry: &Entry) -> Option<serde_json::Value> {
    let OrderEvent::CorrectorSettings(moved) = &entry.content else {
        return None;
    };
    Some(json!({
        "at": at(entry.at), "before": moved.before, "after": moved.after, "note": moved.note,
    }))
}

fn photo(entry: &Entry) -> Option<serde_json::Value> {
    let OrderEvent::Photo(photo) = &entry.content else {
        return None;
    };
    Some(json!(photo))
}

fn at(time: Time) -> serde_json::Value {
    json!(time)
}
