//! Ingest of batches from agents, answered with an acknowledgement and the downlink.
//!
//! Invariants:
//!
//! - A batch is acknowledged only when it and the job to analyse it are on disk, in one
//!   transaction.
//! - The same batch again changes nothing. Other bytes under the same number are refused.
//! - The same transaction records the agent's own alerts, and signs of a second computer that runs
//!   as the same agent.
//! - `contiguous_seq` covers only batches that are stored, all from 1 on.
//! - An agent reaches its own streams and nothing else.
//! - A batch in order takes six statements. Only updates for the agent, a gap, a repetition or another
//!   batch of the stream at the same time takes more.

mod downlink;
mod sender;
mod short_burst;
mod store;

pub use short_burst::{
    Acknowledgement, ImportResult, IncompleteBatch, RefusedMessage, ShortBurst, import_messages,
};

use crate::agent_auth::Agent;
use crate::enrolment;
use crate::event_kinds;
use crate::{alerts, analysis_queue};
use axum::body::Bytes;
use axum::extract::rejection::BytesRejection;
use axum::extract::{DefaultBodyLimit, FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::app::App;
use binnacle_platform::audit::{self, RequestContext};
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::events::{self, NewEvent};
use binnacle_platform::http::{FileContent, Id, Json, Params};
use binnacle_platform::ids::VesselId;
use binnacle_platform::time::Time;
use binnacle_wire::batch::{Batch, StreamId};
use binnacle_wire::codec::MAX_BYTES;
use binnacle_wire::messages::{Downlink, OpenStreamResponse};
use downlink::{AgentState, DownlinkResponse};
use metrics::counter;
use sender::{Sender, StreamState};
use std::time::Duration;
use store::{BoardReport, Upload};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// Upper bound of batch numbers: JSON's numbers are exact up to here, and the database can hold
/// one more.
const SEQ_END: u64 = 1 << 53;
/// Longest wait of a response for an analysis: proxies give up after a minute.
const LONGEST_WAIT: Duration = Duration::from_secs(55);

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(put_batch))
        .route_layer(axum::middleware::from_fn(audit::leave_out))
        .layer(DefaultBodyLimit::max(MAX_BYTES))
        .routes(routes!(open_stream))
        .routes(routes!(downlink))
}

/// Open a new stream for the same compass
#[utoipa::path(post, path = "/streams", tag = "agents", security(("token" = [])),
    responses((status = 201, body = OpenStreamResponse), (status = 401, body = Problem)))]
async fn open_stream(
    State(app): State<App>,
    request: RequestContext,
    agent: Agent,
) -> Result<(StatusCode, Json<OpenStreamResponse>)> {
    let mut tx = request.begin().await?;
    let stream = enrolment::open_stream(&mut tx, agent, app.clock.now().into()).await?;
    tx.commit().await?;
    Ok((StatusCode::CREATED, Json(OpenStreamResponse { stream })))
}

/// Send a batch
///
/// Responds when the batch is durable. The same batch again gets the same response.
#[utoipa::path(put, path = "/streams/{stream}/batches/{seq}", tag = "agents",
    security(("token" = [])),
    params(("stream" = Uuid, Path), ("seq" = u64, Path, minimum = 1), AgentState),
    request_body(content = inline(FileContent), content_type = "application/octet-stream",
                 description = "The frame, as crates/wire/FORMAT.md has it"),
    responses((status = 200, description = "As JSON, or in the compact form asked for",
               content((Downlink = "application/json"),
                       (inline(FileContent) = "application/octet-stream"))),
              (status = 400, body = Problem), (status = 401, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "Other bytes are stored under this number", body = Problem),
              (status = 413, body = Problem), (status = 422, body = Problem)))]
async fn put_batch(
    State(app): State<App>,
    request: RequestContext,
    sender: Sender,
    Id((stream, seq)): Id<(Uuid, u64)>,
    Params(state): Params<AgentState>,
    body: std::result::Result<Bytes, BytesRejection>,
) -> Result<DownlinkResponse> {
    must_not_flood(&app, sender.agent.vessel_id)?;
    let bytes = body.map_err(|rejection| too_large(&rejection))?;
    let batch = decode_batch(&bytes, StreamId(stream), seq)?;
    let delay_s = match state.wait {
        None => analysis_delay_s(&app, &batch),
        // It is the last batch for now.
        Some(_) => 0.0,
    };
    let waits = state.waits.or(state.wait.map(|_| 0));
    let upload = Upload {
        agent: sender.agent,
        stream: sender.stream.clone(),
        batch: &batch,
        bytes: &bytes,
        board: waits.map(|waits| BoardReport {
            waits,
            budget_percent: state.budget,
        }),
        now: app.clock.now().into(),
    };
    let mut tx = request.begin().await?;
    let received = store_upload(&mut tx, upload, delay_s).await?;
    tx.commit().await?;
    for event in received.events_out {
        app.publish(event);
    }
    let result = if received.is_new {
        "stored"
    } else {
        "repeated"
    };
    counter!("binnacle_batches_total", "result" => result).increment(1);
    let stages: &[&str] = if received.is_new {
        &["received", "stored"]
    } else {
        &["received"]
    };
    for &stage in stages {
        counter!("binnacle_bytes_total", "stage" => stage).increment(bytes.len() as u64);
    }
    if let Some(wait_s) = state.wait.filter(|_| !batch.samples.is_empty()) {
        let at_most = Duration::from_secs(wait_s.into()).min(LONGEST_WAIT);
        analysis_queue::wait_until_done(&app, sender.agent.vessel_id, at_most).await?;
    } else if sender.lacks_nothing(&state) {
        return Ok(downlink::acknowledge(&app, received.contiguous_seq, &state));
    }
    downlink::answer(&app, sender.agent, stream, state).await
}

/// Refuses the uploads of a vessel beyond those of a day. An agent keeps its batches and sends them
/// again; a program with a stolen token cannot fill the disk.
fn must_not_flood(app: &App, vessel: VesselId) -> Result<()> {
    let now_s = u64::try_from(app.clock.now().micros() / 1_000_000).unwrap_or(0);
    let limit = app.config.uploads_per_day;
    let day = app
        .uploads
        .count(vessel.0.as_bytes().to_vec(), now_s, limit);
    if day.is_exceeded {
        return Err(Error::TooManyUploads {
            limit,
            retry_after_s: day.resets_in_s,
        });
    }
    Ok(())
}

/// Result of a received batch.
#[derive(Debug)]
pub struct Received {
    /// True if it was not stored before.
    pub is_new: bool,
    /// Number up to which every batch of the stream is stored.
    pub contiguous_seq: i64,
    /// Events to be published once the transaction is committed.
    pub events_out: Vec<events::Event>,
}

/// Stores a batch with all its consequences, on whichever link it arrived.
///
/// # Errors
/// Fails when the stream is not the agent's, or other bytes are stored under the batch's number.
pub async fn store_batch(
    tx: &mut Tx,
    agent: Agent,
    batch: &Batch,
    bytes: &[u8],
    now: Time,
    delay_s: f64,
) -> Result<Received> {
    let upload = Upload {
        agent,
        stream: StreamState::find(tx, agent, batch.stream.0).await?,
        batch,
        bytes,
        board: None,
        now,
    };
    store_upload(tx, upload, delay_s).await
}

async fn store_upload(tx: &mut Tx, upload: Upload<'_>, delay_s: f64) -> Result<Received> {
    let Upload {
        agent, batch, now, ..
    } = upload;
    let has_later_stream = upload.stream.has_later;
    let stored = store::insert(tx, upload).await?;
    let mut events_out = Vec::new();
    if stored.is_new {
        let (vessel, compass) = (agent.vessel_id, agent.compass_id);
        events_out
            .extend(alerts::record_agent_alerts(tx, vessel, compass, &batch.alerts, now).await?);
        if has_later_stream {
            let (stream, seq) = (batch.stream.0, batch.seq);
            let conflict = alerts::check_duplicate_agent(tx, agent, stream, seq, now);
            events_out.extend(conflict.await?);
        }
        let operator = store::update_vessel(tx, vessel, batch, now).await?;
        if !batch.samples.is_empty() || !batch.alerts.is_empty() {
            analysis_queue::enqueue(tx, vessel, now, delay_s).await?;
        }
        let event = NewEvent {
            vessel_id: vessel,
            kind: event_kinds::BATCH,
            about: None,
            firm_id: None,
        };
        events_out.push(events::insert_of(tx, operator, event, now).await?);
    }
    Ok(Received {
        is_new: stored.is_new,
        contiguous_seq: stored.contiguous_seq,
        events_out,
    })
}

/// Fetch the updates that the agent lacks
#[utoipa::path(get, path = "/streams/{stream}/downlink", tag = "agents", security(("token" = [])),
    params(("stream" = Uuid, Path), AgentState),
    responses((status = 200, description = "As JSON, or in the compact form asked for",
               content((Downlink = "application/json"),
                       (inline(FileContent) = "application/octet-stream"))),
              (status = 401, body = Problem), (status = 404, body = Problem)))]
async fn downlink(
    State(app): State<App>,
    agent: Agent,
    Id(stream): Id<Uuid>,
    Params(state): Params<AgentState>,
) -> Result<DownlinkResponse> {
    downlink::answer(&app, agent, stream, state).await
}

/// Returns the delay in which further batches may arrive; none for a batch with an alert.
fn analysis_delay_s(app: &App, batch: &Batch) -> f64 {
    if batch.alerts.is_empty() {
        return f64::from(app.config.analysis_delay_s);
    }
    0.0
}

/// Decodes a frame, and checks that it is the one that the path names.
fn decode_batch(bytes: &[u8], stream: StreamId, seq: u64) -> Result<Batch> {
    let batch =
        binnacle_wire::decode(bytes).map_err(|error| Error::BadRequest(error.to_string()))?;
    if batch.stream != stream {
        return Err(Error::Invalid {
            field: "stream",
            detail: format!("the frame belongs to stream {}", batch.stream),
        });
    }
    if batch.seq >= SEQ_END {
        return Err(Error::BadRequest(format!(
            "seq: {} is not below {SEQ_END}",
            batch.seq
        )));
    }
    if batch.seq != seq {
        return Err(Error::Invalid {
            field: "seq",
            detail: format!("the frame has number {}", batch.seq),
        });
    }
    Ok(batch)
}

fn too_large(rejection: &BytesRejection) -> Error {
    if rejection.status() == StatusCode::PAYLOAD_TOO_LARGE {
        return Error::TooLarge(MAX_BYTES);
    }
    Error::BadRequest(rejection.body_text())
}
