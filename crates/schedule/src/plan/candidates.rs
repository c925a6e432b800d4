//! The candidates of each job, as an assignment problem.

use super::confirmed::Confirmation;
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
const CONFIRMED_VALUE: i64 = 1_000_000_000;

/// One way to do one job.
pub(super) struct Candidate<'a> {
    pub(super) job: usize,
    pub(super) call: &'a PortCall,
    pub(super) firm: usize,
    pub(super) day: NaiveDate,
    pub(super) quote: Quote,
    pub(super) visit: usize,
}

/// All candidates of all jobs, and the assignment problem that they form.
pub(super) struct Candidates<'a> {
    pub(super) all: Vec<Candidate<'a>>,
    pub(super) problem: Problem,
    visits: BTreeMap<(usize, PortCode, NaiveDate), usize>,
    firm_days: BTreeMap<(usize, NaiveDate), usize>,
}

impl<'a> Candidates<'a> {
    pub(super) fn from_jobs(
        input: &'a Input,
        jobs: &[Job<'a>],
        confirmations: &[Confirmation<'a>],
    ) -> Candidates<'a> {
        let mut candidates = Candidates {
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
        for (at, (job, confirmation)) in jobs.iter().zip(confirmations).enumerate() {
            if let Confirmation::Holds {
                call,
                firm,
                day,
                quote,
            } = confirmation
            {
                let travel = travel(&input.firms[*firm], call.port);
                candidates
                    .problem
                    .unmet
                    .push(quote.cost() + travel + CONFIRMED_VALUE);
                candidates.add(input, at, call, *firm, *day, *quote);
                continue;
            }
            let first = candidates.all.len();
            let only_late =
                matches!(confirmation, Confirmation::Released { only_late, .. } if *only_late);
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
                        if !as_late || job.was_planned(&call.id, &of.id, day) {
                            candidates.add(input, at, call, firm, day, quote);
                        }
                    }
                }
            }
            // An undone job waits longer than with any of its candidates. So waiting
            // never favours leaving it undone; only a fee with its travel can.
            let own = candidates.all[first..].iter();
            let without_fees = own.map(|candidate| candidate.quote.cost() - candidate.quote.fee);
            let waits = without_fees.fold(quote::max_waiting_cost(input, job), i64::max);
            let unmet = input.weights.unmet_eur.weight(job.urgency()).cents();
            candidates.problem.unmet.push(unmet + waits);
        }
        candidates
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
        self.all.push(Candidate {
            job,
            call,
            firm,
            day,
            quote,
            visit,
        });
    }
}

/// Returns the cost in cents of sending a team to a port.
pub(super) fn travel(firm: &Firm, port: PortCode) -> i64 {
    firm.travel(port).map_or(0, Eur::cents)
}
