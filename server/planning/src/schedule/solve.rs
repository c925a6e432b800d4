//! Making of a plan: input loaded, solved on a blocking thread without a transaction, stored.
//!
//! Invariants: a plan is stored as the next version after the one in its input, or not at all. Of
//! two concurrent solvers the second loads and solves again.

use super::at_risk::{add_orders_beside_plan, find_jobs_at_risk};
use super::concurrency::{PlanLock, PlanSlots};
use super::input::{Agreed, LoadedInput, Names, load_input};
use super::plan::{Against, Change, Compass, Job, Later, Place, Plan, Unscheduled};
use super::store;
use crate::event_kinds;
use anyhow::Context;
use binnacle_fleet::alerts;
use binnacle_orders::dispatch;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::events;
use binnacle_platform::ids::{CallId, CompassId, FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::input::{JobState, read};
use binnacle_schedule::plan::{self as solved, ChangeKind, Schedule, plan};
use binnacle_schedule::ports::{self, PortCode};
use binnacle_schedule::time::Instant;
use chrono::SecondsFormat;
use metrics::histogram;
use std::collections::{BTreeMap, BTreeSet};
use std::str::FromStr;
use std::sync::Arc;
use tracing::info;
use uuid::Uuid;

/// Attempts to store a plan before giving up to concurrent solvers.
const MAX_ATTEMPTS: usize = 5;

/// Makes a new plan for the operator, or returns the current one if nothing has changed.
/// Concurrent requests wait for the operator's lock and take no slot from other operators.
pub(super) async fn solve(
    app: &App,
    request: &RequestContext,
    slots: &PlanSlots,
    operator: OperatorId,
) -> Result<Plan> {
    let lock = slots.lock_of(operator).await;
    solve_locked(app, Some(request), slots, operator, Arc::new(lock)).await
}

/// Makes a new plan for the operator, unless another task is making one.
pub(super) async fn solve_unless_busy(
    app: &App,
    slots: &PlanSlots,
    operator: OperatorId,
) -> Result<Option<Plan>> {
    match slots.try_lock_of(operator) {
        Some(lock) => solve_locked(app, None, slots, operator, Arc::new(lock))
            .await
            .map(Some),
        None => Ok(None),
    }
}

async fn solve_locked(
    app: &App,
    request: Option<&RequestContext>,
    slots: &PlanSlots,
    operator: OperatorId,
    lock: Arc<PlanLock>,
) -> Result<Plan> {
    for _ in 0..MAX_ATTEMPTS {
        let loaded = load_input(app, operator, &BTreeSet::new()).await?;
        if let Some(former) = &loaded.former
            && former.input_sha256 == loaded.sha256
        {
            let former = former.clone();
            finish_requests(begin_transaction(app, request).await?, operator, &loaded).await?;
            return Ok(former);
        }
        let begun = std::time::Instant::now();
        let (schedule, loaded) = solve_with_held_teams(app, slots, operator, loaded, &lock).await?;
        let took_s = begun.elapsed().as_secs_f64();
        histogram!("binnacle_schedule_seconds").record(took_s);
        let plan = build_plan(schedule, &loaded, app.clock.now().into(), took_s)?;
        let tx = begin_transaction(app, request).await?;
        if store_plan(app, tx, operator, &plan, &loaded).await? {
            info!(%operator, version = plan.version, took_s, gap_percent = plan.gap_percent,
                  "schedule made");
            return Ok(plan);
        }
    }
    Err(Error::WrongState(
        "the schedule is being made by others; try again".to_owned(),
    ))
}

/// Begins a transaction, which carries the audit line of the request that asks for the plan.
async fn begin_transaction(app: &App, request: Option<&RequestContext>) -> Result<Tx> {
    Ok(match request {
        Some(request) => request.begin().await?,
        None => app.db.begin().await?,
    })
}

/// Solves until every order whose job has moved still holds its team, which it does until it is
/// cancelled. Returns the schedule and its input.
async fn solve_with_held_teams(
    app: &App,
    slots: &PlanSlots,
    operator: OperatorId,
    mut loaded: LoadedInput,
    lock: &Arc<PlanLock>,
) -> Result<(Schedule, LoadedInput)> {
    let mut moved = BTreeSet::new();
    let mut schedule = run_solver(slots, loaded.text.clone(), lock).await?;
    loop {
        let more = orders_moved_away(&schedule, &loaded)?;
        if more.is_empty() {
            return Ok((schedule, loaded));
        }
        moved.extend(more);
        loaded = load_input(app, operator, &moved).await?;
        let mut next = run_solver(slots, loaded.text.clone(), lock).await?;
        // The reason of a move is the first one, not the team that its own order holds now.
        for change in &mut next.changes {
            let mut known = schedule.changes.iter();
            let known = known.find(|known| {
                (&known.needs, &known.from, &known.to) == (&change.needs, &change.from, &change.to)
            });
            if let Some(known) = known {
                change.why.clone_from(&known.why);
            }
        }
        schedule = next;
    }
}

/// Returns the orders whose compass the plan has with another firm or at another hour.
fn orders_moved_away(schedule: &Schedule, loaded: &LoadedInput) -> Result<Vec<OrderId>> {
    let mut planned = BTreeMap::new();
    for job in &schedule.jobs {
        for need in &job.needs {
            planned.insert(
                CompassId(parse_id(need)?),
                (FirmId(parse_id(&job.firm)?), Time(job.from.0)),
            );
        }
    }
    let agreed = loaded.names.agreed.iter();
    let moved = agreed
        .filter(|(_, agreed)| loaded.teams_left_to_plan.contains_key(&agreed.order_id))
        .filter(|(compass, agreed)| {
            planned.get(*compass) != Some(&(agreed.firm_id, agreed.hours.from))
        });
    Ok(moved.map(|(_, agreed)| agreed.order_id).collect())
}

/// Deletes the requests in the input, which need no new plan.
pub(super) async fn finish_requests(
    mut tx: Tx,
    operator: OperatorId,
    loaded: &LoadedInput,
) -> Result<()> {
    store::delete_requests(&mut tx, operator, &loaded.requests).await?;
    tx.commit().await?;
    Ok(())
}

async fn run_solver(slots: &PlanSlots, text: String, lock: &Arc<PlanLock>) -> Result<Schedule> {
    let slot = slots.acquire().await?;
    // The solver of an abandoned request keeps the lock until it ends.
    let lock = Arc::clone(lock);
    let done = tokio::task::spawn_blocking(move || {
        let checked = read(&text).context("the loaded input is invalid")?;
        let schedule = plan(&checked);
        drop((slot, lock));
        anyhow::Ok(schedule)
    });
    Ok(done.await??)
}

/// Stores a plan with its alerts and events; false when another solver was faster.
async fn store_plan(
    app: &App,
    mut tx: Tx,
    operator: OperatorId,
    plan: &Plan,
    loaded: &LoadedInput,
) -> Result<bool> {
    if !store::insert(&mut tx, operator, plan, &loaded.text).await? {
        return Ok(false);
    }
    store::delete_requests(&mut tx, operator, &loaded.requests).await?;
    for agreed in loaded.names.agreed.values() {
        let (vessel, order, call) = (agreed.vessel_id, agreed.order_id, agreed.call_id);
        dispatch::link_once(&mut tx, vessel, order, call).await?;
    }
    let mut at_risk = find_jobs_at_risk(plan, &loaded.names);
    let unknown = add_orders_beside_plan(plan, loaded, &mut at_risk);
    let mut pending =
        alerts::reconcile_jobs_at_risk(&mut tx, operator, &at_risk, &unknown, plan.solved_at)
            .await?;
    for vessel in plan.changed_vessels() {
        let kind = event_kinds::SCHEDULE;
        pending.push(events::insert(&mut tx, vessel, kind, plan.solved_at).await?);
    }
    tx.commit().await?;
    for event in pending {
        app.publish(event);
    }
    Ok(true)
}

/// Builds the plan from the solver's result, with names.
fn build_plan(schedule: Schedule, loaded: &LoadedInput, now: Time, took_s: f64) -> Result<Plan> {
    let names = &loaded.names;
    let former = loaded.former.as_ref();
    let jobs: Result<Vec<Job>> = schedule
        .jobs
        .into_iter()
        .map(|one| build_job(one, names))
        .collect();
    let jobs = jobs?;
    let changes: Result<Vec<Change>> = schedule
        .changes
        .into_iter()
        .map(|one| build_change(one, names, &jobs, former))
        .collect();
    let changes = changes?;
    let unscheduled = schedule.unscheduled.into_iter().map(|one| {
        let compasses = name_compasses(&one.needs, names)?;
        let (vessel_id, vessel_name) = find_vessel(&compasses, names);
        Ok(Unscheduled {
            orders: orders_of(&compasses, names, |_| !one.planned_late),
            vessel_id,
            vessel_name,
            compasses,
            due_on: one.due,
            urgency: one.urgency,
            reason: one.reason,
            planned_late: one.planned_late,
            because: one.because,
            would_help: one.would_help,
        })
    });
    let unscheduled: Result<Vec<Unscheduled>> = unscheduled.collect();
    let later = schedule.later.into_iter().map(|one| {
        let compass = names.compass(CompassId(parse_id(&one.need)?));
        let (vessel_id, vessel_name) = find_vessel(std::slice::from_ref(&compass), names);
        Ok(Later {
            vessel_id,
            vessel_name,
            compass,
            due_on: one.due,
            reason: one.reason,
        })
    });
    let later: Result<Vec<Later>> = later.collect();
    let moved = changes
        .iter()
        .filter(|change| matches!(change.what, ChangeKind::Moved | ChangeKind::Dropped));
    let against = former.map(|former| Against {
        version: former.version,
        cost_eur: round_cents(schedule.cost_eur - former.cost_eur),
        paid_eur: round_cents(schedule.paid_eur - former.paid_eur),
        moved: moved.count(),
    });
    Ok(Plan {
        version: former.map_or(0, |former| former.version) + 1,
        solved_at: now,
        as_of: loaded.as_of,
        solved_in_s: round_cents(took_s),
        input_sha256: loaded.sha256.clone(),
        cost_eur: schedule.cost_eur,
        bound_eur: schedule.bound_eur,
        gap_percent: schedule.gap_percent,
        proven_optimal: schedule.proven_optimal,
        paid_eur: schedule.paid_eur,
        against,
        jobs,
        unscheduled: unscheduled?,
        changes,
        later: later?,
        under_way: loaded.under_way.clone(),
        left_out: loaded.left_out.clone(),
    })
}

fn build_job(one: solved::PlannedJob, names: &Names) -> Result<Job> {
    let compasses = name_compasses(&one.needs, names)?;
    let (vessel_id, vessel_name) = find_vessel(&compasses, names);
    let (call_id, firm_id) = (CallId(parse_id(&one.call)?), FirmId(parse_id(&one.firm)?));
    let here = |agreed: &Agreed| {
        let is_then = agreed.hours.from.0 == one.from.0;
        (agreed.call_id, agreed.firm_id) == (call_id, firm_id) && is_then
    };
    let pinned = compasses
        .iter()
        .any(|compass| names.pinned.contains(&compass.compass_id));
    Ok(Job {
        vessel_id,
        vessel_name,
        call_id,
        port: one.port.to_string(),
        port_name: one.port_name.to_owned(),
        berth: names
            .calls
            .get(&call_id)
            .and_then(|call| call.berth.clone()),
        berth_heading: one.berth_heading,
        firm_id,
        firm_name: names.firm_name(firm_id),
        day: one.day,
        from: Time(one.from.0),
        to: Time(one.to.0),
        from_local: local_time(one.port, one.from),
        to_local: local_time(one.port, one.to),
        team: one.team,
        // The solver holds a pinned job like a confirmed one; no firm has agreed to it.
        state: match one.state {
            JobState::Confirmed if pinned => JobState::Proposed,
            state => state,
        },
        pinned: pinned && one.state == JobState::Confirmed,
        orders: orders_of(&compasses, names, here),
        instead_of: orders_of(&compasses, names, |agreed| !here(agreed))
            .into_iter()
            .chain(
                compasses
                    .iter()
                    .filter_map(|one| names.declined.get(&one.compass_id).copied()),
            )
            .collect(),
        due_on: one.due,
        urgency: one.urgency,
        reason: one.reason,
        late_days: one.late_days,
        chance_of_missing: one.chance_of_missing,
        fee_eur: one.fee_eur,
        travel_eur: round_cents(one.travel_eur),
        weighed: one.weighed,
        compasses,
    })
}

fn orders_of(
    compasses: &[Compass],
    names: &Names,
    which: impl Fn(&Agreed) -> bool,
) -> Vec<OrderId> {
    let agreed = compasses
        .iter()
        .filter_map(|one| names.agreed.get(&one.compass_id));
    agreed
        .filter(|agreed| which(agreed))
        .map(|agreed| agreed.order_id)
        .collect()
}

fn build_change(
    one: solved::Change,
    names: &Names,
    jobs: &[Job],
    former: Option<&Plan>,
) -> Result<Change> {
    let compasses = name_compasses(&one.needs, names)?;
    let (vessel_id, vessel_name) = find_vessel(&compasses, names);
    let first = compasses.first().map(|compass| compass.compass_id);
    let before = first.and_then(|first| former?.job_of(first));
    let after = first.and_then(|first| jobs.iter().find(|job| job.is_for(first)));
    // A cancelled call has its name in the previous plan only.
    let why = match (&one.from, before) {
        (Some(place), Some(job)) => one
            .why
            .replace(&place.call, &format!("at {}", job.port_name)),
        _ => one.why,
    };
    let from = one.from.map(|at| build_place(&at, names, before));
    let to = one.to.map(|at| build_place(&at, names, after));
    Ok(Change {
        vessel_id,
        vessel_name,
        compasses,
        what: one.what,
        from: from.transpose()?,
        to: to.transpose()?,
        why,
    })
}

fn build_place(at: &solved::Place, names: &Names, job: Option<&Job>) -> Result<Place> {
    let (call_id, firm_id) = (CallId(parse_id(&at.call)?), FirmId(parse_id(&at.firm)?));
    let job = job.filter(|job| (job.call_id, job.firm_id) == (call_id, firm_id));
    let known = names.calls.get(&call_id).map(|call| call.port.as_str());
    let port = known.or(job.map(|job| job.port.as_str()));
    let found = port.and_then(|port| ports::PortCode::parse(port).ok());
    Ok(Place {
        call_id,
        port_name: found
            .and_then(ports::find)
            .map_or("", |port| port.name)
            .to_owned(),
        firm_id,
        firm_name: names.firm_name(firm_id),
        day: at.day,
        from: at.hour.map(|hour| Time(hour.0)),
        paid_eur: job
            .filter(|job| job.day == at.day)
            .map(|job| round_cents(job.fee_eur + job.travel_eur)),
    })
}

/// Writes an instant in a port's legal time, with its offset.
fn local_time(port: PortCode, at: Instant) -> String {
    let there = at.in_zone(ports::zone(port));
    there.to_rfc3339_opts(SecondsFormat::Secs, false)
}

fn name_compasses(needs: &[String], names: &Names) -> Result<Vec<Compass>> {
    let named = needs
        .iter()
        .map(|need| Ok(names.compass(CompassId(parse_id(need)?))));
    named.collect()
}

fn find_vessel(compasses: &[Compass], names: &Names) -> (VesselId, String) {
    let first = compasses.first();
    let known = first.and_then(|first| names.compasses.get(&first.compass_id));
    known.map_or_else(
        || (VesselId(Uuid::nil()), String::new()),
        |(id, name, _)| (*id, name.clone()),
    )
}

fn parse_id(text: &str) -> Result<Uuid> {
    Ok(Uuid::from_str(text).context("an id in the schedule")?)
}

fn round_cents(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}
