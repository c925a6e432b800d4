//! Reasons why a job could not be scheduled in time, and remedies.
//!
//! Invariants: each remedy is enough by itself, as far as this job is
//! concerned. A way with several obstacles is listed with all of them, and a
//! hopeless one is left out: hours that are over cannot be changed. There is
//! always one remedy.

use super::candidates::{Way, travel};
use super::capacity::Room;
use super::jobs::Job;
use super::quote::{self, Obstacle};
use super::remedies::{Help, Lacking};
use super::schedule::Unscheduled;
use crate::calls::PortCall;
use crate::input::{Firm, Input};
use chrono::NaiveDate;

/// The most lines of either list.
const MOST: usize = 8;

/// Returns all jobs that are not in the plan, or planned after their due date;
/// `unmet` is the cost of leaving each undone, in cents.
pub(super) fn unscheduled(
    input: &Input,
    jobs: &[Job<'_>],
    made: &[Option<&Way<'_>>],
    unmet: &[i64],
) -> Vec<Unscheduled> {
    let room = Room::of(input, jobs, made);
    let open = jobs.iter().zip(made).zip(unmet);
    let open = open.filter(|((job, way), _)| match way {
        None => true,
        Some(way) => way.quote.late_days > 0 && !job.is_overdue(input.now.utc_date()),
    });
    open.map(|((job, way), unmet)| {
        let mut found = Found {
            help: Help::new(input, job, &room, way.is_some()),
            because: Vec::new(),
            unmet: *unmet,
        };
        if let Some(way) = way {
            found.late(way);
        }
        found.look();
        Unscheduled {
            needs: job.ids(),
            vessel: job.vessel.id.clone(),
            due: job.due(),
            urgency: job.urgency(),
            reason: job.needs[0].reason.clone(),
            planned_late: way.is_some(),
            would_help: found.help.lines(MOST),
            because: found.because,
        }
    })
    .collect()
}

struct Found<'a> {
    help: Help<'a>,
    because: Vec<String>,
    unmet: i64,
}

impl Found<'_> {
    /// Explains a job that is planned late.
    fn late(&mut self, way: &Way<'_>) {
        let (late, due) = (way.quote.late_days, self.help.job.due());
        let days = if late == 1 { "day" } else { "days" };
        self.say(format!("planned {late} {days} after the due date, {due}"));
        self.help.extension(way.day);
    }

    fn look(&mut self) {
        let job = self.help.job;
        let overdue = job.is_overdue(self.help.input.now.utc_date());
        let in_time =
            |call: &&PortCall| overdue || call.eta.date(quote::port_of(call).zone) <= job.due();
        let has_one = job.calls.iter().any(in_time);
        if !has_one {
            self.say(match job.calls.first() {
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
            self.look_at_call(call);
        }
        if !has_one || self.help.is_empty() {
            self.help.another_call();
        }
    }

    fn look_at_call(&mut self, call: &PortCall) {
        let (input, port) = (self.help.input, quote::port_of(call));
        let mut serving = input.firms.iter();
        let serving: Vec<&Firm> = serving
            .by_ref()
            .filter(|firm| firm.travel(call.port).is_some())
            .collect();
        if serving.is_empty() {
            self.say(format!(
                "no firm serves {} ({}), call {}",
                port.name,
                call.port,
                call.called()
            ));
            self.help.a_firm_at(call);
        }
        for firm in serving {
            for day in quote::days(call, input.now) {
                // For a job that is planned late, other late days are no
                // remedy.
                if self.help.planned_late && day > self.help.job.due() {
                    continue;
                }
                self.look_at_day(call, firm, day);
            }
        }
    }

    fn look_at_day(&mut self, call: &PortCall, firm: &Firm, day: NaiveDate) {
        let (input, job) = (self.help.input, self.help.job);
        match quote::quote(input, job, call, firm, day) {
            Ok(quote) => {
                let travel = travel(firm, call.port);
                // A late job is done in time for less than it is worth.
                let too_dear = if self.help.planned_late {
                    self.help.too_dear(firm, call.port).unwrap_or(-1)
                } else {
                    quote.cost() + travel - self.unmet
                };
                self.nothing_but_others(firm, call, day, too_dear);
            }
            Err(obstacles) => {
                let is_late_only = obstacles == [Obstacle::AfterDue];
                for obstacle in &obstacles {
                    if *obstacle != Obstacle::AfterDue || is_late_only {
                        self.say(because(job, call, firm, day, *obstacle));
                    }
                }
                self.help.against(call, firm, day, &obstacles);
            }
        }
    }

    /// Explains a way without obstacles: the teams are taken, or the price is
    /// too high.
    fn nothing_but_others(&mut self, firm: &Firm, call: &PortCall, day: NaiveDate, too_dear: i64) {
        let (name, port) = (firm.called(), quote::port_of(call).name);
        let teams = self.help.room.lacking(firm, call.port, day);
        let others = self.help.room.others(firm, day);
        self.say(if teams > 0 && !others.is_empty() {
            format!("{name}'s teams of {day} go to {}", others.join(", "))
        } else if firm.teams == 0 {
            format!("{name} has no teams")
        } else if teams > 0 {
            format!("{name}'s teams of {day} are booked")
        } else if too_dear >= 0 {
            format!("{name} at {port} on {day} costs more than leaving it undone")
        } else {
            format!("{name} at {port} on {day} was not found in the time of the search")
        });
        let mut lacking = Lacking::default();
        lacking.teams(firm, port, day, teams);
        if too_dear >= 0 {
            lacking.price(firm, port, day, too_dear);
        }
        self.help.add(0, day, lacking);
    }

    fn say(&mut self, because: String) {
        if self.because.len() < MOST && !self.because.contains(&because) {
            self.because.push(because);
        }
    }
}

/// An obstacle as text.
fn because(
    job: &Job<'_>,
    call: &PortCall,
    firm: &Firm,
    day: NaiveDate,
    obstacle: Obstacle,
) -> String {
    let (name, port) = (firm.called(), quote::port_of(call).name);
    match obstacle {
        Obstacle::Flag => {
            let flag = job.vessel.flag_in_words();
            format!("{flag} does not accept {name}, which serves {port}")
        }
        Obstacle::Licence => {
            let licence = job.vessel.licence.as_deref().unwrap_or_default();
            format!("{name} at {port} lacks licence {licence}")
        }
        Obstacle::NotWorking => format!("{name} does not work on {}, {day}", day.format("%A")),
        Obstacle::LeadTime => {
            let lead_time_h = firm.lead_time_h;
            format!("{name} wants to be asked {lead_time_h} h ahead, too long for {day}")
        }
        Obstacle::Stay => {
            let call = call.called();
            format!("call {call} leaves {name} too few working hours on {day} at {port}")
        }
        Obstacle::AfterDue => {
            let (call, due) = (call.called(), job.due());
            format!("call {call} at {port} on {day} is after the due date, {due}")
        }
        Obstacle::Declined => format!("{name} declined"),
    }
}
