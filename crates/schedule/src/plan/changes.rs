//! Changes from the previous plan, with their reasons.

use super::candidates::{Options, Way};
use super::confirmed::Standing;
use super::jobs::Job;
use super::quote;
use super::schedule::{Change, ChangeKind, Place};
use crate::input::{FormerJob, Input};
use crate::time::euros;

/// Returns a change for each job of this plan or of the previous one.
pub(super) fn changes(
    input: &Input,
    jobs: &[Job<'_>],
    standing: &[Standing<'_>],
    options: &Options<'_>,
    made: &[Option<&Way<'_>>],
) -> Vec<Change> {
    let mut changes = Vec::new();
    for (at, job) in jobs.iter().enumerate() {
        let to = made[at].map(|way| Place {
            call: way.call.id.clone(),
            firm: input.firms[way.firm].id.clone(),
            day: way.day,
        });
        let from = job.former.map(|former| Place {
            call: former.call.clone(),
            firm: former.firm.clone(),
            day: former.day,
        });
        let (what, why) = match (job.former, made[at]) {
            (None, None) => continue,
            (None, Some(_)) => (ChangeKind::New, job.needs[0].reason.clone()),
            (Some(_), Some(_)) if from == to => (ChangeKind::Kept, kept(&standing[at])),
            (Some(former), way) => {
                let what = if way.is_some() {
                    ChangeKind::Moved
                } else {
                    ChangeKind::Dropped
                };
                (
                    what,
                    cause(input, jobs, &standing[at], options, former, at, way, made),
                )
            }
        };
        changes.push(Change {
            needs: job.ids(),
            what,
            from,
            to,
            why,
        });
    }
    let planned: Vec<&String> = jobs
        .iter()
        .flat_map(|job| &job.needs)
        .map(|need| &need.id)
        .collect();
    for former in &input.former {
        if former.needs.iter().any(|need| planned.contains(&need)) {
            continue;
        }
        changes.push(Change {
            needs: former.needs.clone(),
            what: ChangeKind::Dropped,
            from: Some(Place {
                call: former.call.clone(),
                firm: former.firm.clone(),
                day: former.day,
            }),
            to: None,
            why: "not due within the horizon any more".to_owned(),
        });
    }
    changes
}

fn kept(standing: &Standing<'_>) -> String {
    match standing {
        Standing::Open => "still the best".to_owned(),
        Standing::Stands { .. } => "confirmed".to_owned(),
        Standing::Loose { cause, .. } => format!("{cause}, and nothing better is to be had"),
    }
}

#[allow(
    clippy::too_many_arguments,
    reason = "each is a different thing that is known"
)]
fn cause(
    input: &Input,
    jobs: &[Job<'_>],
    standing: &Standing<'_>,
    options: &Options<'_>,
    former: &FormerJob,
    at: usize,
    way: Option<&Way<'_>>,
    made: &[Option<&Way<'_>>],
) -> String {
    if let Standing::Loose { cause, .. } = standing {
        return cause.clone();
    }
    let job = &jobs[at];
    let Some(call) = job.calls.iter().find(|call| call.id == former.call) else {
        return format!("call {} is cancelled or over", former.call);
    };
    let old = options
        .all
        .iter()
        .find(|old| old.job == at && job.was(&old.call.id, &input.firms[old.firm].id, old.day));
    let Some(old) = old else {
        let firm = input.firms.iter().find(|firm| firm.id == former.firm);
        let declined = input.declined.iter().any(|declined| {
            declined.firm == former.firm && job.needs.iter().any(|need| need.id == declined.need)
        });
        let name = firm.map_or(former.firm.as_str(), |firm| firm.called());
        return if declined {
            format!("{name} declined")
        } else {
            let stay = format!("{} to {}", call.eta, call.etd);
            let port = quote::port_of(call).name;
            format!(
                "{name} on {} is no longer possible: call {} is at {port}, {stay}",
                former.day,
                call.called()
            )
        };
    };
    let others = made
        .iter()
        .flatten()
        .filter(|other| other.firm == old.firm && other.day == old.day);
    let names: Vec<&str> = others
        .map(|other| jobs[other.job].vessel.called())
        .collect();
    let teams = input.firms[old.firm].teams_on(old.day) as usize
        * input.firms[old.firm].jobs_a_team_day as usize;
    if teams == 0 {
        let firm = input.firms[old.firm].called();
        return format!("{firm}'s teams of {} are booked", old.day);
    }
    if names.len() >= teams {
        return format!("gives way to {}", names.join(", "));
    }
    match way {
        Some(way) => {
            let travel = |way: &Way<'_>| options.problem.visits[way.visit].travel;
            let saved = old.quote.cost() + travel(old) - way.quote.cost() - travel(way);
            if saved > 0 {
                format!(
                    "better by {:.2} euros, the cost of moving it included",
                    euros(saved)
                )
            } else {
                "makes the whole plan better, for others' sake".to_owned()
            }
        }
        None => "makes room for others that weigh more".to_owned(),
    }
}
