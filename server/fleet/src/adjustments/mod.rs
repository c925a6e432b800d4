//! Completed adjustments of a compass: adjuster, firm, and verification by headings at sea.
//!
//! Invariants: an adjustment applies to the model that it predicted, to later fits of the epoch
//! that it began, and to no other. Work orders write these rows; this crate only reads them.

use crate::models::StoredModel;
use binnacle_adjustment::adjust::Verification;
use binnacle_platform::db::{Db, Tx, row, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, OrderId, VesselId};
use binnacle_platform::time::Time;
use serde::Deserialize;
use serde_json::Value;

/// An adjustment that was completed.
#[derive(Clone, Debug)]
pub struct CompletedOrder {
    /// The order.
    pub order: OrderId,
    /// The moment of the adjustment.
    pub at: Time,
    /// The adjuster.
    pub adjuster_name: Option<String>,
    /// The number of their licence.
    pub adjuster_licence: Option<String>,
    /// Their firm.
    pub firm: Option<String>,
    /// Headings at sea that agree with the prediction; none while too few do.
    pub at_sea: Option<AtSea>,
}

/// Headings at sea that agree with the prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtSea {
    /// Time at which they were enough.
    pub verified_at: Time,
    /// Headings that counted.
    pub headings: usize,
    /// Samples on them.
    pub samples: usize,
    /// The time of the last of these.
    pub until: Time,
    /// Root mean square of the headings' differences from the prediction, degrees.
    pub rms_deg: f64,
}

/// Lists the adjustments of a compass that work orders completed, in order of time.
pub async fn completed(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Vec<CompletedOrder>> {
    let found = rows!(
        db,
        Row,
        "SELECT id, completed_at, adjuster_name, adjuster_licence, firm, verified_at,
                verification
         FROM work_orders
         WHERE vessel_id = $1 AND compass_id = $2 AND completed_at IS NOT NULL
         ORDER BY completed_at, id",
        vessel,
        compass
    )?;
    found.into_iter().map(Row::read).collect()
}

/// Returns the version of the model from which an order's record predicted the adjustment.
pub async fn predicted_from(db: &Db, vessel: VesselId, order: OrderId) -> Result<Option<i64>> {
    let found = row!(
        db,
        (Option<String>,),
        "SELECT record FROM work_orders WHERE vessel_id = $1 AND id = $2 ORDER BY id",
        vessel,
        order
    )?;
    let Some(record) = found.and_then(|(record,)| record) else {
        return Ok(None);
    };
    let record: Value = serde_json::from_str(&record)?;
    Ok(record["data"]["model_version"].as_i64())
}

/// Returns the time of a compass's last adjustment by an order.
pub async fn last_adjusted_at(
    tx: &mut Tx,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<Time>> {
    let found = row!(
        in tx,
        (Time,),
        "SELECT completed_at FROM work_orders
         WHERE vessel_id = $1 AND compass_id = $2 AND completed_at IS NOT NULL
         ORDER BY completed_at DESC, id DESC
         LIMIT 1",
        vessel,
        compass
    )?;
    Ok(found.map(|(at,)| at))
}

/// Verdict of the headings at sea, as the order's row keeps it.
#[derive(Deserialize)]
struct Verdict {
    verification: Verification,
    samples: usize,
    until: Time,
}

impl CompletedOrder {
    /// Tells whether a model was predicted by this order, or is of the epoch that it began.
    pub fn is_source_of(&self, model: &StoredModel) -> bool {
        let begun_by = model.epoch_begun_by.as_deref();
        model.foretold_by == Some(self.order)
            || (begun_by == Some("adjustment") && model.epoch_from == Some(self.at))
    }
}

#[derive(sqlx::FromRow)]
struct Row {
    id: OrderId,
    completed_at: Time,
    adjuster_name: Option<String>,
    adjuster_licence: Option<String>,
    firm: Option<String>,
    verified_at: Option<Time>,
    verification: Option<String>,
}

impl Row {
    fn read(self) -> Result<CompletedOrder> {
        let verified: Option<Verdict> = self
            .verification
            .map(|text| serde_json::from_str(&text))
            .transpose()?;
        let at_sea = self.verified_at.zip(verified);
        Ok(CompletedOrder {
            order: self.id,
            at: self.completed_at,
            adjuster_name: self.adjuster_name,
            adjuster_licence: self.adjuster_licence,
            firm: self.firm,
            at_sea: at_sea.and_then(|(at, verified)| AtSea::from_verdict(at, &verified)),
        })
    }
}

impl AtSea {
    /// Returns `None` for a verdict other than agreement.
    fn from_verdict(verified_at: Time, verified: &Verdict) -> Option<AtSea> {
        let Verification::Passed {
            headings, rms_deg, ..
        } = verified.verification
        else {
            return None;
        };
        Some(AtSea {
            verified_at,
            headings,
            samples: verified.samples,
            until: verified.until,
            rms_deg,
        })
    }
}
