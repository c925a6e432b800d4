//! `/schedule/pins`: jobs that a person has fixed.
//!
//! Invariants: a pin names a call of the compass's own vessel, a firm that the operator plans with
//! and a day of the call. It moves only for cause, like a confirmed job, and the plan states the
//! cause.

use crate::port_calls;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_orders::firms;
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Valid, optional_text};
use binnacle_platform::ids::{CallId, CompassId, FirmId, OperatorId, VesselId};
use binnacle_platform::session;
use binnacle_platform::time::Time;
use binnacle_schedule::ports;
use binnacle_schedule::time::Instant;
use chrono::NaiveDate;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_pins, pin))
        .routes(routes!(unpin))
}

/// Firm, port call and day to fix for a compass.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewPin, example = json!({
    "compass_id": "0199aa00-0000-7000-8000-000000000002",
    "call_id": "0199aa00-0000-7000-8000-000000000004",
    "firm_id": "0199aa00-0000-7000-8000-000000000003",
    "day": "2026-12-09", "from": "2026-12-09T08:00:00Z", "note": "agreed by telephone"
}))]
struct NewPin {
    /// The compass.
    compass_id: CompassId,
    /// Port call of its vessel.
    call_id: CallId,
    /// The firm.
    firm_id: FirmId,
    /// The day, in the port's time.
    day: NaiveDate,
    /// Beginning of the job, on that day; any of the firm's hours, if absent.
    #[serde(default)]
    from: Option<Time>,
    /// Note, such as the reason.
    #[schema(max_length = 200)]
    note: Option<String>,
}

/// Pin of a compass's job, set by a person.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[schema(as = Pin)]
pub(super) struct Pin {
    /// The vessel.
    pub(super) vessel_id: VesselId,
    /// The compass.
    pub(super) compass_id: CompassId,
    /// The port call.
    pub(super) call_id: CallId,
    /// The firm.
    pub(super) firm_id: FirmId,
    /// The day.
    pub(super) day: NaiveDate,
    /// Beginning of the job; `null` for any of the firm's hours.
    #[schema(required)]
    pub(super) from: Option<Time>,
    /// Note, such as the reason.
    #[schema(required)]
    pub(super) note: Option<String>,
    /// Time of the pin.
    pub(super) created_at: Time,
    /// Name of the person who set it.
    pub(super) created_by: String,
}

/// All pins.
#[derive(Serialize, ToSchema)]
struct PinList {
    /// Pins, in order of vessel and compass.
    items: Vec<Pin>,
}

/// List the schedule's pins
#[utoipa::path(get, path = "/schedule/pins", tag = "adjusting",
    responses((status = 200, body = PinList), (status = 401, body = Problem)))]
async fn list_pins(State(app): State<App>, reader: Reader) -> Result<Json<PinList>> {
    let items = list(&app.db, reader.operator).await?;
    Ok(Json(PinList { items }))
}

/// Pin a compass's job in the schedule
///
/// Replaces an earlier pin of the compass. The job moves only for cause, for example when the call
/// is withdrawn or the firm has no team.
#[utoipa::path(post, path = "/schedule/pins", tag = "adjusting", request_body = NewPin,
    responses((status = 200, body = Pin), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "Compass, call or firm not found", body = Problem),
              (status = 422, body = Problem)))]
async fn pin(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Valid(new): Valid<NewPin>,
) -> Result<Json<Pin>> {
    let now: Time = app.clock.now().into();
    let vessel = find_vessel(&app.db, writer.operator, new.compass_id).await?;
    let vessel = vessel.ok_or(Error::NotFound("compass"))?;
    let calls = port_calls::upcoming_of_fleet(&app.db, writer.operator, now).await?;
    let mut calls = calls.iter().filter(|call| call.vessel_id == vessel);
    let call = calls.find(|call| call.id == new.call_id);
    let call = call.ok_or(Error::NotFound("port call"))?.content()?;
    let zone = ports::zone(call.port);
    let days = Instant(call.eta.0).date(zone)..=Instant(call.etd.0).date(zone);
    if !days.contains(&new.day) {
        return Err(Error::Invalid {
            field: "day",
            detail: format!(
                "{} is not one of the call's days, {} to {}",
                new.day,
                days.start(),
                days.end()
            ),
        });
    }
    if let Some(from) = new.from {
        let is_there = (call.eta..=call.etd).contains(&from);
        if !is_there || Instant(from.0).date(zone) != new.day {
            return Err(Error::Invalid {
                field: "from",
                detail: format!("{} is no hour of the call on {}", from.0, new.day),
            });
        }
    }
    let firms = firms::of_operator(&app.db, writer.operator).await?;
    let pinned = firms.iter().find(|firm| firm.id == new.firm_id);
    let pinned = pinned.filter(|firm| firm.terms.is_some());
    let pinned = pinned.ok_or(Error::NotFound("firm"))?;
    if let Some(problem) = pinned.problems().first() {
        let name = &pinned.name;
        return Err(Error::Invalid {
            field: "firm_id",
            detail: format!("the schedule cannot plan with {name}: {problem}"),
        });
    }
    let note = optional_text("note", new.note.as_deref())?;
    let mut tx = request.begin().await?;
    let pin = Pin {
        vessel_id: vessel,
        compass_id: new.compass_id,
        call_id: new.call_id,
        firm_id: new.firm_id,
        day: new.day,
        from: new.from,
        note,
        created_at: now,
        created_by: session::name_of(&mut tx, writer.user).await?,
    };
    store_pin(&mut tx, &pin).await?;
    super::store::request_schedule(&mut tx, writer.operator, now).await?;
    tx.commit().await?;
    Ok(Json(pin))
}

/// Remove the pin of a compass
#[utoipa::path(delete, path = "/schedule/pins/{compass}", tag = "adjusting",
    params(("compass" = CompassId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn unpin(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(compass): Id<CompassId>,
) -> Result<StatusCode> {
    let vessel = find_vessel(&app.db, writer.operator, compass).await?;
    let vessel = vessel.ok_or(Error::NotFound("pin"))?;
    let mut tx = request.begin().await?;
    let removed = execute!(
        &mut tx,
        "DELETE FROM schedule_pins WHERE vessel_id = $1 AND compass_id = $2",
        vessel,
        compass
    )?;
    if removed == 0 {
        return Err(Error::NotFound("pin"));
    }
    super::store::request_schedule(&mut tx, writer.operator, app.clock.now().into()).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

async fn find_vessel(
    db: &Db,
    operator: OperatorId,
    compass: CompassId,
) -> Result<Option<VesselId>> {
    let found = row!(
        db,
        (VesselId,),
        "SELECT c.vessel_id FROM compasses c JOIN vessels v ON v.id = c.vessel_id
         WHERE v.operator_id = $1 AND c.id = $2
         ORDER BY c.vessel_id",
        operator,
        compass
    )?;
    Ok(found.map(|(vessel,)| vessel))
}

async fn store_pin(tx: &mut Tx, pin: &Pin) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO schedule_pins (vessel_id, compass_id, call_id, firm_id, day, note,
                                    created_at, created_by, from_at)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)
         ON CONFLICT (vessel_id, compass_id) DO UPDATE
         SET call_id = excluded.call_id, firm_id = excluded.firm_id, day = excluded.day,
             note = excluded.note, created_at = excluded.created_at,
             created_by = excluded.created_by, from_at = excluded.from_at",
        pin.vessel_id,
        pin.compass_id,
        pin.call_id,
        pin.firm_id,
        pin.day.to_string(),
        pin.note.as_deref(),
        pin.created_at,
        pin.created_by.as_str(),
        pin.from
    )?;
    Ok(())
}

#[derive(sqlx::FromRow)]
struct Row {
    vessel_id: VesselId,
    compass_id: CompassId,
    call_id: CallId,
    firm_id: FirmId,
    day: String,
    from_at: Option<Time>,
    note: Option<String>,
    created_at: Time,
    created_by: String,
}

/// Returns all pins of a fleet.
pub(super) async fn list(db: &Db, operator: OperatorId) -> Result<Vec<Pin>> {
    let found = rows!(
        db,
        Row,
        "SELECT p.* FROM schedule_pins p JOIN vessels v ON v.id = p.vessel_id
         WHERE v.operator_id = $1
         ORDER BY p.vessel_id, p.compass_id",
        operator
    )?;
    let read = |row: Row| {
        Ok(Pin {
            vessel_id: row.vessel_id,
            compass_id: row.compass_id,
            call_id: row.call_id,
            firm_id: row.firm_id,
            day: row.day.parse().map_err(anyhow::Error::from)?,
            from: row.from_at,
            note: row.note,
            created_at: row.created_at,
            created_by: row.created_by,
        })
    };
    found.into_iter().map(read).collect()
}
