//! Jobs that a plan starts from: agreed, pinned, or proposed by the previous plan.

use crate::needs::Need;
use crate::schedule::pins::Pin;
use crate::schedule::plan::Plan;
use binnacle_platform::ids::{CallId, CompassId, FirmId};
use binnacle_platform::time::Time;
use binnacle_schedule::input::{Firm, FormerJob, JobState};
use binnacle_schedule::time::Instant;
use chrono::NaiveDate;
use std::collections::BTreeSet;

/// Job that a plan starts from.
pub(super) struct StartingJob {
    pub(super) call: CallId,
    pub(super) firm: FirmId,
    pub(super) day: NaiveDate,
    /// Beginning, if it is agreed or fixed.
    pub(super) from: Option<Time>,
    /// End, if it is agreed.
    pub(super) to: Option<Time>,
    /// The firm's team, if it has a name.
    pub(super) team: Option<String>,
    pub(super) state: JobState,
}

impl StartingJob {
    /// Returns the job that a person fixed.
    pub(super) fn of_pin(pin: &Pin) -> StartingJob {
        StartingJob {
            call: pin.call_id,
            firm: pin.firm_id,
            day: pin.day,
            from: pin.from,
            to: None,
            team: None,
            state: JobState::Confirmed,
        }
    }
}

/// Jobs that a plan starts from, at most one for each compass.
pub(super) struct FormerJobs {
    needs: BTreeSet<CompassId>,
    firms: BTreeSet<String>,
    /// Compasses with a job.
    pub(super) with_job: BTreeSet<CompassId>,
    jobs: Vec<FormerJob>,
}

impl FormerJobs {
    pub(super) fn new(needs: &[Need], firms: &[Firm]) -> FormerJobs {
        FormerJobs {
            needs: needs.iter().map(|need| need.compass_id).collect(),
            firms: firms.iter().map(|firm| firm.id.clone()).collect(),
            with_job: BTreeSet::new(),
            jobs: Vec::new(),
        }
    }

    /// Returns whether the compass has a need and the firm is in the plan.
    pub(super) fn knows(&self, compass: &str, firm: &str) -> bool {
        let mut needs = self.needs.iter();
        needs.any(|need| need.to_string() == compass) && self.firms.contains(firm)
    }

    /// Adds a job for those compasses that have a need and no job yet; false when there are none.
    pub(super) fn add(&mut self, compasses: &[CompassId], job: StartingJob) -> bool {
        let firm = job.firm.to_string();
        if !self.firms.contains(&firm) {
            return false;
        }
        let open = compasses
            .iter()
            .filter(|one| self.needs.contains(one) && !self.with_job.contains(one));
        let needs: Vec<CompassId> = open.copied().collect();
        if needs.is_empty() {
            return false;
        }
        self.with_job.extend(needs.iter().copied());
        self.jobs.push(FormerJob {
            needs: needs.iter().map(CompassId::to_string).collect(),
            call: job.call.to_string(),
            firm,
            day: job.day,
            from: job.from.map(|at| Instant(at.0)),
            to: job.to.map(|at| Instant(at.0)),
            team: job.team,
            state: job.state,
        });
        true
    }

    /// Adds the jobs that the previous plan proposed.
    pub(super) fn add_proposed(&mut self, former: Option<&Plan>) {
        for job in former.iter().flat_map(|plan| &plan.jobs) {
            let compasses: Vec<CompassId> =
                job.compasses.iter().map(|one| one.compass_id).collect();
            // No firm knows of the hours that were proposed.
            let proposed = StartingJob {
                call: job.call_id,
                firm: job.firm_id,
                day: job.day,
                from: None,
                to: None,
                team: None,
                state: JobState::Proposed,
            };
            self.add(&compasses, proposed);
        }
    }

    /// Returns the jobs. Jobs at one call with the same firm, hours and state become one.
    pub(super) fn joined(&self) -> Vec<FormerJob> {
        let mut joined: Vec<FormerJob> = Vec::new();
        for job in &self.jobs {
            let alike = joined.iter_mut().find(|other| {
                let alike = |one: &FormerJob| (one.day, one.from, one.to, one.state);
                (&other.call, &other.firm) == (&job.call, &job.firm) && alike(other) == alike(job)
            });
            match alike {
                Some(other) => other.needs.extend(job.needs.iter().cloned()),
                None => joined.push(job.clone()),
            }
        }
        joined
    }
}
