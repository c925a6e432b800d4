//! Checks confirmed jobs: those that stand, and the reasons why others do not.

use super::jobs::Job;
use super::quote::{self, Obstacle, Quote};
use crate::calls::PortCall;
use crate::input::{Input, JobState};
use crate::ports::PortCode;
use chrono::NaiveDate;
use std::collections::BTreeMap;

/// The state of a firm's confirmation.
pub(super) enum Confirmation<'a> {
    /// Not confirmed.
    None,
    /// It holds.
    Holds {
        call: &'a PortCall,
        firm: usize,
        day: NaiveDate,
        quote: Quote,
    },
    /// The job may move, for this cause; a job that is only late may move only
    /// to a day in time.
    Released { cause: String, only_late: bool },
}

/// Checks the confirmation of each job. Where a firm confirmed more jobs than
/// it has teams for, the more urgent and then the earlier due dates hold.
pub(super) fn check_all<'a>(input: &'a Input, jobs: &[Job<'a>]) -> Vec<Confirmation<'a>> {
    let mut all: Vec<Confirmation<'a>> = jobs.iter().map(|job| check(input, job)).collect();
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_key(|at| (std::cmp::Reverse(jobs[*at].urgency()), jobs[*at].due(), *at));
    let mut there: BTreeMap<(usize, NaiveDate), BTreeMap<PortCode, u32>> = BTreeMap::new();
    for at in order {
        let Confirmation::Holds {
            call, firm, day, ..
        } = &all[at]
        else {
            continue;
        };
        let of = &input.firms[*firm];
        let jobs_there = there.entry((*firm, *day)).or_default();
        *jobs_there.entry(call.port).or_default() += 1;
        let sent: u32 = jobs_there
            .values()
            .map(|jobs| jobs.div_ceil(of.jobs_a_team_day))
            .sum();
        if sent > of.teams_on(*day) {
            *jobs_there.entry(call.port).or_default() -= 1;
            let left = of.teams_on(*day);
            let teams = if left == 1 { "team" } else { "teams" };
            let cause = format!("{} has only {left} {teams} on {day}", of.display_name());
            let only_late = false;
            all[at] = Confirmation::Released { cause, only_late };
        }
    }
    all
}

fn check<'a>(input: &'a Input, job: &Job<'a>) -> Confirmation<'a> {
    let Some(former) = job
        .former
        .filter(|former| former.state == JobState::Confirmed)
    else {
        return Confirmation::None;
    };
    let released = |cause| Confirmation::Released {
        cause,
        only_late: false,
    };
    let Some(&call) = job.calls.iter().find(|call| call.id == former.call) else {
        return released(format!("call {} is cancelled or over", former.call));
    };
    let index = input.firms.iter().position(|firm| firm.id == former.firm);
    let at = index.expect("the firms of a checked input's former plan are there");
    let firm = &input.firms[at];
    let (name, day) = (firm.display_name(), former.day);
    if firm.travel(call.port).is_none() {
        return released(format!(
            "call {} is at {}, which {name} does not serve",
            call.display_name(),
            call.port
        ));
    }
    match quote::quote(input, job, call, firm, day) {
        // A late one remains a candidate of the job.
        Ok(quote) if quote.late_days > 0 && !job.is_overdue(input.now.utc_date()) => {
            Confirmation::Released {
                cause: format!("{day} is after the due date, {}", job.due()),
                only_late: true,
            }
        }
        Ok(quote) => Confirmation::Holds {
            call,
            firm: at,
            day,
            quote,
        },
        Err(obstacles) => released(match obstacles[0] {
            Obstacle::Flag => format!("{} does not accept {name}", job.vessel.describe_flag()),
            Obstacle::Licence => format!("{name} lacks the licence that the operator asks for"),
            Obstacle::NotWorking => format!("{name} does not work on {day}"),
            Obstacle::LeadTime => format!("too little of {day} is left"),
            Obstacle::Stay => format!(
                "the ship is now alongside from {} to {}, not long enough in {name}'s hours of {day}",
                call.eta, call.etd
            ),
            Obstacle::AfterDue => format!("{day} is after the due date, {}", job.due()),
            Obstacle::Declined => format!("{name} declined after all"),
        }),
    }
}
