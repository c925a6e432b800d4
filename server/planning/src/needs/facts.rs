//! Facts about a compass that the adjustment rules use, assembled from stored data.

use super::over_limit_since::Since;
use super::prediction::Ahead;
use binnacle_compass::field::{FieldModel, field};
use binnacle_compass::logbook::LogbookKind;
use binnacle_compass::position::Position;
use binnacle_compass::result::Cause;
use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use binnacle_fleet::analysis::Findings;
use binnacle_fleet::deviation::{table, worst_of};
use binnacle_fleet::models::StoredModel;
use binnacle_fleet::particulars::{Particulars, place_of};
use binnacle_fleet::settings::AlertLimits;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::needs::{Change, Compass, Event, FailedVerification, Predicted, Ship, Side};
use binnacle_schedule::ports::{self, PortCode};
use binnacle_schedule::rules::{EventKind, Limit};
use binnacle_schedule::time::Instant;
use chrono::NaiveDate;

/// Degrees of heading between those on which the greatest deviation is looked for.
const STEP_DEG: f64 = 10.0;

/// Facts about a compass.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Her name.
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// Its name.
    pub compass_name: String,
    /// The ship as rules see her.
    pub ship: Ship,
    /// A licence that an adjuster must hold.
    pub licence: Option<String>,
    /// The compass as rules see it.
    pub compass: Compass,
    /// The greatest deviation at the places and on the days ahead.
    pub ahead: Vec<Ahead>,
    /// Updated history of deviation at the vessel's position, where it differs from the stored
    /// one.
    pub(super) since: Option<Since>,
}

/// A logbook entry of work on a compass or on the ship.
#[derive(Clone, Debug)]
pub(super) struct Work {
    pub(super) compass_id: Option<CompassId>,
    pub(super) kind: LogbookKind,
    pub(super) from: Time,
    pub(super) to: Option<Time>,
}

/// The last adjustment that an order brought about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Completed {
    pub(super) at: Time,
    /// Whether verification by headings at sea is still open.
    pub(super) awaits_verification: bool,
}

/// A place and a time ahead.
#[derive(Clone, Debug)]
pub(super) struct Waypoint {
    pub(super) port: PortCode,
    pub(super) at: Time,
}

/// Stored data of a compass.
pub(super) struct Stored<'a> {
    pub(super) work: Vec<&'a Work>,
    pub(super) completed: Option<Completed>,
    /// Until when headings at sea were looked at that spoke against the last completed order,
    /// and by how much the worst of them was off, degrees.
    pub(super) failed: Option<(Time, f64)>,
    pub(super) model: Option<&'a StoredModel>,
    pub(super) findings: Option<&'a Findings>,
    pub(super) limits: AlertLimits,
    pub(super) calls: &'a [Waypoint],
    pub(super) since: &'a Since,
}

/// Name of the vessel's current position.
const HERE: &str = "here";
const PANAMA_CANAL: &str = "Panama Canal";

impl Facts {
    /// Returns the vessel's particulars that are unknown.
    pub(super) fn not_known(&self) -> Vec<&'static str> {
        let fields = [
            ("flag_state", self.ship.flag.is_none()),
            ("gross_tonnage", self.ship.gross_tonnage.is_none()),
            ("trade", self.ship.trade.is_none()),
            ("deviation_record", self.ship.deviation_record.is_none()),
        ];
        let missing = fields.into_iter().filter(|(_, missing)| *missing);
        missing.map(|(field, _)| field).collect()
    }
}

/// The compass as rules see it, the deviation ahead of it, and since when it has been as
/// great as it is.
pub(super) fn compass(
    stored: &Stored<'_>,
    particulars: &Particulars,
    now: Time,
) -> (Compass, Vec<Ahead>, Since) {
    let ahead = ahead(stored, particulars, now);
    let here = ahead.iter().find(|ahead| ahead.place == HERE);
    let seen = here.map(|here| stored.since.seen(here.on, here.worst_deviation_deg));
    let has_been = seen.iter().flat_map(Since::levels);
    let has_been = has_been.filter(|(on, _)| *on < day(now));
    let has_been = has_been.map(|(on, worst_deviation_deg)| Predicted {
        on,
        place: None,
        worst_deviation_deg,
        // It has been as great as that, on whichever side.
        side: None,
    });
    let adjusted = stored
        .work
        .iter()
        .filter(|work| work.kind == LogbookKind::Adjustment)
        .map(|work| work.from)
        .chain(stored.completed.map(|completed| completed.at))
        .filter(|at| *at <= now)
        .max();
    // What is planned has not happened.
    let begun = stored.work.iter().filter(|work| work.from <= now);
    let events = begun.filter_map(|work| {
        let at = work.to.unwrap_or(work.from);
        Some(Event {
            kind: event(work.kind)?,
            on: day(at),
            at: Some(Instant(at.0)),
        })
    });
    // By instants: she may be adjusted anew on the day of the verdict.
    let failed = stored
        .failed
        .filter(|(until, _)| adjusted.is_none_or(|adjusted| *until >= adjusted))
        .map(|(at, worst_error_deg)| FailedVerification {
            on: day(at),
            worst_error_deg,
        });
    let compass = Compass {
        adjusted_on: adjusted.map(day),
        adjusted_at: adjusted.map(|at| Instant(at.0)),
        events: events.collect(),
        predicted: has_been.chain(ahead.iter().map(predicted)).collect(),
        deviation_limit_deg: Limit::try_from(stored.limits.deviation_deg).ok(),
        change: stored
            .findings
            .and_then(|findings| change(findings, adjusted)),
        failed_verification: failed,
        awaits_verification: stored.completed.is_some_and(|completed| {
            completed.awaits_verification && adjusted == Some(completed.at)
        }),
    };
    let since = seen.unwrap_or_else(|| stored.since.clone());
    (compass, ahead, since)
}

fn predicted(ahead: &Ahead) -> Predicted {
    let place = match ahead.place.as_str() {
        HERE => "her position",
        PANAMA_CANAL => "the Panama Canal",
        port => port,
    };
    Predicted {
        on: ahead.on,
        place: Some(place.to_owned()),
        worst_deviation_deg: ahead.worst_deviation_deg,
        side: Some(ahead.side),
    }
}

/// Returns the rule event that a logbook entry stands for, if any.
fn event(kind: LogbookKind) -> Option<EventKind> {
    match kind {
        LogbookKind::CompassMoved => Some(EventKind::Installation),
        LogbookKind::DryDocking => Some(EventKind::DryDocking),
        LogbookKind::Repair | LogbookKind::Welding => Some(EventKind::StructuralChange),
        _ => None,
    }
}

/// The largest change since the last adjustment that lasts. What a cargo brings it takes
/// away again, and work that was told of is an event.
fn change(findings: &Findings, adjusted: Option<Time>) -> Option<Change> {
    let lasting = findings.changes.iter().filter(|found| {
        let change = &found.change;
        let cause = change.cause;
        change.confirmed
            && change.ended.is_none()
            && cause.changes_deviation()
            && !matches!(cause, Cause::MagneticCargo | Cause::AdjustmentOrRepair)
            && !found.expected
            && adjusted.is_none_or(|adjusted| change.from > adjusted.0)
    });
    let sized = lasting.filter_map(|found| {
        Some(Change {
            on: day(found.change.from.into()),
            size_deg: found.size_deg?,
        })
    });
    sized.max_by(|one, other| one.size_deg.abs().total_cmp(&other.size_deg.abs()))
}

/// The greatest deviation where the ship is, at her calls and at her transits; what the
/// model knows only roughly is left out, and so is everything without a model.
fn ahead(stored: &Stored<'_>, particulars: &Particulars, now: Time) -> Vec<Ahead> {
    let Some(model) = stored.model else {
        return Vec::new();
    };
    let mut ahead = Vec::new();
    let here = EarthField {
        h_nt: model.h_nt,
        z_nt: model.z_nt,
    };
    let mut add = |on, place: &str, earth| {
        let worst = table(&model.model.0, earth, STEP_DEG)
            .ok()
            .and_then(|rows| worst_of(&rows));
        let sure = worst.filter(|worst| {
            worst
                .band95_deg
                .is_some_and(|band| band <= stored.limits.band95_deg)
        });
        ahead.extend(sure.map(|worst| Ahead {
            on,
            place: place.to_owned(),
            worst_deviation_deg: worst.deviation_deg.abs(),
            side: Side::of(worst.deviation_deg),
        }));
    };
    add(day(now), HERE, here);
    for call in stored.calls {
        let Some(port) = ports::find(call.port) else {
            continue;
        };
        if let Some(earth) = earth(port.position, call.at.0) {
            add(day(call.at), port.name, earth);
        }
    }
    for transit in &particulars.transits {
        let (lat, lon) = place_of(transit.canal);
        let position = Position::new(lat, lon).ok();
        let noon = transit.on.and_hms_opt(12, 0, 0).map(|noon| noon.and_utc());
        let noon = noon.and_then(|noon| Timestamp::from_micros(noon.timestamp_micros()).ok());
        if transit.on >= day(now)
            && let Some(earth) = position.zip(noon).and_then(|(place, at)| earth(place, at))
        {
            add(transit.on, PANAMA_CANAL, earth);
        }
    }
    ahead
}

fn earth(position: Position, at: Timestamp) -> Option<EarthField> {
    let found = field(FieldModel::Wmm2025, position, 0.0, at)
        .or_else(|_| field(FieldModel::Igrf14, position, 0.0, at));
    found.ok().map(|field| field.for_ship())
}

fn day(at: Time) -> NaiveDate {
    at.0.to_chrono().date_naive()
}
