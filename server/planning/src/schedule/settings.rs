//! `/schedule/settings`: cost weights, terms and horizon of the schedule.

use crate::schedule_settings::{self, ScheduleSettings};
use axum::extract::{FromRef, State};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Json, Valid};
use binnacle_platform::session;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_schedule_settings, set_settings))
}

/// See the schedule's settings
#[utoipa::path(get, path = "/schedule/settings", tag = "adjusting",
    responses((status = 200, body = ScheduleSettings), (status = 401, body = Problem)))]
async fn find_schedule_settings(
    State(app): State<App>,
    reader: Reader,
) -> Result<Json<ScheduleSettings>> {
    Ok(Json(
        schedule_settings::find(&app.db, reader.operator).await?,
    ))
}

/// Change the schedule's settings
#[utoipa::path(put, path = "/schedule/settings", tag = "adjusting", request_body = ScheduleSettings,
    responses((status = 200, body = ScheduleSettings), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 422, body = Problem)))]
async fn set_settings(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Valid(settings): Valid<ScheduleSettings>,
) -> Result<Json<ScheduleSettings>> {
    settings.check()?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    let by = session::name_of(&mut tx, writer.user).await?;
    schedule_settings::put(&mut tx, writer.operator, &settings, &by, now).await?;
    super::store::request_schedule(&mut tx, writer.operator, now).await?;
    tx.commit().await?;
    Ok(Json(settings))
}
