//! Files of port calls: CSV in and out, calendars in.

use super::call::Source;
use super::commit;
use super::file::{OfVessel, Taken, by_vessel, invalid_file, unreadable_file, whole};
use super::moving;
use super::store::{self, Author};
use axum::body::Body;
use axum::extract::{FromRef, State};
use axum::response::Response;
use binnacle_fleet::vessels;
use binnacle_orders::dispatch::{announce_call_updates, attach_new_calls};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Params, file, file_name};
use binnacle_platform::ids::{CallId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::calls::{FileErrors, csv, ics};
use binnacle_schedule::time::Instant;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(upload_fleet_csv))
        .routes(routes!(export_csv, upload_csv))
        .routes(routes!(upload_ics))
}

/// Options of an upload.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct How {
    /// Whether the file is complete. Then calls of its vessels that came from such a file before,
    /// are not over and are missing in this one are withdrawn. By default they stay.
    replace: Option<bool>,
}

/// Result of an upload.
#[derive(Debug, Default, Serialize, ToSchema)]
#[schema(as = PortCallUpload, example = json!({
    "created": 3, "amended": 1, "unchanged": 8, "withdrawn": 0, "over": 2
}))]
struct Uploaded {
    /// Calls that were not known.
    created: usize,
    /// Calls that say something else now.
    amended: usize,
    /// Calls that say what they said.
    unchanged: usize,
    /// Calls that count no more.
    withdrawn: usize,
    /// Calls that are over, and were passed by.
    over: usize,
}

/// Send a file of the fleet's port calls
///
/// The first line names the columns: `vessel` (id, IMO number or name), `port`, `eta`,
/// `etd`, and if wanted `id`, `berth`, `eta_uncertainty_h`, `etd_uncertainty_h`,
/// `berth_heading_deg`. A call is known by its `id`; one without is called after its port
/// and ETA. Calls that are over are passed by. The file is taken whole or not at all: 8 MiB and
/// 50,000 calls at most.
#[utoipa::path(post, path = "/port-calls.csv", tag = "adjusting", params(How),
    request_body(content = String, content_type = "text/csv",
        example = "vessel,id,port,eta,etd\n9074729,c1,NLRTM,2026-12-08T06:00:00Z,2026-12-10T18:00:00Z\n"),
    responses((status = 200, body = Uploaded), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 413, body = Problem),
              (status = 422, description = "Something is wrong; the detail names the lines and \
                             their columns, the first fifty of them", body = Problem)))]
async fn upload_fleet_csv(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Params(how): Params<How>,
    body: Body,
) -> Result<Json<Uploaded>> {
    let bytes = whole(body).await?;
    let now: Time = app.clock.now().into();
    let (rows, mut faults) = read_csv(bytes, None, now).await?;
    let fleet = vessels::names(&app.db, writer.operator).await?;
    let found = by_vessel(rows.calls, &fleet, now, &mut faults)?;
    take(
        &app,
        &request,
        writer,
        (found, faults),
        Source::Csv,
        &how,
        rows.over,
    )
    .await
}

/// Send a file of a vessel's port calls
///
/// As for the fleet; rows may leave `vessel` out.
#[utoipa::path(post, path = "/vessels/{id}/port-calls.csv", tag = "adjusting",
    params(("id" = VesselId, Path), How),
    request_body(content = String, content_type = "text/csv",
        example = "id,port,eta,etd\nc1,NLRTM,2026-12-08T06:00:00Z,2026-12-10T18:00:00Z\n"),
    responses((status = 200, body = Uploaded), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 413, body = Problem),
              (status = 422, description = "Something is wrong; the detail names the lines and \
                             their columns, the first fifty of them", body = Problem)))]
async fn upload_csv(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(vessel): Id<VesselId>,
    Params(how): Params<How>,
    body: Body,
) -> Result<Json<Uploaded>> {
    let row = vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let bytes = whole(body).await?;
    let now: Time = app.clock.now().into();
    let of = vessel.to_string();
    let (rows, mut faults) = read_csv(bytes, Some(of), now).await?;
    let her = [(vessel, row.name, row.imo_number)];
    let mut found = by_vessel(rows.calls, &her, now, &mut faults)?;
    found.entry(vessel).or_default();
    take(
        &app,
        &request,
        writer,
        (found, faults),
        Source::Csv,
        &how,
        rows.over,
    )
    .await
}

/// A file's rows, and what is wrong with others; `of` is the vessel of rows that name none.
async fn read_csv(
    bytes: Vec<u8>,
    of: Option<String>,
    now: Time,
) -> Result<(csv::Rows, FileErrors)> {
    let read = move || {
        let mut faults = FileErrors::default();
        let read = csv::read(&bytes[..], of.as_deref(), Instant(now.0), &mut faults);
        match read {
            Ok(rows) => Ok((rows, faults)),
            Err(fault) => {
                faults.push(fault);
                Err(faults)
            }
        }
    };
    tokio::task::spawn_blocking(read)
        .await?
        .map_err(invalid_file)
}

/// Send a calendar of a vessel's port calls
///
/// iCalendar (RFC 5545). A `VEVENT` is a call: `UID` its reference, `DTSTART` and `DTEND` or
/// `DURATION` its ETA and ETD, and its port the UN/LOCODE of `X-UNLOCODE`, that or the name in
/// `LOCATION`, or without either the UN/LOCODE behind "at" in `SUMMARY`. A cancelled event withdraws its call; events that are over are passed by.
#[utoipa::path(post, path = "/vessels/{id}/port-calls.ics", tag = "adjusting",
    params(("id" = VesselId, Path), How),
    request_body(content = String, content_type = "text/calendar",
        example = "BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:-//agent//calls//EN\r\nBEGIN:VEVENT\r\nUID:c1@agent.example\r\nDTSTAMP:20261121T000000Z\r\nDTSTART:20261208T060000Z\r\nDTEND:20261210T180000Z\r\nLOCATION:NLRTM\r\nEND:VEVENT\r\nEND:VCALENDAR\r\n"),
    responses((status = 200, body = Uploaded), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 413, body = Problem),
              (status = 422, description = "Something is wrong; the detail names the line and \
                             the property", body = Problem)))]
async fn upload_ics(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(vessel): Id<VesselId>,
    Params(how): Params<How>,
    body: Body,
) -> Result<Json<Uploaded>> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let text = String::from_utf8(whole(body).await?).map_err(|_| Error::Invalid {
        field: "file",
        detail: "is not UTF-8 text".to_owned(),
    })?;
    let now: Time = app.clock.now().into();
    let of = vessel.to_string();
    let read = move || ics::read(&text, &of, Instant(now.0));
    let calendar = tokio::task::spawn_blocking(read)
        .await?
        .map_err(unreadable_file)?;
    let mut hers = OfVessel {
        cancelled: calendar.cancelled.into_iter().collect(),
        ..OfVessel::default()
    };
    let mut faults = FileErrors::default();
    for located in calendar.calls {
        hers.push(located, now, &mut faults)?;
    }
    let found = BTreeMap::from([(vessel, hers)]);
    take(
        &app,
        &request,
        writer,
        (found, faults),
        Source::Icalendar,
        &how,
        calendar.over,
    )
    .await
}

/// Takes a file whole, or nothing of it where anything is wrong.
async fn take(
    app: &App,
    request: &RequestContext,
    writer: Writer,
    (found, mut faults): (BTreeMap<VesselId, OfVessel>, FileErrors),
    source: Source,
    how: &How,
    over: usize,
) -> Result<Json<Uploaded>> {
    let now = app.clock.now().into();
    let replaces = how.replace.unwrap_or(false);
    let mut done = Uploaded {
        over,
        ..Uploaded::default()
    };
    let (mut changed, mut told) = (Vec::new(), Vec::new());
    let mut tx = request.begin().await?;
    let author = Author::of(&mut tx, writer.user, now).await?;
    // In the order of their ids: two files at once wait for one another only one way.
    for (vessel, hers) in found {
        let known = store::lock(&mut tx, writer.operator, vessel).await?;
        let taken = hers.against(&known, source, replaces, now, &mut faults)?;
        // Nothing of it is kept; what else is wrong is still to be told.
        if !faults.is_empty() {
            continue;
        }
        let new: Vec<_> = taken.new.iter().map(|call| (CallId::new(), call)).collect();
        let moving = moving::taken(&taken, &new)?;
        let Taken {
            new: _,
            amended,
            unchanged,
            withdrawn,
        } = &taken;
        if new.len() + amended.len() + withdrawn.len() > 0 {
            changed.push(vessel);
        }
        done.created += new.len();
        done.amended += amended.len();
        done.unchanged += unchanged;
        done.withdrawn += withdrawn.len();
        for (id, call) in &new {
            store::insert(&mut tx, vessel, *id, call, source, &author).await?;
        }
        told.extend(announce_call_updates(&mut tx, vessel, &moving, &author.name, now).await?);
        for (row, call) in amended {
            store::revise(&mut tx, row, call, source, &author).await?;
        }
        for (row, why) in withdrawn {
            store::withdraw(&mut tx, row, Some(why), &author).await?;
        }
        let is = new.iter().map(|(id, call)| (*id, *call));
        let is = is.chain(amended.iter().map(|(row, call)| (row.id, call)));
        let is: Vec<_> = is.map(|(id, call)| (id, moving::alongside(call))).collect();
        told.extend(attach_new_calls(&mut tx, vessel, &is, &author.name, now).await?);
    }
    faults.unless(()).map_err(invalid_file)?;
    commit(app, tx, &changed, told, now).await?;
    Ok(Json(done))
}

/// Read a vessel's port calls as CSV
///
/// Those that are not over, in the form in which they are sent.
#[utoipa::path(get, path = "/vessels/{id}/port-calls.csv", tag = "adjusting",
    params(("id" = VesselId, Path)),
    responses((status = 200, content_type = "text/csv", body = String),
              (status = 401, body = Problem), (status = 404, body = Problem)))]
async fn export_csv(
    State(app): State<App>,
    reader: Reader,
    Id(vessel): Id<VesselId>,
) -> Result<Response> {
    let row = vessels::must_be_in_fleet(&app.db, reader.operator, vessel).await?;
    let ahead = store::ahead_of(&app.db, vessel, app.clock.now().into()).await?;
    let calls: Result<Vec<_>> = ahead
        .iter()
        .map(|call| Ok(call.content()?.of(&call.reference, &vessel.to_string())))
        .collect();
    let mut bytes = Vec::new();
    csv::write(&calls?, &mut bytes).map_err(anyhow::Error::from)?;
    let name = file_name(&["port calls", &row.name], "csv");
    Ok(file("text/csv; charset=utf-8", &name, bytes))
}
