//! Changes from the previous plan, with their reasons.

use super::candidates::{Candidate, Candidates};
use super::confirmation::Confirmation;
use super::jobs::Job;
use super::quote;
use super::schedule::{Change, ChangeKind, Place};
use crate::input::{FormerJob, Input};
use crate::solve::Appointment;
use crate::time::euros;

/// Returns a change for each job of this plan or of the previous one.
pub(super) fn changes(
    input: &Input,
    jobs: &[Job<'_>],
    confirmations: &[Confirmation<'_>],
    candidates: &Candidates<'_>,
    made: &[Option<&Candidate<'_>>],
    hours: &[Option<Appointment>],
) -> Vec<Change> {
    let mut changes = Vec::new();
    for (at, job) in jobs.iter().enumerate() {
        let to = made[at].map(|candidate| Place {
            call: candidate.call.id.clone(),
            firm: input.firms[candidate.firm].id.clone(),
            day: candidate.day,
            hour: hours[at].map(|hour| quote::instant(hour.from)),
        });
        let from = job.former.map(|former| Place {
            call: former.call.clone(),
            firm: former.firm.clone(),
            day: former.day,
            hour: former.from,
        });
        let stays = from.as_ref().zip(to.as_ref()).is_some_and(|(from, to)| {
            let same = (&from.call, &from.firm, from.day) == (&to.call, &to.firm, to.day);
            same && job
                .agreed_hour()
                .is_none_or(|agreed| to.hour == Some(agreed))
        });
        let (what, why) = match (job.former, made[at]) {
            (None, None) => continue,
            (None, Some(_)) => (ChangeKind::New, job.needs[0].reason.clone()),
            (Some(_), Some(_)) if stays => (ChangeKind::Kept, reason_to_keep(&confirmations[at])),
            (Some(former), candidate) => {
                let what = if candidate.is_some() {
                    ChangeKind::Moved
                } else {
                    ChangeKind::Dropped
                };
                (
                    what,
                    reason_to_move(
                        input,
                        jobs,
                        &confirmations[at],
                        candidates,
                        former,
                        at,
                        candidate,
                        made,
                    ),
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
                hour: former.from,
            }),
            to: None,
            why: "no longer due within the horizon".to_owned(),
        });
    }
    changes
}

fn reason_to_keep(confirmation: &Confirmation<'_>) -> String {
    match confirmation {
        Confirmation::None => "still the best".to_owned(),
        Confirmation::Holds { .. } => "confirmed".to_owned(),
        Confirmation::Released { cause, .. } => format!("{cause}, and nothing better is available"),
    }
}

#[allow(
    clippy::too_many_arguments,
    reason = "each is a different thing that is known"
)]
fn reason_to_move(
    input: &Input,
    jobs: &[Job<'_>],
    confirmation: &Confirmation<'_>,
    candidates: &Candidates<'_>,
    former: &FormerJob,
    at: usize,
    candidate: Option<&Candidate<'_>>,
    made: &[Option<&Candidate<'_>>],
) -> String {
    if let Confirmation::Released { cause, .. } = confirmation {
        return cause.clone();
    }
    let job = &jobs[at];
    let Some(call) = job.calls.iter().find(|call| call.id == former.call) else {
        return format!("call {} is cancelled or over", former.call);
    };
    let old = candidates.all.iter().find(|old| {
        old.job == at && job.was_planned(&old.call.id, &input.firms[old.firm].id, old.day)
    });
    let Some(old) = old else {
        let firm = input.firms.iter().find(|firm| firm.id == former.firm);
        let declined = input.declined.iter().any(|declined| {
            declined.firm == former.firm && job.needs.iter().any(|need| need.id == declined.need)
        });
        let name = firm.map_or(former.firm.as_str(), |firm| firm.display_name());
        return if declined {
            format!("{name} declined")
        } else {
            let stay = format!("{} to {}", call.eta, call.etd);
            let port = quote::port_of(call).name;
            format!(
                "{name} on {} is no longer possible: call {} is at {port}, {stay}",
                former.day,
                call.display_name()
            )
        };
    };
    let others = made
        .iter()
        .flatten()
        .filter(|other| other.firm == old.firm && other.day == old.day);
    let names: Vec<&str> = others
        .map(|other| jobs[other.job].vessel.display_name())
        .collect();
    let teams = input.firms[old.firm].teams_on(old.day) as usize
        * input.firms[old.firm].jobs_a_team_day as usize;
    if teams == 0 {
        let firm = input.firms[old.firm].display_name();
        return format!("{firm}'s teams of {} are booked", old.day);
    }
    if names.len() >= teams {
        return format!("gives way to {}", names.join(", "));
    }
    match candidate {
        Some(candidate) => {
            let cost = |of: &Candidate<'_>| of.quote.cost() + candidates.travel(of);
            let saved = cost(old) - cost(candidate);
            if saved > 0 {
                format!(
                    "better by {:.2} euros, the cost of moving it included",
                    euros(saved)
                )
            } else {
                "improves the plan as a whole".to_owned()
            }
        }
        None => "makes room for jobs of greater weight".to_owned(),
    }
}
