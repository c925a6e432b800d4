//! Check of a printed card: whether it is in force, for anyone who holds it.
//!
//! Invariants: no login, and no answer to a code that the server did not sign. The answer has what
//! the card itself says and whether that still holds: no ship's position, and nothing of her
//! operator.

mod code;
mod page;

pub(super) use code::CardContent;

use super::observed::STEP_DEG;
use super::refusal::Refusal;
use super::tables::tables;
use axum::Router;
use axum::extract::{FromRef, Path, State};
use axum::http::StatusCode;
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use binnacle_compass::angle::wrap_180;
use binnacle_fleet::alerts::{self, CardEffect};
use binnacle_fleet::compasses;
use binnacle_fleet::deviation::{DeviationRow, table};
use binnacle_fleet::models::{self, StoredModel};
use binnacle_fleet::settings;
use binnacle_fleet::vessels;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::Json;
use binnacle_platform::time::Time;
use binnacle_wire::messages::CardWithdrawn;
use serde::Serialize;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Time by which later samples move the beginning of one and the same change, seconds.
const SAME_CHANGE_S: f64 = 6.0 * 3600.0;

/// Returns the route for programs.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(check_card))
}

/// Returns the route of the page.
pub fn page_router<S>() -> Router<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    Router::new().route("/check/{code}", get(check_page))
}

/// Check of a printed deviation card.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CardCheck {
    /// State of the card.
    pub state: CardState,
    /// The state in words, with its reason.
    #[schema(example = "This card is in force.")]
    pub statement: String,
    /// Time of this check.
    pub checked_at: Time,
    /// Name of the ship.
    #[schema(example = "Nao Victoria")]
    pub vessel_name: String,
    /// Her IMO number.
    #[schema(required, example = "9074729")]
    pub imo_number: Option<String>,
    /// The compass, with make and serial number where they are recorded.
    #[schema(example = "Standard compass, Cassens & Plath, no. 2047")]
    pub compass: String,
    /// Time that the card is for.
    pub at: Time,
    /// Version of the model behind the card.
    #[schema(example = 12)]
    pub model_version: i64,
    /// Lines of the card by compass heading from 0, each 15°.
    pub rows: Vec<CheckedRow>,
    /// Greatest difference between the card and the compass's latest model, at the card's place,
    /// degrees; none where no model gives deviations there.
    #[schema(required, example = 0.2)]
    pub largest_difference_deg: Option<f64>,
}

/// Line of a printed card.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct CheckedRow {
    /// Compass heading.
    #[schema(example = 15.0)]
    pub compass_deg: f64,
    /// Deviation, degrees, east positive, to a tenth.
    #[schema(example = 2.3)]
    pub deviation_deg: f64,
}

/// State of a printed card.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CardState {
    /// Nothing that is known contradicts it.
    InForce,
    /// A later card replaces it: the ship's magnetism changed, or is known better.
    Replaced,
    /// It is withdrawn, and there is no later card yet.
    Withdrawn,
    /// The compass itself is suspected.
    Suspected,
    /// No card would be printed now: the last heading is too old, the band too wide, or headings
    /// are ambiguous in the card's field.
    Unconfirmed,
}

/// Check a printed deviation card
///
/// By the code on it, without signing in. A code that this server did not sign is `not-found`.
#[utoipa::path(get, path = "/card-checks/{code}", tag = "adjusting", security(()),
    params(("code" = String, Path, description = "The code on the card")),
    responses((status = 200, body = CardCheck), (status = 404, body = Problem)))]
async fn check_card(State(app): State<App>, Path(code): Path<String>) -> Result<Json<CardCheck>> {
    Ok(Json(check(&app, &code).await?))
}

async fn check_page(State(app): State<App>, Path(code): Path<String>) -> Response {
    match check(&app, &code).await {
        Ok(found) => Html(page::of_card(&found)).into_response(),
        Err(Error::NotFound(_)) => (StatusCode::NOT_FOUND, Html(page::unknown())).into_response(),
        Err(error) => error.into_response(),
    }
}

async fn check(app: &App, code: &str) -> Result<CardCheck> {
    const NO_CARD: Error = Error::NotFound("card");
    let db = &app.db;
    let content = CardContent::read(db, code).await?.ok_or(NO_CARD)?;
    let (id, at) = (content.vessel, content.at().ok_or(NO_CARD)?);
    let operator = vessels::find_operator(db, id).await?.ok_or(NO_CARD)?;
    let vessel = vessels::must_be_in_fleet(db, operator, id).await?;
    let compass = compasses::find(db, id, Some(content.compass)).await?;
    let current = models::current(db, id, compass.id).await?;
    let withdrawn = models::card_withdrawn(db, id, compass.id).await?;
    let alerts = alerts::list_in_force(db, id, compass.id).await?;
    let latest = current
        .as_ref()
        .and_then(|model| table(&model.model.0, content.earth(), STEP_DEG).ok());
    let apart = latest.map(|rows| Apart::of(&content, &rows));
    let limit_deg = settings::find(db, id).await?.alerts.band95_deg;
    let now = app.clock.now().into();
    let is_suspected = alerts
        .iter()
        .any(|alert| alert.cause.effect_on_card() == CardEffect::Block);
    let (state, statement) = match (current, apart) {
        _ if is_suspected => suspected(),
        (None, _) => unsupported(withdrawn),
        (Some(model), apart) => replaced(&content, &model, apart).unwrap_or_else(|| {
            let refusal = tables(&model, content.earth(), limit_deg, now).err();
            refusal.map_or_else(|| in_force(apart), |refusal| unconfirmed(&model, &refusal))
        }),
    };
    let described = [
        Some(compass.name),
        compass.make,
        compass.serial_number.map(|serial| format!("no. {serial}")),
    ];
    Ok(CardCheck {
        state,
        statement,
        checked_at: now,
        vessel_name: vessel.name,
        imo_number: vessel.imo_number,
        compass: described
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(", "),
        at,
        model_version: content.version,
        rows: rows(&content).collect(),
        largest_difference_deg: apart.map(|apart| apart.largest_deg),
    })
}

fn rows(content: &CardContent) -> impl Iterator<Item = CheckedRow> {
    let tenths = content.deviation_tenths.iter().enumerate();
    tenths.map(|(index, tenths)| CheckedRow {
        compass_deg: STEP_DEG * index as f64,
        deviation_deg: f64::from(*tenths) / 10.0,
    })
}

/// Difference between a card and the latest model.
#[derive(Clone, Copy)]
struct Apart {
    largest_deg: f64,
    /// True where it is outside the latest model's 95 % band on some heading, by more than the digits
    /// of the card.
    is_outside: bool,
}

impl Apart {
    fn of(content: &CardContent, latest: &[DeviationRow]) -> Apart {
        let mut apart = Apart {
            largest_deg: 0.0,
            is_outside: false,
        };
        for (card, latest) in rows(content).zip(latest) {
            let off_deg = wrap_180(card.deviation_deg - latest.deviation_deg).abs();
            apart.largest_deg = apart.largest_deg.max(off_deg);
            let band_deg = latest.band95_deg.unwrap_or(f64::INFINITY);
            apart.is_outside |= off_deg > band_deg + 0.05;
        }
        apart
    }

    fn words(self) -> String {
        format!(
            " The latest observations differ from it by up to {:.1}°.",
            self.largest_deg
        )
    }
}

fn suspected() -> (CardState, String) {
    let says = "The compass is suspected: an alert on it is open. Do not rely on this card.";
    (CardState::Suspected, says.to_owned())
}

/// Returns the state of a card whose compass has no model now.
fn unsupported(withdrawn: Option<CardWithdrawn>) -> (CardState, String) {
    let why = withdrawn.map_or(String::new(), |change| {
        let since = Time(change.since).day();
        format!(" on {since} ({})", change.reason.replace('_', " "))
    });
    let says = format!("This card was withdrawn{why}, and there is no newer one yet.");
    (CardState::Withdrawn, says)
}

/// Returns the state of a card that a later one replaces.
fn replaced(
    content: &CardContent,
    latest: &StoredModel,
    apart: Option<Apart>,
) -> Option<(CardState, String)> {
    let change = latest.replaces().filter(|change| {
        let known = content.epoch_from();
        known.is_none_or(|known| change.since.seconds_since(known.0) > SAME_CHANGE_S)
    });
    if let Some(change) = change {
        let since = Time(change.since).day();
        let reason = change.reason.replace('_', " ");
        let says = format!(
            "This card is no longer valid: the ship’s magnetism changed on {since} ({reason}), \
             and a newer card replaces it."
        );
        return Some((CardState::Replaced, says));
    }
    let apart = apart.filter(|apart| apart.is_outside)?;
    let says = format!(
        "This card is out of date. Print a new one.{}",
        apart.words()
    );
    Some((CardState::Replaced, says))
}

/// Returns the state of a card in whose place the service would print none now.
fn unconfirmed(latest: &StoredModel, refusal: &Refusal) -> (CardState, String) {
    let why = match refusal {
        Refusal::TooOld { days, .. } => format!("that was {days:.0} days ago"),
        Refusal::BandTooWide { band95_deg, .. } => {
            format!("the deviation is now known only to ±{band95_deg:.1}° on some heading")
        }
        Refusal::NoHeadings(_) => {
            "by the latest observations the compass gives no sure heading where the card is for"
                .to_owned()
        }
        Refusal::CompassSuspected { .. } => "an alert on the compass is open".to_owned(),
    };
    let until = latest.data_until.day();
    let says = format!(
        "This card cannot be confirmed. The last heading known of this compass is from {until}; \
         {why}."
    );
    (CardState::Unconfirmed, says)
}

fn in_force(apart: Option<Apart>) -> (CardState, String) {
    let largest = apart.map_or(String::new(), Apart::words);
    (
        CardState::InForce,
        format!("This card is in force.{largest}"),
    )
}
