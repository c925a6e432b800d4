//! Evidence of a group's vessels, by the first epoch of their latest analyses.
//!
//! The first epoch alone is fitted from the prior, a later one from the epoch before. What the
//! prior of that analysis gave is taken away again, see [`ShipPrior::bound`].

use binnacle_analysis::fleet_prior::{Class, ShipEvidence, ShipPrior};
use binnacle_compass::model::Model;
use binnacle_fleet::compasses::Role;
use binnacle_platform::db::{Db, Result, rows};
use binnacle_platform::ids::{OperatorId, VesselId};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use tracing::debug;

/// Compasses that inform each other: of one role, on an operator's vessels of a class.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub(crate) operator: OperatorId,
    pub(crate) class: Class,
    pub(crate) role: Role,
}

/// Latest analysis of a compass, with the prior that it was made with.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(crate) struct Analysed {
    vessel_id: VesselId,
    epochs: String,
    prior: Option<String>,
}

/// Epoch as stored, as far as the evidence needs it.
#[derive(Deserialize)]
struct StoredEpoch {
    model: Option<Model>,
}

/// Lists the latest analyses of a group, by vessel and compass.
pub(crate) async fn list(db: &Db, group: &Group) -> Result<Vec<Analysed>> {
    let sisters = match &group.class {
        Class::Sisters(name) => Some(name.as_str()),
        Class::Operator(_) => None,
    };
    rows!(
        db,
        Analysed,
        "SELECT a.vessel_id, a.epochs, p.prior FROM analyses a
         JOIN vessels v ON v.id = a.vessel_id
         JOIN compasses c ON c.vessel_id = a.vessel_id AND c.id = a.compass_id
         LEFT JOIN vessel_priors p ON p.vessel_id = a.vessel_id AND p.compass_id = a.compass_id
                                  AND p.estimator = a.estimator
         WHERE v.operator_id = $1 AND c.role = $2 AND ($3 IS NULL OR v.sister_class = $3)
         ORDER BY a.vessel_id, a.compass_id",
        group.operator,
        group.role,
        sisters
    )
}

/// Returns the evidence of each vessel, by the first of its compasses that has any.
pub(crate) fn of_vessels(analysed: &[Analysed]) -> Vec<ShipEvidence> {
    let mut found: Vec<ShipEvidence> = Vec::new();
    for one in analysed {
        let vessel = one.vessel_id.to_string();
        if found.last().is_some_and(|last| last.vessel() == vessel) {
            continue;
        }
        match of_vessel(&vessel, one) {
            Ok(evidence) => found.extend(evidence),
            Err(error) => debug!(%vessel, %error, "the vessel is no evidence for its fleet"),
        }
    }
    found
}

/// Returns a vessel's evidence; none while its first epoch has no model.
fn of_vessel(vessel: &str, analysed: &Analysed) -> anyhow::Result<Option<ShipEvidence>> {
    let epochs: Vec<StoredEpoch> = serde_json::from_str(&analysed.epochs)?;
    let Some(model) = epochs.into_iter().next().and_then(|epoch| epoch.model) else {
        return Ok(None);
    };
    let fitted_with: ShipPrior = match &analysed.prior {
        Some(text) => serde_json::from_str(text)?,
        None => ShipPrior::population(),
    };
    let hash = sha256(&serde_json::to_string(&model)?)?;
    let evidence = ShipEvidence::new(vessel, &hash, &model, &fitted_with.bound()?)?;
    Ok(Some(evidence))
}

/// Returns the SHA-256 of a text, as hexadecimal.
fn sha256(text: &str) -> anyhow::Result<String> {
    let mut hexadecimal = String::with_capacity(64);
    for byte in Sha256::digest(text) {
        write!(hexadecimal, "{byte:02x}")?;
    }
    Ok(hexadecimal)
}
