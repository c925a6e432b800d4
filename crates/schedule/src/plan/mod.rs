//! The schedule: assigns firms and days to jobs, from a checked input.
//!
//! Invariants:
//! - A need is met at most once, by a firm that serves the port and is
//!   accepted, within its teams, on a working day on which the ship is expected
//!   alongside long enough.
//! - A job is planned after its due date only if that has passed already,
//!   nothing in time is available, or the weights allow it.
//! - A confirmed job stays unchanged while it remains possible.
//! - The same input gives the same schedule.

mod confirmed;
mod help;
mod jobs;
mod moves;
mod quote;
mod room;
mod schedule;
mod why;

pub use schedule::{Change, ChangeKind, Later, Place, PlannedJob, Schedule, Unscheduled, Weighed};

use crate::calls::{BerthHeading, HeadingSource, PortCall};
use crate::input::{Checked, Firm, Input, JobState};
use crate::ports::PortCode;
use crate::solve::{self, Choice, Problem, Visit};
use crate::time::euros;
use chrono::NaiveDate;
use confirmed::Standing;
use jobs::Job;
use quote::Quote;
use std::collections::BTreeMap;

/// Value of a confirmed job that holds, beyond its cost, in cents: ten million
/// euros.
const STANDS: i64 = 1_000_000_000;

/// One way to do one job.
struct Way<'a> {
    job: usize,
    call: &'a PortCall,
    firm: usize,
    day: NaiveDate,
    quote: Quote,
    visit: usize,
}

/// All ways to do all jobs, and the assignment problem that they form.
struct Options<'a> {
    all: Vec<Way<'a>>,
    problem: Problem,
    visits: BTreeMap<(usize, PortCode, NaiveDate), usize>,
    firm_days: BTreeMap<(usize, NaiveDate), usize>,
}

/// Makes the schedule of an input.
pub fn plan(checked: &Checked) -> Schedule {
    let input = checked.get();
    let (jobs, later) = jobs::jobs(checked);
    let standing = confirmed::standing(input, &jobs);
    let options = Options::of(input, &jobs, &standing);
    let solved = solve::solve(&options.problem);
    let made: Vec<Option<&Way<'_>>> = solved
        .assignment
        .iter()
        .map(|choice| choice.map(|choice| &options.all[choice]))
        .collect();
    let planned = planned(input, &jobs, &made);
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
        unscheduled: why::unscheduled(input, &jobs, &made, &options.problem.unmet),
        changes: moves::changes(input, &jobs, &standing, &options, &made),
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

impl<'a> Options<'a> {
    fn of(input: &'a Input, jobs: &[Job<'a>], standing: &[Standing<'a>]) -> Options<'a> {
        let mut options = Options {
            all: Vec::new(),
            problem: Problem::default(),
            visits: BTreeMap::new(),
            firm_days: BTreeMap::new(),
        };
        let mut serving: BTreeMap<PortCode, Vec<usize>> = BTreeMap::new();
        for (at, firm) in input.firms.iter().enumerate() {
            for served in &firm.ports {
                serving.entry(served.port).or_default().push(at);
            }
        }
        for (at, (job, standing)) in jobs.iter().zip(standing).enumerate() {
            if let Standing::Stands {
                call,
                firm,
                day,
                quote,
            } = standing
            {
                let travel = travel(&input.firms[*firm], call.port);
                options.problem.unmet.push(quote.cost() + travel + STANDS);
                options.add(input, at, call, *firm, *day, *quote);
                continue;
            }
            let first = options.all.len();
            let only_late = matches!(standing, Standing::Loose { only_late, .. } if *only_late);
            for &call in &job.calls {
                for &firm in serving.get(&call.port).into_iter().flatten() {
                    for day in quote::days(call, input.now) {
                        let of = &input.firms[firm];
                        let Ok(quote) = quote::quote(input, job, call, of, day) else {
                            continue;
                        };
                        // A confirmed but late job may stay, or move to a day
                        // in time.
                        let as_late = only_late && quote.late_days > 0;
                        if !as_late || job.was(&call.id, &of.id, day) {
                            options.add(input, at, call, firm, day, quote);
                        }
                    }
                }
            }
            // An undone job waits longer than with any of its ways. So waiting
            // never favours leaving it undone; only a fee with its travel can.
            let ways = options.all[first..].iter();
            let ways = ways.map(|way| way.quote.cost() - way.quote.fee);
            let waits = ways.fold(quote::waits_at_most(input, job), i64::max);
            let unmet = input.weights.unmet_eur.of(job.urgency()).cents();
            options.problem.unmet.push(unmet + waits);
        }
        options
    }

    fn add(
        &mut self,
        input: &Input,
        job: usize,
        call: &'a PortCall,
        firm: usize,
        day: NaiveDate,
        quote: Quote,
    ) {
        let of = &input.firms[firm];
        let problem = &mut self.problem;
        let firm_day = *self.firm_days.entry((firm, day)).or_insert_with(|| {
            problem.teams.push(of.teams_on(day));
            problem.teams.len() - 1
        });
        let visit = *self
            .visits
            .entry((firm, call.port, day))
            .or_insert_with(|| {
                problem.visits.push(Visit {
                    firm_day,
                    travel: travel(of, call.port),
                    jobs_a_team: of.jobs_a_team_day,
                });
                problem.visits.len() - 1
            });
        problem.choices.push(Choice {
            need: job,
            visit,
            cost: quote.cost(),
        });
        self.all.push(Way {
            job,
            call,
            firm,
            day,
            quote,
            visit,
        });
    }
}

fn travel(firm: &Firm, port: PortCode) -> i64 {
    firm.travel(port).map_or(0, crate::time::Eur::cents)
}

fn planned(input: &Input, jobs: &[Job<'_>], made: &[Option<&Way<'_>>]) -> Vec<PlannedJob> {
    let mut at_visit: BTreeMap<usize, u32> = BTreeMap::new();
    for option in made.iter().flatten() {
        *at_visit.entry(option.visit).or_default() += 1;
    }
    let mut planned: Vec<PlannedJob> = made
        .iter()
        .flatten()
        .map(|option| planned_job(input, &jobs[option.job], option, at_visit[&option.visit]))
        .collect();
    planned.sort_by(|one, other| {
        (one.day, one.from, &one.needs).cmp(&(other.day, other.from, &other.needs))
    });
    planned
}

fn planned_job(input: &Input, job: &Job<'_>, option: &Way<'_>, jobs_there: u32) -> PlannedJob {
    let (firm, call, quote) = (&input.firms[option.firm], option.call, option.quote);
    let port = quote::port_of(call);
    let teams = jobs_there.div_ceil(firm.jobs_a_team_day);
    let kept = job.was(&call.id, &firm.id, option.day);
    PlannedJob {
        needs: job.ids(),
        vessel: job.vessel.id.clone(),
        call: call.id.clone(),
        port: call.port,
        port_name: port.name,
        firm: firm.id.clone(),
        day: option.day,
        from: quote.from,
        to: quote.to,
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
        travel_eur: euros(travel(firm, call.port)) * f64::from(teams) / f64::from(jobs_there),
        weighed: Weighed {
            risk_eur: euros(quote.risk),
            waiting_eur: euros(quote.waiting),
            late_eur: euros(quote.late),
            early_eur: euros(quote.early),
            changed_eur: euros(quote.changed),
        },
    }
}
