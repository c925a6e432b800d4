//! Handlers of firms' terms.

use super::engaged::{self, EngagedFirm};
use super::terms::{Terms, TermsChanged};
use super::{store, teams};
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid};
use binnacle_platform::ids::FirmId;
use binnacle_platform::session;
use binnacle_schedule::input::Team;
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
        .routes(routes!(list_terms))
        .routes(routes!(set_terms, end_terms))
}

/// Firm that works for an operator, with its terms.
#[derive(Serialize, ToSchema)]
#[schema(as = FirmWithTerms)]
struct FirmWithTerms {
    /// The firm.
    firm_id: FirmId,
    /// Its name.
    firm_name: String,
    /// Its terms; `null` before any were set.
    #[schema(required)]
    terms: Option<Terms>,
    /// Teams as the firm states them, which take the place of the number in the terms; empty if
    /// it states none.
    teams: Vec<Team>,
    /// Reasons for which the schedule leaves the firm out; empty when it does not.
    #[schema(example = json!(["working_days: a firm that works on no day of the week serves nobody"]))]
    problems: Vec<String>,
}

/// All firms that work for an operator.
#[derive(Serialize, ToSchema)]
#[schema(as = FirmTermsList)]
struct TermsList {
    /// Firms in the order of their creation.
    items: Vec<FirmWithTerms>,
}

/// List the terms of firms for you
#[utoipa::path(get, path = "/firm-terms", tag = "adjusting",
    responses((status = 200, body = TermsList), (status = 401, body = Problem)))]
async fn list_terms(State(app): State<App>, reader: Reader) -> Result<Json<TermsList>> {
    let items = engaged::of_operator(&app.db, reader.operator).await?;
    let items = items.into_iter().map(FirmWithTerms::new).collect();
    Ok(Json(TermsList { items }))
}

/// Set the terms of a firm for you
///
/// The schedule plans with firms that have terms. Terms without days or ports are stored, and
/// reported as a problem.
#[utoipa::path(put, path = "/firms/{id}/terms", tag = "adjusting",
    params(("id" = FirmId, Path)), request_body = Terms,
    responses((status = 200, body = FirmWithTerms), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "Also when it does not work for you", body = Problem),
              (status = 422, body = Problem)))]
async fn set_terms(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(firm): Id<FirmId>,
    Valid(terms): Valid<Terms>,
) -> Result<Json<FirmWithTerms>> {
    let terms = terms.checked()?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let name = store::find_name(&mut tx, writer.operator, firm)
        .await?
        .ok_or(Error::NotFound("firm"))?;
    let by = session::name_of(&mut tx, writer.user).await?;
    let json = serde_json::to_string(&terms)?;
    store::put_terms(&mut tx, writer.operator, firm, &json, &by, now).await?;
    tx.publish(&TermsChanged {
        operator: writer.operator,
        at: now,
    })
    .await?;
    let engaged = EngagedFirm {
        id: firm,
        name,
        terms: Some(terms),
        stated: teams::find_stated(&mut tx, firm).await?,
    };
    tx.commit().await?;
    Ok(Json(FirmWithTerms::new(engaged)))
}

/// Remove the terms of a firm for you
///
/// The schedule no longer plans with the firm. It keeps its orders.
#[utoipa::path(delete, path = "/firms/{id}/terms", tag = "adjusting",
    params(("id" = FirmId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, description = "Also when it has no terms", body = Problem)))]
async fn end_terms(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(firm): Id<FirmId>,
) -> Result<StatusCode> {
    let mut tx = request.begin().await?;
    if !store::remove_terms(&mut tx, writer.operator, firm).await? {
        return Err(Error::NotFound("firm"));
    }
    tx.publish(&TermsChanged {
        operator: writer.operator,
        at: app.clock.now().into(),
    })
    .await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

impl FirmWithTerms {
    fn new(firm: EngagedFirm) -> FirmWithTerms {
        FirmWithTerms {
            problems: firm.problems(),
            firm_id: firm.id,
            firm_name: firm.name,
            terms: firm.terms,
            teams: firm.stated.teams,
        }
    }
}
