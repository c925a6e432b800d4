//! Deviation cards: a model's deviation on each heading at a place, as PDF, SVG, CSV and JSON.
//!
//! Invariants:
//!
//! - A card states whether it is predicted or verified by headings at sea, and that it is not a
//!   certificate. Facts that nobody has recorded are marked so, or left blank for a person's pen.
//! - Each compass has a card of its own.
//! - A card that would mislead is refused, with the reason.
//! - The same model, place and date make the same card, to the byte, while the server's signing key
//!   is the same.
//! - Anyone who holds a card can check whether it is in force.

pub mod check;
mod contents;
mod csv;
mod due;
mod layout;
mod make;
mod observed;
mod refusal;
mod tables;

pub use contents::{Card, CardStatus};
pub use refusal::Refusal;

use axum::extract::{FromRef, State};
use axum::response::Response;
use binnacle_compass::field::field;
use binnacle_compass::position::Position;
use binnacle_fleet::adjustments;
use binnacle_fleet::alerts;
use binnacle_fleet::analysis;
use binnacle_fleet::binnacles;
use binnacle_fleet::compasses;
use binnacle_fleet::deviation_table;
use binnacle_fleet::logbook;
use binnacle_fleet::models::{self, StoredModel};
use binnacle_fleet::settings::{self, VesselSettings};
use binnacle_fleet::vessels;
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{FileContent, FileName, Id, Json, Params, file, time};
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::signing_keys;
use binnacle_platform::time::Time;
use contents::{CardPlace, CardVessel};
use make::{CardInput, make};
use observed::{SampleRole, observed};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .merge(check::router())
        .routes(routes!(card_json))
        .routes(routes!(card_pdf))
        .routes(routes!(card_svg))
        .routes(routes!(card_csv))
}

/// Compass, place and time of a card.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Query {
    /// A compass of the vessel; its first one by default.
    compass: Option<CompassId>,
    /// Degrees north; the vessel's last position by default.
    #[param(example = 43.4)]
    lat: Option<f64>,
    /// Degrees east; the vessel's last position by default.
    #[param(example = -3.1)]
    lon: Option<f64>,
    /// RFC 3339; by default the time of the last sample, or of the model.
    #[param(value_type = Option<String>, format = DateTime)]
    at: Option<String>,
}

/// See a compass's deviation card
///
/// By the compass's model, at a place and a date. It is `predicted` until headings at sea have
/// verified the adjustment that the model comes from. Then it is `verified`, and `verified` names
/// the order, the time and the number of headings. A change that ends the adjustment's epoch ends
/// that too. It is never a certificate.
///
/// Besides the usual problems: `no-model-yet` (404) without a model, also because the last one is
/// withdrawn. `model-too-old`, `band-too-wide`, `field-too-weak`, `headings-ambiguous` or
/// `compass-suspected` (409) where the model makes no card.
#[utoipa::path(get, path = "/vessels/{id}/card.json", tag = "fleet",
    params(("id" = VesselId, Path), Query),
    responses((status = 200, body = Card), (status = 401, body = Problem),
              (status = 404, description = "Also when there is no model, or it is withdrawn", body = Problem),
              (status = 409, description = "The model makes no card, for the reason in the detail", body = Problem),
              (status = 422, body = Problem)))]
async fn card_json(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(query): Params<Query>,
) -> Result<Json<Card>> {
    Ok(Json(find(&app, reader, id, &query).await?))
}

/// Print a compass's deviation card
///
/// One sheet of A4 in portrait, refused as `card.json` is.
#[utoipa::path(get, path = "/vessels/{id}/card.pdf", tag = "fleet",
    params(("id" = VesselId, Path), Query),
    responses((status = 200, content_type = "application/pdf", body = inline(FileContent)),
              (status = 401, body = Problem),
              (status = 404, description = "Also when there is no model, or it is withdrawn", body = Problem),
              (status = 409, description = "The model makes no card, for the reason in the detail", body = Problem),
              (status = 422, body = Problem)))]
async fn card_pdf(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(query): Params<Query>,
) -> Result<Response> {
    let card = find(&app, reader, id, &query).await?;
    let name = name(&card, "pdf");
    let drawn = move || binnacle_drawing::pdf(&[layout::sheet(&card)], &layout::about(&card));
    let bytes = tokio::task::spawn_blocking(drawn).await??;
    Ok(file("application/pdf", &name, bytes))
}

/// Draw a compass's deviation card
///
/// The sheet of `card.pdf` as a picture; refused as `card.json` is.
#[utoipa::path(get, path = "/vessels/{id}/card.svg", tag = "fleet",
    params(("id" = VesselId, Path), Query),
    responses((status = 200, content_type = "image/svg+xml", body = inline(FileContent)),
              (status = 401, body = Problem),
              (status = 404, description = "Also when there is no model, or it is withdrawn", body = Problem),
              (status = 409, description = "The model makes no card, for the reason in the detail", body = Problem),
              (status = 422, body = Problem)))]
async fn card_svg(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(query): Params<Query>,
) -> Result<Response> {
    let card = find(&app, reader, id, &query).await?;
    let svg = binnacle_drawing::svg(&[layout::sheet(&card)], &layout::about(&card).title);
    Ok(file("image/svg+xml", &name(&card, "svg"), svg))
}

/// A compass's deviation card as CSV
///
/// A line for each 15° of compass heading, with its status, model and work order. Refused as
/// `card.json` is.
#[utoipa::path(get, path = "/vessels/{id}/card.csv", tag = "fleet",
    params(("id" = VesselId, Path), Query),
    responses((status = 200, content_type = "text/csv", body = inline(FileContent)),
              (status = 401, body = Problem),
              (status = 404, description = "Also when there is no model, or it is withdrawn", body = Problem),
              (status = 409, description = "The model makes no card, for the reason in the detail", body = Problem),
              (status = 422, body = Problem)))]
async fn card_csv(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(query): Params<Query>,
) -> Result<Response> {
    let card = find(&app, reader, id, &query).await?;
    let bytes = csv::csv(&card).map_err(|error| Error::Internal(error.into()))?;
    Ok(file("text/csv; charset=utf-8", &name(&card, "csv"), bytes))
}

async fn find(app: &App, reader: Reader, id: VesselId, query: &Query) -> Result<Card> {
    let db = &app.db;
    let vessel = vessels::must_be_in_fleet(db, reader.operator, id).await?;
    let compass = compasses::find(db, id, query.compass).await?;
    let model = models::must_have(app, id, compass.id).await?;
    let settings = settings::find(db, id).await?;
    let last = vessel.last_position();
    let last_at = last.map_or(model.place_at, |last| last.at);
    let last = match last {
        Some(last) => Position::new(last.lat, last.lon),
        None => Position::new(model.lat, model.lon),
    };
    let last = last.map_err(anyhow::Error::from)?;
    let position = deviation_table::position(query.lat, query.lon, last)?;
    let place = place(position, query.at(&model, last_at)?, &settings)?;
    let now = app.clock.now().into();
    let (from, until) = match (model.foretold_by, model.epoch_from) {
        // A predicted model includes no observation since.
        (Some(_), Some(from)) => (from, now),
        _ => (model.data_from, model.data_until.0.plus_seconds(1.0).into()),
    };
    let data = data_of(app, &model).await?;
    let samples = analysis::samples(db, id, compass.id, Some(from), Some(until)).await?;
    let completed = adjustments::completed(db, id, compass.id).await?;
    let binnacle = binnacles::current(db, id, compass.id).await?;
    let logbook = logbook::of_compass(db, id, compass.id).await?;
    let alerts = alerts::list_in_force(db, id, compass.id).await?;
    let key = signing_keys::of_server(db, now).await?;
    let public_url = app.config.mail.public_url.clone();
    let made = tokio::task::spawn_blocking(move || {
        let role = match model.foretold_by {
            Some(_) => SampleRole::Predicted(&model.model.0),
            None => SampleRole::Fitted,
        };
        let input = CardInput {
            observed: observed(&samples, from, role),
            vessel: CardVessel {
                id,
                name: vessel.name,
                imo_number: vessel.imo_number,
                call_sign: vessel.call_sign,
                flag: vessel.flag,
                degaussing: vessel.degaussing,
            },
            compass,
            place,
            model,
            data,
            completed,
            binnacle,
            logbook,
            alerts,
            limit_deg: settings.alerts.band95_deg,
            own_limit_deg: settings.alerts.deviation_deg,
            now,
            key,
            public_url,
        };
        make(input)
    });
    made.await?
}

/// Returns the times of the first and the last sample of a model. For a predicted model they are
/// those of the model before the adjustment.
async fn data_of(app: &App, model: &StoredModel) -> Result<(Time, Time)> {
    let from = match model.foretold_by {
        Some(order) => adjustments::predicted_from(&app.db, model.vessel_id, order).await?,
        None => None,
    };
    let behind = match from {
        Some(version) => {
            models::find_version(&app.db, model.vessel_id, model.compass_id, version).await?
        }
        None => None,
    };
    let behind = behind.as_ref().unwrap_or(model);
    Ok((behind.data_from, behind.data_until))
}

impl Query {
    /// Returns the time that the card is for. A model is not valid before its epoch.
    fn at(&self, model: &StoredModel, last_at: Time) -> Result<Time> {
        let at = time("at", self.at.as_deref())?.map(Time);
        let at = at.unwrap_or(model.place_at.max(last_at));
        if let Some(from) = model.epoch_from.filter(|from| at < *from) {
            return Err(Error::Invalid {
                field: "at",
                detail: format!("the model is valid only from {} on", from.0),
            });
        }
        Ok(at)
    }
}

fn place(position: Position, at: Time, settings: &VesselSettings) -> Result<CardPlace> {
    let source = settings.analysis.field_model;
    let earth = field(source, position, 0.0, at.0).map_err(|error| Error::Invalid {
        field: "at",
        detail: error.to_string(),
    })?;
    Ok(CardPlace {
        lat: position.lat_deg(),
        lon: position.lon_deg(),
        at,
        variation_deg: earth.declination().degrees_east(),
        variation_source: source.to_string(),
        h_nt: earth.h_nt(),
        z_nt: earth.z_nt,
    })
}

fn name(card: &Card, ending: &'static str) -> FileName {
    let version = format!("v{}", card.model.version);
    FileName::new(
        &[
            "deviation-card",
            &card.vessel.name,
            &card.compass.name,
            &version,
        ],
        ending,
    )
}
