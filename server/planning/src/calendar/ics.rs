//! Orders, port calls and due dates as iCalendar events (RFC 5545).
//!
//! Invariants: an event keeps its UID, and its SEQUENCE grows with the order's log, the call's
//! revisions or the versions of the due date. Times are UTC, an order's also in the port's time in
//! its description, and due dates are days. Equal records give equal bytes.

use super::store::{CalendarCall, CalendarDueDate, CalendarOrder};
use anyhow::Context;
use binnacle_orders::work_orders::{CallFit, Hours, State};
use binnacle_platform::time::Time;
use binnacle_schedule::ports::{self, PortCode};
use chrono::{DateTime, NaiveDate, TimeDelta, Utc};
use icalendar::{Alarm, Calendar, Component, Event, EventLike, EventStatus, Property, Trigger};
use serde::Deserialize;

/// Time from the reminder of an agreed job to the job.
const REMINDER: TimeDelta = TimeDelta::days(1);

/// Returns the calendar of some events.
pub(super) fn render_calendar(name: &str, events: impl Iterator<Item = Event>) -> String {
    let mut calendar = Calendar {
        properties: Vec::new(),
        components: Vec::new(),
    };
    for (key, value) in [
        ("VERSION", "2.0"),
        ("PRODID", "-//Binnacle//Work orders//EN"),
        ("CALSCALE", "GREGORIAN"),
        ("METHOD", "PUBLISH"),
        ("X-WR-CALNAME", name),
        ("X-PUBLISHED-TTL", "PT1H"),
    ] {
        calendar.append_property(Property::new(key, value));
    }
    for event in events {
        calendar.push(event);
    }
    calendar.to_string()
}

/// Returns work orders as events.
///
/// # Errors
/// Fails when a time is outside the range of calendars, as do the next two.
pub(super) fn render_orders(
    orders: &[CalendarOrder],
    public_url: Option<&str>,
) -> anyhow::Result<impl Iterator<Item = Event>> {
    let all: anyhow::Result<Vec<Event>> = orders
        .iter()
        .map(|one| render_order(one, public_url))
        .collect();
    Ok(all?.into_iter())
}

/// Returns port calls as events.
pub(super) fn render_calls(
    calls: &[CalendarCall],
    public_url: Option<&str>,
) -> anyhow::Result<impl Iterator<Item = Event>> {
    let all: anyhow::Result<Vec<Event>> = calls
        .iter()
        .map(|one| render_call(one, public_url))
        .collect();
    Ok(all?.into_iter())
}

/// Returns due dates as events of a day.
pub(super) fn render_due_dates(
    due: &[CalendarDueDate],
    public_url: Option<&str>,
) -> anyhow::Result<impl Iterator<Item = Event>> {
    let all: anyhow::Result<Vec<Event>> = due
        .iter()
        .map(|one| render_due_date(one, public_url))
        .collect();
    Ok(all?.into_iter())
}

fn render_call(call: &CalendarCall, public_url: Option<&str>) -> anyhow::Result<Event> {
    let port = PortCode::parse(&call.port).ok().and_then(ports::find);
    let port = port.map_or_else(
        || call.port.clone(),
        |port| format!("{} ({})", port.name, call.port),
    );
    let place = match &call.berth {
        Some(berth) => format!("{port}, {berth}"),
        None => port.clone(),
    };
    let at = to_utc(
        call.withdrawn_at
            .or(call.revised_at)
            .unwrap_or(call.created_at),
    )?;
    // A withdrawal is no revision of its own and comes after the last one.
    let sequence = 2 * call.revision + i64::from(call.withdrawn_at.is_some());
    let mut lines = vec![
        format_time("ETA", call.eta, call.eta_uncertainty_h),
        format_time("ETD", call.etd, call.etd_uncertainty_h),
    ];
    if call.withdrawn_at.is_some() {
        let why = call.withdrawal_reason.as_deref();
        lines.push(why.map_or_else(|| "Withdrawn".to_owned(), |why| format!("Withdrawn: {why}")));
    }
    let mut event = Event::new();
    event
        .uid(&format!("call-{}@binnacle", call.id))
        .add_property("SEQUENCE", sequence.to_string())
        .timestamp(at)
        .last_modified(at)
        .starts(to_utc(call.eta)?)
        .ends(to_utc(call.etd)?)
        .summary(&format!("{} at {port}", call.vessel_name))
        .location(&place)
        .description(&lines.join("\n"))
        .add_property("TRANSP", "TRANSPARENT")
        .status(if call.withdrawn_at.is_some() {
            EventStatus::Cancelled
        } else {
            EventStatus::Tentative
        });
    if let Some(url) = public_url {
        let url = url.trim_end_matches('/');
        event.url(&format!("{url}/vessels/{}", call.vessel_id));
    }
    Ok(event.done())
}

fn format_time(label: &str, at: Time, uncertainty_h: f64) -> String {
    let at = at.to_the_minute();
    if uncertainty_h > 0.0 {
        format!("{label}: {at}, ±{uncertainty_h} h (95 %)")
    } else {
        format!("{label}: {at}")
    }
}

fn render_due_date(due: &CalendarDueDate, public_url: Option<&str>) -> anyhow::Result<Event> {
    let on: NaiveDate = due.day.parse().context("stored due date")?;
    let at = to_utc(due.changed_at)?;
    let mut event = Event::new();
    event
        .uid(&format!("due-{}@binnacle", due.compass_id))
        .add_property("SEQUENCE", due.version.to_string())
        .timestamp(at)
        .last_modified(at)
        .starts(on)
        .summary(&format!(
            "{}, {}: adjustment due ({})",
            due.vessel_name, due.compass_name, due.urgency
        ))
        .description(&due.reason)
        .add_property("TRANSP", "TRANSPARENT")
        .status(EventStatus::Confirmed);
    if let Some(url) = public_url {
        let url = url.trim_end_matches('/');
        event.url(&format!("{url}/vessels/{}", due.vessel_id));
    }
    Ok(event.done())
}

/// Fields of a log entry that a calendar shows.
#[derive(Deserialize)]
struct LogEntry {
    at: Time,
}

fn render_order(order: &CalendarOrder, public_url: Option<&str>) -> anyhow::Result<Event> {
    let entry: LogEntry = serde_json::from_str(&order.line)?;
    let place = match &order.berth {
        Some(berth) => format!("{}, {berth}", order.port),
        None => order.port.clone(),
    };
    let state = state_name(order.state);
    let mut event = Event::new();
    event
        .uid(&format!("{}@binnacle", order.id))
        .add_property("SEQUENCE", order.last_seq.to_string())
        .timestamp(to_utc(entry.at)?)
        .last_modified(to_utc(entry.at)?)
        .starts(to_utc(order.planned_at)?)
        .ends(to_utc(order.planned_until)?)
        .summary(&format!(
            "Adjust {}, {} ({state})",
            order.compass_name, order.vessel_name
        ))
        .location(&place)
        .description(&describe_order(order))
        .status(event_status(order));
    // Who has agreed on a job is reminded of it; nobody of one that may not take place.
    if order.state == State::Accepted {
        let words = format!("Adjust {}, {}", order.compass_name, order.vessel_name);
        let mut alarm = Alarm::display(&words, Trigger::before_start(REMINDER));
        // Without these the alarm would have the present time and an id by chance.
        alarm.uid(&format!("{}-reminder@binnacle", order.id));
        alarm.timestamp(to_utc(entry.at)?);
        event.alarm(alarm);
    }
    if let Some(url) = public_url {
        let url = url.trim_end_matches('/');
        event.url(&format!("{url}/work-orders/{}", order.id));
    }
    Ok(event.done())
}

fn describe_order(order: &CalendarOrder) -> String {
    let hours = Hours {
        from: order.planned_at,
        until: order.planned_until,
    };
    let mut lines = vec![
        hours.describe(&order.port),
        format!("Operator: {}", order.operator_name),
    ];
    if let Some(firm) = &order.firm {
        lines.push(format!("Firm: {firm}"));
    }
    if let Some(adjuster) = &order.adjuster_name {
        lines.push(format!("Adjuster: {adjuster}"));
    }
    lines.extend(find_warning(order).map(str::to_owned));
    lines.join("\n")
}

/// Returns the warning for an order still to be done whose port call has moved.
fn find_warning(order: &CalendarOrder) -> Option<&'static str> {
    let is_open = matches!(
        order.state,
        State::Offered
            | State::Proposed
            | State::Accepted
            | State::OnBoard
            | State::Measured
            | State::Adjusting
    );
    match order.call_fit.filter(|_| is_open)? {
        CallFit::Fits => None,
        CallFit::OtherHour => Some(
            "The port call has moved since this time was agreed: another hour of that day is \
             needed.",
        ),
        CallFit::NeedsNewDay => {
            Some("The port call has moved since this time was agreed: a new day is needed.")
        }
        CallFit::NoCall => Some(
            "The port call of this appointment is withdrawn or at another port: another time is \
             needed.",
        ),
    }
}

fn event_status(order: &CalendarOrder) -> EventStatus {
    match order.state {
        State::Planned | State::Offered | State::Proposed | State::Declined => {
            EventStatus::Tentative
        }
        State::Cancelled => EventStatus::Cancelled,
        _ if find_warning(order).is_some() => EventStatus::Tentative,
        _ => EventStatus::Confirmed,
    }
}

fn state_name(state: State) -> &'static str {
    match state {
        State::Planned => "planned",
        State::Offered => "offered",
        State::Proposed => "other terms proposed",
        State::Declined => "no firm has taken it",
        State::Accepted => "accepted",
        State::OnBoard => "on board",
        State::Measured => "measured",
        State::Adjusting => "adjusting",
        State::Adjusted => "adjusted",
        State::Verified => "verified",
        State::Failed => "not confirmed at sea",
        State::Closed => "closed",
        State::ClosedUnverified => "closed without verification",
        State::Cancelled => "cancelled",
    }
}

fn to_utc(time: Time) -> anyhow::Result<DateTime<Utc>> {
    DateTime::from_timestamp_micros(time.0.micros()).context("time outside the calendar's range")
}
