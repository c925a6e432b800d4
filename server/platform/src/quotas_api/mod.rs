//! API that shows quotas and sets those of an operator.

use crate::access::{PartyReader, Platform};
use crate::app::App;
use crate::audit::RequestContext;
use crate::error::{Error, Problem, Result};
use crate::http::{Json, Valid};
use crate::ids::OperatorId;
use crate::quotas::{self, QuotaList};
use axum::extract::{FromRef, Path, State};
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Largest limit that may be set.
const MOST: i64 = 1_000_000_000;

/// Routes of the quotas.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    QuotaList: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_quotas))
        .routes(routes!(change_quota))
}

/// Use of a quota.
#[derive(Debug, Serialize, ToSchema)]
struct QuotaUse {
    /// Name of the quota.
    #[schema(example = "webhooks")]
    name: &'static str,
    /// Number of those that exist.
    used: i64,
    /// Largest number allowed.
    most: i64,
}

/// Quotas of an operator or a firm.
#[derive(Debug, Serialize, ToSchema)]
struct Quotas {
    /// All quotas.
    items: Vec<QuotaUse>,
}

/// Limit to be set.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({ "most": 100 }))]
struct ChangedQuota {
    /// Largest number allowed; `null` for the limit by default.
    #[schema(required, minimum = 0, maximum = 1_000_000_000)]
    most: Option<i64>,
}

/// Show your quotas
///
/// The response has how much your company has of each limited thing, and how much it may have.
/// Something beyond the limit is refused with the type `quota-exceeded`.
#[utoipa::path(get, path = "/quotas", tag = "people",
    responses((status = 200, body = Quotas), (status = 401, body = Problem),
              (status = 403, body = Problem)))]
async fn list_quotas(
    State(app): State<App>,
    State(list): State<QuotaList>,
    reader: PartyReader,
) -> Result<Json<Quotas>> {
    let now = app.clock.now().into();
    let uses = list.uses(&app.db, reader.tenant, now).await?;
    let shown = |(name, used, most)| QuotaUse { name, used, most };
    let items = uses.into_iter().map(shown).collect();
    Ok(Json(Quotas { items }))
}

/// Set an operator's quota
///
/// Things beyond a lower limit stay.
#[utoipa::path(put, path = "/operators/{id}/quotas/{quota}", tag = "platform",
    params(("id" = OperatorId, Path), ("quota" = String, Path, example = "webhooks")),
    request_body = ChangedQuota,
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn change_quota(
    State(list): State<QuotaList>,
    request: RequestContext,
    platform: Platform,
    Path((operator, name)): Path<(OperatorId, String)>,
    Valid(changed): Valid<ChangedQuota>,
) -> Result<StatusCode> {
    platform.must_be_writer()?;
    let quota = list.find(&name).ok_or(Error::NotFound("quota"))?;
    if let Some(most) = changed.most.filter(|most| !(0..=MOST).contains(most)) {
        return Err(Error::Invalid {
            field: "most",
            detail: format!("{most} is outside 0 to {MOST}"),
        });
    }
    let mut tx = request.begin().await?;
    quotas::set(&mut tx, operator, quota, changed.most).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}
