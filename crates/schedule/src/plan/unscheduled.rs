//! Reasons why a job could not be scheduled in time, and remedies.
//!
//! Invariants: each remedy is enough by itself, as far as this job is
//! concerned. A candidate with several obstacles is listed with all of them, and a
//! hopeless one is left out: hours that are over cannot be changed. There is
//! always one remedy.

use super::candidates::{Candidate, travel};
use super::capacity::Capacity;
use super::jobs::Job;
use super::quote::{self, Obstacle};
use super::remedies::{Remedies, Remedy};
use super::schedule::Unscheduled;
use crate::calls::PortCall;
use crate::input::{Firm, Input};
use chrono::NaiveDate;

/// The most lines of either list.
const MAX_LINES: usize = 8;

/// Returns all jobs that are not in the plan, or planned after their due date;
/// `unmet` is the cost of leaving each undone, in cents.
pub(super) fn unscheduled(
    input: &Input,
    jobs: &[Job<'_>],
    made: &[Option<&Candidate<'_>>],
    unmet: &[i64],
) -> Vec<Unscheduled> {
    let capacity = Capacity::from_plan(input, jobs, made);
    let open = jobs.iter().zip(made).zip(unmet);
    let open = open.filter(|((job, candidate), _)| match candidate {
        None => true,
        Some(candidate) => candidate.quote.late_days > 0 && !job.is_overdue(input.now.utc_date()),
    });
    open.map(|((job, candidate), unmet)| {
        let mut explanation = Explanation {
            remedies: Remedies::new(input, job, &capacity, candidate.is_some()),
            because: Vec::new(),
            unmet: *unmet,
        };
        if let Some(candidate) = candidate {
            explanation.explain_late(candidate);
        }
        explanation.explain_calls();
        Unscheduled {
            needs: job.ids(),
            vessel: job.vessel.id.clone(),
            due: job.due(),
            urgency: job.urgency(),
            reason: job.needs[0].reason.clone(),
            planned_late: candidate.is_some(),
            would_help: explanation.remedies.lines(MAX_LINES),
            because: explanation.because,
        }
    })
    .collect()
}

struct Explanation<'a> {
    remedies: Remedies<'a>,
    because: Vec<String>,
    unmet: i64,
}

impl Explanation<'_> {
    /// Explains a job that is planned late.
    fn explain_late(&mut self, candidate: &Candidate<'_>) {
        let (late, due) = (candidate.quote.late_days, self.remedies.job.due());
        let days = if late == 1 { "day" } else { "days" };
        self.add_reason(format!("planned {late} {days} after the due date, {due}"));
        self.remedies.add_extension(candidate.day);
    }

    fn explain_calls(&mut self) {
        let job = self.remedies.job;
        let overdue = job.is_overdue(self.remedies.input.now.utc_date());
        let in_time =
            |call: &&PortCall| overdue || call.eta.date(quote::port_of(call).zone) <= job.due();
        let has_one = job.calls.iter().any(in_time);
        if !has_one {
            self.add_reason(match job.calls.first() {
                None => "no port call is known".to_owned(),
                Some(call) => format!(
                    "no port call before the due date, {}; the first is {} at {}",
                    job.due(),
                    call.eta,
                    quote::port_of(call).name
                ),
            });
        }
        for call in &job.calls {
            self.explain_call(call);
        }
        if !has_one || self.remedies.is_empty() {
            self.remedies.add_call();
        }
    }

    fn explain_call(&mut self, call: &PortCall) {
        let (input, port) = (self.remedies.input, quote::port_of(call));
        let mut serving = input.firms.iter();
        let serving: Vec<&Firm> = serving
            .by_ref()
            .filter(|firm| firm.travel(call.port).is_some())
            .collect();
        if serving.is_empty() {
            self.add_reason(format!(
                "no firm serves {} ({}), call {}",
                port.name,
                call.port,
                call.display_name()
            ));
            self.remedies.add_firm_at(call);
        }
        for firm in serving {
            for day in quote::days(call, input.now) {
                // For a job that is planned late, other late days are no
                // remedy.
                if self.remedies.planned_late && day > self.remedies.job.due() {
                    continue;
                }
                self.explain_day(call, firm, day);
            }
        }
    }

    fn explain_day(&mut self, call: &PortCall, firm: &Firm, day: NaiveDate) {
        let (input, job) = (self.remedies.input, self.remedies.job);
        match quote::quote(input, job, call, firm, day) {
            Ok(quote) => {
                let travel = travel(firm, call.port);
                // A late job is done in time for less than it is worth.
                let excess_price = if self.remedies.planned_late {
                    self.remedies.excess_price(firm, call.port).unwrap_or(-1)
                } else {
                    quote.cost() + travel - self.unmet
                };
                self.explain_capacity_or_price(firm, call, day, excess_price);
            }
            Err(obstacles) => {
                let is_late_only = obstacles == [Obstacle::AfterDue];
                for obstacle in &obstacles {
                    if *obstacle != Obstacle::AfterDue || is_late_only {
                        self.add_reason(describe_obstacle(job, call, firm, day, *obstacle));
                    }
                }
                self.remedies.overcome(call, firm, day, &obstacles);
            }
        }
    }

    /// Explains a way without obstacles: the teams are taken, or the price is
    /// too high.
    fn explain_capacity_or_price(
        &mut self,
        firm: &Firm,
        call: &PortCall,
        day: NaiveDate,
        excess_price: i64,
    ) {
        let (name, port) = (firm.display_name(), quote::port_of(call).name);
        let teams = self.remedies.capacity.missing_teams(firm, call.port, day);
        let others = self.remedies.capacity.ships_served(firm, day);
        self.add_reason(if teams > 0 && !others.is_empty() {
            format!("{name}'s teams of {day} go to {}", others.join(", "))
        } else if firm.teams == 0 {
            format!("{name} has no teams")
        } else if teams > 0 {
            format!("{name}'s teams of {day} are booked")
        } else if excess_price >= 0 {
            format!("{name} at {port} on {day} costs more than leaving it undone")
        } else {
            format!("{name} at {port} on {day} was not found within the search limit")
        });
        let mut remedy = Remedy::default();
        remedy.teams(firm, port, day, teams);
        if excess_price >= 0 {
            remedy.price(firm, port, day, excess_price);
        }
        self.remedies.add(0, day, remedy);
    }

    fn add_reason(&mut self, because: String) {
        if self.because.len() < MAX_LINES && !self.because.contains(&because) {
            self.because.push(because);
        }
    }
}

/// Returns an obstacle as text.
fn describe_obstacle(
    job: &Job<'_>,
    call: &PortCall,
    firm: &Firm,
    day: NaiveDate,
    obstacle: Obstacle,
) -> String {
    let (name, port) = (firm.display_name(), quote::port_of(call).name);
    match obstacle {
        Obstacle::Flag => {
            let flag = job.vessel.describe_flag();
            format!("{flag} does not accept {name}, which serves {port}")
        }
        Obstacle::Licence => {
            let licence = job.vessel.licence.as_deref().unwrap_or_default();
            format!("{name} at {port} lacks licence {licence}")
        }
        Obstacle::NotWorking => format!("{name} does not work on {}, {day}", day.format("%A")),
        Obstacle::LeadTime => {
            let lead_time_h = firm.lead_time_h;
            format!("{name} needs {lead_time_h} h notice, too long for {day}")
        }
        Obstacle::Stay => {
            let call = call.display_name();
            format!("call {call} leaves {name} too few working hours on {day} at {port}")
        }
        Obstacle::AfterDue => {
            let (call, due) = (call.display_name(), job.due());
            format!("call {call} at {port} on {day} is after the due date, {due}")
        }
        Obstacle::Declined => format!("{name} declined"),
    }
}
