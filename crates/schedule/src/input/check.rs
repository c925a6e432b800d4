//! Checks the consistency of an input.

use super::{Checked, FormerJob, Input, InputError, check_firm};
use crate::calls::find_overlap;
use crate::ports;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum length of a list.
const MAX_LIST: usize = 50_000;
/// Maximum number of candidates of all jobs, as [`max_candidates`] counts them. Each takes about 250
/// bytes and a microsecond before the search begins.
const MAX_CANDIDATES: u64 = 3_000_000;

type Result<T> = std::result::Result<T, InputError>;

/// Refuses an input that is too large to plan.
///
/// # Errors
/// The first list that is too long, or the number of candidates.
pub fn check_size(input: &Input) -> Result<()> {
    check_lengths(input)?;
    match max_candidates(input) {
        count if count > MAX_CANDIDATES => Err(InputError::new(
            "port_calls",
            format!(
                "{count} pairs of a need and a firm's day in a call are more than {MAX_CANDIDATES}: \
                 plan for fewer ships, with fewer firms or with shorter calls"
            ),
        )),
        _ => Ok(()),
    }
}

/// Returns an upper bound of the candidates of all jobs: each need on each day of its
/// ship's calls by each firm of the port.
fn max_candidates(input: &Input) -> u64 {
    let (mut needs, mut firms) = (BTreeMap::new(), BTreeMap::new());
    let of_needs = input.needs.iter().map(|need| &need.vessel);
    for vessel in of_needs.chain(input.compasses.iter().map(|compass| &compass.vessel)) {
        *needs.entry(vessel.as_str()).or_insert(0_u64) += 1;
    }
    for firm in &input.firms {
        // Teams with names are asked one by one.
        let crews = firm.teams.named().len().max(1) as u64;
        for served in &firm.ports {
            *firms.entry(served.port).or_insert(0_u64) += crews;
        }
    }
    input.port_calls.iter().fold(0, |sum: u64, call| {
        let days = (call.etd.utc_date() - call.eta.utc_date()).num_days() + 1;
        let of = |known: Option<&u64>| known.copied().unwrap_or(0);
        let days = u64::try_from(days).unwrap_or(0);
        let candidates = days.saturating_mul(of(needs.get(call.vessel.as_str())));
        sum.saturating_add(candidates.saturating_mul(of(firms.get(&call.port))))
    })
}

pub(super) fn check(input: Input) -> Result<Checked> {
    check_lengths(&input)?;
    check_settings(&input)?;
    let vessels = collect_ids(
        "vessels",
        input.vessels.iter().map(|vessel| vessel.id.as_str()),
    )?;
    let needs = input.needs.iter().map(|need| need.id.as_str());
    let mut compasses = collect_ids("needs", needs)?;
    for (at, compass) in input.compasses.iter().enumerate() {
        let path = format!("compasses[{at}]");
        insert_id(&mut compasses, &path, &compass.id)?;
        check_reference(
            &vessels,
            format!("{path}.vessel"),
            &compass.vessel,
            "vessel",
        )?;
        check_facts(&format!("{path}.facts"), &compass.facts)?;
    }
    for (at, need) in input.needs.iter().enumerate() {
        check_reference(
            &vessels,
            format!("needs[{at}].vessel"),
            &need.vessel,
            "vessel",
        )?;
    }
    let calls = collect_ids(
        "port_calls",
        input.port_calls.iter().map(|call| call.id.as_str()),
    )?;
    check_calls(&input, &vessels)?;
    check_size(&input)?;
    let firms = collect_ids("firms", input.firms.iter().map(|firm| firm.id.as_str()))?;
    for (at, firm) in input.firms.iter().enumerate() {
        check_firm(firm).map_err(|error| {
            InputError::new(format!("firms[{at}].{}", error.field), error.detail)
        })?;
    }
    let mut met: BTreeSet<&str> = BTreeSet::new();
    for (at, job) in input.former.iter().enumerate() {
        check_reference(&firms, format!("former[{at}].firm"), &job.firm, "firm")?;
        if job.needs.is_empty() {
            return Err(InputError::new(
                format!("former[{at}].needs"),
                "a job must meet at least one need",
            ));
        }
        for (of, need) in job.needs.iter().enumerate() {
            let path = format!("former[{at}].needs[{of}]");
            check_reference(&compasses, path.clone(), need, "need or compass")?;
            if !met.insert(need) {
                return Err(InputError::new(
                    path,
                    format!("{need:?} is in two former jobs"),
                ));
            }
        }
        check_hours(job).map_err(|detail| InputError::new(format!("former[{at}].to"), detail))?;
        // A call may have been cancelled since; its id must still be given.
        if job.call.is_empty() && !calls.contains("") {
            return Err(InputError::new(format!("former[{at}].call"), "is empty"));
        }
    }
    for (at, declined) in input.declined.iter().enumerate() {
        check_reference(
            &firms,
            format!("declined[{at}].firm"),
            &declined.firm,
            "firm",
        )?;
        check_reference(
            &compasses,
            format!("declined[{at}].need"),
            &declined.need,
            "need or compass",
        )?;
    }
    Ok(Checked(input))
}

/// Checks that a job ends after its beginning, within a day.
fn check_hours(job: &FormerJob) -> std::result::Result<(), String> {
    let Some(to) = job.to else {
        return Ok(());
    };
    let Some(from) = job.from else {
        return Err(format!("{to} is the end of a job without a beginning"));
    };
    let hours = to.hours_since(from);
    if hours > 0.0 && hours <= 24.0 {
        return Ok(());
    }
    Err(format!("{to} is not within 24 hours after {from}"))
}

fn check_lengths(input: &Input) -> Result<()> {
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
        if length > MAX_LIST {
            return Err(InputError::new(
                list,
                format!("{length} entries exceed the limit of {MAX_LIST}"),
            ));
        }
    }
    Ok(())
}

fn check_settings(input: &Input) -> Result<()> {
    if !(1..=730).contains(&input.horizon_days) {
        let detail = format!("{} is not within 1 to 730", input.horizon_days);
        return Err(InputError::new("horizon_days", detail));
    }
    if !(0.5..=24.0).contains(&input.weights.job_h) {
        let detail = format!("{} is not within 0.5 to 24", input.weights.job_h);
        return Err(InputError::new("weights.job_h", detail));
    }
    Ok(())
}

fn collect_ids<'a>(list: &str, ids: impl Iterator<Item = &'a str>) -> Result<BTreeSet<&'a str>> {
    let mut names = BTreeSet::new();
    for (at, id) in ids.enumerate() {
        insert_id(&mut names, &format!("{list}[{at}]"), id)?;
    }
    Ok(names)
}

fn insert_id<'a>(names: &mut BTreeSet<&'a str>, path: &str, id: &'a str) -> Result<()> {
    if id.trim().is_empty() || id.chars().count() > 100 {
        return Err(InputError::new(
            format!("{path}.id"),
            "is empty or longer than 100 characters",
        ));
    }
    if !names.insert(id) {
        return Err(InputError::new(
            format!("{path}.id"),
            format!("{id:?} appears twice"),
        ));
    }
    Ok(())
}

fn check_reference(names: &BTreeSet<&str>, path: String, name: &str, kind: &str) -> Result<()> {
    if names.contains(name) {
        return Ok(());
    }
    Err(InputError::new(
        path,
        format!("there is no {kind} {name:?}"),
    ))
}

fn check_facts(path: &str, compass: &crate::needs::Compass) -> Result<()> {
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

fn check_calls(input: &Input, vessels: &BTreeSet<&str>) -> Result<()> {
    for (at, call) in input.port_calls.iter().enumerate() {
        let path = format!("port_calls[{at}]");
        check_reference(vessels, format!("{path}.vessel"), &call.vessel, "vessel")?;
        if ports::find(call.port).is_none() {
            let detail = ports::describe_unknown(call.port);
            return Err(InputError::new(format!("{path}.port"), detail));
        }
        if let Err(error) = call.checked(input.now) {
            return Err(InputError::new(
                format!("{path}.{}", error.field),
                error.detail,
            ));
        }
    }
    let Some((at, of)) = find_overlap(&input.port_calls) else {
        return Ok(());
    };
    let (next, first) = (&input.port_calls[at], &input.port_calls[of]);
    let detail = format!(
        "{} overlaps call {:?} of the same ship, which ends {}",
        next.eta, first.id, first.etd
    );
    Err(InputError::new(format!("port_calls[{at}].eta"), detail))
}
