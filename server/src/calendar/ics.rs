//! Orders as iCalendar events (RFC 5545).
//!
//! What always holds: an order keeps its UID, and its SEQUENCE grows with its log; times
//! are UTC; the same orders make the same octets.

use super::store::Appointment;
use crate::time::Time;
use crate::work_orders::State;
use anyhow::Context;
use chrono::{DateTime, TimeDelta, Utc};
use icalendar::{Calendar, Component, Event, EventLike, EventStatus, Property};
use serde::Deserialize;

/// An adjustment at the berth takes about so long.
const TAKES: TimeDelta = TimeDelta::hours(2);

/// The calendar of these orders.
///
/// # Errors
/// When an order's time is beyond the calendar's.
pub(super) fn write(
    name: &str,
    appointments: &[Appointment],
    public_url: Option<&str>,
) -> anyhow::Result<String> {
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
    for appointment in appointments {
        calendar.push(event(appointment, public_url)?);
    }
    Ok(calendar.to_string())
}

/// What an entry of the log says of itself.
#[derive(Deserialize)]
struct Written {
    at: Time,
}

fn event(order: &Appointment, public_url: Option<&str>) -> anyhow::Result<Event> {
    let starts = utc(order.planned_at)?;
    let written: Written = serde_json::from_str(&order.line)?;
    let place = match &order.berth {
        Some(berth) => format!("{}, {berth}", order.port),
        None => order.port.clone(),
    };
    let state = in_words(order.state);
    let mut event = Event::new();
    event
        .uid(&format!("{}@binnacle", order.id))
        .add_property("SEQUENCE", order.last_seq.to_string())
        .timestamp(utc(written.at)?)
        .starts(starts)
        .ends(starts + TAKES)
        .summary(&format!(
            "Adjust {}, {} ({state})",
            order.compass_name, order.vessel_name
        ))
        .location(&place)
        .description(&description(order))
        .status(status(order.state));
    if let Some(url) = public_url {
        let url = url.trim_end_matches('/');
        event.url(&format!("{url}/work-orders/{}", order.id));
    }
    Ok(event.done())
}

fn description(order: &Appointment) -> String {
    let mut lines = vec![format!("Operator: {}", order.operator_name)];
    if let Some(firm) = &order.firm {
        lines.push(format!("Firm: {firm}"));
    }
    if let Some(adjuster) = &order.adjuster_name {
        lines.push(format!("Adjuster: {adjuster}"));
    }
    lines.join("\n")
}

fn status(state: State) -> EventStatus {
    match state {
        State::Planned | State::Offered | State::Proposed | State::Declined => {
            EventStatus::Tentative
        }
        State::Cancelled => EventStatus::Cancelled,
        _ => EventStatus::Confirmed,
    }
}

fn in_words(state: State) -> &'static str {
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
        State::Cancelled => "cancelled",
    }
}

fn utc(time: Time) -> anyhow::Result<DateTime<Utc>> {
    DateTime::from_timestamp_micros(time.0.micros()).context("a time beyond the calendar's")
}
