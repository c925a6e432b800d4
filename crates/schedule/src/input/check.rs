//! Whether an input hangs together.

use super::{Checked, Firm, Input, InputError};
use crate::calls::PortCall;
use crate::ports;
use std::collections::{BTreeMap, BTreeSet};

/// No list is longer.
const MOST: usize = 50_000;
/// A ship that stays longer is laid up, and her call is not one.
const LONGEST_STAY_DAYS: f64 = 120.0;

type Result<T> = std::result::Result<T, InputError>;

pub(super) fn check(input: Input) -> Result<Checked> {
    lists(&input)?;
    let vessels = names(
        "vessels",
        input.vessels.iter().map(|vessel| vessel.id.as_str()),
    )?;
    let needs = input.needs.iter().map(|need| need.id.as_str());
    let mut compasses = names("needs", needs)?;
    for (at, compass) in input.compasses.iter().enumerate() {
        let path = format!("compasses[{at}]");
        one_more(&mut compasses, &path, &compass.id)?;
        known(
            &vessels,
            format!("{path}.vessel"),
            &compass.vessel,
            "vessel",
        )?;
        facts(&format!("{path}.facts"), &compass.facts)?;
    }
    for (at, need) in input.needs.iter().enumerate() {
        known(
            &vessels,
            format!("needs[{at}].vessel"),
            &need.vessel,
            "vessel",
        )?;
    }
    let calls = names(
        "port_calls",
        input.port_calls.iter().map(|call| call.id.as_str()),
    )?;
    calls_of(&input, &vessels)?;
    let firms = names("firms", input.firms.iter().map(|firm| firm.id.as_str()))?;
    for (at, firm) in input.firms.iter().enumerate() {
        firm_is_sound(firm, &format!("firms[{at}]"))?;
    }
    let mut met: BTreeSet<&str> = BTreeSet::new();
    for (at, job) in input.former.iter().enumerate() {
        known(&firms, format!("former[{at}].firm"), &job.firm, "firm")?;
        if job.needs.is_empty() {
            return Err(InputError::new(
                format!("former[{at}].needs"),
                "a job meets at least one need",
            ));
        }
        for (of, need) in job.needs.iter().enumerate() {
            let path = format!("former[{at}].needs[{of}]");
            known(&compasses, path.clone(), need, "need or compass")?;
            if !met.insert(need) {
                return Err(InputError::new(
                    path,
                    format!("{need:?} is in two former jobs"),
                ));
            }
        }
        // A call may have been cancelled since; its name must still be one.
        if job.call.is_empty() && !calls.contains("") {
            return Err(InputError::new(format!("former[{at}].call"), "is empty"));
        }
    }
    for (at, declined) in input.declined.iter().enumerate() {
        known(
            &firms,
            format!("declined[{at}].firm"),
            &declined.firm,
            "firm",
        )?;
        known(
            &compasses,
            format!("declined[{at}].need"),
            &declined.need,
            "need or compass",
        )?;
    }
    Ok(Checked(input))
}

fn lists(input: &Input) -> Result<()> {
    let lengths = [
        ("vessels", input.vessels.len()),
        ("needs", input.needs.len()),
        ("compasses", input.compasses.len()),
        ("port_calls", input.port_calls.len()),
        ("firms", input.firms.len()),
        ("former", input.former.len()),
        ("declined", input.declined.len()),
    ];
    for (list, length) in lengths {
        if length > MOST {
            return Err(InputError::new(
                list,
                format!("{length} are more than {MOST}"),
            ));
        }
    }
    if !(1..=730).contains(&input.horizon_days) {
        let what = format!("{} is not within 1 to 730", input.horizon_days);
        return Err(InputError::new("horizon_days", what));
    }
    if !(0.5..=24.0).contains(&input.weights.job_h) {
        let what = format!("{} is not within 0.5 to 24", input.weights.job_h);
        return Err(InputError::new("weights.job_h", what));
    }
    Ok(())
}

fn names<'a>(list: &str, ids: impl Iterator<Item = &'a str>) -> Result<BTreeSet<&'a str>> {
    let mut names = BTreeSet::new();
    for (at, id) in ids.enumerate() {
        one_more(&mut names, &format!("{list}[{at}]"), id)?;
    }
    Ok(names)
}

fn one_more<'a>(names: &mut BTreeSet<&'a str>, path: &str, id: &'a str) -> Result<()> {
    if id.trim().is_empty() || id.chars().count() > 100 {
        return Err(InputError::new(
            format!("{path}.id"),
            "is empty or longer than 100 characters",
        ));
    }
    if !names.insert(id) {
        return Err(InputError::new(
            format!("{path}.id"),
            format!("{id:?} stands there twice"),
        ));
    }
    Ok(())
}

fn known(names: &BTreeSet<&str>, path: String, name: &str, what: &str) -> Result<()> {
    if names.contains(name) {
        return Ok(());
    }
    Err(InputError::new(
        path,
        format!("there is no {what} {name:?}"),
    ))
}

fn facts(path: &str, compass: &crate::needs::Compass) -> Result<()> {
    let degrees = |path: String, value: f64| {
        let fine = (-180.0..=180.0).contains(&value);
        fine.then_some(())
            .ok_or_else(|| InputError::new(path, format!("{value} is not within -180 to 180")))
    };
    for (at, predicted) in compass.predicted.iter().enumerate() {
        let path = format!("{path}.predicted[{at}].worst_deviation_deg");
        degrees(path.clone(), predicted.worst_deviation_deg)?;
        if predicted.worst_deviation_deg < 0.0 {
            return Err(InputError::new(
                path,
                "is negative; it is the largest on any heading, either way",
            ));
        }
    }
    if let Some(change) = compass.change {
        degrees(format!("{path}.change.size_deg"), change.size_deg)?;
    }
    if let Some(failed) = compass.failed_verification {
        degrees(
            format!("{path}.failed_verification.worst_error_deg"),
            failed.worst_error_deg,
        )?;
    }
    Ok(())
}

fn calls_of(input: &Input, vessels: &BTreeSet<&str>) -> Result<()> {
    let mut of: BTreeMap<&str, Vec<(usize, &PortCall)>> = BTreeMap::new();
    for (at, call) in input.port_calls.iter().enumerate() {
        let path = format!("port_calls[{at}]");
        known(vessels, format!("{path}.vessel"), &call.vessel, "vessel")?;
        if ports::find(call.port).is_none() {
            let what = format!("{} is no sea port of the UN/LOCODE table", call.port);
            return Err(InputError::new(format!("{path}.port"), what));
        }
        if let Err(error) = call.checked(input.now) {
            return Err(InputError::new(
                format!("{path}.{}", error.field),
                error.detail,
            ));
        }
        if call.etd.hours_since(call.eta) > LONGEST_STAY_DAYS * 24.0 {
            let what = format!(
                "{} is more than {LONGEST_STAY_DAYS} days after eta",
                call.etd
            );
            return Err(InputError::new(format!("{path}.etd"), what));
        }
        of.entry(&call.vessel).or_default().push((at, call));
    }
    for calls in of.values_mut() {
        calls.sort_by_key(|(at, call)| (call.eta, *at));
        for pair in calls.windows(2) {
            let ((_, first), (at, next)) = (pair[0], pair[1]);
            if next.eta < first.etd {
                let what = format!(
                    "{} overlaps call {:?} of the same ship, which ends {}",
                    next.eta, first.id, first.etd
                );
                return Err(InputError::new(format!("port_calls[{at}].eta"), what));
            }
        }
    }
    Ok(())
}

fn firm_is_sound(firm: &Firm, path: &str) -> Result<()> {
    let wrong = |field: &str, detail: &str| Err(InputError::new(format!("{path}.{field}"), detail));
    if firm.working_days.is_empty() {
        return wrong(
            "working_days",
            "a firm that works on no day of the week serves nobody",
        );
    }
    if firm.ports.is_empty() {
        return wrong("ports", "a firm without ports serves nobody");
    }
    if firm.teams > 1000 {
        return wrong("teams", "more than 1000");
    }
    if !(1..=20).contains(&firm.jobs_a_team_day) {
        return wrong("jobs_a_team_day", "is not within 1 to 20");
    }
    let hours = 0.0..=24.0;
    if !hours.contains(&firm.first_hour) {
        return wrong("first_hour", "is not within 0 to 24");
    }
    if !hours.contains(&firm.last_hour) || firm.last_hour <= firm.first_hour {
        return wrong("last_hour", "is not after first_hour and up to 24");
    }
    if !(0.0..=8760.0).contains(&firm.lead_time_h) {
        return wrong("lead_time_h", "is not within 0 to 8760");
    }
    let mut served = BTreeSet::new();
    for (at, port) in firm.ports.iter().enumerate() {
        let path = format!("{path}.ports[{at}].port");
        if ports::find(port.port).is_none() {
            let what = format!("{} is no sea port of the UN/LOCODE table", port.port);
            return Err(InputError::new(path, what));
        }
        if !served.insert(port.port) {
            return Err(InputError::new(
                path,
                format!("{} stands there twice", port.port),
            ));
        }
    }
    Ok(())
}
