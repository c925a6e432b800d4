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

/// Number of results by default.
const DEFAULT_LIMIT: usize = 20;
/// Maximum number of results, and of characters in a query.
const MAX: usize = 100;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(search_ports))
}

/// Query of a search for ports.
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
    /// UN/LOCODE of the port.
    #[schema(value_type = String, example = "NLRTM")]
    code: PortCode,
    /// Name of the port.
    #[schema(example = "Rotterdam")]
    name: &'static str,
    /// Approximate latitude, degrees north; not for navigation.
    lat: f64,
    /// Approximate longitude, degrees east.
    lon: f64,
    /// Time zone of the port, IANA name.
    #[schema(value_type = String, example = "Europe/Amsterdam")]
    zone: Zone,
}

/// Result of a search.
#[derive(Serialize, ToSchema)]
struct PortList {
    /// Ports; those whose name begins with the text come first.
    items: Vec<Port>,
}

/// Search for ports
///
/// Ports are those of UNECE's list of UN/LOCODEs. Accents do not matter.
#[utoipa::path(get, path = "/ports", tag = "adjusting", params(Search),
    responses((status = 200, body = PortList), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn search_ports(_: PartyReader, Params(search): Params<Search>) -> Result<Json<PortList>> {
    if search.q.chars().count() > MAX {
        return Err(Error::Invalid {
            field: "q",
            detail: format!("is longer than {MAX} characters"),
        });
    }
    let limit = search.limit.unwrap_or(DEFAULT_LIMIT).clamp(1, MAX);
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
