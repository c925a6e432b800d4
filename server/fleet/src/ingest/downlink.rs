//! Downlink: the acknowledgement, and updates that the agent lacks.

use crate::agent_auth::Agent;
use crate::models::{self, StoredModel};
use crate::settings;
use axum::Json;
use axum::body::{Body, HttpBody};
use axum::response::{IntoResponse, Response};
use binnacle_compass::model::Model;
use binnacle_platform::app::App;
use binnacle_platform::db::row;
use binnacle_platform::error::{Error, Result};
use binnacle_wire::downlink::{self, FORM, card_tag};
use binnacle_wire::messages::{Downlink, ModelDownlink};
use metrics::counter;
use serde::Deserialize;
use utoipa::IntoParams;
use uuid::Uuid;

/// State of the agent, as the request names it.
#[derive(Clone, Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct AgentState {
    /// The model version it uses. Any later one is sent at once.
    model: Option<Uuid>,
    /// The last eight digits of that model's id. A later model is sent when the difference matters.
    card: Option<String>,
    /// The settings it uses.
    settings: Option<u32>,
    /// The compact form that it reads, of crates/wire/DOWNLINK.md; JSON when absent.
    form: Option<u8>,
    /// With a batch: number of others that wait on board; absent with `wait`, in the last one.
    pub(super) waits: Option<u32>,
    /// With a batch: rest of the link's budget where that is less than a day's, in hundredths of
    /// it; negative when overdrawn.
    pub(super) budget: Option<i32>,
    /// Seconds, at most 55, for which the response to a batch may wait for the analysis of its
    /// samples. The response then includes its results. Sent with the last batch for now.
    pub(super) wait: Option<u16>,
}

impl AgentState {
    pub(super) fn uses(&self, model: Uuid) -> bool {
        self.model == Some(model)
    }

    pub(super) fn uses_card(&self, tag: &str) -> bool {
        self.card.as_deref() == Some(tag)
    }

    pub(super) fn has_card(&self) -> bool {
        self.model.is_some() || self.card.is_some()
    }

    pub(super) fn settings_version(&self) -> u32 {
        self.settings.unwrap_or(0)
    }
}

/// Downlink in the form that the agent requested.
pub(super) struct DownlinkResponse {
    downlink: Downlink,
    form: Option<u8>,
}

impl IntoResponse for DownlinkResponse {
    fn into_response(self) -> Response {
        let reads_compact = self.form.is_some_and(|form| form >= FORM);
        let compact = reads_compact.then(|| downlink::encode(&self.downlink));
        let response = match compact.flatten() {
            // A body without a content type is bytes (RFC 9110, 8.3), which saves forty of them.
            Some(bytes) => Body::from(bytes).into_response(),
            None => Json(self.downlink).into_response(),
        };
        let bytes = response.body().size_hint().exact().unwrap_or_default();
        counter!("binnacle_bytes_total", "stage" => "sent").increment(bytes);
        response
    }
}

/// Returns the acknowledgement for an agent that lacks nothing.
pub(super) fn acknowledge(app: &App, contiguous_seq: i64, state: &AgentState) -> DownlinkResponse {
    DownlinkResponse {
        downlink: Downlink {
            contiguous_seq: contiguous_seq as u64,
            model: None,
            unread: None,
            card_withdrawn: None,
            settings: None,
            server_time: app.clock.now(),
        },
        form: state.form,
    }
}

/// Returns the acknowledgement, with what the agent lacks.
pub(super) async fn answer(
    app: &App,
    agent: Agent,
    stream: Uuid,
    state: AgentState,
) -> Result<DownlinkResponse> {
    let (contiguous_seq,) = row!(
        &app.db,
        (i64,),
        "SELECT contiguous_seq FROM streams
         WHERE vessel_id = $1 AND id = $2 AND agent_id = $3
         ORDER BY id",
        agent.vessel_id,
        stream,
        agent.agent_id
    )?
    .ok_or(Error::NotFound("stream"))?;
    let current = models::current(&app.db, agent.vessel_id, agent.compass_id).await?;
    let card_withdrawn = if state.has_card() {
        models::card_withdrawn(&app.db, agent.vessel_id, agent.compass_id).await?
    } else {
        None
    };
    let newer = match current {
        Some(model) if Some(model.id.0) == state.model => None,
        Some(model) if !should_send(app, &model, state.card.as_deref()).await? => None,
        current => current,
    };
    if let Some(model) = newer.as_ref().filter(|model| model.sent_at.is_none()) {
        let mut tx = app.db.begin().await?;
        models::note_sent(&mut tx, model, app.clock.now().into()).await?;
        tx.commit().await?;
    }
    let settings = settings::find(&app.db, agent.vessel_id).await?.agent;
    let downlink = Downlink {
        contiguous_seq: contiguous_seq as u64,
        model: newer.map(|model| ModelDownlink {
            id: model.id.0,
            version: model.version as u32,
            data_until: model.data_until.0,
            replaces: model.replaces(),
            // The server keeps the quality of the model; the bridge has its band.
            model: Model {
                quality: None,
                ..model.model.0
            },
        }),
        unread: None,
        card_withdrawn,
        settings: Some(settings).filter(|current| current.version != state.settings_version()),
        server_time: app.clock.now(),
    };
    let form = state.form;
    Ok(DownlinkResponse { downlink, form })
}

/// Tells whether an agent should get this model in place of the one that it names.
async fn should_send(app: &App, model: &StoredModel, card: Option<&str>) -> Result<bool> {
    let Some(card) = card else {
        return Ok(true);
    };
    if card == card_tag(model.id.0) {
        return Ok(false);
    }
    let known = models::list_recent(&app.db, model.vessel_id, model.compass_id).await?;
    let known = known.iter().find(|known| card == card_tag(known.id.0));
    Ok(known.is_none_or(|known| model.is_update_of(known)))
}
