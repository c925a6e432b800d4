//! The schedule: assigns firms and days to jobs, from a checked input.
//!
//! Invariants:
//! - A need is met at most once, by a firm that serves the port and is
//!   accepted, on a working day and in hours in which the ship is expected
//!   alongside.
//! - A team does one job after the other, and has the time to travel between
//!   them, also over nights.
//! - A job is planned after its due date only if that has passed already,
//!   nothing in time is available, or the weights allow it.
//! - A confirmed job stays unchanged while it remains possible.
//! - The same input gives the same schedule.

mod candidates;
mod capacity;
mod changes;
mod confirmation;
mod confirmed;
mod crews;
mod jobs;
mod quote;
mod remedies;
mod schedule;
mod unscheduled;

pub use schedule::{
    Change, ChangeKind, CostedOption, Later, Place, PlannedJob, Schedule, Unscheduled,
};

use crate::calls::{BerthHeading, HeadingSource};
use crate::input::{Checked, JobState};
use crate::solve::{self, Appointment};
use crate::time::euros;
use candidates::{Candidate, Candidates, travel};
use crews::Crew;
use jobs::Job;
use std::collections::BTreeMap;

/// Makes the schedule of an input.
pub fn plan(checked: &Checked) -> Schedule {
    let input = checked.get();
    let (jobs, later) = jobs::jobs(checked);
    let crews = crews::crews(input);
    let confirmations = confirmed::check_all(input, &crews, &jobs);
    let candidates = Candidates::from_jobs(input, &crews, &jobs, &confirmations);
    let solved = solve::solve(&candidates.problem);
    let made: Vec<Option<&Candidate<'_>>> = solved
        .assignment
        .iter()
        .map(|choice| choice.map(|choice| &candidates.all[choice]))
        .collect();
    let hours = solve::timetable(&candidates.problem, &solved.assignment);
    let planned = planned(&jobs, &candidates, &made, &hours);
    // A floating-point sum of nothing is −0.
    let paid = planned
        .iter()
        .fold(0.0, |paid: f64, job| paid + job.fee_eur + job.travel_eur);
    let gap = solved.cost - solved.bound;
    Schedule {
        cost_eur: euros(solved.cost),
        bound_eur: euros(solved.bound),
        gap_percent: 100.0 * gap as f64 / solved.cost.max(1) as f64,
        proven_optimal: gap == 0,
        paid_eur: (paid * 100.0).round() / 100.0,
        jobs: planned,
        unscheduled: unscheduled::unscheduled(input, &jobs, &candidates, &solved.assignment),
        changes: changes::changes(input, &jobs, &confirmations, &candidates, &made, &hours),
        later: later
            .into_iter()
            .map(|need| Later {
                need: need.id,
                due: need.due,
                reason: need.reason,
            })
            .collect(),
    }
}

fn planned(
    jobs: &[Job<'_>],
    candidates: &Candidates<'_>,
    made: &[Option<&Candidate<'_>>],
    hours: &[Option<Appointment>],
) -> Vec<PlannedJob> {
    let made = made.iter().zip(hours);
    let made = made.filter_map(|(made, hour)| Some(((*made)?, (*hour)?)));
    let made: Vec<(&Candidate<'_>, Appointment)> = made.collect();
    // Jobs of each team at each visit, which share its travel.
    let mut shares: BTreeMap<(usize, usize), u32> = BTreeMap::new();
    for (candidate, appointment) in &made {
        *shares
            .entry((candidate.visit, appointment.team))
            .or_default() += 1;
    }
    let each = made.iter().map(|(candidate, appointment)| {
        let jobs_there = shares[&(candidate.visit, appointment.team)];
        let crew = &candidates.crews[candidate.crew];
        planned_job(
            &jobs[candidate.job],
            candidate,
            crew,
            *appointment,
            jobs_there,
        )
    });
    let mut planned: Vec<PlannedJob> = each.collect();
    planned.sort_by(|one, other| {
        (one.day, one.from, &one.needs).cmp(&(other.day, other.from, &other.needs))
    });
    planned
}

fn planned_job(
    job: &Job<'_>,
    candidate: &Candidate<'_>,
    crew: &Crew<'_>,
    appointment: Appointment,
    jobs_there: u32,
) -> PlannedJob {
    let (firm, call, quote) = (crew.firm, candidate.call, candidate.quote);
    let port = quote::port_of(call);
    let from = quote::instant(appointment.from);
    let is_agreed = job.agreed_hour().is_none_or(|agreed| agreed == from);
    let kept = job.was_planned(&call.id, &firm.id, candidate.day) && is_agreed;
    PlannedJob {
        needs: job.ids(),
        vessel: job.vessel.id.clone(),
        call: call.id.clone(),
        port: call.port,
        port_name: port.name,
        firm: firm.id.clone(),
        day: candidate.day,
        from,
        to: quote::instant(appointment.from + quote.length_s),
        team: crew.team_name(appointment.team),
        berth_heading: call.berth_heading_deg.map(|heading_deg| BerthHeading {
            heading_deg,
            source: HeadingSource::Given,
        }),
        state: match job.former {
            Some(former) if kept => former.state,
            _ => JobState::Proposed,
        },
        due: job.due(),
        urgency: job.urgency(),
        reason: job.needs[0].reason.clone(),
        late_days: quote.late_days,
        chance_of_missing: (quote.chance_of_missing * 1e4).round() / 1e4,
        fee_eur: euros(quote.fee),
        travel_eur: euros(travel(firm, call.port)) / f64::from(jobs_there),
        weighed: CostedOption {
            risk_eur: euros(quote.risk),
            waiting_eur: euros(quote.waiting),
            late_eur: euros(quote.late),
            early_eur: euros(quote.early),
            changed_eur: euros(quote.changed),
        },
    }
}
