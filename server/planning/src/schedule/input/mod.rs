//! Loading of a schedule's input from the database.
//!
//! What always holds: the requests for a schedule are read first, so that a change made while the
//! rest is read leaves a new request. Records are linked by id; sentences use names.

mod firms;
mod former;
mod names;
mod orders;

use super::plan::{LeftOut, Plan, UnderWay};
use super::{pins, store};
use crate::needs::{self, Facts, Need};
use crate::port_calls::{self, Earlier, heading};
use crate::schedule_settings;
use binnacle_compass::time::Timestamp;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, FirmId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use binnacle_schedule::input::{self, Declined, Input, JobState, Vessel};
use binnacle_schedule::time::Instant;
use firms::{book, declined, firms_of};
use former::Former;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use uuid::Uuid;

pub(super) use names::{Agreed, Names};
pub(super) use orders::Aside;

const HOUR_MICROS: i64 = 3_600_000_000;

/// Everything that a schedule is made from, and everybody's names.
pub(super) struct Gathered {
    pub(super) as_of: Time,
    pub(super) asks: Vec<(Uuid, Time)>,
    pub(super) former: Option<Plan>,
    pub(super) names: Names,
    pub(super) under_way: Vec<UnderWay>,
    pub(super) left_out: Vec<LeftOut>,
    /// Orders that a firm has accepted and that are beside the plan.
    pub(super) aside: Vec<Aside>,
    /// Orders whose teams are left to the plan, which has their jobs with these firms.
    pub(super) held: BTreeMap<OrderId, FirmId>,
    /// Whether there is any firm to plan with.
    pub(super) has_firms: bool,
    /// As the solver reads it.
    pub(super) text: String,
    /// SHA-256 of it, but for what the plan before proposed: that only says what was best.
    pub(super) sha256: String,
}

/// Gathers it. Orders that the plan has moved their jobs away from hold their teams.
pub(super) async fn load_input(
    app: &App,
    operator: OperatorId,
    moved: &BTreeSet<OrderId>,
) -> Result<Gathered> {
    let asks = store::asks(&app.db, operator).await?;
    let former = store::current(&app.db, operator).await?;
    let now: Time = app.clock.now().into();
    let as_of = begun_hour(now)?;
    let settings = schedule_settings::find(&app.db, operator).await?;
    let facts = needs::load_facts(app, operator, None).await?;
    let mut names = Names::of(&facts);

    let ahead = port_calls::ahead(&app.db, operator, now).await?;
    let (mut planned_with, left_out) = firms_of(app, operator, &mut names).await?;
    let orders = orders::under_way(&app.db, operator).await?;
    let beside = names.take_orders(&orders, &ahead, &planned_with);
    let aside: Result<Vec<Aside>> = beside
        .iter()
        .filter_map(|(order, _)| order.aside(&ahead, &left_out).transpose())
        .collect();
    let busy: BTreeSet<CompassId> = beside.iter().map(|(order, _)| order.compass_id).collect();
    let today = as_of.0.to_chrono().date_naive();
    let found: Vec<Need> = facts
        .iter()
        .filter(|facts| !busy.contains(&facts.compass_id))
        .filter_map(|facts| needs::find_need(facts, &settings.terms, today))
        .collect();

    let nos = orders::declined(&app.db, operator).await?;
    let nos: Vec<Declined> = nos.iter().filter_map(|no| declined(no, &ahead)).collect();
    let earlier = Earlier::of_fleet(&app.db, operator, now).await?;
    let mut calls = Vec::new();
    for row in ahead {
        let content = row.content()?;
        let mut call = content.of(&row.id.to_string(), &row.vessel_id.to_string());
        let day = row.eta.0.to_chrono().date_naive();
        call.name = Some(format!("{} {day}", content.port));
        let learnt = heading(&content, row.lay_heading_deg, &earlier);
        call.berth_heading_deg = learnt.map(|learnt| learnt.heading_deg);
        calls.push(call);
        names.calls.insert(row.id, row);
    }
    let pins = pins::list(&app.db, operator).await?;
    let mut all = Former::new(&found, &planned_with);
    for (compass, agreed) in &names.agreed {
        let place = (agreed.call_id, agreed.firm_id, agreed.day);
        all.add(&[*compass], place.0, place.1, place.2, agreed.state);
    }
    let nos = nos.into_iter().filter(|no| all.knows(&no.need, &no.firm));
    let declined: Vec<Declined> = nos.collect();
    for pin in &pins {
        let stands = all.add(
            &[pin.compass_id],
            pin.call_id,
            pin.firm_id,
            pin.day,
            JobState::Confirmed,
        );
        if stands {
            names.pinned.insert(pin.compass_id);
        }
    }
    let planned = names.planned(&all);
    book(app, operator, as_of, &planned, &mut planned_with).await?;
    let has_firms = !planned_with.is_empty();
    let mut input = Input {
        now: Instant(as_of.0),
        horizon_days: settings.horizon_days,
        vessels: vessels(&facts),
        needs: found.iter().map(as_input).collect(),
        compasses: Vec::new(),
        port_calls: calls,
        firms: planned_with,
        former: all.joined(),
        declined,
        weights: settings.weights,
        terms: settings.terms,
    };
    input::must_fit(&input)
        .map_err(|error| Error::WrongState(format!("this fleet cannot be planned: {error}")))?;
    let sha256 = sha256_hex(&serde_json::to_string(&input)?);
    // What follows from the plan made of it says nothing new either.
    let mut held = planned;
    held.retain(|order, _| !moved.contains(order));
    book(app, operator, as_of, &held, &mut input.firms).await?;
    all.add_proposed(former.as_ref());
    input.former = all.joined();
    Ok(Gathered {
        as_of,
        asks,
        former,
        under_way: names.under_way(beside),
        names,
        left_out,
        aside: aside?,
        held,
        has_firms,
        text: serde_json::to_string(&input)?,
        sha256,
    })
}

/// Returns the start of the current hour, so that repeated requests within it share one input.
fn begun_hour(now: Time) -> Result<Time> {
    let micros = now.0.micros().div_euclid(HOUR_MICROS) * HOUR_MICROS;
    let begun = Timestamp::from_micros(micros).map_err(anyhow::Error::from)?;
    Ok(begun.into())
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

fn as_input(need: &Need) -> input::Need {
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
