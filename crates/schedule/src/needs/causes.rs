//! Each cause of a due date.

use super::{Cause, CauseKind, Compass, Event, Ship, Terms};
use crate::rules::{Applies, DeviationRecord, Limit, Requirement, Rule};
use chrono::{Days, NaiveDate};

/// All causes, those of rules in the rules' order.
pub(super) fn find(
    ship: &Ship,
    compass: &Compass,
    rules: &[Rule],
    terms: &Terms,
    today: NaiveDate,
) -> Vec<Cause> {
    let mut causes = Vec::new();
    causes.extend(failed_verification(compass, terms));
    causes.extend(change(compass, terms));
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
                        at_transit(compass, transit.on, *below_deg, |adjusted| {
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
                    format!("{} months after the adjustment of {day}", months.get()),
                ),
                None => (
                    CauseKind::NeverAdjusted,
                    today,
                    "no adjustment is on record".to_owned(),
                ),
            }),
            Requirement::AfterEvent { events } => since_adjusted(compass)
                .filter(|event| events.contains(&event.kind))
                .map(|event| {
                    let due = plus(event.on, terms.after_event_days);
                    (
                        CauseKind::Event,
                        due,
                        format!("not adjusted since {} of {}", event.kind, event.on),
                    )
                })
                .min_by_key(|found| found.1),
            Requirement::Deviation { adjust_above_deg } => {
                over(compass, *adjust_above_deg, terms, today)
            }
        };
        causes.extend(found.map(|(kind, due, words)| Cause {
            kind,
            due,
            reason: format!("{words} ({})", rule.citation),
            rule: Some(rule.id.clone()),
        }));
    }
    causes
}

/// Whether a rule binds a ship. What is not known of her is taken to be as the rule has
/// it: to adjust too early costs a fee, to adjust too late a detention.
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

type Found = (CauseKind, NaiveDate, String);

fn since_adjusted(compass: &Compass) -> impl Iterator<Item = &Event> {
    let adjusted = compass.adjusted_on.unwrap_or(NaiveDate::MIN);
    compass
        .events
        .iter()
        .filter(move |event| event.on > adjusted)
}

/// The first day on which the prediction is over a limit, or since which the deviation has
/// been.
fn over(compass: &Compass, limit: Limit, terms: &Terms, today: NaiveDate) -> Option<Found> {
    let over = compass
        .predicted
        .iter()
        .filter(|predicted| predicted.worst_deviation_deg > limit.degrees())
        .min_by_key(|predicted| predicted.on)?;
    let (deviation_deg, limit_deg) = (over.worst_deviation_deg, limit.degrees());
    let how_much = if over.on < today {
        format!("{deviation_deg:.1}° of deviation or more since {}", over.on)
    } else {
        format!("{deviation_deg:.1}° of deviation predicted for {}", over.on)
    };
    let words = format!("{how_much}, where more than {limit_deg}° must be adjusted");
    Some((
        CauseKind::OverLimit,
        plus(over.on, terms.over_limit_days),
        words,
    ))
}

fn at_transit(
    compass: &Compass,
    on: NaiveDate,
    below: Limit,
    too_old: impl Fn(NaiveDate) -> bool,
) -> Option<Found> {
    let found = |words| Some((CauseKind::Transit, on, words));
    match compass.adjusted_on {
        None => {
            return found(format!(
                "the transit of {on} asks for a deviation table, and none is on record"
            ));
        }
        Some(day) if too_old(day) => {
            return found(format!(
                "at the transit of {on} the table of {day} is too old"
            ));
        }
        Some(_) => {}
    }
    // What holds at the transit is the last prediction before it.
    let then = compass
        .predicted
        .iter()
        .filter(|predicted| predicted.on <= on);
    let then = then.max_by_key(|predicted| predicted.on)?;
    if then.worst_deviation_deg < below.degrees() {
        return None;
    }
    found(format!(
        "{:.1}° of deviation predicted at the transit of {on}, which asks for less than {}°",
        then.worst_deviation_deg,
        below.degrees()
    ))
}

fn change(compass: &Compass, terms: &Terms) -> Option<Cause> {
    let change = compass.change?;
    let counts = change.size_deg.abs() * 100.0 >= f64::from(terms.change_centideg);
    let since = compass.adjusted_on.is_none_or(|day| change.on > day);
    (counts && since).then(|| Cause {
        kind: CauseKind::Change,
        due: plus(change.on, terms.after_event_days),
        reason: format!(
            "the ship's magnetism changed on {}, by {:.1}° on the worst heading",
            change.on,
            change.size_deg.abs()
        ),
        rule: None,
    })
}

fn failed_verification(compass: &Compass, terms: &Terms) -> Option<Cause> {
    let failed = compass.failed_verification?;
    let since = compass.adjusted_on.is_none_or(|day| failed.on >= day);
    since.then(|| Cause {
        kind: CauseKind::FailedVerification,
        due: plus(failed.on, terms.after_event_days),
        reason: format!(
            "the verification of {} failed: headings are {:.1}° off the card on the worst heading",
            failed.on,
            failed.worst_error_deg.abs()
        ),
        rule: None,
    })
}

fn plus(day: NaiveDate, days: u32) -> NaiveDate {
    day.checked_add_days(Days::new(days.into()))
        .unwrap_or(NaiveDate::MAX)
}
