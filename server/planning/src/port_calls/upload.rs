//! Upload of port calls as CSV or iCalendar, and export as CSV.

use super::QUOTA;
use super::call::Source;
use super::commit::commit;
use super::moves;
use super::store::{self, Author};
use super::uploaded_file::{
    FileChanges, VesselCalls, group_by_vessel, read_body, refuse_file, refuse_unreadable,
};
use axum::body::Body;
use axum::extract::{FromRef, State};
use axum::response::Response;
use binnacle_fleet::vessels::{self, VesselNames};
use binnacle_orders::dispatch::{announce_call_updates, attach_new_calls};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{FileContent, FileName, Id, Json, Params, file};
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
struct UploadOptions {
    /// `true` for a complete file: calls of its vessels from an earlier file that are not over and
    /// missing in this one are withdrawn. By default they stay.
    replace: Option<bool>,
}

/// Result of an upload.
#[derive(Debug, Default, Serialize, ToSchema)]
#[schema(as = PortCallUpload, example = json!({
    "created": 3, "amended": 1, "unchanged": 8, "withdrawn": 0, "over": 2
}))]
pub(super) struct Uploaded {
    /// Number of new calls.
    pub(super) created: usize,
    /// Number of calls that changed.
    pub(super) amended: usize,
    /// Number of calls that stayed the same.
    unchanged: usize,
    /// Number of calls withdrawn.
    pub(super) withdrawn: usize,
    /// Number of past calls, which are skipped.
    over: usize,
}

/// Upload a CSV file of the fleet's port calls
///
/// The first line names the columns: `vessel` (id, IMO number or name), `port`, `eta`, `etd`, and
/// optionally `id`, `berth`, `eta_uncertainty_h`, `etd_uncertainty_h`, `berth_heading_deg`. The `id`
/// identifies a call; by default it is made of port and ETA. Past calls are skipped. The file is
/// stored whole or not at all. Limits: 8 MiB and 50,000 calls.
#[utoipa::path(post, path = "/port-calls.csv", tag = "adjusting", params(UploadOptions),
    request_body(content = inline(FileContent), content_type = "text/csv",
        example = "vessel,id,port,eta,etd\n9074729,c1,NLRTM,2026-12-08T06:00:00Z,2026-12-10T18:00:00Z\n"),
    responses((status = 200, body = Uploaded), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 409, description = "The quota is used up", body = Problem),
              (status = 413, body = Problem),
              (status = 422, description = "The file has errors; the detail names the first fifty \
                             with line and column", body = Problem)))]
async fn upload_fleet_csv(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Params(options): Params<UploadOptions>,
    body: Body,
) -> Result<Json<Uploaded>> {
    let bytes = read_body(body).await?;
    let now: Time = app.clock.now().into();
    let (rows, mut errors) = read_csv(bytes, None, now).await?;
    let fleet = vessels::names(&app.db, writer.operator).await?;
    let vessels = group_by_vessel(rows.calls, &fleet, now, &mut errors)?;
    let file = ParsedFile {
        vessels,
        errors,
        over: rows.over,
    };
    let tx = request.begin().await?;
    let replaces = options.replace.unwrap_or(false);
    Ok(Json(
        Box::pin(store_file(&app, tx, writer, file, Source::Csv, replaces)).await?,
    ))
}

/// Upload a CSV file of a vessel's port calls
///
/// The format is the fleet's; the column `vessel` is optional.
#[utoipa::path(post, path = "/vessels/{id}/port-calls.csv", tag = "adjusting",
    params(("id" = VesselId, Path), UploadOptions),
    request_body(content = inline(FileContent), content_type = "text/csv",
        example = "id,port,eta,etd\nc1,NLRTM,2026-12-08T06:00:00Z,2026-12-10T18:00:00Z\n"),
    responses((status = 200, body = Uploaded), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "The quota is used up", body = Problem),
              (status = 413, body = Problem),
              (status = 422, description = "The file has errors; the detail names the first fifty \
                             with line and column", body = Problem)))]
async fn upload_csv(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(vessel): Id<VesselId>,
    Params(options): Params<UploadOptions>,
    body: Body,
) -> Result<Json<Uploaded>> {
    let row = vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let bytes = read_body(body).await?;
    let now: Time = app.clock.now().into();
    let id = vessel.to_string();
    let (rows, mut errors) = read_csv(bytes, Some(id), now).await?;
    let fleet = [VesselNames {
        id: vessel,
        name: row.name,
        imo_number: row.imo_number,
    }];
    let mut vessels = group_by_vessel(rows.calls, &fleet, now, &mut errors)?;
    vessels.entry(vessel).or_default();
    let file = ParsedFile {
        vessels,
        errors,
        over: rows.over,
    };
    let tx = request.begin().await?;
    let replaces = options.replace.unwrap_or(false);
    Ok(Json(
        Box::pin(store_file(&app, tx, writer, file, Source::Csv, replaces)).await?,
    ))
}

/// Returns the valid rows of a file and the errors of others. `vessel` is that of rows without one.
async fn read_csv(
    bytes: Vec<u8>,
    vessel: Option<String>,
    now: Time,
) -> Result<(csv::Rows, FileErrors)> {
    let read = move || {
        let mut errors = FileErrors::default();
        let read = csv::read(&bytes[..], vessel.as_deref(), Instant(now.0), &mut errors);
        match read {
            Ok(rows) => Ok((rows, errors)),
            Err(error) => {
                errors.push(error);
                Err(errors)
            }
        }
    };
    tokio::task::spawn_blocking(read)
        .await?
        .map_err(refuse_file)
}

/// Upload a calendar of a vessel's port calls
///
/// iCalendar (RFC 5545). Each `VEVENT` is a call: `UID` is its reference, `DTSTART` and `DTEND` or
/// `DURATION` are its ETA and ETD. The port is the UN/LOCODE of `X-UNLOCODE`, the UN/LOCODE or name
/// in `LOCATION`, or without either the UN/LOCODE after "at" in `SUMMARY`. A cancelled event
/// withdraws its call; past events are skipped.
#[utoipa::path(post, path = "/vessels/{id}/port-calls.ics", tag = "adjusting",
    params(("id" = VesselId, Path), UploadOptions),
    request_body(content = inline(FileContent), content_type = "text/calendar",
        example = "BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:-//agent//calls//EN\r\nBEGIN:VEVENT\r\nUID:c1@agent.example\r\nDTSTAMP:20261121T000000Z\r\nDTSTART:20261208T060000Z\r\nDTEND:20261210T180000Z\r\nLOCATION:NLRTM\r\nEND:VEVENT\r\nEND:VCALENDAR\r\n"),
    responses((status = 200, body = Uploaded), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "The quota is used up", body = Problem),
              (status = 413, body = Problem),
              (status = 422, description = "The file has errors; the detail names line and property", body = Problem)))]
async fn upload_ics(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(vessel): Id<VesselId>,
    Params(options): Params<UploadOptions>,
    body: Body,
) -> Result<Json<Uploaded>> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let text = String::from_utf8(read_body(body).await?).map_err(|_| Error::Invalid {
        field: "file",
        detail: "is not UTF-8 text".to_owned(),
    })?;
    let now: Time = app.clock.now().into();
    let id = vessel.to_string();
    let read = move || ics::read(&text, &id, Instant(now.0));
    let calendar = tokio::task::spawn_blocking(read)
        .await?
        .map_err(refuse_unreadable)?;
    let mut calls = VesselCalls {
        cancelled: calendar.cancelled.into_iter().collect(),
        ..VesselCalls::default()
    };
    let mut errors = FileErrors::default();
    for located in calendar.calls {
        calls.push(located, now, &mut errors)?;
    }
    let vessels = BTreeMap::from([(vessel, calls)]);
    let file = ParsedFile {
        vessels,
        errors,
        over: calendar.over,
    };
    let tx = request.begin().await?;
    let replaces = options.replace.unwrap_or(false);
    Ok(Json(
        Box::pin(store_file(
            &app,
            tx,
            writer,
            file,
            Source::Icalendar,
            replaces,
        ))
        .await?,
    ))
}

/// Parsed file of port calls.
pub(super) struct ParsedFile {
    /// Calls by vessel.
    pub(super) vessels: BTreeMap<VesselId, VesselCalls>,
    /// Errors of the file.
    pub(super) errors: FileErrors,
    /// Number of past calls, which are skipped.
    pub(super) over: usize,
}

/// Stores a file whole, or nothing of it if it has an error.
pub(super) async fn store_file(
    app: &App,
    mut tx: Tx,
    writer: Writer,
    file: ParsedFile,
    source: Source,
    replaces: bool,
) -> Result<Uploaded> {
    let now = app.clock.now().into();
    let mut errors = file.errors;
    let mut uploaded = Uploaded {
        over: file.over,
        ..Uploaded::default()
    };
    let (mut changed, mut pending) = (Vec::new(), Vec::new());
    let author = Author::from_user(&mut tx, writer.user, now).await?;
    // In order of ids, so that concurrent files cannot deadlock.
    for (vessel, calls) in file.vessels {
        let known = store::lock(&mut tx, writer.operator, vessel).await?;
        let changes = calls.compare(&known, source, replaces, now, &mut errors)?;
        // Nothing will be stored, but all errors are reported.
        if !errors.is_empty() {
            continue;
        }
        let new: Vec<_> = changes
            .new
            .iter()
            .map(|call| (CallId::new(), call))
            .collect();
        let moving = moves::of_file(&changes, &new)?;
        let FileChanges {
            new: _,
            amended,
            unchanged,
            withdrawn,
        } = &changes;
        if new.len() + amended.len() + withdrawn.len() > 0 {
            changed.push(vessel);
        }
        uploaded.created += new.len();
        uploaded.amended += amended.len();
        uploaded.unchanged += unchanged;
        uploaded.withdrawn += withdrawn.len();
        for (id, call) in &new {
            store::insert(&mut tx, vessel, *id, call, source, &author).await?;
        }
        pending.extend(announce_call_updates(&mut tx, vessel, &moving, &author.name, now).await?);
        for call in amended {
            store::revise(&mut tx, call.stored, &call.content, source, &author).await?;
        }
        for call in withdrawn {
            store::withdraw(&mut tx, call.stored, Some(call.reason), &author).await?;
        }
        let current = new.iter().map(|(id, call)| moves::new_call(*id, call));
        let revised = amended.iter();
        let revised = revised.map(|call| moves::new_call(call.stored.id, &call.content));
        let current: Vec<_> = current.chain(revised).collect();
        pending.extend(attach_new_calls(&mut tx, vessel, &current, &author.name, now).await?);
    }
    errors.into_result(()).map_err(refuse_file)?;
    if uploaded.created > 0 {
        QUOTA.must_hold(&mut tx, writer.operator, now).await?;
    }
    commit(app, tx, &changed, pending, now).await?;
    Ok(uploaded)
}

/// Export a vessel's port calls as CSV
///
/// Current and future calls, in the format of uploads.
#[utoipa::path(get, path = "/vessels/{id}/port-calls.csv", tag = "adjusting",
    params(("id" = VesselId, Path)),
    responses((status = 200, content_type = "text/csv", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 404, body = Problem)))]
async fn export_csv(
    State(app): State<App>,
    reader: Reader,
    Id(vessel): Id<VesselId>,
) -> Result<Response> {
    let row = vessels::must_be_in_fleet(&app.db, reader.operator, vessel).await?;
    let upcoming = store::upcoming_of_vessel(&app.db, vessel, app.clock.now().into()).await?;
    let calls: Result<Vec<_>> = upcoming
        .iter()
        .map(|call| {
            Ok(call
                .content()?
                .to_schedule_call(&call.reference, &vessel.to_string()))
        })
        .collect();
    let mut bytes = Vec::new();
    csv::write(&calls?, &mut bytes).map_err(anyhow::Error::from)?;
    let name = FileName::new(&["port calls", &row.name], "csv");
    Ok(file("text/csv; charset=utf-8", &name, bytes))
}
