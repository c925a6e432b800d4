//! Loading of a schedule's input from the database.
//!
//! Invariants: the requests for a schedule are read first, so that a change during loading leaves
//! a new request. Records are linked by id; sentences use names.

mod firms;
mod former;
mod names;
mod orders;

use super::plan::{LeftOut, Plan, UnderWay};
use super::{pins, store};
use crate::needs::{self, Facts, Need};
use crate::port_calls::{self, EarlierHeadings, StoredCall, heading_alongside};
use crate::schedule_settings;
use binnacle_compass::time::Timestamp;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::calls::PortCall;
use binnacle_schedule::input::{self, Declined, Input, Vessel};
use binnacle_schedule::time::Instant;
use firms::{book_teams, find_declined, load_firms};
use former::{FormerJobs, StartingJob};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use uuid::Uuid;

pub(super) use names::{Agreed, Names};
pub(super) use orders::OrderBesidePlan;

const HOUR_MICROS: i64 = 3_600_000_000;

/// Input of a schedule, with the names for its result.
pub(super) struct LoadedInput {
    pub(super) as_of: Time,
    pub(super) requests: Vec<(Uuid, Time)>,
    pub(super) former: Option<Plan>,
    pub(super) names: Names,
    pub(super) under_way: Vec<UnderWay>,
    pub(super) left_out: Vec<LeftOut>,
    /// Orders beside the plan that a firm has accepted.
    pub(super) orders_beside_plan: Vec<OrderBesidePlan>,
    /// Orders whose teams are left to the plan, and their firms.
    pub(super) teams_left_to_plan: BTreeMap<OrderId, FirmId>,
    /// True when there is a firm to plan with.
    pub(super) has_firms: bool,
    /// Input of the solver, as JSON.
    pub(super) text: String,
    /// SHA-256 of the input without the jobs that the previous plan proposed.
    pub(super) sha256: String,
}

/// Loads the input. The orders in `moved`, whose jobs the plan has moved, hold their teams.
pub(super) async fn load_input(
    app: &App,
    operator: OperatorId,
    moved: &BTreeSet<OrderId>,
) -> Result<LoadedInput> {
    let requests = store::list_requests(&app.db, operator).await?;
    let former = store::find_current(&app.db, operator).await?;
    let now: Time = app.clock.now().into();
    let as_of = start_of_hour(now)?;
    let settings = schedule_settings::find(&app.db, operator).await?;
    let facts = needs::load_facts(app, operator, None).await?;
    let mut names = Names::from_facts(&facts);

    let upcoming = port_calls::upcoming_of_fleet(&app.db, operator, now).await?;
    let (mut planned_with, left_out) = load_firms(app, operator, &mut names).await?;
    let orders = orders::list_under_way(&app.db, operator).await?;
    let beside = names.add_orders(&orders, &upcoming, &planned_with);
    let orders_beside_plan: Result<Vec<OrderBesidePlan>> = beside
        .iter()
        .filter_map(|(order, _)| order.beside_plan(&upcoming, &left_out).transpose())
        .collect();
    let busy: BTreeSet<CompassId> = beside.iter().map(|(order, _)| order.compass_id).collect();
    let today = as_of.0.to_chrono().date_naive();
    let needs: Vec<Need> = facts
        .iter()
        .filter(|facts| !busy.contains(&facts.compass_id))
        .filter_map(|facts| needs::find_need(facts, &settings.terms, today))
        .collect();

    let declinations = orders::list_declined(&app.db, operator).await?;
    let declinations = declinations.iter();
    let declinations: Vec<Declined> = declinations
        .filter_map(|one| find_declined(one, &upcoming))
        .collect();
    let port_calls = name_calls(app, operator, now, upcoming, &mut names).await?;
    let pins = pins::list(&app.db, operator).await?;
    let mut former_jobs = FormerJobs::new(&needs, &planned_with);
    for (compass, agreed) in &names.agreed {
        former_jobs.add(&[*compass], agreed.starting_job(&planned_with));
    }
    let known = declinations.into_iter();
    let known = known.filter(|one| former_jobs.knows(&one.need, &one.firm));
    let declined: Vec<Declined> = known.collect();
    for pin in &pins {
        let is_kept = former_jobs.add(&[pin.compass_id], StartingJob::of_pin(pin));
        if is_kept {
            names.pinned.insert(pin.compass_id);
        }
    }
    let planned = names.planned(&former_jobs);
    book_teams(app, operator, as_of, &planned, &mut planned_with).await?;
    let has_firms = !planned_with.is_empty();
    let mut input = Input {
        now: Instant(as_of.0),
        horizon_days: settings.horizon_days,
        vessels: vessels(&facts),
        needs: needs.iter().map(input_need).collect(),
        compasses: Vec::new(),
        port_calls,
        firms: planned_with,
        former: former_jobs.joined(),
        declined,
        weights: settings.weights,
        terms: settings.terms,
    };
    input::check_size(&input)
        .map_err(|error| Error::WrongState(format!("this fleet cannot be planned: {error}")))?;
    let sha256 = sha256_hex(&serde_json::to_string(&input)?);
    // The teams that moved orders hold follow from the plan: they are not in the hash.
    let mut held = planned;
    held.retain(|order, _| !moved.contains(order));
    book_teams(app, operator, as_of, &held, &mut input.firms).await?;
    former_jobs.add_proposed(former.as_ref());
    input.former = former_jobs.joined();
    Ok(LoadedInput {
        as_of,
        requests,
        former,
        under_way: names.under_way(beside),
        names,
        left_out,
        orders_beside_plan: orders_beside_plan?,
        teams_left_to_plan: held,
        has_firms,
        text: serde_json::to_string(&input)?,
        sha256,
    })
}

/// Returns the upcoming calls for the solver, with names and headings alongside.
async fn name_calls(
    app: &App,
    operator: OperatorId,
    now: Time,
    upcoming: Vec<StoredCall>,
    names: &mut Names,
) -> Result<Vec<PortCall>> {
    let earlier = EarlierHeadings::of_fleet(&app.db, operator, now).await?;
    let mut calls = Vec::new();
    for row in upcoming {
        let content = row.content()?;
        let mut call = content.to_schedule_call(&row.id.to_string(), &row.vessel_id.to_string());
        let day = row.eta.0.to_chrono().date_naive();
        call.name = Some(format!("{} {day}", content.port));
        let learnt = heading_alongside(&content, row.lay_heading_deg, &earlier);
        call.berth_heading_deg = learnt.map(|learnt| learnt.heading_deg);
        calls.push(call);
        names.calls.insert(row.id, row);
    }
    Ok(calls)
}

/// Returns the start of the current hour, so that requests within it share one input.
fn start_of_hour(now: Time) -> Result<Time> {
    let micros = now.0.micros().div_euclid(HOUR_MICROS) * HOUR_MICROS;
    let start = Timestamp::from_micros(micros).map_err(anyhow::Error::from)?;
    Ok(start.into())
}

fn vessels(facts: &[Facts]) -> Vec<Vessel> {
    let mut vessels: BTreeMap<VesselId, Vessel> = BTreeMap::new();
    for one in facts {
        vessels.entry(one.vessel_id).or_insert_with(|| Vessel {
            id: one.vessel_id.to_string(),
            name: Some(one.vessel_name.clone()),
            licence: one.licence.clone(),
            flag: one.ship.flag,
            gross_tonnage: one.ship.gross_tonnage,
            trade: one.ship.trade,
            deviation_record: one.ship.deviation_record,
            transits: one.ship.transits.clone(),
        });
    }
    vessels.into_values().collect()
}

fn input_need(need: &Need) -> input::Need {
    input::Need {
        id: need.compass_id.to_string(),
        vessel: need.vessel_id.to_string(),
        due: need.due_on,
        urgency: Some(need.urgency),
        reason: Some(need.reason.clone()),
    }
}

fn sha256_hex(text: &str) -> String {
    let mut hex = String::with_capacity(64);
    for byte in Sha256::digest(text.as_bytes()) {
        // Writing to a string cannot fail.
        let _ = write!(hex, "{byte:02x}");
    }
    hex
}
