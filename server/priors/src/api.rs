//! HTTP API of priors: what a compass began with, and what the fleet has published.

use crate::publications::{self, Listed};
use crate::vessel_priors::{self, RefusedClass, VesselPrior};
use axum::extract::{FromRef, State};
use binnacle_analysis::fleet_prior::{Basis, Class, FEWEST_SHIPS};
use binnacle_fleet::compasses::{self, Role, WhichCompass};
use binnacle_fleet::vessels;
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Params};
use binnacle_platform::ids::{CompassId, FleetPriorId, VesselId};
use binnacle_platform::time::Time;
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(find_prior))
        .routes(routes!(list_fleet_priors))
}

/// Prior knowledge that a compass's analysis began with.
#[derive(Debug, Serialize, ToSchema)]
struct Prior {
    /// The compass.
    compass_id: CompassId,
    /// The estimator that began with it; none before the first analysis.
    #[schema(required)]
    estimator: Option<String>,
    /// Time at which it was chosen; none before the first analysis. It is kept until another
    /// estimator derives the vessel anew.
    #[schema(required)]
    chosen_at: Option<Time>,
    /// Vessels that it was made of; none for the prior of all ships.
    #[schema(required)]
    basis: Option<PriorBasis>,
    /// Classes that were too small to inform the vessel.
    refused: Vec<RefusedPriorClass>,
}

/// Vessels that a prior was made of.
#[derive(Debug, Serialize, ToSchema)]
struct PriorBasis {
    /// Version of the method.
    method: u32,
    /// Time of the publication.
    published_at: Time,
    /// Their class.
    class: PriorClass,
    /// Their number, without the vessel itself.
    #[schema(example = 12)]
    ships: usize,
}

/// A class that was too small to inform a vessel.
#[derive(Debug, Serialize, ToSchema)]
struct RefusedPriorClass {
    /// The class.
    class: PriorClass,
    /// Number of other vessels with evidence.
    #[schema(example = 1)]
    ships: usize,
    /// Least number.
    #[schema(example = 2)]
    needed: usize,
}

/// Vessels that inform each other.
#[derive(Debug, Serialize, ToSchema)]
#[serde(tag = "kind", content = "name", rename_all = "snake_case")]
enum PriorClass {
    /// Sister ships, by the name of their class.
    Sisters(String),
    /// All vessels of the operator.
    Operator,
}

/// A publication of what a fleet's vessels say of a new one.
#[derive(Debug, Serialize, ToSchema)]
struct FleetPriorSummary {
    /// The publication's id.
    id: FleetPriorId,
    /// Time of the publication.
    published_at: Time,
    /// The estimator whose analyses begin with it.
    estimator: String,
    /// Version of the method.
    method: i64,
    /// Class of the vessels.
    class: PriorClass,
    /// Role of the compasses.
    role: Role,
    /// Number of vessels with evidence.
    ships: i64,
}

/// A page of publications.
#[derive(Serialize, ToSchema)]
struct FleetPriorList {
    /// The newest first.
    items: Vec<FleetPriorSummary>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// See the prior that a compass's analysis began with
#[utoipa::path(get, path = "/vessels/{id}/prior", tag = "fleet",
    params(("id" = VesselId, Path), WhichCompass),
    responses((status = 200, body = Prior), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_prior(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(which): Params<WhichCompass>,
) -> Result<Json<Prior>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
    let compass = compasses::find(&app.db, id, which.compass).await?;
    let found = vessel_priors::find_of_analysis(&app.db, id, compass.id).await?;
    Ok(Json(Prior::new(compass.id, found)))
}

/// List the fleet's published priors
///
/// A class is published when a new vessel needs it, at most once in 30 days.
#[utoipa::path(get, path = "/fleet-priors", tag = "fleet", params(Page),
    responses((status = 200, body = FleetPriorList), (status = 401, body = Problem)))]
async fn list_fleet_priors(
    State(app): State<App>,
    reader: Reader,
    page: Page,
) -> Result<Json<FleetPriorList>> {
    let before = page.after_id()?;
    let found = publications::list(&app.db, reader.operator, before, page.fetch()).await?;
    let listed = page.cut(found, |one| one.id.to_string());
    Ok(Json(FleetPriorList {
        items: listed.items.into_iter().map(Listed::shown).collect(),
        next: listed.next,
    }))
}

impl Prior {
    /// Shows the prior of a compass, if one is stored.
    fn new(compass_id: CompassId, found: Option<VesselPrior>) -> Prior {
        let Some(found) = found else {
            return Prior {
                compass_id,
                estimator: None,
                chosen_at: None,
                basis: None,
                refused: Vec::new(),
            };
        };
        Prior {
            compass_id,
            estimator: Some(found.estimator),
            chosen_at: Some(found.chosen_at),
            basis: found.prior.basis.map(PriorBasis::from),
            refused: found.refused.into_iter().map(Into::into).collect(),
        }
    }
}

impl Listed {
    fn shown(self) -> FleetPriorSummary {
        FleetPriorSummary {
            id: self.id,
            published_at: self.published_at,
            estimator: self.estimator,
            method: self.method,
            class: match self.class_kind.as_str() {
                "sisters" => PriorClass::Sisters(self.class_name),
                _ => PriorClass::Operator,
            },
            role: self.role,
            ships: self.ships,
        }
    }
}

impl From<Basis> for PriorBasis {
    fn from(basis: Basis) -> PriorBasis {
        PriorBasis {
            method: basis.method,
            published_at: Time(basis.made_at),
            class: basis.class.into(),
            ships: basis.ships.len(),
        }
    }
}

impl From<RefusedClass> for RefusedPriorClass {
    fn from(refused: RefusedClass) -> RefusedPriorClass {
        RefusedPriorClass {
            class: refused.class.into(),
            ships: refused.ships,
            needed: FEWEST_SHIPS,
        }
    }
}

impl From<Class> for PriorClass {
    fn from(class: Class) -> PriorClass {
        match class {
            Class::Sisters(name) => PriorClass::Sisters(name),
            Class::Operator(_) => PriorClass::Operator,
        }
    }
}
