//! Checks confirmed jobs: those that stand, and the reasons why others do not.

use super::jobs::Job;
use super::quote::{self, Obstacle, Quote};
use crate::calls::PortCall;
use crate::input::{Input, JobState};
use crate::ports::PortCode;
use chrono::NaiveDate;
use std::collections::BTreeMap;

/// The state of a firm's confirmation.
pub(super) enum Standing<'a> {
    /// Not confirmed.
    Open,
    /// It holds.
    Stands {
        call: &'a PortCall,
        firm: usize,
        day: NaiveDate,
        quote: Quote,
    },
    /// The job may move, for this cause; a job that is only late may move only
    /// to a day in time.
    Loose { cause: String, only_late: bool },
}

/// Checks the confirmation of each job. Where a firm confirmed more jobs than
/// it has teams for, the more urgent and then the earlier due dates hold.
pub(super) fn standing<'a>(input: &'a Input, jobs: &[Job<'a>]) -> Vec<Standing<'a>> {
    let mut all: Vec<Standing<'a>> = jobs.iter().map(|job| of(input, job)).collect();
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_key(|at| (std::cmp::Reverse(jobs[*at].urgency()), jobs[*at].due(), *at));
    let mut there: BTreeMap<(usize, NaiveDate), BTreeMap<PortCode, u32>> = BTreeMap::new();
    for at in order {
        let Standing::Stands {
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
            let cause = format!("{} has only {left} {teams} on {day}", of.called());
            let only_late = false;
            all[at] = Standing::Loose { cause, only_late };
        }
    }
    all
}

fn of<'a>(input: &'a Input, job: &Job<'a>) -> Standing<'a> {
    let Some(former) = job
        .former
        .filter(|former| former.state == JobState::Confirmed)
    else {
        return Standing::Open;
    };
    let loose = |cause| Standing::Loose {
        cause,
        only_late: false,
    };
    let Some(&call) = job.calls.iter().find(|call| call.id == former.call) else {
        return loose(format!("call {} is cancelled or over", former.call));
    };
    let index = input.firms.iter().position(|firm| firm.id == former.firm);
    let at = index.expect("the firms of a checked input's former plan are there");
    let firm = &input.firms[at];
    let (name, day) = (firm.called(), former.day);
    if firm.travel(call.port).is_none() {
        return loose(format!(
            "call {} is at {}, which {name} does not serve",
            call.called(),
            call.port
        ));
    }
    match quote::quote(input, job, call, firm, day) {
        // A late one remains a candidate of the job.
        Ok(quote) if quote.late_days > 0 && !job.is_overdue(input.now.utc_date()) => {
            Standing::Loose {
                cause: format!("{day} is after the due date, {}", job.due()),
                only_late: true,
            }
        }
        Ok(quote) => Standing::Stands {
            call,
            firm: at,
            day,
            quote,
        },
        Err(obstacles) => loose(match obstacles[0] {
            Obstacle::Flag => format!("{} does not accept {name}", job.vessel.flag_in_words()),
            Obstacle::Licence => format!("{name} lacks the licence that the operator asks for"),
            Obstacle::NotWorking => format!("{name} does not work on {day}"),
            Obstacle::LeadTime => format!("too little is left of {day}"),
            Obstacle::Stay => format!(
                "the ship is now alongside from {} to {}, not long enough in {name}'s hours of {day}",
                call.eta, call.etd
            ),
            Obstacle::AfterDue => format!("{day} is after the due date, {}", job.due()),
            Obstacle::Declined => format!("{name} declined after all"),
        }),
    }
}
