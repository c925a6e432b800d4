//! The cost of a job by one crew on one day of one call, or the obstacles to
//! it.

use super::crews::{Crew, seconds_down, seconds_up};
use super::jobs::Job;
use crate::calls::PortCall;
use crate::input::{Firm, Input, JobState};
use crate::needs::Urgency;
use crate::ports::{self, Port};
use crate::solve::Window;
use crate::time::Instant;
use crate::zone::Zone;
use binnacle_compass::time::Timestamp;
use chrono::{Days, NaiveDate};

/// The most days counted, so that sums of money cannot overflow.
const MAX_DAYS: i64 = 3650;

/// An obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Obstacle {
    /// The flag does not accept the firm's adjusters.
    Flag,
    /// The firm lacks the licence that the operator asks for.
    Licence,
    /// The firm does not work that day.
    NotWorking,
    /// The firm needs more notice.
    LeadTime,
    /// The ship is not alongside long enough in the firm's hours.
    Stay,
    /// The day is after the due date.
    AfterDue,
    /// The firm declined.
    Declined,
}

/// The costs in cents, the hours within which the job is done, and its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quote {
    pub(super) window: Window,
    pub(super) length_s: i64,
    pub(super) chance_of_missing: f64,
    pub(super) late_days: i64,
    pub(super) fee: i64,
    pub(super) risk: i64,
    pub(super) waiting: i64,
    pub(super) late: i64,
    pub(super) early: i64,
    pub(super) changed: i64,
}

impl Quote {
    /// Returns all costs but the travel, which jobs may share.
    pub(super) fn cost(&self) -> i64 {
        self.fee + self.risk + self.waiting + self.late + self.early + self.changed
    }
}

/// Returns the instant of a second since 1970.
pub(super) fn instant(second: i64) -> Instant {
    let at = Timestamp::from_micros(second.saturating_mul(1_000_000));
    Instant(at.expect("hours of a call are years of this calendar"))
}

/// Returns the port of a call of a checked input.
pub(super) fn port_of(call: &PortCall) -> &'static Port {
    ports::find(call.port).expect("the ports of a checked input are in the table")
}

/// Returns the days of a call, from today on, in the port's time.
pub(super) fn days(call: &PortCall, now: Instant) -> impl Iterator<Item = NaiveDate> + use<> {
    let zone = port_of(call).zone;
    let first = call.eta.date(zone).max(now.date(zone));
    let last = call.etd.date(zone);
    std::iter::successors(Some(first), |day| day.checked_add_days(Days::new(1)))
        .take_while(move |day| *day <= last)
}

/// Returns the seconds of a job whose hours are not agreed yet.
pub(super) fn job_s(input: &Input) -> i64 {
    (input.weights.job_h * 3600.0).ceil() as i64
}

/// Returns the hours of a crew's day in a port.
pub(super) fn work_hours(crew: &Crew<'_>, day: NaiveDate, zone: Zone) -> Window {
    Window {
        from: seconds_up(Instant::at(day, crew.first_hour(), zone)),
        to: seconds_down(Instant::at(day, crew.last_hour(), zone)),
    }
}

/// Returns the part of some hours in which the ship is alongside.
pub(super) fn alongside(call: &PortCall, hours: Window) -> Window {
    Window {
        from: hours.from.max(seconds_up(call.eta)),
        to: hours.to.min(seconds_down(call.etd)),
    }
}

/// Returns a quote, or all obstacles; with an agreed beginning, that of the job at that
/// hour.
pub(super) fn quote(
    input: &Input,
    job: &Job<'_>,
    call: &PortCall,
    crew: &Crew<'_>,
    day: NaiveDate,
    agreed: Option<Instant>,
) -> Result<Quote, Vec<Obstacle>> {
    let firm = crew.firm;
    let agreed_s = agreed.and_then(|_| job.agreed_length_s());
    let length_s = agreed_s.unwrap_or_else(|| job_s(input));
    let zone = port_of(call).zone;
    let weights = &input.weights;
    let today = input.now.date(zone);
    let former = job
        .former
        .filter(|_| job.was_planned(&call.id, &firm.id, day))
        .map(|former| former.state);
    let confirmed = former == Some(JobState::Confirmed);
    // An agreed beginning holds whatever the crew's hours are.
    let work = match agreed.map(seconds_up) {
        Some(from) => Window {
            from,
            to: from + length_s,
        },
        None => work_hours(crew, day, zone),
    };
    // Notice counts only before a firm is asked.
    let ready = match former {
        Some(JobState::Offered | JobState::Confirmed) => input.now,
        Some(JobState::Proposed) | None => input.now.plus_hours(firm.lead_time_h),
    };
    let alongside = alongside(call, work);
    let window = Window {
        from: alongside.from.max(seconds_up(ready)),
        to: alongside.to,
    };
    let late_days = (day - job.due()).num_days().max(0);

    let mut obstacles = Vec::new();
    let mut unless = |fine: bool, obstacle| {
        if !fine {
            obstacles.push(obstacle);
        }
    };
    unless(firm.is_accepted_by(job.vessel.flag), Obstacle::Flag);
    let licence = job.vessel.licence.as_ref();
    unless(
        licence.is_none_or(|asked| crew.holds(asked)),
        Obstacle::Licence,
    );
    unless(crew.works(day), Obstacle::NotWorking);
    let in_hours = alongside.to - alongside.from >= length_s;
    unless(in_hours, Obstacle::Stay);
    unless(
        !in_hours || window.to - window.from >= length_s,
        Obstacle::LeadTime,
    );
    let overdue = job.may_be_any_day(today);
    let in_cap = |most: u32| late_days <= i64::from(most);
    let allowed = overdue || confirmed || weights.late_days.is_none_or(in_cap);
    unless(allowed, Obstacle::AfterDue);
    unless(
        !has_declined(input, job, call, firm, day),
        Obstacle::Declined,
    );
    if !obstacles.is_empty() {
        return Err(obstacles);
    }

    let urgency = job.urgency();
    let begins = instant(work.from.max(seconds_up(ready)));
    let chance_of_missing =
        call.chance_of_missing(begins, instant(work.to), length_s as f64 / 3600.0);
    let waits = (day - today).num_days().clamp(0, MAX_DAYS);
    let early_days = match urgency {
        Urgency::Routine | Urgency::Soon => (job.due() - day).num_days().clamp(0, MAX_DAYS),
        // No interval is known of which days could be lost.
        Urgency::Unknown | Urgency::Urgent | Urgency::Overdue => 0,
    };
    // Past lateness cannot be changed: only days to come count.
    let late_to_come = (day - job.due().max(today)).num_days().clamp(0, MAX_DAYS);
    // Being late at all costs as much as leaving undone a job that could be
    // done in time.
    let at_all = late_days > 0 && !overdue && weights.late_days.is_none();
    let late_at_all = i64::from(at_all) * weights.unmet_eur.weight(urgency).cents();
    let more = job.needs.iter().skip(1);
    let extra: i64 = more.map(|_| firm.extra_compass_eur.cents()).sum();
    Ok(Quote {
        window,
        length_s,
        chance_of_missing,
        late_days,
        fee: firm.fee_eur.cents() + extra,
        risk: (chance_of_missing * weights.missed_eur.weight(urgency).cents() as f64).round()
            as i64,
        waiting: waits * weights.waiting_eur_day.weight(urgency).cents(),
        late: late_to_come * weights.late_eur_day.cents() + late_at_all,
        early: early_days * weights.early_eur_day.cents(),
        changed: change_cost(input, job, call, firm, day, agreed),
    })
}

/// Returns the maximum cost of waiting for a job, without a fee: to the end of the
/// horizon, then late, and with a missed ship. An undone job costs this much
/// whatever the obstacles, so that no new obstacle makes a plan cheaper.
pub(super) fn max_waiting_cost(input: &Input, job: &Job<'_>) -> i64 {
    let (weights, urgency) = (&input.weights, job.urgency());
    let today = input.now.utc_date();
    let ends = today + Days::new(input.horizon_days.into());
    let days = |from: NaiveDate, to: NaiveDate| (to - from).num_days().clamp(0, MAX_DAYS);
    let early = match urgency {
        Urgency::Routine | Urgency::Soon => days(today, job.due()),
        Urgency::Unknown | Urgency::Urgent | Urgency::Overdue => 0,
    };
    let at_all = !job.may_be_any_day(today) && weights.late_days.is_none();
    let late = days(job.due().max(today), ends) * weights.late_eur_day.cents()
        + i64::from(at_all) * weights.unmet_eur.weight(urgency).cents();
    let waiting = days(today, ends) * weights.waiting_eur_day.weight(urgency).cents();
    let changed = job
        .former
        .map_or(0, |former| departure_cost(input, former.state));
    // A day is either early or late.
    let waits = (early * weights.early_eur_day.cents()).max(waiting + late);
    waits + weights.missed_eur.weight(urgency).cents() + changed
}

/// Returns the cost of departing from the previous plan.
fn change_cost(
    input: &Input,
    job: &Job<'_>,
    call: &PortCall,
    firm: &Firm,
    day: NaiveDate,
    agreed: Option<Instant>,
) -> i64 {
    let stays = job.was_planned(&call.id, &firm.id, day) && agreed == job.agreed_hour();
    match job.former {
        Some(former) if !stays => departure_cost(input, former.state),
        _ => 0,
    }
}

fn departure_cost(input: &Input, from: JobState) -> i64 {
    match from {
        JobState::Proposed => input.weights.changed_eur.cents(),
        // A confirmed job that moves has a cause, and none of these costs
        // applies.
        JobState::Offered | JobState::Confirmed => input.weights.withdrawn_eur.cents(),
    }
}

fn has_declined(
    input: &Input,
    job: &Job<'_>,
    call: &PortCall,
    firm: &Firm,
    day: NaiveDate,
) -> bool {
    input.declined.iter().any(|declined| {
        declined.firm == firm.id
            && declined.day.is_none_or(|only| only == day)
            && declined.call.as_ref().is_none_or(|only| *only == call.id)
            && job.needs.iter().any(|need| need.id == declined.need)
    })
}
