//! Reasons why a job could not be scheduled in time, and remedies.
//!
//! Invariants: each remedy is enough by itself, as far as this job is
//! concerned. A candidate with several obstacles is listed with all of them, and a
//! hopeless one is left out: hours that are over cannot be changed. There is
//! always one remedy.

use super::candidates::{Candidate, Candidates, travel};
use super::capacity::{Capacity, Served};
use super::jobs::Job;
use super::quote::{self, Obstacle};
use super::remedies::{Remedies, Remedy};
use super::schedule::Unscheduled;
use crate::calls::PortCall;
use crate::input::{Firm, Input};
use crate::ports;
use crate::solve::Window;
use chrono::NaiveDate;

/// The most lines of either list.
const MAX_LINES: usize = 8;

/// Returns all jobs that are not in the plan, or planned after their due date.
pub(super) fn unscheduled(
    input: &Input,
    jobs: &[Job<'_>],
    candidates: &Candidates<'_>,
    assignment: &[Option<usize>],
) -> Vec<Unscheduled> {
    let capacity = Capacity::from_plan(candidates, jobs, assignment);
    let made = assignment
        .iter()
        .map(|choice| choice.map(|choice| &candidates.all[choice]));
    let open = jobs.iter().zip(made).zip(&candidates.problem.unmet);
    let open = open.filter(|((job, candidate), _)| match candidate {
        None => true,
        Some(candidate) => {
            candidate.quote.late_days > 0 && !job.may_be_any_day(input.now.utc_date())
        }
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
        let overdue = job.may_be_any_day(self.remedies.input.now.utc_date());
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

    /// Explains a firm's day by the crew that has the fewest obstacles.
    fn explain_day(&mut self, call: &PortCall, firm: &Firm, day: NaiveDate) {
        let (input, job) = (self.remedies.input, self.remedies.job);
        let crews = self.remedies.capacity.crews_of(firm);
        let quotes = crews
            .filter(|(_, crew)| crew.serves(call.port))
            .map(|(at, crew)| {
                let quote = quote::quote(input, job, call, crew, day, None);
                (quote.as_ref().err().map_or(0, Vec::len), at, quote)
            });
        let nearest = quotes.min_by_key(|(obstacles, at, _)| (*obstacles, *at));
        let Some((_, crew, nearest)) = nearest else {
            return;
        };
        match nearest {
            Ok(quote) => {
                let travel = travel(firm, call.port);
                // A late job is done in time for less than it is worth.
                let excess_price = if self.remedies.planned_late {
                    self.remedies.excess_price(firm, call.port).unwrap_or(-1)
                } else {
                    quote.cost() + travel - self.unmet
                };
                self.explain_capacity_or_price(crew, call, day, quote.window, excess_price);
            }
            Err(obstacles) => {
                let is_late_only = obstacles == [Obstacle::AfterDue];
                for obstacle in &obstacles {
                    if *obstacle != Obstacle::AfterDue || is_late_only {
                        self.add_reason(describe_obstacle(job, call, firm, day, *obstacle));
                    }
                }
                self.remedies.overcome(call, crew, day, &obstacles);
            }
        }
    }

    /// Explains a way without obstacles: the teams are taken, or the price is
    /// too high.
    fn explain_capacity_or_price(
        &mut self,
        at: usize,
        call: &PortCall,
        day: NaiveDate,
        window: Window,
        excess_price: i64,
    ) {
        let capacity = self.remedies.capacity;
        let crew = &capacity.candidates.crews[at];
        let (name, port) = (crew.firm.display_name(), quote::port_of(call).name);
        let teams = capacity.missing_teams(at, call.port, day, window);
        let others = capacity.ships_near(at, day);
        let today: Vec<&str> = others
            .iter()
            .filter(|other| other.day == day)
            .map(|other| other.ship)
            .collect();
        let jobs =
            (crew.teams().saturating_sub(crew.booked(day)) * crew.firm.jobs_a_team_day) as usize;
        let booked = crew.booked_jobs(day) as usize;
        self.add_reason(
            if teams > 0 && today.len() + booked >= jobs && !today.is_empty() {
                format!("{name}'s teams of {day} go to {}", today.join(", "))
            } else if crew.teams() == 0 {
                format!("{name} has no teams")
            } else if teams > 0 && booked >= jobs {
                format!("{name}'s teams of {day} are booked")
            } else if teams > 0 {
                self.describe_hours(call, name, window, &others)
            } else if excess_price >= 0 {
                format!("{name} at {port} on {day} costs more than leaving it undone")
            } else {
                format!("{name} at {port} on {day} was not found within the search limit")
            },
        );
        if teams > 0 {
            self.remedies
                .add_longer_stay(call, at, day, window, excess_price);
        }
        let mut remedy = Remedy::default();
        remedy.teams(crew.firm, port, day, teams);
        if excess_price >= 0 {
            remedy.price(crew.firm, port, day, excess_price);
        }
        self.remedies.add(0, day, remedy);
    }

    /// Returns why the hours of a day are not enough for teams that have jobs near it.
    fn describe_hours(
        &self,
        call: &PortCall,
        name: &str,
        window: Window,
        others: &[Served<'_>],
    ) -> String {
        let zone = quote::port_of(call).zone;
        let [from, to] = [window.from, window.to].map(|at| zone.local(quote::instant(at)));
        let job_h = self.remedies.input.weights.job_h;
        let own = format!(
            "{} can be served at {} from {} to {} only",
            self.remedies.job.vessel.display_name(),
            quote::port_of(call).name,
            from.format("%H:%M"),
            to.format("%H:%M on %Y-%m-%d"),
        );
        if others.is_empty() {
            return format!("{name}'s teams are booked at hours that leave no {job_h} h: {own}");
        }
        let others = others.iter().map(|other| {
            let port = ports::find(other.port).map_or("", |port| port.name);
            let zone = ports::zone(other.port);
            format!(
                "{} at {port} from {} to {}",
                other.ship,
                zone.local(other.from).format("%H:%M"),
                zone.local(other.to).format("%H:%M on %Y-%m-%d")
            )
        });
        format!(
            "{name}'s teams go to {}, and have no {job_h} h with the travel left: {own}",
            others.collect::<Vec<_>>().join(", ")
        )
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
