//! The candidates of each job, as an assignment problem.

use super::confirmation::{Confirmation, Held};
use super::crews::{self, Crew};
use super::jobs::Job;
use super::quote::{self, Quote};
use crate::calls::PortCall;
use crate::input::{Firm, Input};
use crate::ports::PortCode;
use crate::solve::{Choice, CrewDay, Problem, Visit};
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
    pub(super) crew: usize,
    pub(super) day: NaiveDate,
    pub(super) quote: Quote,
    pub(super) visit: usize,
}

/// All candidates of all jobs, and the assignment problem that they form.
pub(super) struct Candidates<'a> {
    pub(super) all: Vec<Candidate<'a>>,
    pub(super) problem: Problem,
    /// Seconds of a job whose hours are not agreed yet.
    pub(super) job_s: i64,
    pub(super) crews: &'a [Crew<'a>],
    visits: BTreeMap<(usize, PortCode, NaiveDate), usize>,
    days: BTreeMap<(usize, NaiveDate), usize>,
}

impl<'a> Candidates<'a> {
    /// The crews, and no candidates yet.
    pub(super) fn new(input: &Input, crews: &'a [Crew<'a>]) -> Candidates<'a> {
        Candidates {
            all: Vec::new(),
            problem: Problem {
                job_s: quote::job_s(input),
                crews: crews.iter().map(Crew::numbers).collect(),
                ..Problem::default()
            },
            job_s: quote::job_s(input),
            crews,
            visits: BTreeMap::new(),
            days: BTreeMap::new(),
        }
    }

    pub(super) fn from_jobs(
        input: &'a Input,
        crews: &'a [Crew<'a>],
        jobs: &[Job<'a>],
        confirmations: &[Confirmation<'a>],
    ) -> Candidates<'a> {
        let mut candidates = Candidates::new(input, crews);
        let mut serving: BTreeMap<PortCode, Vec<usize>> = BTreeMap::new();
        for (at, crew) in crews.iter().enumerate() {
            for served in crew
                .firm
                .ports
                .iter()
                .filter(|served| crew.serves(served.port))
            {
                serving.entry(served.port).or_default().push(at);
            }
        }
        for (at, (job, confirmation)) in jobs.iter().zip(confirmations).enumerate() {
            let first = candidates.all.len();
            if let Confirmation::Holds(held) = confirmation {
                candidates.add_held(at, held);
                let own = candidates.all[first..].iter();
                let dearest = own
                    .map(|own| own.quote.cost() + candidates.travel(own))
                    .max();
                candidates
                    .problem
                    .unmet
                    .push(dearest.unwrap_or(0) + CONFIRMED_VALUE);
                continue;
            }
            let only_late =
                matches!(confirmation, Confirmation::Released { only_late, .. } if *only_late);
            for &call in &job.calls {
                for &crew in serving.get(&call.port).into_iter().flatten() {
                    for day in quote::days(call, input.now) {
                        candidates.add_day(input, job, at, call, crew, day, only_late);
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

    /// Adds the ways in which a confirmation can be kept.
    pub(super) fn add_held(&mut self, job: usize, held: &Held<'a>) {
        for (crew, quote) in &held.ways {
            self.add(job, held.call, *crew, held.day, *quote);
        }
    }

    /// Adds a job on a crew's day: at any hour, and at that which the firm was asked for.
    #[allow(
        clippy::too_many_arguments,
        reason = "each is a different thing that is known"
    )]
    fn add_day(
        &mut self,
        input: &Input,
        job: &Job<'a>,
        at: usize,
        call: &'a PortCall,
        crew: usize,
        day: NaiveDate,
        only_late: bool,
    ) {
        let of = &self.crews[crew];
        let was_planned = job.was_planned(&call.id, &of.firm.id, day);
        let agreed = job.agreed_hour().filter(|_| was_planned).map(Some);
        for hour in [None].into_iter().chain(agreed) {
            let Ok(quote) = quote::quote(input, job, call, of, day, hour) else {
                continue;
            };
            // A confirmed but late job may stay, or move to a day in time.
            let as_late = only_late && quote.late_days > 0;
            if !as_late || was_planned && hour == job.agreed_hour() {
                self.add(at, call, crew, day, quote);
            }
        }
    }

    fn add(&mut self, job: usize, call: &'a PortCall, crew: usize, day: NaiveDate, quote: Quote) {
        let of = &self.crews[crew];
        let problem = &mut self.problem;
        problem.job_s = problem.job_s.min(quote.length_s);
        let crew_day = *self.days.entry((crew, day)).or_insert_with(|| {
            problem.days.push(CrewDay {
                crew,
                date: crews::date(day),
                teams: of.teams().saturating_sub(of.booked(day)),
            });
            problem.days.len() - 1
        });
        let visit = *self
            .visits
            .entry((crew, call.port, day))
            .or_insert_with(|| {
                problem.visits.push(Visit {
                    day: crew_day,
                    place: of.place(call.port),
                    travel: travel(of.firm, call.port),
                });
                problem.visits.len() - 1
            });
        problem.choices.push(Choice {
            need: job,
            visit,
            cost: quote.cost(),
            window: quote.window,
            length_s: quote.length_s,
        });
        self.all.push(Candidate {
            job,
            call,
            firm: of.at,
            crew,
            day,
            quote,
            visit,
        });
    }

    /// Returns the travel of a team for a candidate alone, in cents.
    pub(super) fn travel(&self, candidate: &Candidate<'_>) -> i64 {
        self.problem.visits[candidate.visit].travel
    }
}

/// Returns the cost in cents of sending a team to a port.
pub(super) fn travel(firm: &Firm, port: PortCode) -> i64 {
    firm.travel(port).map_or(0, Eur::cents)
}
