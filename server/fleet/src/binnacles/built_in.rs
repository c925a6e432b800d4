//! Designs of binnacles that are built into the product.

use anyhow::Context;
use axum::extract::FromRef;
use binnacle_adjustment::binnacle::{Design, DesignForm, SHIPPED};
use binnacle_platform::access::Caller;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json};
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_types))
        .routes(routes!(find_type))
}

/// A design in a line.
#[derive(Serialize, ToSchema)]
struct BinnacleType {
    /// By which it is found.
    #[schema(example = "class_a_trays")]
    name: &'static str,
    /// Its maker.
    maker: String,
    /// The maker's name for it.
    model: String,
    /// Source of its figures.
    provenance: String,
}

/// All designs; they are few.
#[derive(Serialize, ToSchema)]
struct BinnacleTypeList {
    /// In no order that matters.
    items: Vec<BinnacleType>,
    /// There is no next page.
    #[schema(required)]
    next: Option<String>,
}

/// List the types of binnacle that come with the product
#[utoipa::path(get, path = "/binnacle-types", tag = "adjusting",
    responses((status = 200, body = BinnacleTypeList), (status = 401, body = Problem)))]
async fn list_types(_: Caller) -> Result<Json<BinnacleTypeList>> {
    let read = |(name, text): (&'static str, &str)| {
        let design = design(text)?;
        Ok(BinnacleType {
            name,
            maker: design.maker.clone(),
            model: design.model.clone(),
            provenance: design.provenance.clone(),
        })
    };
    let items: Result<Vec<BinnacleType>> = SHIPPED.into_iter().map(read).collect();
    Ok(Json(BinnacleTypeList {
        items: items?,
        next: None,
    }))
}

/// See a type of binnacle whole
///
/// As it goes into a binnacle's `type`.
#[utoipa::path(get, path = "/binnacle-types/{name}", tag = "adjusting",
    params(("name" = String, Path, example = "class_a_trays")),
    responses((status = 200, body = DesignForm), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_type(_: Caller, Id(name): Id<String>) -> Result<Json<Design>> {
    let found = SHIPPED.into_iter().find(|(known, _)| *known == name);
    let (_, text) = found.ok_or(Error::NotFound("binnacle type"))?;
    Ok(Json(design(text)?))
}

fn design(text: &str) -> Result<Design> {
    Ok(serde_json::from_str(text).context("a design that is built_in")?)
}
