//! List of the binnacles of a fleet, one line for each compass, also without a binnacle.

use super::store;
use crate::compasses::Role;
use axum::extract::{FromRef, State};
use binnacle_adjustment::binnacle::{Binnacle, Inventory};
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Json, Page};
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(list_binnacles))
}

/// A compass of the fleet, with its binnacle.
#[derive(Debug, Serialize, ToSchema)]
struct FleetBinnacle {
    /// The vessel's id.
    vessel_id: VesselId,
    /// The vessel's name.
    vessel_name: String,
    /// The compass's id.
    compass_id: CompassId,
    /// Its name.
    compass_name: String,
    /// Its role.
    role: Role,
    /// Its binnacle. None where none was entered, and no adjustment can be planned.
    #[schema(required)]
    binnacle: Option<BinnacleInShort>,
}

/// Summary of a binnacle's latest revision.
#[derive(Debug, Serialize, ToSchema)]
struct BinnacleInShort {
    /// Its maker.
    maker: String,
    /// The maker's name for it.
    model: String,
    /// The maker's number of this one.
    serial: String,
    /// All correctors on board, those in use included.
    #[serde(rename = "aboard")]
    inventory: Inventory,
    /// Number of measured effects.
    measured_effects: usize,
    /// Counts from 1.
    revision: i64,
    /// Time of the revision.
    at: Time,
    /// Author of the revision.
    by: String,
    /// Reason, in a few words.
    #[schema(required)]
    reason: Option<String>,
}

/// A page of binnacles.
#[derive(Serialize, ToSchema)]
struct FleetBinnacleList {
    /// In the order in which the compasses were entered.
    items: Vec<FleetBinnacle>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// List the fleet's binnacles
///
/// Every compass of the vessels in service, with a summary of its binnacle where one is entered.
#[utoipa::path(get, path = "/binnacles", tag = "adjusting", params(Page),
    responses((status = 200, body = FleetBinnacleList), (status = 401, body = Problem)))]
async fn list_binnacles(
    State(app): State<App>,
    reader: Reader,
    page: Page,
) -> Result<Json<FleetBinnacleList>> {
    let after = page.after_id()?;
    let found = store::of_fleet(&app.db, reader.operator, after, page.fetch()).await?;
    let listed = page.cut(found, |row| row.compass_id.to_string());
    let items: Result<Vec<FleetBinnacle>> = listed
        .items
        .into_iter()
        .map(FleetBinnacle::from_row)
        .collect();
    Ok(Json(FleetBinnacleList {
        items: items?,
        next: listed.next,
    }))
}

impl FleetBinnacle {
    fn from_row(row: store::CompassRow) -> Result<FleetBinnacle> {
        let binnacle = row.revised()?.map(BinnacleInShort::from_revision);
        Ok(FleetBinnacle {
            vessel_id: row.vessel_id,
            vessel_name: row.vessel_name,
            compass_id: row.compass_id,
            compass_name: row.compass_name,
            role: row.role,
            binnacle,
        })
    }
}

impl BinnacleInShort {
    fn from_revision(written: store::StoredRevision) -> BinnacleInShort {
        let binnacle: &Binnacle = &written.binnacle.0;
        BinnacleInShort {
            maker: binnacle.design.maker.clone(),
            model: binnacle.design.model.clone(),
            serial: binnacle.serial.clone(),
            inventory: binnacle.inventory.clone(),
            measured_effects: binnacle.calibration.len(),
            revision: written.revision,
            at: written.at,
            by: written.author_name,
            reason: written.reason,
        }
    }
}
