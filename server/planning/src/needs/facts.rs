//! Facts about a compass that the adjustment rules use, assembled from stored data.

use super::order::OpenOrder;
use super::over_limit_since::DeviationHistory;
use super::prediction::PredictedDeviation;
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

/// Step of the headings at which the greatest deviation is searched, degrees.
const STEP_DEG: f64 = 10.0;

/// Facts about a compass that decide its need.
#[derive(Clone, Debug)]
pub struct Facts {
    /// The vessel.
    pub vessel_id: VesselId,
    /// Name of the vessel.
    pub vessel_name: String,
    /// The compass.
    pub compass_id: CompassId,
    /// Name of the compass.
    pub compass_name: String,
    /// The vessel as rules see it.
    pub ship: Ship,
    /// Licence that the adjuster must hold.
    pub licence: Option<String>,
    /// The compass as rules see it.
    pub compass: Compass,
    /// Greatest deviation at each place and day to come.
    pub predicted: Vec<PredictedDeviation>,
    /// Work order of the compass that is not over.
    pub order: Option<OpenOrder>,
    /// History of the deviation at the vessel's position, where it differs from the stored one.
    pub(super) changed_history: Option<DeviationHistory>,
}

/// A logbook entry of work on a compass or on the ship.
#[derive(Clone, Debug)]
pub(super) struct Work {
    pub(super) compass_id: Option<CompassId>,
    pub(super) kind: LogbookKind,
    pub(super) from: Time,
    pub(super) to: Option<Time>,
}

/// Last completed adjustment by a work order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Completed {
    pub(super) at: Time,
    /// True while verification by headings at sea is open.
    pub(super) awaits_verification: bool,
}

/// Port and time of an upcoming call.
#[derive(Clone, Debug)]
pub(super) struct UpcomingCall {
    pub(super) port: PortCode,
    pub(super) at: Time,
}

/// Stored data of a compass.
pub(super) struct Stored<'a> {
    pub(super) work: Vec<&'a Work>,
    pub(super) completed: Option<Completed>,
    /// Last heading at sea that contradicts the last completed order, and the largest error,
    /// degrees.
    pub(super) failed: Option<(Time, f64)>,
    pub(super) model: Option<&'a StoredModel>,
    pub(super) findings: Option<&'a Findings>,
    pub(super) limits: AlertLimits,
    pub(super) calls: &'a [UpcomingCall],
    pub(super) history: &'a DeviationHistory,
}

/// Name of the vessel's current position.
const HERE: &str = "here";
const PANAMA_CANAL: &str = "Panama Canal";

impl Facts {
    /// Returns the vessel's particulars that are unknown.
    pub(super) fn unknown_particulars(&self) -> Vec<&'static str> {
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

/// Returns the compass as rules see it, its predicted deviations, and the history of its
/// deviation at the vessel's position.
pub(super) fn assess_compass(
    stored: &Stored<'_>,
    particulars: &Particulars,
    now: Time,
) -> (Compass, Vec<PredictedDeviation>, DeviationHistory) {
    let predicted = predict_deviations(stored, particulars, now);
    let here = predicted.iter().find(|one| one.place == HERE);
    let history = here.map(|here| {
        let worst_deg = here.worst_deviation_deg;
        stored.history.with_observation(here.on, worst_deg)
    });
    let past = history.iter().flat_map(DeviationHistory::levels);
    let past = past.filter(|(on, _)| *on < day(now));
    let past = past.map(|(on, worst_deviation_deg)| Predicted {
        on,
        place: None,
        worst_deviation_deg,
        // The history has sizes alone.
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
    // Planned work is no event yet.
    let started = stored.work.iter().filter(|work| work.from <= now);
    let events = started.filter_map(|work| {
        let at = work.to.unwrap_or(work.from);
        Some(Event {
            kind: rule_event(work.kind)?,
            on: day(at),
            at: Some(Instant(at.0)),
        })
    });
    // By instants: the compass may be adjusted again on the day of the verdict.
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
        predicted: past.chain(predicted.iter().map(for_rules)).collect(),
        deviation_limit_deg: Limit::try_from(stored.limits.deviation_deg).ok(),
        change: stored
            .findings
            .and_then(|findings| largest_lasting_change(findings, adjusted)),
        failed_verification: failed,
        awaits_verification: stored.completed.is_some_and(|completed| {
            completed.awaits_verification && adjusted == Some(completed.at)
        }),
    };
    let history = history.unwrap_or_else(|| stored.history.clone());
    (compass, predicted, history)
}

fn for_rules(predicted: &PredictedDeviation) -> Predicted {
    let place = match predicted.place.as_str() {
        HERE => "the vessel's position",
        PANAMA_CANAL => "the Panama Canal",
        port => port,
    };
    Predicted {
        on: predicted.on,
        place: Some(place.to_owned()),
        worst_deviation_deg: predicted.worst_deviation_deg,
        side: Some(predicted.side),
    }
}

/// Returns the rule event that a logbook entry stands for, if any.
fn rule_event(kind: LogbookKind) -> Option<EventKind> {
    match kind {
        LogbookKind::CompassMoved => Some(EventKind::Installation),
        LogbookKind::DryDocking => Some(EventKind::DryDocking),
        LogbookKind::Repair | LogbookKind::Welding => Some(EventKind::StructuralChange),
        _ => None,
    }
}

/// Returns the largest lasting change since the last adjustment. A cargo's change ends with it,
/// and work in the logbook is an event of its own.
fn largest_lasting_change(findings: &Findings, adjusted: Option<Time>) -> Option<Change> {
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

/// Predicts the greatest deviation at the vessel's position, port calls and transits. Places where
/// the model's band is too wide are left out; without a model there is none.
fn predict_deviations(
    stored: &Stored<'_>,
    particulars: &Particulars,
    now: Time,
) -> Vec<PredictedDeviation> {
    let Some(model) = stored.model else {
        return Vec::new();
    };
    let mut predicted = Vec::new();
    let here = EarthField {
        h_nt: model.h_nt,
        z_nt: model.z_nt,
    };
    let mut add = |on, place: &str, earth| {
        let worst = table(&model.model.0, earth, STEP_DEG)
            .ok()
            .and_then(|rows| worst_of(&rows));
        let certain = worst.filter(|worst| {
            worst
                .band95_deg
                .is_some_and(|band| band <= stored.limits.band95_deg)
        });
        predicted.extend(certain.map(|worst| PredictedDeviation {
            on,
            place: place.to_owned(),
            worst_deviation_deg: worst.deviation_deg.abs(),
            side: Side::from_deviation(worst.deviation_deg),
        }));
    };
    add(day(now), HERE, here);
    for call in stored.calls {
        let Some(port) = ports::find(call.port) else {
            continue;
        };
        if let Some(earth) = earth_field(port.position, call.at.0) {
            add(day(call.at), port.name, earth);
        }
    }
    for transit in &particulars.transits {
        let (lat, lon) = place_of(transit.canal);
        let position = Position::new(lat, lon).ok();
        let noon = transit.on.and_hms_opt(12, 0, 0).map(|noon| noon.and_utc());
        let noon = noon.and_then(|noon| Timestamp::from_micros(noon.timestamp_micros()).ok());
        if transit.on >= day(now)
            && let Some(earth) = position
                .zip(noon)
                .and_then(|(place, at)| earth_field(place, at))
        {
            add(transit.on, PANAMA_CANAL, earth);
        }
    }
    predicted
}

fn earth_field(position: Position, at: Timestamp) -> Option<EarthField> {
    let found = field(FieldModel::Wmm2025, position, 0.0, at)
        .or_else(|_| field(FieldModel::Igrf14, position, 0.0, at));
    found.ok().map(|field| field.for_ship())
}

fn day(at: Time) -> NaiveDate {
    at.0.to_chrono().date_naive()
}
