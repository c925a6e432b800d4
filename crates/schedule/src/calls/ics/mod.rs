//! Reads port calls from iCalendar (RFC 5545), as agents and fleet programs
//! export them.
//!
//! A `VEVENT` is a call: `UID` is its id, `DTSTART` the ETA, `DTEND` the ETD.
//! Its port is that of `X-UNLOCODE`, of `LOCATION`, or without either of
//! `SUMMARY`. Such programs also export past and cancelled calls; both are left
//! out and reported.
//!
//! Invariant: a time counts only where the file states its zone, as UTC or as a
//! `VTIMEZONE` of one offset or of yearly rules. Floating times, whole days and
//! repeating events are refused with their line.

mod duration;
mod line;
mod place;
mod zone;

use super::FileError;
use super::csv::{MAX_CALLS, check_id};
use super::{Located, PortCall};
use crate::time::Instant;
use binnacle_compass::time::Timestamp;
use chrono::NaiveDateTime;
use line::{Line, lines};
use std::collections::BTreeMap;
use zone::Zone;

/// The contents of a ship's calendar.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calendar {
    /// Calls that are not over.
    pub calls: Vec<Located>,
    /// Ids of cancelled calls.
    pub cancelled: Vec<String>,
    /// Number of past calls.
    pub over: usize,
}

/// Reads the calls of one ship.
///
/// # Errors
/// [`FileError`] with the first fault: nothing of a bad file is kept.
pub fn read(text: &str, vessel: &str, now: Instant) -> Result<Calendar, FileError> {
    let lines = lines(text)?;
    if lines
        .first()
        .is_none_or(|line| !line.is("BEGIN", "VCALENDAR"))
    {
        return Err(FileError::new(
            1,
            "BEGIN",
            "a calendar begins with BEGIN:VCALENDAR",
        ));
    }
    let zones = zone::zones(&lines)?;
    let (mut calendar, mut ids) = (Calendar::default(), BTreeMap::new());
    let mut event: Option<(usize, Vec<&Line>)> = None;
    // An alarm within an event has lines of its own.
    let mut inner = 0;
    for line in &lines {
        match &mut event {
            None if line.is("BEGIN", "VEVENT") => event = Some((line.number, Vec::new())),
            Some((begins, own)) if line.is("END", "VEVENT") => {
                if calendar.calls.len() == MAX_CALLS {
                    return Err(FileError::new(
                        *begins,
                        "VEVENT",
                        format!("more than {MAX_CALLS} calls"),
                    ));
                }
                match read_event(*begins, own, &zones, vessel, now)? {
                    Event::Call(call) => {
                        check_id(&mut ids, &call, *begins)?;
                        let line = *begins;
                        calendar.calls.push(Located { line, call });
                    }
                    Event::Cancelled(id) => calendar.cancelled.push(id),
                    Event::Over => calendar.over += 1,
                }
                (event, inner) = (None, 0);
            }
            Some(_) if line.name == "BEGIN" => inner += 1,
            Some(_) if line.name == "END" => inner -= 1,
            Some((_, own)) if inner == 0 => own.push(line),
            _ => {}
        }
    }
    match event {
        Some((begins, _)) => Err(FileError::new(begins, "VEVENT", "has no end")),
        None => Ok(calendar),
    }
}

enum Event {
    Call(PortCall),
    Cancelled(String),
    Over,
}

fn read_event(
    begins: usize,
    own: &[&Line],
    zones: &BTreeMap<String, Zone>,
    vessel: &str,
    now: Instant,
) -> Result<Event, FileError> {
    let find = |name: &str| own.iter().find(|line| line.name == name).copied();
    if find("STATUS").is_some_and(|line| line.value.eq_ignore_ascii_case("CANCELLED")) {
        let id = find("UID").map_or_else(String::new, |line| line.value.clone());
        return Ok(Event::Cancelled(id));
    }
    if let Some(line) = own
        .iter()
        .find(|line| line.name == "RRULE" || line.name == "RDATE")
    {
        return Err(FileError::new(
            line.number,
            &line.name,
            "a port call does not repeat",
        ));
    }
    let needed = |name: &str| {
        find(name).ok_or_else(|| FileError::new(begins, name, "is missing in the event"))
    };
    let eta = needed("DTSTART")?;
    let arrives = instant(eta, zones)?;
    let (etd, leaves) = match find("DURATION") {
        Some(line) if find("DTEND").is_none() => (line, arrives.plus_hours(duration::hours(line)?)),
        _ => {
            let end = needed("DTEND")?;
            (end, instant(end, zones)?)
        }
    };
    if arrives < leaves && leaves <= now {
        return Ok(Event::Over);
    }
    let call = PortCall {
        id: needed("UID")?.value.clone(),
        name: None,
        vessel: vessel.to_owned(),
        port: place::find_port(begins, &find)?,
        berth: None,
        eta: arrives,
        eta_uncertainty_h: 0.0,
        etd: leaves,
        etd_uncertainty_h: 0.0,
        berth_heading_deg: None,
    };
    let checked = call.checked(now).and_then(|()| call.check_horizon(now));
    checked.map_err(|error| {
        let line = if error.field == "eta" { eta } else { etd };
        FileError::new(line.number, &line.name, error.detail)
    })?;
    Ok(Event::Call(call))
}

fn instant(line: &Line, zones: &BTreeMap<String, Zone>) -> Result<Instant, FileError> {
    let wrong = |what: String| FileError::new(line.number, &line.name, what);
    let (text, utc) = match line.value.strip_suffix('Z') {
        Some(text) => (text, true),
        None => (line.value.as_str(), false),
    };
    if text.len() == 8 && text.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(wrong(format!(
            "{text:?} is a whole day; a call needs the time of day"
        )));
    }
    let naive = NaiveDateTime::parse_from_str(text, "%Y%m%dT%H%M%S").map_err(|_| {
        wrong(format!(
            "{:?} is not a time as 20261201T080000Z",
            line.value
        ))
    })?;
    let offset_s = match line.parameter("TZID") {
        _ if utc => 0,
        Some(name) => match zones.get(name) {
            Some(zone) => zone.offset_s(naive),
            None if ["UTC", "Etc/UTC", "GMT", "Etc/GMT"].contains(&name) => 0,
            None => {
                return Err(wrong(format!(
                    "time zone {name:?} has no VTIMEZONE in the file"
                )));
            }
        },
        None => {
            return Err(wrong(format!(
                "{:?} has no time zone; write Z for UTC",
                line.value
            )));
        }
    };
    // In another zone, a four-digit year may end outside the years 1 to 9999.
    let utc = naive.checked_sub_signed(chrono::Duration::seconds(offset_s));
    let micros = utc.map(|utc| utc.and_utc().timestamp_micros());
    let micros = micros.and_then(|micros| Timestamp::from_micros(micros).ok());
    micros
        .map(Instant)
        .ok_or_else(|| wrong(format!("{:?} lies outside the years 1 to 9999", line.value)))
}
