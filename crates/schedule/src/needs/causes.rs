//! The causes of due dates.

use super::facts::{Compass, Event, Predicted, Ship, Side, Terms};
use crate::rules::{Applies, DeviationRecord, Limit, Requirement, Rule};
use chrono::{Days, NaiveDate};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// Kind of cause of a due date.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "openapi", schema(as = NeedCauseKind))]
#[serde(rename_all = "snake_case")]
pub enum CauseKind {
    /// No adjustment is on record.
    NeverAdjusted,
    /// A rule's interval ends.
    Interval,
    /// A rule asks for an adjustment after an event.
    Event,
    /// Predicted deviation exceeds a rule's limit, or the vessel's own.
    OverLimit,
    /// A transit requires a newer table or a smaller deviation.
    Transit,
    /// The ship's magnetism changed.
    Change,
    /// The last adjustment failed its verification at sea.
    FailedVerification,
}

/// One cause, with its own due date.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Cause {
    /// Kind of cause.
    pub kind: CauseKind,
    /// Its own due date.
    pub due: NaiveDate,
    /// Reason as text.
    pub reason: String,
    /// Id of the rule, if it is one.
    pub rule: Option<String>,
}

/// Prefix of an interval that begins with an unverified adjustment.
const NOT_VERIFIED: &str = "adjusted, not yet verified at sea: ";

/// Finds all causes, those of rules in the rules' order.
pub(super) fn find_causes(
    ship: &Ship,
    compass: &Compass,
    rules: &[Rule],
    terms: &Terms,
    today: NaiveDate,
) -> Vec<Cause> {
    let mut causes = Vec::new();
    causes.extend(find_failed_verification(compass, terms));
    causes.extend(find_change(compass, terms));
    for rule in rules.iter().filter(|rule| binds(&rule.applies, ship)) {
        let found = match &rule.requires {
            Requirement::Transit {
                table_within_months,
                below_deg,
            } => {
                let begins = rule.effective_from.unwrap_or(NaiveDate::MIN);
                let transits = ship.transits.iter().filter(|transit| {
                    Some(transit.canal) == rule.applies.canal && transit.on >= begins.max(today)
                });
                transits
                    .filter_map(|transit| {
                        find_at_transit(compass, transit.on, *below_deg, |adjusted| {
                            table_within_months.after(adjusted) < transit.on
                        })
                    })
                    .min_by_key(|found| found.1)
            }
            _ if rule.effective_from.is_some_and(|from| from > today) => None,
            Requirement::Interval { months } => Some(match compass.adjusted_on {
                Some(day) => (
                    CauseKind::Interval,
                    months.after(day),
                    format!(
                        "{}{} months after the adjustment of {day}",
                        if compass.awaits_verification {
                            NOT_VERIFIED
                        } else {
                            ""
                        },
                        months.get()
                    ),
                ),
                // The interval may end on any day: one to arrange an adjustment by.
                None => (
                    CauseKind::NeverAdjusted,
                    add_days(today, terms.soon_days),
                    "no adjustment is on record".to_owned(),
                ),
            }),
            Requirement::AfterEvent { events } => events_since_adjustment(compass)
                .filter(|event| events.contains(&event.kind))
                .map(|event| {
                    let due = add_days(event.on, terms.after_event_days);
                    (
                        CauseKind::Event,
                        due,
                        format!("not adjusted since {} of {}", event.kind, event.on),
                    )
                })
                .min_by_key(|found| found.1),
            Requirement::Deviation { adjust_above_deg } => {
                let limit = *adjust_above_deg;
                let words = format!("where more than {}° must be adjusted", limit.degrees());
                find_over_limit(compass, limit, &words, terms, today)
            }
        };
        causes.extend(found.map(|(kind, due, words)| Cause {
            kind,
            due,
            reason: format!("{words} ({})", rule.citation),
            rule: Some(rule.id.clone()),
        }));
    }
    causes.extend(find_over_own_limit(ship, compass, rules, terms, today));
    causes
}

/// Returns the cause of exceeding the operator's own limit, where no applicable rule
/// sets as strict a one.
fn find_over_own_limit(
    ship: &Ship,
    compass: &Compass,
    rules: &[Rule],
    terms: &Terms,
    today: NaiveDate,
) -> Option<Cause> {
    let own = compass.deviation_limit_deg?;
    let is_ruled = rules.iter().any(|rule| {
        let Requirement::Deviation { adjust_above_deg } = &rule.requires else {
            return false;
        };
        let holds = rule.effective_from.is_none_or(|from| from <= today);
        holds && *adjust_above_deg <= own && binds(&rule.applies, ship)
    });
    if is_ruled {
        return None;
    }
    let words = format!("over the vessel's own limit of {}°", own.degrees());
    let (kind, due, reason) = find_over_limit(compass, own, &words, terms, today)?;
    Some(Cause {
        kind,
        due,
        reason,
        rule: None,
    })
}

/// Returns true if a rule applies to a ship. An unknown fact is taken to match the
/// rule: an early adjustment costs a fee, a late one a detention.
fn binds(applies: &Applies, ship: &Ship) -> bool {
    let kept = ship.deviation_record.unwrap_or(DeviationRecord::NotKept);
    (applies.flags.is_empty() || ship.flag.is_none_or(|flag| applies.flags.contains(&flag)))
        && (applies.trades.is_empty()
            || ship
                .trade
                .is_none_or(|trade| applies.trades.contains(&trade)))
        && applies
            .min_gross_tonnage
            .is_none_or(|least| ship.gross_tonnage.is_none_or(|tonnage| tonnage >= least))
        && applies.deviation_record.is_none_or(|asked| asked == kept)
        && applies
            .canal
            .is_none_or(|canal| ship.transits.iter().any(|transit| transit.canal == canal))
}

/// Cause of a rule: its kind, due date and reason.
type DatedReason = (CauseKind, NaiveDate, String);

/// Returns the events since the last adjustment. Instants decide where both are known,
/// otherwise days: an adjustment settles an event of the same day.
fn events_since_adjustment(compass: &Compass) -> impl Iterator<Item = &Event> {
    let day = compass.adjusted_on.unwrap_or(NaiveDate::MIN);
    let is_since = move |event: &&Event| match (event.at, compass.adjusted_at) {
        (Some(event), Some(adjusted)) => event > adjusted,
        _ => event.on > day,
    };
    compass.events.iter().filter(is_since)
}

/// Returns the cause of exceeding a limit, due from the first day on which the
/// prediction exceeds it or the deviation has exceeded it since. The last
/// adjustment is the earliest such day.
fn find_over_limit(
    compass: &Compass,
    limit: Limit,
    words: &str,
    terms: &Terms,
    today: NaiveDate,
) -> Option<DatedReason> {
    let limit_deg = limit.degrees();
    let exceeding = || {
        let all = compass.predicted.iter();
        all.filter(|predicted| predicted.worst_deviation_deg > limit_deg)
    };
    let first = exceeding().min_by_key(|predicted| predicted.on)?;
    let since = first.on.max(compass.adjusted_on.unwrap_or(first.on));
    let first_deg = first.worst_deviation_deg;
    let how_much = match first.on.cmp(&today) {
        Ordering::Greater => {
            let (on, at) = (first.on, describe_place(first));
            format!("{} predicted for {on}{at}", describe_deviation(first))
        }
        Ordering::Equal => format!(
            "{}{} on {today}",
            describe_deviation(first),
            describe_place(first)
        ),
        Ordering::Less => match exceeding().find(|predicted| predicted.on == today) {
            Some(now) => format!(
                "{}{}, {first_deg:.1}° or more since {since}",
                describe_deviation(now),
                describe_place(now)
            ),
            None => format!("{first_deg:.1}° of deviation or more since {since}"),
        },
    };
    Some((
        CauseKind::OverLimit,
        add_days(since, terms.over_limit_days),
        format!("{how_much}, {words}"),
    ))
}

fn describe_deviation(predicted: &Predicted) -> String {
    let side = match predicted.side {
        Some(Side::East) => " E",
        Some(Side::West) => " W",
        None => "",
    };
    format!("{:.1}°{side} of deviation", predicted.worst_deviation_deg)
}

fn describe_place(predicted: &Predicted) -> String {
    let place = predicted.place.as_ref();
    place.map_or_else(String::new, |place| format!(" at {place}"))
}

fn find_at_transit(
    compass: &Compass,
    on: NaiveDate,
    below: Limit,
    too_old: impl Fn(NaiveDate) -> bool,
) -> Option<DatedReason> {
    let found = |words| Some((CauseKind::Transit, on, words));
    match compass.adjusted_on {
        None => {
            return found(format!(
                "the transit of {on} requires a deviation table, and none is on record"
            ));
        }
        Some(day) if too_old(day) => {
            return found(format!(
                "at the transit of {on} the table of {day} is too old"
            ));
        }
        Some(_) => {}
    }
    // The last prediction before the transit holds at the transit.
    let then = compass
        .predicted
        .iter()
        .filter(|predicted| predicted.on <= on);
    let then = then.max_by_key(|predicted| predicted.on)?;
    if then.worst_deviation_deg < below.degrees() {
        return None;
    }
    found(format!(
        "{} predicted at the transit of {on}, which requires less than {}°",
        describe_deviation(then),
        below.degrees()
    ))
}

fn find_change(compass: &Compass, terms: &Terms) -> Option<Cause> {
    let change = compass.change?;
    let counts = change.size_deg.abs() * 100.0 >= f64::from(terms.change_centideg);
    let since = compass.adjusted_on.is_none_or(|day| change.on >= day);
    (counts && since).then(|| Cause {
        kind: CauseKind::Change,
        due: add_days(change.on, terms.after_event_days),
        reason: format!(
            "the ship's magnetism changed on {}, by {:.1}° on the worst heading",
            change.on,
            change.size_deg.abs()
        ),
        rule: None,
    })
}

fn find_failed_verification(compass: &Compass, terms: &Terms) -> Option<Cause> {
    let failed = compass.failed_verification?;
    let since = compass.adjusted_on.is_none_or(|day| failed.on >= day);
    since.then(|| Cause {
        kind: CauseKind::FailedVerification,
        due: add_days(failed.on, terms.after_event_days),
        reason: format!(
            "the verification of {} failed: headings are {:.1}° off the card on the worst heading",
            failed.on,
            failed.worst_error_deg.abs()
        ),
        rule: None,
    })
}

fn add_days(day: NaiveDate, days: u32) -> NaiveDate {
    day.checked_add_days(Days::new(days.into()))
        .unwrap_or(NaiveDate::MAX)
}
