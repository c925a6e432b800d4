//! Reason for which a compass has no model.

use super::left_out::LeftOut;
use axum::http::StatusCode;
use binnacle_compass::result::FitError;
use binnacle_platform::db::{Db, row};
use binnacle_platform::error::{DomainProblem, Error, Result};
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_wire::messages::CardWithdrawn;
use serde::{Deserialize, Serialize};
use std::fmt;
use utoipa::ToSchema;

/// Description of a missing model.
#[derive(Clone, Debug)]
pub struct NoModel {
    /// Reason for which the samples make none; none before the first analysis.
    pub refusal: Option<FitError>,
    /// The samples that the logbook leaves out.
    pub left_out: LeftOut,
    /// Withdrawal of the last model, which must not be used.
    pub card_withdrawn: Option<CardWithdrawn>,
}

impl fmt::Display for NoModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(withdrawn) = &self.card_withdrawn {
            write!(f, "{withdrawn}: ")?;
        }
        match &self.refusal {
            Some(refusal) => write!(f, "{refusal}{}", self.left_out),
            None => f.write_str("no samples have been analysed yet"),
        }
    }
}

/// Fields of the problem `no-model-yet`.
#[derive(Serialize, ToSchema)]
pub struct NoModelFields {
    /// Reason for which the model is refused. Only in `no-model-yet`, and not before the first
    /// samples have been analysed.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(required = false)]
    refusal: Option<FitError>,
    /// The samples that the logbook leaves out of the current epoch; only in
    /// `no-model-yet`, and only if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(required = false)]
    left_out: Option<LeftOut>,
    /// Withdrawal of the last model; only in `no-model-yet`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(required = false)]
    card_withdrawn: Option<CardWithdrawn>,
}

impl From<NoModel> for Error {
    fn from(missing: NoModel) -> Error {
        let detail = missing.to_string();
        let fields = NoModelFields {
            refusal: missing.refusal,
            left_out: Some(missing.left_out).filter(LeftOut::any),
            card_withdrawn: missing.card_withdrawn,
        };
        let problem = DomainProblem {
            status: StatusCode::NOT_FOUND,
            kind: "no-model-yet",
            title: "No model yet",
            detail,
            extra: serde_json::Map::new(),
        };
        problem.with(&fields).into()
    }
}

/// Returns the reason for which the current epoch has no model, and the samples that the logbook
/// leaves out. The reason is none before the first analysis.
pub(super) async fn find_refusal(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<(Option<FitError>, LeftOut)> {
    #[derive(Deserialize)]
    struct Refused {
        refusal: Option<FitError>,
    }
    #[derive(Default, Deserialize)]
    struct Beside {
        #[serde(default)]
        left_out: LeftOut,
    }
    let found = row!(
        db,
        (String, Option<String>),
        "SELECT epochs, findings FROM analyses WHERE vessel_id = $1 AND compass_id = $2
         ORDER BY compass_id",
        vessel,
        compass
    )?;
    let Some((epochs, findings)) = found else {
        return Ok((None, LeftOut::default()));
    };
    let mut epochs: Vec<Refused> = serde_json::from_str(&epochs)?;
    let beside = findings.map(|text| serde_json::from_str::<Beside>(&text));
    let left_out = beside.transpose()?.unwrap_or_default().left_out;
    Ok((epochs.pop().and_then(|epoch| epoch.refusal), left_out))
}
