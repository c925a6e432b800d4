//! Alert that the ship's own agent reports: compass and gyro have parted.
//!
//! Invariant: reports within [`QUIET_S`] of each other are one alert. It is over after that time
//! without a further report, by the ship's samples or the clock.

use super::facts::AgentReports;
use super::row::{CardEffect, Case, CauseRow, Condition, Ending, Finder, PlanEffect, Size};
use crate::alerts::alert::{KnownAlert, State};
use crate::alerts::cause::Cause;
use crate::alerts::desired::EventWindow;
use binnacle_compass::time::Timestamp;
use binnacle_platform::severity::Severity;
use binnacle_platform::time::Time;
use binnacle_wire::alert::{ShipAlert, ShipAlertState, Suspect};

/// Time of agreement after which the alert is over, seconds: compass and gyro that part at the
/// limit do so again and again.
const QUIET_S: f64 = 6.0 * 3600.0;
/// Departure beyond which the compass, or the gyro, is worse than none, degrees.
const CRITICAL_DEG: f64 = 10.0;

/// Compass and reference parted, by the agent's own comparison.
pub(super) const REPORTED_BY_AGENT: CauseRow = CauseRow {
    cause: Cause::ReportedByAgent,
    title: "compass and gyro have parted, reported by the agent",
    finders: &[Finder::AgentReports(reported)],
    severity,
    advice,
    on_card: CardEffect::Block,
    on_plan: PlanEffect::Note,
    ending: Ending::AfterSilence { seconds: QUIET_S },
    // Reports that suspect the gyro outlast an adjustment: the agent's reports tell.
    ends_with_adjustment: false,
    is_redated: false,
};

/// Returns the condition that the agent's reports make; the latest comes first.
fn reported(facts: &AgentReports<'_>) -> Option<Condition> {
    let last = facts.reports.first()?;
    let condition = if last.state == ShipAlertState::Open {
        disagreement(last)
    } else {
        let quiet_s = facts
            .until
            .map_or(0.0, |until| until.seconds_since(last.at));
        quiet(last, facts.known.filter(|_| quiet_s < QUIET_S)?)
    };
    // After a person cleared it, the next departure is another event.
    let is_another = facts.known.is_some_and(|known| {
        known.state == State::Cleared && known.cleared_at.is_some_and(|at| at.0 < last.since)
    });
    if is_another {
        return Some(condition);
    }
    let since: Time = since(facts.reports).unwrap_or(last.since).into();
    Some(Condition {
        since,
        window: EventWindow {
            from: Some(since),
            ..condition.window
        },
        ..condition
    })
}

/// Returns the beginning of the first of those reports that followed each other within hours.
fn since(reports: &[ShipAlert]) -> Option<Timestamp> {
    let mut since = reports.first()?.since;
    for earlier in &reports[1..] {
        if since.seconds_since(earlier.at) >= QUIET_S {
            break;
        }
        since = since.min(earlier.since);
    }
    Some(since)
}

fn disagreement(report: &ShipAlert) -> Condition {
    let size_deg = report.departure_deg().abs();
    let departures = [
        ("gyro", report.gyro_departure_deg),
        ("satellite compass", report.satellite_departure_deg),
    ];
    let mut evidence: Vec<String> = departures
        .into_iter()
        .filter_map(|(name, departure)| Some((name, departure?)))
        .map(|(name, departure_deg)| {
            format!("The corrected compass less the {name} is {departure_deg:+.1}°.")
        })
        .collect();
    evidence.push(format!(
        "Model {} and the usual error of the {} allow {:.1}°.",
        report.model_version,
        report.reference(),
        report.limit_deg
    ));
    Condition {
        since: report.since.into(),
        window: EventWindow::exactly(report.since.into()),
        size: Size {
            magnitude_deg: size_deg,
            ..Size::default()
        },
        case: Case::Parted {
            suspect: report.suspect(),
            has_gyro: report.gyro_departure_deg.is_some(),
        },
        summary: format!(
            "{} parted by {size_deg:.0}°, reported by the ship's agent.",
            instruments(report)
        ),
        evidence,
    }
}

/// Returns the condition of an open alert after the agent closed its own.
fn quiet(last: &ShipAlert, known: &KnownAlert) -> Condition {
    let since = Time(last.at).to_the_minute();
    let (state, case) = match last.state {
        ShipAlertState::NotJudged => (
            format!("since {since} it is not known whether they are still apart"),
            Case::NotJudged,
        ),
        _ => (format!("since {since} they agree"), Case::Agreeing),
    };
    Condition {
        size: Size {
            was: Some(known.severity),
            ..Size::default()
        },
        case,
        summary: format!(
            "{} parted, reported by the ship's agent; {state}.",
            instruments(last)
        ),
        ..disagreement(last)
    }
}

fn severity(size: &Size) -> Severity {
    match size.was {
        Some(was) => was,
        None if size.magnitude_deg > CRITICAL_DEG => Severity::Critical,
        None => Severity::Warning,
    }
}

fn instruments(report: &ShipAlert) -> &'static str {
    match report.suspect() {
        Suspect::Gyro => "Gyro and compass",
        _ if report.reference() == "gyro" => "Compass and gyro",
        _ => "Compass and satellite compass",
    }
}

fn advice(case: Case) -> &'static str {
    match case {
        Case::Parted {
            suspect: Suspect::Compass,
            ..
        } => {
            "Steer by gyro: the satellite compass confirms it. Do not use the card. Take an \
             azimuth, and ask on board about lightning, a shock or magnetic cargo."
        }
        Case::Parted {
            suspect: Suspect::Gyro,
            ..
        } => {
            "The satellite compass confirms the magnetic compass: have the gyro and its speed and \
             latitude settings checked, and an azimuth taken before it is steered by."
        }
        Case::Parted {
            suspect: Suspect::Satellite,
            ..
        } => {
            "The gyro confirms the magnetic compass: have the satellite compass and its antennas \
             checked."
        }
        Case::Parted {
            suspect: Suspect::Unknown,
            has_gyro: false,
        } => {
            "Trust neither until an azimuth proves one: compare both with a steady course over \
             ground, check the satellite compass and its antennas, and ask on board about \
             lightning, a shock or magnetic cargo."
        }
        Case::Parted {
            suspect: Suspect::Unknown,
            has_gyro: true,
        } => {
            "Steer by gyro, but trust neither until an azimuth proves one: check the gyro, and ask \
             on board about lightning, a shock or magnetic cargo."
        }
        Case::NotJudged => "Steer by gyro and take an azimuth until there is a card again.",
        _ => {
            "Keep comparing them each watch. If they stay together for six hours, this alert \
             clears itself."
        }
    }
}
