//! Checks confirmed jobs: those that stand, and the reasons why others do not.

use super::candidates::Candidates;
use super::confirmation::{Confirmation, Held};
use super::crews::Crew;
use super::jobs::Job;
use super::quote::{self, Obstacle, Quote};
use crate::input::{FormerJob, Input, JobState};
use crate::ports::PortCode;
use crate::solve;
use chrono::NaiveDate;
use std::collections::BTreeMap;

/// Checks the confirmation of each job. Where a firm confirmed more jobs than
/// its teams can do, the more urgent and then the earlier due dates hold.
pub(super) fn check_all<'a>(
    input: &'a Input,
    crews: &'a [Crew<'a>],
    jobs: &[Job<'a>],
) -> Vec<Confirmation<'a>> {
    let each = jobs.iter().map(|job| check(input, crews, job));
    let mut all: Vec<Confirmation<'a>> = each.collect();
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_key(|at| (std::cmp::Reverse(jobs[*at].urgency()), jobs[*at].due(), *at));
    let mut candidates = Candidates::new(input, crews);
    candidates.problem.unmet = vec![0; jobs.len()];
    for &at in &order {
        if let Confirmation::Holds(held) = &all[at] {
            candidates.add_held(at, held);
        }
    }
    let holds = solve::take_in_order(&candidates.problem);
    let mut there: BTreeMap<(usize, NaiveDate), BTreeMap<PortCode, u32>> = BTreeMap::new();
    for at in order {
        let Confirmation::Holds(held) = &all[at] else {
            continue;
        };
        let firm = crews[held.ways[0].0].firm;
        let jobs_there = there
            .entry((crews[held.ways[0].0].at, held.day))
            .or_default();
        if holds[at].is_some() {
            *jobs_there.entry(held.call.port).or_default() += 1;
            continue;
        }
        let with = |port: PortCode| u32::from(port == held.call.port);
        let others = jobs_there.iter().map(|(port, jobs)| jobs + with(*port));
        let is_new = !jobs_there.contains_key(&held.call.port);
        let each = others.chain(is_new.then_some(1));
        let sent: u32 = each.map(|jobs| jobs.div_ceil(firm.jobs_a_team_day)).sum();
        let (left, day, name) = (firm.teams_on(held.day), held.day, firm.display_name());
        let cause = if sent > left {
            let teams = if left == 1 { "team" } else { "teams" };
            format!("{name} has only {left} {teams} on {day}")
        } else {
            format!(
                "{name}'s teams have not the hours for it beside the other jobs agreed near {day}"
            )
        };
        let only_late = false;
        all[at] = Confirmation::Released { cause, only_late };
    }
    all
}

fn check<'a>(input: &'a Input, crews: &'a [Crew<'a>], job: &Job<'a>) -> Confirmation<'a> {
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
    let able = crews_of(crews, at, former);
    let able: Vec<usize> = able.filter(|crew| crews[*crew].serves(call.port)).collect();
    if able.is_empty() {
        let team = former.team.as_deref().unwrap_or_default();
        return released(format!("{name} has no team {team:?} at {}", call.port));
    }
    let hour = job.agreed_hour();
    let quotes = able.into_iter().map(|crew| {
        let quote = quote::quote(input, job, call, &crews[crew], day, hour);
        quote.map(|quote| (crew, quote))
    });
    let (ways, obstacles): (Vec<_>, Vec<_>) = quotes.partition(Result::is_ok);
    let ways: Vec<(usize, Quote)> = ways.into_iter().flatten().collect();
    if let Some((_, quote)) = ways.first() {
        // A late one remains a candidate of the job.
        if quote.late_days > 0 && !job.may_be_any_day(input.now.utc_date()) {
            return Confirmation::Released {
                cause: format!("{day} is after the due date, {}", job.due()),
                only_late: true,
            };
        }
        return Confirmation::Holds(Held { call, day, ways });
    }
    let first = obstacles.into_iter().find_map(Result::err);
    let first = first.expect("each crew has a quote or obstacles")[0];
    let hours = match hour {
        Some(hour) => format!("at the hour agreed, {hour}"),
        None => format!("in {name}'s hours of {day}"),
    };
    released(match first {
        Obstacle::Flag => format!("{} does not accept {name}", job.vessel.describe_flag()),
        Obstacle::Licence => format!("{name} lacks the licence that the operator asks for"),
        Obstacle::NotWorking => format!("{name} does not work on {day}"),
        Obstacle::LeadTime => format!("too little of {day} is left"),
        Obstacle::Stay => format!(
            "the ship is now alongside from {} to {}, not long enough {hours}",
            call.eta, call.etd
        ),
        Obstacle::AfterDue => format!("{day} is after the due date, {}", job.due()),
        Obstacle::Declined => format!("{name} declined after all"),
    })
}

/// Returns the crews of a firm that a former job may stay with: its team, if that has a
/// name.
fn crews_of<'a>(
    crews: &'a [Crew<'a>],
    firm: usize,
    former: &'a FormerJob,
) -> impl Iterator<Item = usize> + 'a {
    let of_firm = crews
        .iter()
        .enumerate()
        .filter(move |(_, crew)| crew.at == firm);
    let able = of_firm.filter(|(_, crew)| match (crew.team, &former.team) {
        (Some(team), Some(asked)) => team.name == *asked,
        _ => true,
    });
    able.map(|(at, _)| at)
}
