//! Handlers of photographs, completion, signatures and evidence.

use crate::berth_session::photos::{Caption, MAX_BYTES, MAX_PHOTOS};
use crate::berth_session::plan::{
    predict, require_current_reading, require_total_turn, require_within_limits,
};
use crate::berth_session::plan_slots::CorrectorPlanSlots;
use crate::completion::complete;
use crate::completion::record::VesselAndCompass;
use crate::completion::sign_off::SignOff;
use crate::evidence::{Evidence, File, Line, archive, predicted_csv, record_pdf, record_svg};
use crate::firms::keys;
use crate::work_orders::events::OrderEvent;
use crate::work_orders::log::firm_view;
use crate::work_orders::log::seal::{OPERATOR, SealedEntry, readers};
use crate::work_orders::order::Order;
use crate::work_orders::payload::photograph::Photo;
use crate::work_orders::payload::signed_record::{KnownKey, RecordedSignature, SubmittedSignature};
use crate::work_orders::state::State;
use crate::work_orders::store::StoredOrder;
use crate::work_orders::{load_order, prepare_update, store};
use axum::body::{Body, Bytes};
use axum::extract::rejection::BytesRejection;
use axum::extract::{DefaultBodyLimit, FromRef, State as Shared};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use binnacle_fleet::compasses;
use binnacle_fleet::vessels;
use binnacle_platform::access::{PartyReader, PartyWriter};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{FileContent, Id, Json, Params, Valid};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::{OrderId, PhotoId};
use binnacle_platform::signing_keys;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// States in which photographs may be added.
const PHOTO_STATES: [State; 8] = [
    State::Planned,
    State::Accepted,
    State::OnBoard,
    State::Measured,
    State::Adjusting,
    State::Adjusted,
    State::Verified,
    State::Failed,
];

pub(crate) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    CorrectorPlanSlots: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(add_photo))
        .layer(DefaultBodyLimit::max(MAX_BYTES))
        .routes(routes!(find_photo))
        .routes(routes!(complete_work_order))
        .routes(routes!(sign_record))
        .routes(routes!(find_record))
        .routes(routes!(print_record))
        .routes(routes!(draw_record))
        .routes(routes!(tabulate_record))
        .routes(routes!(find_evidence))
}

/// Add a photograph
///
/// The body is the file itself: JPEG, PNG or WebP, 10 MiB at most.
#[utoipa::path(post, path = "/work-orders/{id}/photos", tag = "adjusting",
    params(("id" = OrderId, Path), Caption, Key),
    request_body(content = inline(FileContent), content_type = "application/octet-stream"),
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, body = Problem), (status = 413, body = Problem),
              (status = 415, body = Problem)))]
async fn add_photo(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    Params(caption): Params<Caption>,
    key: Key,
    body: std::result::Result<Bytes, BytesRejection>,
) -> Result<Json<Order>> {
    let bytes = body.map_err(|_| Error::TooLarge(MAX_BYTES))?;
    let taken = Photo::new(PhotoId::new(), &bytes, &caption)?;
    let update = prepare_update(&app, request, writer, id, key, "photo", &taken.sha256)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.tenant, id).await;
    }
    stored.require_state(
        &PHOTO_STATES,
        "photographs are added once a firm has it, until it is closed",
    )?;
    if photos(&stored).count() >= MAX_PHOTOS {
        return Err(Error::WrongState(format!(
            "there are {MAX_PHOTOS} photographs"
        )));
    }
    if let Some(mut change) = update.begin(&stored).await? {
        let (sha256, kind) = (taken.sha256.as_str(), taken.media_type.as_str());
        store::insert_photo(
            &mut change.tx,
            &stored.summary,
            taken.id,
            kind,
            sha256,
            &bytes,
        )
        .await?;
        change.append(OrderEvent::Photo(taken)).await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

fn photos(stored: &StoredOrder) -> impl Iterator<Item = (i64, &Photo)> {
    stored.log.iter().filter_map(|entry| match &entry.content {
        OrderEvent::Photo(photo) => Some((entry.seq, photo)),
        _ => None,
    })
}

/// See a photograph
#[utoipa::path(get, path = "/work-orders/{id}/photos/{photo}", tag = "adjusting",
    params(("id" = OrderId, Path), ("photo" = PhotoId, Path)),
    responses((status = 200, content_type = "image/*", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 404, body = Problem)))]
async fn find_photo(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id((id, photo)): Id<(OrderId, PhotoId)>,
) -> Result<Response> {
    let summary = store::find_summary(&app.db, reader.tenant, id).await?;
    let found = store::find_photo(&app.db, summary.vessel_id, id, photo).await?;
    let (media_type, bytes) = found.ok_or(Error::NotFound("photograph"))?;
    let headers = [
        (CONTENT_TYPE, media_type.as_str()),
        (CONTENT_SECURITY_POLICY, "default-src 'none'; sandbox"),
        (CONTENT_DISPOSITION, "attachment"),
    ];
    Ok((headers, bytes).into_response())
}

/// Complete an adjustment
///
/// By the adjuster's name, licence and typed signature. From that moment on the logbook contains
/// the adjustment, and the vessel receives the predicted model. The card is a prediction until
/// headings at sea agree.
#[utoipa::path(post, path = "/work-orders/{id}/complete", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = SignOff,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "A step is not done", body = Problem),
              (status = 422, body = Problem)))]
async fn complete_work_order(
    Shared(app): Shared<App>,
    Shared(slots): Shared<CorrectorPlanSlots>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(sign_off): Valid<SignOff>,
) -> Result<Json<Order>> {
    let update = prepare_update(&app, request, writer, id, key, "completion", &sign_off)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.tenant, id).await;
    }
    stored.require_state(&[State::Adjusting], "no plan was followed")?;
    let state = stored.state();
    let plan_request = state.plan_request()?;
    require_current_reading(&app, &stored.summary, &plan_request).await?;
    require_within_limits(&state)?;
    let (sign_off, at) = sign_off.checked(&stored, app.clock.now().into())?;
    complete::require_planned_setting(&state)?;
    require_total_turn(&slots, &state, plan_request).await?;
    let prediction = predict(&slots, &state).await?;
    let vessel = load_vessel(&app, &stored).await?;
    if let Some(mut change) = update.begin(&stored).await? {
        Box::pin(complete::complete(
            &mut change,
            &vessel,
            prediction,
            sign_off,
            at,
        ))
        .await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

async fn load_vessel(app: &App, stored: &StoredOrder) -> Result<VesselAndCompass> {
    let summary = &stored.summary;
    let vessel = vessels::find_row(&app.db, summary.operator_id, summary.vessel_id).await?;
    let vessel = vessel.ok_or(Error::NotFound("vessel"))?;
    Ok(VesselAndCompass {
        vessel_name: vessel.name,
        imo_number: vessel.imo_number,
        call_sign: vessel.call_sign,
        flag: vessel.flag,
        compass: compasses::find(&app.db, summary.vessel_id, Some(summary.compass_id)).await?,
    })
}

/// Sign the record with a firm's key
///
/// An Ed25519 signature over the 32 bytes of `record_sha256`. The order names the owner of a key
/// that the order's firm has registered (`/firms/{id}/keys`). Other keys are shown as unknown.
#[utoipa::path(post, path = "/work-orders/{id}/signatures", tag = "adjusting",
    params(("id" = OrderId, Path), Key), request_body = SubmittedSignature,
    responses((status = 200, body = Order), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is no record yet", body = Problem),
              (status = 422, description = "The signature is not by this key", body = Problem)))]
async fn sign_record(
    Shared(app): Shared<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(id): Id<OrderId>,
    key: Key,
    Valid(signature): Valid<SubmittedSignature>,
) -> Result<Json<Order>> {
    let update = prepare_update(&app, request, writer, id, key, "signature", &signature)?;
    let (stored, done) = update.load().await?;
    if done.is_some() {
        return load_order(&app, writer.tenant, id).await;
    }
    let completed = stored.state().completion;
    let completed = completed.ok_or_else(no_record)?;
    signature.checked(&completed.record_sha256)?;
    if let Some(mut change) = update.begin(&stored).await? {
        let holder = change.stored.summary.firm_id;
        let key = keys::find_active(&mut change.tx, holder, &signature.public_key).await?;
        let key = key.map(|key| KnownKey {
            id: key.id,
            name: key.name,
            firm_id: key.firm_id,
            firm_name: key.firm_name,
        });
        let recorded = RecordedSignature { signature, key };
        change.append(OrderEvent::Signature(recorded)).await?;
        change.commit().await?;
    }
    load_order(&app, writer.tenant, id).await
}

fn no_record() -> Error {
    Error::WrongState("there is no record before the adjustment is completed".to_owned())
}

/// See the adjustment record
///
/// The exact bytes whose hash a firm's key signs.
#[utoipa::path(get, path = "/work-orders/{id}/record.json", tag = "adjusting",
    params(("id" = OrderId, Path)),
    responses((status = 200, content_type = "application/json", body = std::collections::HashMap<String, serde_json::Value>),
              (status = 401, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is no record yet", body = Problem)))]
async fn find_record(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Response> {
    let summary = store::find_summary(&app.db, reader.tenant, id).await?;
    let record = store::find_record(&app.db, summary.vessel_id, id).await?;
    let headers = [(CONTENT_TYPE, "application/json")];
    Ok((headers, record.ok_or_else(no_record)?).into_response())
}

/// Print the adjustment record
///
/// The sheets of the evidence, drawn from `record.json`. A prediction, not a certificate.
#[utoipa::path(get, path = "/work-orders/{id}/record.pdf", tag = "adjusting",
    params(("id" = OrderId, Path)),
    responses((status = 200, content_type = "application/pdf", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is no record yet", body = Problem)))]
async fn print_record(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Response> {
    let bytes = render_record(&app, reader, id, record_pdf).await?;
    Ok(record_file(id, "pdf", "application/pdf", bytes))
}

/// Draw the adjustment record
///
/// The sheets of `record.pdf` as one picture, one below the other.
#[utoipa::path(get, path = "/work-orders/{id}/record.svg", tag = "adjusting",
    params(("id" = OrderId, Path)),
    responses((status = 200, content_type = "image/svg+xml", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is no record yet", body = Problem)))]
async fn draw_record(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Response> {
    let text = render_record(&app, reader, id, record_svg).await?;
    Ok(record_file(id, "svg", "image/svg+xml", text))
}

/// Get the predicted residuals of an adjustment record as CSV
///
/// One line for each place and compass heading, with the 95 % band.
#[utoipa::path(get, path = "/work-orders/{id}/record.csv", tag = "adjusting",
    params(("id" = OrderId, Path)),
    responses((status = 200, content_type = "text/csv", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is no record yet", body = Problem)))]
async fn tabulate_record(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Response> {
    let text = render_record(&app, reader, id, predicted_csv).await?;
    Ok(record_file(id, "csv", "text/csv; charset=utf-8", text))
}

async fn render_record<T: Send + 'static>(
    app: &App,
    reader: PartyReader,
    id: OrderId,
    make: fn(&str) -> anyhow::Result<T>,
) -> Result<T> {
    let summary = store::find_summary(&app.db, reader.tenant, id).await?;
    let record = store::find_record(&app.db, summary.vessel_id, id).await?;
    let record = record.ok_or_else(no_record)?;
    Ok(tokio::task::spawn_blocking(move || make(&record)).await??)
}

fn record_file(id: OrderId, extension: &str, kind: &str, body: impl Into<Body>) -> Response {
    let name = format!("inline; filename=\"record-{id}.{extension}\"");
    let headers = [(CONTENT_TYPE, kind), (CONTENT_DISPOSITION, name.as_str())];
    (headers, body.into()).into_response()
}

/// Get the evidence of an adjustment
///
/// One archive that `binnacle-server verify-evidence` checks, with instructions for a check by
/// hand. A prediction, not a certificate.
#[utoipa::path(get, path = "/work-orders/{id}/evidence.zip", tag = "adjusting",
    params(("id" = OrderId, Path)),
    responses((status = 200, content_type = "application/zip", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "There is no record yet", body = Problem)))]
async fn find_evidence(
    Shared(app): Shared<App>,
    reader: PartyReader,
    Id(id): Id<OrderId>,
) -> Result<Response> {
    let stored = store::find(&app.db, reader.tenant, id).await?;
    let vessel = stored.summary.vessel_id;
    let record = store::find_record(&app.db, vessel, id).await?;
    let record = record.ok_or_else(no_record)?;
    let mut files = vec![File {
        name: "predicted.csv".to_owned(),
        bytes: predicted_csv(&record)?.into_bytes(),
    }];
    for (seq, photo) in photos(&stored) {
        let found = store::find_photo(&app.db, vessel, id, photo.id).await?;
        let (_, bytes) = found.ok_or_else(|| anyhow::anyhow!("a photograph is missing"))?;
        let name = photo.file(seq);
        files.push(File { name, bytes });
    }
    files.push(File {
        name: "record.json".to_owned(),
        bytes: record.clone().into_bytes(),
    });
    let lines = store::list_lines(&app.db, vessel, id, None, i64::MAX).await?;
    // An entry written meanwhile is left for the next archive.
    let lines = lines.into_iter().zip(&stored.log);
    let lines = lines.map(|(stored, entry)| {
        let sealed = SealedEntry {
            seq: stored.seq,
            sha256: stored.sha256.clone(),
            readers: readers(entry.content.event().audience()),
            seal: stored.seal(),
        };
        let text = firm_view::line(reader.tenant, entry, stored.line, &sealed.sha256)?;
        Ok(Line { text, sealed })
    });
    let firm = reader.tenant.firm();
    let mut evidence = Evidence {
        order: id.to_string(),
        reader: firm.map_or(OPERATOR.to_owned(), |firm| firm.to_string()),
        lines: lines.collect::<Result<_>>()?,
        files,
    };
    let key = signing_keys::of_server(&app.db, app.clock.now().into()).await?;
    let written = tokio::task::spawn_blocking(move || {
        evidence.files.push(File {
            name: "record.pdf".to_owned(),
            bytes: record_pdf(&record)?,
        });
        archive(evidence, &key)
    });
    let bytes = written.await??;
    let name = format!("attachment; filename=\"evidence-{id}.zip\"");
    let headers = [
        (CONTENT_TYPE, "application/zip"),
        (CONTENT_DISPOSITION, name.as_str()),
    ];
    Ok((headers, bytes).into_response())
}
