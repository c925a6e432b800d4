//! Port calls from port systems, one time after another: the timestamps of DCSA's standard for
//! just-in-time port calls, version 1.2.
//!
//! Invariants: a call follows from arrival and departure at the berth; a first one alone is kept
//! until the other is known. Times of services and of other places change nothing. The reference
//! of the visit identifies the call. What the call has besides, such as its uncertainty, stays.

use super::call::{Content, Source};
use super::store;
use super::upload::{ParsedFile, Uploaded, store_file};
use super::uploaded_file::VesselCalls;
use axum::extract::{FromRef, State};
use binnacle_fleet::vessels;
use binnacle_platform::access::Writer;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Tx, execute, row};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Json, Valid, optional_text, text};
use binnacle_platform::ids::VesselId;
use binnacle_platform::time::Time;
use binnacle_schedule::calls::FileErrors;
use binnacle_schedule::ports::{self, PortCode};
use binnacle_schedule::time::Instant;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(receive_timestamp))
}

/// Time of a vessel's visit to a port. Other members of the standard are ignored.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
#[schema(as = PortCallTimestamp, example = json!({
    "vesselIMONumber": "9074729", "UNLocationCode": "NLRTM", "portVisitReference": "NLRTM26120042",
    "facilityTypeCode": "BRTH", "eventClassifierCode": "EST", "operationsEventTypeCode": "ARRI",
    "eventDateTime": "2026-12-08T06:00:00Z", "eventLocation": { "locationName": "Maasvlakte 3" }
}))]
struct Timestamp {
    /// IMO number of the vessel.
    #[serde(rename = "vesselIMONumber")]
    vessel_imo_number: String,
    /// UN/LOCODE of the port.
    #[serde(rename = "UNLocationCode")]
    #[schema(value_type = String)]
    un_location_code: PortCode,
    /// Reference of the visit in the port's system.
    #[schema(max_length = 50)]
    port_visit_reference: String,
    /// Kind of place: `BRTH` is the berth.
    facility_type_code: String,
    /// Nature of the time.
    event_classifier_code: Classifier,
    /// Event.
    operations_event_type_code: EventType,
    /// Time, with a time zone.
    #[schema(value_type = Time)]
    event_date_time: Instant,
    /// Service that the event belongs to, such as pilotage.
    port_call_service_type_code: Option<String>,
    /// Berth.
    event_location: Option<EventLocation>,
}

/// Place of an event.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
#[schema(as = PortCallTimestampLocation)]
struct EventLocation {
    /// Name of the berth.
    #[schema(max_length = 100)]
    location_name: Option<String>,
}

/// Nature of a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "UPPERCASE")]
#[schema(as = PortCallTimestampClassifier)]
enum Classifier {
    /// Estimated.
    Est,
    /// Requested by one side: not used.
    Req,
    /// Planned: agreed on.
    Pln,
    /// Actual.
    Act,
}

/// Event of a visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "UPPERCASE")]
#[schema(as = PortCallTimestampEvent)]
enum EventType {
    /// Arrival.
    Arri,
    /// Departure.
    Depa,
    /// Start of a service: not used.
    Strt,
    /// Completion of a service: not used.
    Cmpl,
    /// The visit is left out.
    Omit,
    /// The visit is cancelled.
    Canc,
}

/// Effect of a timestamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = PortCallTimestampEffect)]
enum Effect {
    /// Kept until the arrival is known.
    AwaitsArrival,
    /// Kept until the departure is known.
    AwaitsDeparture,
    /// A port call was made.
    Created,
    /// The port call was amended.
    Amended,
    /// The port call was withdrawn.
    Withdrawn,
    /// The port call has these times already.
    Unchanged,
    /// Not a time at a berth, a request, or of a visit that is over.
    NotUsed,
}

/// Effect of a timestamp.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = ReceivedPortCallTimestamp)]
struct Received {
    /// The vessel.
    vessel_id: VesselId,
    /// Effect.
    effect: Effect,
}

/// Receive a time of a port call from a port system
///
/// The message is a timestamp of DCSA's standard for just-in-time port calls, version 1.2, as port
/// systems and agents send it. Arrival and departure at the berth (`BRTH`, no service) make a port
/// call whose reference is `portVisitReference`; estimated, planned and actual times amend it;
/// `OMIT` and `CANC` of the visit withdraw it, those of a service do not.
#[utoipa::path(post, path = "/port-calls/timestamps", tag = "adjusting", request_body = Timestamp,
    responses((status = 200, body = Received), (status = 401, body = Problem),
              (status = 403, body = Problem),
              (status = 404, description = "No vessel of yours has the IMO number", body = Problem),
              (status = 409, description = "The quota of port calls is used up", body = Problem),
              (status = 422, description = "Also when the call overlaps another", body = Problem)))]
async fn receive_timestamp(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Valid(timestamp): Valid<Timestamp>,
) -> Result<Json<Received>> {
    let fleet = vessels::names(&app.db, writer.operator).await?;
    let named = |imo: &Option<String>| imo.as_deref() == Some(timestamp.vessel_imo_number.as_str());
    let vessel = fleet.iter().find(|vessel| named(&vessel.imo_number));
    let vessel_id = vessel.ok_or(Error::NotFound("vessel"))?.id;
    let effect = Box::pin(apply(&app, &request, writer, vessel_id, timestamp)).await?;
    Ok(Json(Received { vessel_id, effect }))
}

async fn apply(
    app: &App,
    request: &RequestContext,
    writer: Writer,
    vessel: VesselId,
    timestamp: Timestamp,
) -> Result<Effect> {
    if !timestamp.is_used() {
        return Ok(Effect::NotUsed);
    }
    let port = timestamp.un_location_code;
    if ports::find(port).is_none() {
        return Err(Error::Invalid {
            field: "UNLocationCode",
            detail: ports::describe_unknown(port),
        });
    }
    let reference = text("portVisitReference", &timestamp.port_visit_reference)?;
    let now: Time = app.clock.now().into();
    let mut tx = request.begin().await?;
    let known = store::lock(&mut tx, writer.operator, vessel).await?;
    let known = known.iter().find(|row| row.reference == reference);
    let mut calls = VesselCalls::default();
    if timestamp.ends_visit() {
        forget(&mut tx, vessel, &reference).await?;
        calls.cancelled.insert(reference);
    } else {
        let known = known.map(store::StoredCall::content).transpose()?;
        let reported = keep(&mut tx, vessel, &reference, &timestamp, now).await?;
        let eta = reported.0.or(known.as_ref().map(|call| call.eta));
        let etd = reported.1.or(known.as_ref().map(|call| call.etd));
        let (eta, etd) = match (eta, etd) {
            (Some(eta), Some(etd)) => (eta, etd),
            (eta, _) => {
                tx.commit().await?;
                return Ok(if eta.is_none() {
                    Effect::AwaitsArrival
                } else {
                    Effect::AwaitsDeparture
                });
            }
        };
        if etd <= now {
            return Ok(Effect::NotUsed);
        }
        forget(&mut tx, vessel, &reference).await?;
        let call = timestamp.amended(known, reference, eta, etd)?;
        calls.add(call.checked(now)?);
    }
    let file = ParsedFile {
        vessels: BTreeMap::from([(vessel, calls)]),
        errors: FileErrors::default(),
        over: 0,
    };
    let done = Box::pin(store_file(app, tx, writer, file, Source::Api, false)).await?;
    Ok(Effect::of(&done))
}

impl Timestamp {
    fn is_used(&self) -> bool {
        let is_service = self.port_call_service_type_code.is_some()
            || matches!(
                self.operations_event_type_code,
                EventType::Strt | EventType::Cmpl
            );
        let is_request = self.event_classifier_code == Classifier::Req;
        let is_of_visit = self.ends_visit() || self.facility_type_code == "BRTH";
        is_of_visit && !is_service && !is_request
    }

    fn ends_visit(&self) -> bool {
        matches!(
            self.operations_event_type_code,
            EventType::Omit | EventType::Canc
        )
    }

    /// Returns the call with the times of the visit, and what else was known of it.
    fn amended(
        &self,
        known: Option<Content>,
        reference: String,
        eta: Time,
        etd: Time,
    ) -> Result<Content> {
        let location = self.event_location.as_ref();
        let berth = location.and_then(|location| location.location_name.as_deref());
        let berth = optional_text("eventLocation.locationName", berth)?;
        let known_berth = known.as_ref().and_then(|call| call.berth.clone());
        Ok(Content {
            reference,
            port: self.un_location_code,
            berth: berth.or(known_berth),
            eta,
            eta_uncertainty_h: known.as_ref().map_or(0.0, |call| call.eta_uncertainty_h),
            etd,
            etd_uncertainty_h: known.as_ref().map_or(0.0, |call| call.etd_uncertainty_h),
            berth_heading_deg: known.and_then(|call| call.berth_heading_deg),
        })
    }
}

impl Effect {
    fn of(done: &Uploaded) -> Effect {
        match done {
            Uploaded { created: 1.., .. } => Effect::Created,
            Uploaded { amended: 1.., .. } => Effect::Amended,
            Uploaded { withdrawn: 1.., .. } => Effect::Withdrawn,
            _ => Effect::Unchanged,
        }
    }
}

/// Keeps a time of a visit, and returns the arrival and departure that are known of it.
async fn keep(
    tx: &mut Tx,
    vessel: VesselId,
    reference: &str,
    timestamp: &Timestamp,
    now: Time,
) -> Result<(Option<Time>, Option<Time>)> {
    let at = Some(Time(timestamp.event_date_time.0));
    let (eta, etd) = match timestamp.operations_event_type_code {
        EventType::Depa => (None, at),
        _ => (at, None),
    };
    let known = row!(
        in tx,
        (Option<Time>, Option<Time>),
        "INSERT INTO port_visits (vessel_id, reference, eta, etd, changed_at)
         VALUES ($1, $2, $3, $4, $5)
         ON CONFLICT (vessel_id, reference) DO UPDATE
         SET eta = COALESCE(excluded.eta, port_visits.eta),
             etd = COALESCE(excluded.etd, port_visits.etd), changed_at = excluded.changed_at
         RETURNING eta, etd",
        vessel,
        reference,
        eta,
        etd,
        now
    )?;
    Ok(known.unwrap_or((eta, etd)))
}

/// Forgets the times of a visit: its call has them, or it does not take place.
async fn forget(tx: &mut Tx, vessel: VesselId, reference: &str) -> Result<()> {
    execute!(
        tx,
        "DELETE FROM port_visits WHERE vessel_id = $1 AND reference = $2",
        vessel,
        reference
    )?;
    Ok(())
}
