//! Overview of a fleet: vessels page by page, for a map and a table side by side.
//!
//! Invariants: it is one operator's fleet, or the one vessel requested, in the order of
//! entry. A page reads no other page's records. It repeats facts of the vessels' own pages in
//! short, because a slow link carries them.

mod store;

use crate::alerts::{Cause, State};
use crate::analysis::{Interference, Track};
use crate::deviation::{self, WorstHeading};
use crate::models::StoredModel;
use crate::vessels::LastPosition;
use axum::extract;
use axum::extract::FromRef;
use binnacle_compass::field::{FieldModel, field};
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Problem, Result};
use binnacle_platform::http::{Json, Page, Params};
use binnacle_platform::ids::{AlertId, VesselId};
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use binnacle_schedule::ports::{self, PortCode};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use store::{NextPortCall, VesselRow, WorstAlert};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Limit of a page above which it has no tracks.
const MOST_WITH_TRACKS: usize = 200;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_fleet))
}

/// Selection of vessels.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Which {
    /// Only this vessel, for a page that has the others already.
    vessel: Option<VesselId>,
}

/// An operator's vessels.
#[derive(Debug, Serialize, ToSchema)]
pub struct Fleet {
    /// In the order in which they were entered.
    pub vessels: Vec<FleetVessel>,
    /// `after` of the next page.
    #[schema(required)]
    pub next: Option<String>,
}

/// State of a vessel, for a line of a table and a mark on a map.
#[derive(Debug, Serialize, ToSchema)]
pub struct FleetVessel {
    /// The vessel's id.
    pub id: VesselId,
    /// Its name.
    pub name: String,
    /// Its IMO number, seven digits.
    #[schema(required)]
    pub imo_number: Option<String>,
    /// Its call sign.
    #[schema(required)]
    pub call_sign: Option<String>,
    /// Its tags, in alphabetical order.
    pub tags: Vec<String>,
    /// Time of its last batch.
    #[schema(required)]
    pub last_upload_at: Option<Time>,
    /// Place of its latest sample.
    #[schema(required)]
    pub position: Option<LastPosition>,
    /// Its places in the month before, degrees north and east, one for each twelve hours, the
    /// oldest first. Empty with a `limit` above 200, as a map of so many would be unreadable.
    #[schema(value_type = Vec<[f64; 2]>)]
    pub track: Track,
    /// GNSS interference that it met in the last fortnight, the earliest first.
    pub interference: Vec<Interference>,
    /// The current model of its first compass that has one.
    #[schema(required)]
    pub model: Option<FleetModel>,
    /// The heading with the greatest deviation by that model, where it was made.
    #[schema(required)]
    pub worst: Option<WorstHeading>,
    /// Alerts that nobody has acknowledged.
    pub open_alerts: u32,
    /// Its first port call that is not over.
    #[schema(required)]
    pub next_call: Option<NextCall>,
    /// Its most urgent alert that is not cleared: the worst, then those that nobody has
    /// acknowledged, then the latest.
    #[schema(required)]
    pub alert: Option<FleetAlert>,
}

/// Quality of a model, in short.
#[derive(Debug, Serialize, ToSchema)]
pub struct FleetModel {
    /// Counts the compass's models from 1.
    pub version: i64,
    /// Root mean square of the residuals, degrees.
    #[schema(required)]
    pub rms_deg: Option<f64>,
    /// The time of the last sample in it.
    pub data_until: Time,
    /// Number of reasons for which it should not be trusted everywhere.
    pub cautions: usize,
}

/// A port call in short, with the worst heading there.
#[derive(Debug, Serialize, ToSchema)]
pub struct NextCall {
    /// Its UN/LOCODE.
    pub port: String,
    /// Its name; empty where the code is unknown.
    pub port_name: &'static str,
    /// Time of arrival.
    pub eta: Time,
    /// Time of departure.
    pub etd: Time,
    /// The heading with the greatest deviation there and then, by its model.
    #[schema(required)]
    pub worst: Option<WorstHeading>,
}

/// An alert, in short.
#[derive(Debug, Serialize, ToSchema)]
pub struct FleetAlert {
    /// Its id.
    pub id: AlertId,
    /// Its cause.
    pub cause: Cause,
    /// Its severity.
    pub severity: Severity,
    /// Its state of handling.
    pub state: State,
    /// Summary, in a sentence.
    pub summary: String,
}

/// The fleet at a glance
#[utoipa::path(get, path = "/fleet", tag = "fleet", params(Which, Page),
    responses((status = 200, body = Fleet), (status = 401, body = Problem)))]
async fn find_fleet(
    extract::State(app): extract::State<App>,
    reader: Reader,
    Params(which): Params<Which>,
    page: Page,
) -> Result<Json<Fleet>> {
    let which = store::Which {
        operator: reader.operator,
        only: which.vessel,
        after: page.after_id()?.map(VesselId),
        fetch: page.fetch(),
        with_tracks: page.limit() <= MOST_WITH_TRACKS,
    };
    let found = store::find(&app.db, &which, app.clock.now().into()).await?;
    // A thousand models on every heading take too long for an async thread.
    let fleet = tokio::task::spawn_blocking(move || assemble(found, &page));
    Ok(Json(fleet.await.map_err(anyhow::Error::from)?))
}

fn assemble(found: store::FleetRecords, page: &Page) -> Fleet {
    let listed = page.cut(found.vessels, |row| row.id.to_string());
    let mut alerts: HashMap<VesselId, Vec<WorstAlert>> = HashMap::new();
    for alert in found.alerts {
        alerts.entry(alert.vessel_id).or_default().push(alert);
    }
    let mut models = by_vessel(found.models, |model| model.vessel_id);
    let mut tracks = by_vessel(found.tracks, |track| track.vessel_id);
    let mut calls = by_vessel(found.calls, |call| call.vessel_id);
    let mut interference: HashMap<VesselId, Vec<Interference>> = HashMap::new();
    for met in found.interference {
        interference.entry(met.vessel_id).or_default().push(met);
    }
    let mut tags: HashMap<VesselId, Vec<String>> = HashMap::new();
    for (vessel, tag) in found.tags {
        tags.entry(vessel).or_default().push(tag);
    }
    let vessels = listed.items.into_iter().map(|row| {
        let model = models.remove(&row.id);
        let track = tracks.remove(&row.id).map(|stored| stored.track);
        let alerts = alerts.remove(&row.id).unwrap_or_default();
        let call = calls.remove(&row.id);
        let call = call.map(|call| NextCall::from_port_call(call, model.as_ref()));
        let met = interference.remove(&row.id).unwrap_or_default();
        let tags = tags.remove(&row.id).unwrap_or_default();
        FleetVessel {
            interference: met,
            tags,
            ..row.with(model.as_ref(), track.unwrap_or_default(), call, alerts)
        }
    });
    Fleet {
        vessels: vessels.collect(),
        next: listed.next,
    }
}

/// Returns the first item of each vessel.
fn by_vessel<T>(items: Vec<T>, vessel: impl Fn(&T) -> VesselId) -> HashMap<VesselId, T> {
    let mut found = HashMap::with_capacity(items.len());
    for item in items {
        found.entry(vessel(&item)).or_insert(item);
    }
    found
}

impl VesselRow {
    fn with(
        self,
        model: Option<&StoredModel>,
        track: Track,
        next_call: Option<NextCall>,
        alerts: Vec<WorstAlert>,
    ) -> FleetVessel {
        FleetVessel {
            position: self.position(),
            id: self.id,
            name: self.name,
            imo_number: self.imo_number,
            call_sign: self.call_sign,
            last_upload_at: self.last_upload_at,
            track,
            interference: Vec::new(),
            tags: Vec::new(),
            next_call,
            worst: model.and_then(StoredModel::worst).map(rounded),
            model: model.map(FleetModel::from_model),
            open_alerts: alerts.iter().filter(|alert| alert.is_raised()).count() as u32,
            alert: alerts
                .into_iter()
                .max_by_key(WorstAlert::urgency)
                .map(FleetAlert::from),
        }
    }
}

impl NextCall {
    fn from_port_call(call: NextPortCall, model: Option<&StoredModel>) -> NextCall {
        let port = PortCode::parse(&call.port).ok().and_then(ports::find);
        let worst = port.zip(model).and_then(|(port, model)| {
            let earth = field(FieldModel::Igrf14, port.position, 0.0, call.eta.0).ok()?;
            deviation::worst(&model.model.0, earth.for_ship())
        });
        NextCall {
            port: call.port,
            port_name: port.map_or("", |port| port.name),
            eta: call.eta,
            etd: call.etd,
            worst: worst.map(rounded),
        }
    }
}

/// Rounds figures to a thousandth, to save a slow link bytes.
fn rounded(worst: WorstHeading) -> WorstHeading {
    WorstHeading {
        compass_deg: worst.compass_deg,
        deviation_deg: thousandth(worst.deviation_deg),
        band95_deg: worst.band95_deg.map(thousandth),
    }
}

fn thousandth(degrees: f64) -> f64 {
    (degrees * 1000.0).round() / 1000.0
}

impl FleetModel {
    fn from_model(model: &StoredModel) -> FleetModel {
        let quality = model.model.0.quality.as_ref();
        FleetModel {
            version: model.version,
            rms_deg: model.model.0.rms_deg.map(thousandth),
            data_until: model.data_until,
            cautions: quality.map_or(0, |quality| quality.cautions.len()),
        }
    }
}

impl From<WorstAlert> for FleetAlert {
    fn from(alert: WorstAlert) -> FleetAlert {
        FleetAlert {
            id: alert.id,
            cause: alert.cause,
            severity: alert.severity,
            state: alert.state,
            summary: alert.summary,
        }
    }
}
