//! Due date of a compass's next adjustment, as its card shows it.
//!
//! Invariant: the date follows from the schedule's rules and the records at the card's date.
//! Without an adjustment on record there is none.

use super::contents::CardNextDue;
use binnacle_compass::logbook::{LogbookEntry, LogbookKind};
use binnacle_platform::time::Time;
use binnacle_schedule::needs::{self, Event, Predicted, Side, Terms, due};
use binnacle_schedule::rules::{EventKind, Flag, Limit, built_in_rules};
use binnacle_schedule::time::Instant;

/// No state's letters (ISO 3166-1, 8.1.3). A schedule that knows no flag counts every
/// flag's rules; a card that names a flag in words would then cite another state's.
const NO_FLAG: &str = "ZZ";

/// Facts that the rules use.
pub(super) struct Facts<'a> {
    /// The vessel's flag as it is recorded.
    pub(super) flag: Option<&'a str>,
    /// Time of the last adjustment.
    pub(super) adjusted_at: Option<Time>,
    /// Entries of the logbook.
    pub(super) logbook: &'a [LogbookEntry],
    /// The day of the card.
    pub(super) at: Time,
    /// The greatest deviation on it, degrees, east positive.
    pub(super) worst_deviation_deg: f64,
    /// The greatest within the vessel's own limits, degrees.
    pub(super) own_limit_deg: f64,
}

/// Returns the due date; none where no adjustment is on record.
pub(super) fn next_due(facts: &Facts<'_>) -> Option<CardNextDue> {
    let flag = facts.flag.and_then(|flag| letters(flag.trim()));
    let ship = needs::Ship {
        flag: flag.or_else(|| letters(NO_FLAG)),
        gross_tonnage: None,
        trade: None,
        deviation_record: None,
        transits: Vec::new(),
    };
    let adjusted_at = facts.adjusted_at?;
    let compass = needs::Compass {
        adjusted_on: Some(adjusted_at.day().parse().ok()?),
        adjusted_at: Some(Instant(adjusted_at.0)),
        events: facts.logbook.iter().filter_map(event).collect(),
        predicted: vec![Predicted {
            on: facts.at.day().parse().ok()?,
            place: None,
            worst_deviation_deg: facts.worst_deviation_deg.abs(),
            side: Some(Side::from_deviation(facts.worst_deviation_deg)),
        }],
        deviation_limit_deg: Limit::try_from(facts.own_limit_deg).ok(),
        ..needs::Compass::default()
    };
    let today = facts.at.day().parse().ok()?;
    let found = due(&ship, &compass, built_in_rules(), &Terms::default(), today)?;
    Some(CardNextDue {
        on: found.on.to_string(),
        reason: found.reason,
        flags_own_rules: flag.is_some(),
    })
}

fn letters(text: &str) -> Option<Flag> {
    Flag::try_from(text.to_owned()).ok()
}

fn event(entry: &LogbookEntry) -> Option<Event> {
    let kind = match entry.kind {
        LogbookKind::DryDocking => EventKind::DryDocking,
        LogbookKind::Repair | LogbookKind::Welding => EventKind::StructuralChange,
        LogbookKind::CompassMoved => EventKind::Installation,
        LogbookKind::Adjustment
        | LogbookKind::CorrectorChange
        | LogbookKind::Degaussing
        | LogbookKind::Lightning
        | LogbookKind::Shock
        | LogbookKind::MagneticCargo
        | LogbookKind::Berth
        | LogbookKind::Note => return None,
    };
    let at = entry.to.unwrap_or(entry.from);
    Some(Event {
        kind,
        on: Time(at).day().parse().ok()?,
        at: Some(Instant(at)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::time::Timestamp;

    fn time(text: &str) -> Time {
        Time(Timestamp::parse(text).unwrap())
    }

    fn facts(flag: &str) -> Facts<'_> {
        Facts {
            flag: Some(flag),
            adjusted_at: Some(time("2026-11-21T08:00:00Z")),
            logbook: &[],
            at: time("2026-12-01T00:00:00Z"),
            worst_deviation_deg: -1.4,
            own_limit_deg: 5.0,
        }
    }

    #[test]
    fn an_adjustment_is_due_again_by_the_rule_that_comes_first() {
        let found = next_due(&facts("ES")).unwrap();
        assert_eq!(
            (found.on.as_str(), found.flags_own_rules),
            ("2028-11-21", true)
        );
        assert!(found.reason.contains("ISO 25862"), "{}", found.reason);
        let found = next_due(&facts("PA")).unwrap();
        assert_eq!(found.on, "2027-11-21", "{}", found.reason);
        let found = next_due(&facts("somewhere")).unwrap();
        assert_eq!(
            (found.on.as_str(), found.flags_own_rules),
            ("2028-11-21", false)
        );
    }

    #[test]
    fn a_deviation_over_the_flags_limit_and_a_dock_bring_it_forward() {
        let over = Facts {
            worst_deviation_deg: -5.2,
            ..facts("PA")
        };
        assert_eq!(next_due(&over).unwrap().on, "2026-12-15");
        let docked: LogbookEntry = serde_json::from_value(serde_json::json!({
            "kind": "dry_docking", "from": "2026-12-01T00:00:00Z", "to": "2026-12-20T00:00:00Z",
        }))
        .unwrap();
        let logbook = [docked];
        let found = next_due(&Facts {
            logbook: &logbook,
            ..facts("ES")
        })
        .unwrap();
        assert_eq!(found.on, "2027-01-19", "{}", found.reason);
    }

    #[test]
    fn a_deviation_over_the_vessels_own_limit_brings_it_forward() {
        let own = |own_limit_deg| Facts {
            worst_deviation_deg: -3.2,
            own_limit_deg,
            ..facts("ES")
        };
        let over = next_due(&own(3.0)).unwrap();
        assert_eq!(over.on, "2026-12-15");
        assert!(over.reason.starts_with("3.2° W"), "{}", over.reason);
        assert!(over.reason.contains("own limit of 3°"), "{}", over.reason);
        assert_eq!(next_due(&own(4.0)).unwrap().on, "2028-11-21");
    }

    #[test]
    fn work_on_the_day_of_an_adjustment_counts_if_it_came_after_it() {
        let welded = |at: &str| -> LogbookEntry {
            serde_json::from_value(serde_json::json!({ "kind": "welding", "from": at })).unwrap()
        };
        // Adjusted at 08:00.
        for (at, due) in [
            ("2026-11-21T07:00:00Z", "2028-11-21"),
            ("2026-11-21T15:00:00Z", "2026-12-21"),
        ] {
            let logbook = [welded(at)];
            let found = next_due(&Facts {
                logbook: &logbook,
                ..facts("ES")
            });
            assert_eq!(found.unwrap().on, due, "{at}");
        }
    }

    #[test]
    fn without_an_adjustment_on_record_there_is_no_day() {
        let never = Facts {
            adjusted_at: None,
            ..facts("ES")
        };
        assert_eq!(next_due(&never), None);
    }
}
