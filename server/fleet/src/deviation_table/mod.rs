//! Deviation table of a compass by its current model, at any place and time.

use crate::compasses;
use crate::deviation::{DeviationRow, table};
use crate::models;
use crate::vessels;
use axum::extract::{FromRef, State};
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Params, degrees, time};
use binnacle_platform::ids::{CompassId, ModelId, VesselId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_deviation))
}

/// Place and time.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Query {
    /// Degrees north; the last position's by default.
    lat: Option<f64>,
    /// Degrees east; the last position's by default.
    lon: Option<f64>,
    /// RFC 3339; the last position's time by default.
    #[param(value_type = Option<String>, format = DateTime)]
    at: Option<String>,
    /// A compass of the vessel; its first one by default.
    compass: Option<CompassId>,
    /// Degrees of compass heading between rows, 1 to 90; 15 by default.
    step_deg: Option<f64>,
}

/// A deviation table.
#[derive(Debug, Serialize, ToSchema)]
pub struct DeviationTable {
    /// Degrees north.
    pub lat: f64,
    /// Degrees east.
    pub lon: f64,
    /// Time.
    pub at: Time,
    /// The earth's variation there, degrees, east positive (IGRF-14).
    pub variation_deg: f64,
    /// Horizontal field there, nT.
    pub h_nt: f64,
    /// Vertical field there, nT, down positive.
    pub z_nt: f64,
    /// The model behind it.
    pub model_id: ModelId,
    /// Its version.
    pub model_version: i64,
    /// By compass heading from 0, each `step_deg`.
    pub rows: Vec<DeviationRow>,
}

/// Deviation by compass heading, at a place and time
#[utoipa::path(get, path = "/vessels/{id}/deviation", tag = "fleet",
    params(("id" = VesselId, Path), Query),
    responses((status = 200, body = DeviationTable), (status = 401, body = Problem),
              (status = 404, description = "Also when there is no model yet", body = Problem),
              (status = 422, body = Problem)))]
async fn find_deviation(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(query): Params<Query>,
) -> Result<Json<DeviationTable>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let compass = compasses::find(&app.db, id, query.compass).await?;
    let model = models::must_have(&app, id, compass.id).await?;
    let step_deg = degrees("step_deg", query.step_deg.unwrap_or(15.0), 1.0, 90.0)?;
    let (position, at) = query.place(&model)?;
    let earth =
        field(FieldModel::Igrf14, position, 0.0, at).map_err(|error| invalid("at", &error))?;
    let rows = table(&model.model.0, earth.for_ship(), step_deg)
        .map_err(|error| invalid("lat", &error))?;
    Ok(Json(DeviationTable {
        lat: position.lat_deg(),
        lon: position.lon_deg(),
        at: at.into(),
        variation_deg: earth.declination().degrees_east(),
        h_nt: earth.h_nt(),
        z_nt: earth.z_nt,
        model_id: model.id,
        model_version: model.version,
        rows,
    }))
}

impl Query {
    fn place(&self, model: &models::StoredModel) -> Result<(Position, Timestamp)> {
        let last = Position::new(model.lat, model.lon).map_err(anyhow::Error::from)?;
        let position = position(self.lat, self.lon, last)?;
        let at = time("at", self.at.as_deref())?.unwrap_or(model.place_at.0);
        Ok((position, at))
    }
}

/// Returns the requested place, degrees north and east, or else the last one.
///
/// # Errors
/// Fails when the requested place is invalid or incomplete.
pub fn position(lat: Option<f64>, lon: Option<f64>, last: Position) -> Result<Position> {
    match (lat, lon) {
        (Some(lat), Some(lon)) => {
            Position::new(lat, lon).map_err(|error| invalid("lat, lon", &error))
        }
        (None, None) => Ok(last),
        _ => Err(invalid("lat, lon", &"one without the other")),
    }
}

fn invalid(field: &'static str, detail: &impl std::fmt::Display) -> Error {
    Error::Invalid {
        field,
        detail: detail.to_string(),
    }
}
