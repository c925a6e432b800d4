//! Particulars of a vessel: facts that the rules on adjusting use.
//!
//! Invariant: an unknown fact counts as if it bound the vessel. So no fact is required, and each
//! known fact can only give more time.

use crate::vessels;
use axum::extract::{FromRef, State};
use binnacle_platform::access::{Reader, Writer};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{DomainEvent, Tx, execute, row};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, IfMatch, Valid, Version, Versioned, optional_text};
use binnacle_platform::ids::{OperatorId, VesselId};
use binnacle_platform::session;
use binnacle_platform::time::Time;
use binnacle_schedule::needs::{Ship, Transit};
use binnacle_schedule::rules::{Canal, DeviationRecord, Flag, Trade};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Largest number of planned transits.
const MOST_TRANSITS: usize = 50;
const MOST_TONNAGE: u32 = 1_000_000;

/// Announces that the facts which rules use are about to change.
pub struct ParticularsChanged {
    /// Operator of the vessel.
    pub operator: OperatorId,
    /// Time of the change.
    pub at: Time,
}

impl DomainEvent for ParticularsChanged {}

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_particulars, set_particulars))
}

/// Facts about a vessel that rules on adjusting use.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
#[schema(as = VesselParticulars, example = json!({
    "flag_state": "PA", "gross_tonnage": 24000, "trade": "bulk", "deviation_record": "kept",
    "licence": null, "transits": [{ "canal": "panama", "on": "2027-02-10" }]
}))]
pub struct Particulars {
    /// Its flag, ISO 3166; by default that of the vessel's own `flag`.
    #[schema(value_type = Option<String>, required, pattern = "^[A-Z]{2}$")]
    pub flag_state: Option<Flag>,
    /// Its gross tonnage.
    #[schema(required, maximum = 1_000_000)]
    pub gross_tonnage: Option<u32>,
    /// Its trade.
    #[schema(required)]
    pub trade: Option<Trade>,
    /// True if the compass deviation book is kept.
    #[schema(required)]
    pub deviation_record: Option<DeviationRecord>,
    /// A licence that an adjuster must hold.
    #[schema(required, max_length = 200)]
    pub licence: Option<String>,
    /// Transits of canals with a rule of their own that are planned.
    pub transits: Vec<Transit>,
}

/// See a vessel's particulars for the rules on adjusting
#[utoipa::path(get, path = "/vessels/{id}/particulars", tag = "adjusting",
    params(("id" = VesselId, Path)),
    responses((status = 200, body = Particulars, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn find_particulars(
    State(app): State<App>,
    reader: Reader,
    Id(vessel): Id<VesselId>,
) -> Result<Versioned<Particulars>> {
    vessels::must_be_in_fleet(&app.db, reader.operator, vessel).await?;
    let stored = row!(&app.db, (String,), FIND, vessel)?;
    versioned(particulars_of(stored.map(|(text,)| text))?)
}

/// Set a vessel's particulars for the rules on adjusting
///
/// A fact that is left out or null is unknown, and binds the vessel: to adjust too early costs a
/// fee, to adjust too late a detention.
#[utoipa::path(put, path = "/vessels/{id}/particulars", tag = "adjusting",
    params(("id" = VesselId, Path), IfMatch), request_body = Particulars,
    responses((status = 200, body = Particulars, headers(("ETag" = String, description = "Version of what can be edited"))), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 422, body = Problem)))]
async fn set_particulars(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    Id(vessel): Id<VesselId>,
    if_match: IfMatch,
    Valid(particulars): Valid<Particulars>,
) -> Result<Versioned<Particulars>> {
    vessels::must_be_in_fleet(&app.db, writer.operator, vessel).await?;
    let particulars = particulars.checked()?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    vessels::lock(&mut tx, writer.operator, vessel).await?;
    let stored = row!(in &mut tx, (String,), FIND, vessel)?;
    let stored = particulars_of(stored.map(|(text,)| text))?;
    if_match.check(&Version::of(&stored)?)?;
    let name = session::name_of(&mut tx, writer.user).await?;
    put(&mut tx, vessel, &particulars, &name, now).await?;
    tx.publish(&ParticularsChanged {
        operator: writer.operator,
        at: now,
    })
    .await?;
    tx.commit().await?;
    versioned(particulars)
}

fn versioned(particulars: Particulars) -> Result<Versioned<Particulars>> {
    let version = Version::of(&particulars)?;
    Ok(Versioned(particulars, version))
}

const FIND: &str =
    "SELECT particulars FROM vessel_particulars WHERE vessel_id = $1 ORDER BY vessel_id";

fn particulars_of(stored: Option<String>) -> Result<Particulars> {
    Ok(stored.map_or_else(
        || Ok(Particulars::default()),
        |text| serde_json::from_str(&text),
    )?)
}

/// Returns a vessel's flag, and the adjuster's licence that its operator requires.
///
/// # Errors
/// Fails when the database fails.
pub async fn adjuster_requirements(
    tx: &mut Tx,
    vessel: VesselId,
) -> Result<(Option<Flag>, Option<String>)> {
    let found = row!(
        in tx,
        (Option<String>, Option<String>),
        "SELECT v.flag, p.particulars FROM vessels v
         LEFT JOIN vessel_particulars p ON p.vessel_id = v.id
         WHERE v.id = $1 ORDER BY v.id",
        vessel
    )?;
    let (flag, particulars) = found.unwrap_or_default();
    let said: Particulars = match particulars {
        Some(text) => serde_json::from_str(&text)?,
        None => Particulars::default(),
    };
    Ok((said.ship(flag.as_deref()).flag, said.licence))
}

async fn put(
    tx: &mut Tx,
    vessel: VesselId,
    particulars: &Particulars,
    by: &str,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO vessel_particulars (vessel_id, particulars, changed_at, changed_by)
         VALUES ($1, $2, $3, $4)
         ON CONFLICT (vessel_id) DO UPDATE
         SET particulars = excluded.particulars, changed_at = excluded.changed_at,
             changed_by = excluded.changed_by",
        vessel,
        serde_json::to_string(particulars)?,
        now,
        by
    )?;
    Ok(())
}

impl Particulars {
    fn checked(self) -> Result<Particulars> {
        let invalid = |field, detail: String| Err(Error::Invalid { field, detail });
        if self
            .gross_tonnage
            .is_some_and(|tonnage| tonnage == 0 || tonnage > MOST_TONNAGE)
        {
            return invalid("gross_tonnage", format!("is outside 1 to {MOST_TONNAGE}"));
        }
        if self.transits.len() > MOST_TRANSITS {
            return invalid("transits", format!("are more than {MOST_TRANSITS}"));
        }
        Ok(Particulars {
            licence: optional_text("licence", self.licence.as_deref())?,
            ..self
        })
    }

    /// Returns the ship as rules see it; `flag` is what is recorded of the vessel itself.
    pub fn ship(&self, flag: Option<&str>) -> Ship {
        Ship {
            flag: self.flag_state.or_else(|| flag.and_then(flag_of)),
            gross_tonnage: self.gross_tonnage,
            trade: self.trade,
            deviation_record: self.deviation_record,
            transits: self.transits.clone(),
        }
    }
}

/// Returns the middle of a canal, degrees north and east. Its field stands for the whole canal.
pub fn place_of(canal: Canal) -> (f64, f64) {
    match canal {
        Canal::Panama => (9.1, -79.7),
    }
}

/// Parses a flag as people write it: two letters, or the name of one of the great registers.
fn flag_of(text: &str) -> Option<Flag> {
    const NAMES: [(&str, &str); 16] = [
        ("panama", "PA"),
        ("liberia", "LR"),
        ("marshall islands", "MH"),
        ("hong kong", "HK"),
        ("singapore", "SG"),
        ("malta", "MT"),
        ("bahamas", "BS"),
        ("china", "CN"),
        ("greece", "GR"),
        ("japan", "JP"),
        ("cyprus", "CY"),
        ("norway", "NO"),
        ("united kingdom", "GB"),
        ("australia", "AU"),
        ("spain", "ES"),
        ("portugal", "PT"),
    ];
    let lower = text.trim().to_lowercase();
    let code = NAMES.iter().find(|(name, _)| *name == lower);
    let code = code.map_or_else(|| text.trim().to_owned(), |(_, code)| (*code).to_owned());
    Flag::try_from(code).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flag_is_known_by_its_letters_or_by_a_great_registers_name() {
        let letters = |text| flag_of(text).map(|flag| flag.letters().to_owned());
        assert_eq!(letters(" Panama ").as_deref(), Some("PA"));
        assert_eq!(letters("NO").as_deref(), Some("NO"));
        assert_eq!(letters("Ruritania"), None);
    }
}
