//! `/ports`: sea ports by name or UN/LOCODE.

use axum::extract::FromRef;
use binnacle_platform::access::PartyReader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Json, Params};
use binnacle_schedule::ports::{self, PortCode};
use binnacle_schedule::zone::Zone;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

const DEFAULT_LIMIT: usize = 20;
const MOST: usize = 100;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(search_ports))
}

/// Search for a port.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Search {
    /// The beginning of a name or of a UN/LOCODE, or a part of a name.
    #[param(example = "rotterdam")]
    q: String,
    /// Maximum number of results; 20 by default.
    #[param(minimum = 1, maximum = 100)]
    limit: Option<usize>,
}

/// A sea port.
#[derive(Serialize, ToSchema)]
struct Port {
    /// Its UN/LOCODE.
    #[schema(value_type = String, example = "NLRTM")]
    code: PortCode,
    /// Its name.
    #[schema(example = "Rotterdam")]
    name: &'static str,
    /// About where it is, degrees north: not for navigation.
    lat: f64,
    /// Degrees east.
    lon: f64,
    /// Its legal time, by the zone's name in the IANA time zone database.
    #[schema(value_type = String, example = "Europe/Amsterdam")]
    zone: Zone,
}

/// Ports found.
#[derive(Serialize, ToSchema)]
struct PortList {
    /// Ports that begin with the text come first.
    items: Vec<Port>,
}

/// Search for ports
///
/// From UNECE's list of UN/LOCODEs; names are found with and without accents.
#[utoipa::path(get, path = "/ports", tag = "adjusting", params(Search),
    responses((status = 200, body = PortList), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn search_ports(_: PartyReader, Params(search): Params<Search>) -> Result<Json<PortList>> {
    if search.q.chars().count() > MOST {
        return Err(Error::Invalid {
            field: "q",
            detail: format!("is longer than {MOST} characters"),
        });
    }
    let limit = search.limit.unwrap_or(DEFAULT_LIMIT).clamp(1, MOST);
    let items = ports::search(&search.q, limit)
        .into_iter()
        .map(|port| Port {
            code: port.code,
            name: port.name,
            lat: port.position.lat_deg(),
            lon: port.position.lon_deg(),
            zone: port.zone,
        });
    Ok(Json(PortList {
        items: items.collect(),
    }))
}
