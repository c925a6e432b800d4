//! Why a job could not be scheduled in time, and what would have helped.
//!
//! What would help is what stands alone: a firm's day against which there is one thing
//! only, or nothing but that others have its teams.

use super::Way;
use super::jobs::Job;
use super::quote::{self, Obstacle};
use super::schedule::Unscheduled;
use crate::calls::PortCall;
use crate::input::{Firm, Input};
use chrono::NaiveDate;
use std::collections::{BTreeMap, BTreeSet};

/// Lines of either list.
const MOST: usize = 8;

/// All jobs that are not in the plan, or there after their due date.
pub(super) fn unscheduled(
    input: &Input,
    jobs: &[Job<'_>],
    made: &[Option<&Way<'_>>],
) -> Vec<Unscheduled> {
    let mut taken: BTreeMap<(&str, NaiveDate), Vec<&str>> = BTreeMap::new();
    for way in made.iter().flatten() {
        let firm = input.firms[way.firm].id.as_str();
        taken
            .entry((firm, way.day))
            .or_default()
            .push(jobs[way.job].vessel.called());
    }
    let overdue = |job: &Job<'_>| job.is_overdue(input.now.utc_date());
    let open = jobs.iter().zip(made).filter(|(job, way)| match way {
        None => true,
        Some(way) => way.quote.late_days > 0 && !overdue(job),
    });
    open.map(|(job, way)| {
        let mut found = Found::default();
        if let Some(way) = way {
            found.late(job, way);
        }
        found.look(input, job, &taken);
        Unscheduled {
            needs: job.ids(),
            vessel: job.vessel.id.clone(),
            due: job.due(),
            urgency: job.urgency(),
            reason: job.needs[0].reason.clone(),
            planned_late: way.is_some(),
            would_help: found.help(),
            because: found.because,
        }
    })
    .collect()
}

#[derive(Default)]
struct Found {
    because: Vec<String>,
    /// By how near each is: what is only a question of teams first.
    near: BTreeSet<(u8, NaiveDate, String)>,
    planned_late: bool,
}

/// That a call somewhere would help. No ship makes one by the day that it is, or before.
fn called_in_time(input: &Input, job: &Job<'_>, place: &str) -> String {
    let today = input.now.utc_date();
    if job.due() <= today || job.is_overdue(today) {
        format!("as soon as she can call at {place}")
    } else {
        format!("a call by {} at {place}", job.due())
    }
}

impl Found {
    /// It is planned, and late.
    fn late(&mut self, job: &Job<'_>, way: &Way<'_>) {
        let (late, due, day) = (way.quote.late_days, job.due(), way.day);
        let days = if late == 1 { "day" } else { "days" };
        self.planned_late = true;
        self.say(format!("planned {late} {days} after the due date, {due}"));
        self.extension(job, day);
    }

    /// Who has set the due date may set another.
    fn extension(&mut self, job: &Job<'_>, day: NaiveDate) {
        let whose = match job.vessel.flag {
            Some(flag) => format!("flag {}", flag.letters()),
            None => "the flag".to_owned(),
        };
        let help = format!("an extension to {day}, asked of {whose} where its rules know one");
        self.near.insert((4, day, help));
    }

    fn look(
        &mut self,
        input: &Input,
        job: &Job<'_>,
        taken: &BTreeMap<(&str, NaiveDate), Vec<&str>>,
    ) {
        let in_time: Vec<&PortCall> = job
            .calls
            .iter()
            .filter(|call| {
                call.eta.date(quote::port_of(call).zone) <= job.due()
                    || job.is_overdue(input.now.utc_date())
            })
            .copied()
            .collect();
        if in_time.is_empty() {
            self.say(match job.calls.first() {
                None => "no port call is known".to_owned(),
                Some(call) => format!(
                    "no port call before the due date, {}; the first is {} at {}",
                    job.due(),
                    call.eta,
                    quote::port_of(call).name
                ),
            });
            let served: BTreeSet<String> = input
                .firms
                .iter()
                .filter(|firm| firm.is_accepted_by(job.vessel.flag))
                .flat_map(|firm| firm.ports.iter().map(|served| served.port.to_string()))
                .take(200)
                .collect();
            let ports: Vec<String> = served.into_iter().take(12).collect();
            let help = if ports.is_empty() {
                "a firm that the flag accepts: there is none".to_owned()
            } else {
                let ports = ports.join(", ");
                called_in_time(input, job, &format!("a port that a firm serves: {ports}"))
            };
            self.near.insert((3, job.due(), help));
        }
        for call in &job.calls {
            self.look_at_call(input, job, call, taken);
        }
    }

    fn look_at_call(
        &mut self,
        input: &Input,
        job: &Job<'_>,
        call: &PortCall,
        taken: &BTreeMap<(&str, NaiveDate), Vec<&str>>,
    ) {
        let port = quote::port_of(call);
        let serving: Vec<&Firm> = input
            .firms
            .iter()
            .filter(|firm| firm.travel(call.port).is_some())
            .collect();
        if serving.is_empty() {
            self.say(format!(
                "no firm serves {} ({}), call {}",
                port.name,
                call.port,
                call.called()
            ));
            let day = call.eta.date(port.zone);
            if day <= job.due() {
                let help = format!("a firm at {} ({}) on {day}", port.name, call.port);
                self.near.insert((2, day, help));
            }
        }
        for firm in serving {
            // Of what is planned late, other late days would help nobody.
            let (late, days) = (self.planned_late, quote::days(call, input.now));
            for day in days.filter(|day| !late || *day <= job.due()) {
                match quote::quote(input, job, call, firm, day) {
                    Ok(_) => self.taken(firm, call, day, taken),
                    Err(obstacles) => {
                        let come = format!("{}: {} could come", port.name, firm.called());
                        let in_time = called_in_time(input, job, &come);
                        self.obstacles(job, call, firm, day, &obstacles, &in_time);
                    }
                }
            }
        }
    }

    /// Nothing stands against it but other jobs, or its price.
    fn taken(
        &mut self,
        firm: &Firm,
        call: &PortCall,
        day: NaiveDate,
        taken: &BTreeMap<(&str, NaiveDate), Vec<&str>>,
    ) {
        let (name, port) = (firm.called(), quote::port_of(call).name);
        let Some(others) = taken.get(&(firm.id.as_str(), day)) else {
            if firm.teams == 0 {
                self.say(format!("{name} has no teams"));
            } else if firm.teams_on(day) == 0 {
                self.say(format!("{name}'s teams of {day} are booked"));
                let help = format!("one more team of {name} on {day}, at {port}");
                self.near.insert((0, day, help));
            } else {
                self.say(format!(
                    "{name} at {port} on {day} costs more than leaving it undone"
                ));
            }
            return;
        };
        self.say(format!(
            "{name}'s teams of {day} go to {}",
            others.join(", ")
        ));
        self.near.insert((
            0,
            day,
            format!("one more team of {name} on {day}, at {port}"),
        ));
    }

    fn obstacles(
        &mut self,
        job: &Job<'_>,
        call: &PortCall,
        firm: &Firm,
        day: NaiveDate,
        obstacles: &[Obstacle],
        in_time: &str,
    ) {
        let (name, port, due) = (firm.called(), quote::port_of(call).name, job.due());
        // What would help against days that are too late is about the due date.
        let about = if obstacles.contains(&Obstacle::AfterDue) {
            due
        } else {
            day
        };
        let only = |help: String| (obstacles.len() == 1).then_some((1, about, help));
        let licence = job.vessel.licence.as_deref().unwrap_or_default();
        let flag = job.vessel.flag_in_words();
        for obstacle in obstacles {
            let (because, help) = match obstacle {
                Obstacle::Flag => (
                    format!("{flag} does not accept {name}, which serves {port}"),
                    format!("{flag} accepting {name}, at {port} on {day}"),
                ),
                Obstacle::Licence => (
                    format!("{name} at {port} lacks licence {licence}"),
                    format!("{name} holding licence {licence}, at {port} on {day}"),
                ),
                Obstacle::NotWorking => (
                    format!("{name} does not work on {}, {day}", day.format("%A")),
                    format!("{name} working at {port} on {}, {day}", day.format("%A")),
                ),
                Obstacle::LeadTime => (
                    format!(
                        "{name} wants to be asked {} h ahead, too long for {day}",
                        firm.lead_time_h
                    ),
                    format!(
                        "{name}, or another firm, coming to {port} at shorter notice than {} h, \
                         on {day}",
                        firm.lead_time_h
                    ),
                ),
                Obstacle::Stay => (
                    format!(
                        "call {} leaves {name} too few working hours on {day} at {port}",
                        call.called()
                    ),
                    format!("a longer stay at {port} on {day}, for {name}"),
                ),
                Obstacle::AfterDue => (
                    format!(
                        "call {} at {port} on {day} is after the due date, {due}",
                        call.called()
                    ),
                    in_time.to_owned(),
                ),
                Obstacle::Declined => (
                    format!("{name} declined"),
                    format!("{name} accepting after all, at {port} on {day}"),
                ),
            };
            if *obstacle != Obstacle::AfterDue || obstacles.len() == 1 {
                self.say(because);
            }
            self.near.extend(only(help));
            if *obstacle == Obstacle::AfterDue && obstacles.len() == 1 {
                self.extension(job, day);
            }
        }
    }

    fn say(&mut self, because: String) {
        if self.because.len() < MOST && !self.because.contains(&because) {
            self.because.push(because);
        }
    }

    fn help(&self) -> Vec<String> {
        self.near
            .iter()
            .map(|(_, _, help)| help.clone())
            .take(MOST)
            .collect()
    }
}
