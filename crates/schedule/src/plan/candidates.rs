//! The candidates of each job, as an assignment problem.

use super::confirmed::Standing;
use super::jobs::Job;
use super::quote::{self, Quote};
use crate::calls::PortCall;
use crate::input::{Firm, Input};
use crate::ports::PortCode;
use crate::solve::{Choice, Problem, Visit};
use crate::time::Eur;
use chrono::NaiveDate;
use std::collections::BTreeMap;

/// Value of a confirmed job that holds, beyond its cost, in cents: ten million
/// euros.
const STANDS: i64 = 1_000_000_000;

/// One way to do one job.
pub(super) struct Way<'a> {
    pub(super) job: usize,
    pub(super) call: &'a PortCall,
    pub(super) firm: usize,
    pub(super) day: NaiveDate,
    pub(super) quote: Quote,
    pub(super) visit: usize,
}

/// All ways to do all jobs, and the assignment problem that they form.
pub(super) struct Options<'a> {
    pub(super) all: Vec<Way<'a>>,
    pub(super) problem: Problem,
    visits: BTreeMap<(usize, PortCode, NaiveDate), usize>,
    firm_days: BTreeMap<(usize, NaiveDate), usize>,
}

impl<'a> Options<'a> {
    pub(super) fn of(input: &'a Input, jobs: &[Job<'a>], standing: &[Standing<'a>]) -> Options<'a> {
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

/// Cost in cents of sending a team to a port.
pub(super) fn travel(firm: &Firm, port: PortCode) -> i64 {
    firm.travel(port).map_or(0, Eur::cents)
}
