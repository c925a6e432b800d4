//! What a schedule is made from, gathered out of the database.
//!
//! What always holds: what asked for a schedule is read before anything else, so that what
//! changes while the rest is read asks again. Who is whose is known by ids, and sentences
//! name people's names.

use super::orders::{self, Aside, Order};
use super::plan::{Compass, LeftOut, Plan, UnderWay};
use super::{pins, settings, store};
use crate::app::App;
use crate::error::Result;
use crate::firms;
use crate::ids::{CallId, CompassId, FirmId, OperatorId, OrderId, VesselId};
use crate::needs::{self, Facts, Need};
use crate::port_calls::{self, Earlier, Row, heading};
use crate::time::Time;
use crate::work_orders::State;
use binnacle_magnetics::time::Timestamp;
use binnacle_schedule::input::{self, Declined, Firm, FormerJob, Input, JobState, Taken, Vessel};
use binnacle_schedule::time::Instant;
use chrono::NaiveDate;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use uuid::Uuid;

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
    /// Orders whose teams are left to the plan, which has their jobs.
    pub(super) held: BTreeSet<OrderId>,
    /// Whether there is any firm to plan with.
    pub(super) has_firms: bool,
    /// As the solver reads it.
    pub(super) text: String,
    /// SHA-256 of it, but for what the plan before proposed: that only says what was best.
    pub(super) sha256: String,
}

/// Everybody's names.
#[derive(Default)]
pub(super) struct Names {
    pub(super) compasses: BTreeMap<CompassId, (VesselId, String, String)>,
    pub(super) firms: BTreeMap<FirmId, String>,
    pub(super) calls: BTreeMap<CallId, Row>,
    pub(super) pinned: BTreeSet<CompassId>,
    /// Orders that are jobs of the plan.
    pub(super) agreed: BTreeMap<CompassId, Agreed>,
    /// Orders that every firm has declined.
    pub(super) declined: BTreeMap<CompassId, OrderId>,
}

/// Where an order has a compass adjusted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Agreed {
    pub(super) vessel_id: VesselId,
    pub(super) order_id: OrderId,
    pub(super) state: JobState,
    pub(super) call_id: CallId,
    pub(super) firm_id: FirmId,
    pub(super) day: NaiveDate,
}

/// Gathers it. Orders that the plan has moved their jobs away from hold their teams.
pub(super) async fn gather(
    app: &App,
    operator: OperatorId,
    moved: &BTreeSet<OrderId>,
) -> Result<Gathered> {
    let asks = store::asks(&app.db, operator).await?;
    let former = store::current(&app.db, operator).await?;
    let now: Time = app.clock.now().into();
    let as_of = begun_hour(now)?;
    let settings = settings::find(&app.db, operator).await?;
    let facts = needs::of_fleet(app, operator, None).await?;
    let mut names = Names::of(&facts);

    let ahead = port_calls::ahead(&app.db, operator, now).await?;
    let (mut planned_with, left_out) = firms_of(app, operator, &mut names).await?;
    let orders = orders::under_way(&app.db, operator).await?;
    let beside = names.take_orders(&orders, &ahead, &planned_with);
    let aside: Result<Vec<Aside>> = beside
        .iter()
        .filter_map(|(order, _)| order.aside(&ahead).transpose())
        .collect();
    let busy: BTreeSet<CompassId> = beside.iter().map(|(order, _)| order.compass_id).collect();
    let today = as_of.0.to_chrono().date_naive();
    let found: Vec<Need> = facts
        .iter()
        .filter(|facts| !busy.contains(&facts.compass_id))
        .filter_map(|facts| needs::need(facts, &settings.terms, today))
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
    let sha256 = sha256_hex(&serde_json::to_string(&input)?);
    // What follows from the plan made of it says nothing new either.
    let held: BTreeSet<OrderId> = planned.difference(moved).copied().collect();
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

/// The same schedule is asked for more than once within an hour.
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

/// A firm's no to an order: to its call, as long as that is ahead. Where none is known it is to
/// whatever the order is for while it stands.
fn declined(no: &Order, ahead: &[Row]) -> Option<Declined> {
    let call = no.call(ahead);
    let is_ahead = call.is_some_and(|call| ahead.iter().any(|row| row.id == call));
    if !is_ahead && (call.is_some() || no.is_cancelled()) {
        return None;
    }
    Some(Declined {
        need: no.compass_id.to_string(),
        firm: no.firm_id?.to_string(),
        day: None,
        call: call.map(|call| call.to_string()),
    })
}

/// The firms to plan with, and those that cannot be planned with.
async fn firms_of(
    app: &App,
    operator: OperatorId,
    names: &mut Names,
) -> Result<(Vec<Firm>, Vec<LeftOut>)> {
    let (mut planned_with, mut left_out) = (Vec::new(), Vec::new());
    for (firm_id, firm_name, terms) in firms::of_operator(&app.db, operator).await? {
        names.firms.insert(firm_id, firm_name.clone());
        let problems = terms.as_ref().map(firms::Terms::problems);
        match (terms, problems.as_deref()) {
            (Some(terms), Some([])) => {
                planned_with.push(terms.firm(&firm_id.to_string(), Some(&firm_name)));
            }
            (_, problems) => left_out.push(LeftOut {
                firm_id,
                firm_name,
                why: problems
                    .and_then(<[String]>::first)
                    .map_or("nobody has said on what terms it works", String::as_str)
                    .to_owned(),
            }),
        }
    }
    Ok((planned_with, left_out))
}

/// Takes out the teams that orders have which are no jobs of the plan: other operators', and
/// this one's beside it.
async fn book(
    app: &App,
    operator: OperatorId,
    as_of: Time,
    planned: &BTreeSet<OrderId>,
    firms: &mut [Firm],
) -> Result<()> {
    let from = Time(as_of.0.plus_seconds(-86_400.0));
    for firm in firms {
        let id = FirmId(Uuid::parse_str(&firm.id).map_err(anyhow::Error::from)?);
        let all = firms::bookings(&app.db, id, from).await?;
        let elsewhere = all.iter().filter(|one| {
            let counts = one.is_taken || one.operator_id == operator;
            counts && !planned.contains(&one.order_id)
        });
        let days = firms::teams_taken(elsewhere, firm.jobs_a_team_day).into_iter();
        firm.taken = days.map(|(day, teams)| Taken { day, teams }).collect();
    }
    Ok(())
}

/// Jobs of the plan before, and what has become of them since: each compass in one.
struct Former {
    needs: BTreeSet<CompassId>,
    firms: BTreeSet<String>,
    taken: BTreeSet<CompassId>,
    jobs: Vec<FormerJob>,
}

impl Former {
    fn new(found: &[Need], firms: &[Firm]) -> Former {
        Former {
            needs: found.iter().map(|need| need.compass_id).collect(),
            firms: firms.iter().map(|firm| firm.id.clone()).collect(),
            taken: BTreeSet::new(),
            jobs: Vec::new(),
        }
    }

    /// Whether a compass has a need, and a firm is planned with.
    fn knows(&self, compass: &str, firm: &str) -> bool {
        let mut needs = self.needs.iter();
        needs.any(|need| need.to_string() == compass) && self.firms.contains(firm)
    }

    /// Adds a job for those of its compasses that have a need and no job yet; whether
    /// there were any.
    fn add(
        &mut self,
        compasses: &[CompassId],
        call: CallId,
        firm: FirmId,
        day: NaiveDate,
        state: JobState,
    ) -> bool {
        let firm = firm.to_string();
        if !self.firms.contains(&firm) {
            return false;
        }
        let open = compasses
            .iter()
            .filter(|one| self.needs.contains(one) && !self.taken.contains(one));
        let needs: Vec<CompassId> = open.copied().collect();
        if needs.is_empty() {
            return false;
        }
        self.taken.extend(needs.iter().copied());
        self.jobs.push(FormerJob {
            needs: needs.iter().map(CompassId::to_string).collect(),
            call: call.to_string(),
            firm,
            day,
            state,
        });
        true
    }

    /// Adds what the plan before proposed.
    fn add_proposed(&mut self, former: Option<&Plan>) {
        for job in former.iter().flat_map(|plan| &plan.jobs) {
            let compasses: Vec<CompassId> =
                job.compasses.iter().map(|one| one.compass_id).collect();
            let proposed = JobState::Proposed;
            self.add(&compasses, job.call_id, job.firm_id, job.day, proposed);
        }
    }

    /// The jobs; those of one ship that are alike are one.
    fn joined(&self) -> Vec<FormerJob> {
        let mut joined: Vec<FormerJob> = Vec::new();
        for job in &self.jobs {
            let alike = joined.iter_mut().find(|other| {
                (&other.call, &other.firm, other.day, other.state)
                    == (&job.call, &job.firm, job.day, job.state)
            });
            match alike {
                Some(other) => other.needs.extend(job.needs.iter().cloned()),
                None => joined.push(job.clone()),
            }
        }
        joined
    }
}

impl Names {
    fn of(facts: &[Facts]) -> Names {
        let compasses = facts.iter().map(|one| {
            let names = (
                one.vessel_id,
                one.vessel_name.clone(),
                one.compass_name.clone(),
            );
            (one.compass_id, names)
        });
        Names {
            compasses: compasses.collect(),
            ..Names::default()
        }
    }

    /// Takes the orders that are jobs of the plan; those beside it come back, and why.
    fn take_orders<'a>(
        &mut self,
        orders: &'a [Order],
        ahead: &[Row],
        planned_with: &[Firm],
    ) -> Vec<(&'a Order, String)> {
        let mut beside = Vec::new();
        for order in orders {
            if order.state == State::Declined {
                self.declined.insert(order.compass_id, order.id);
                continue;
            }
            let (Some(state), Some(firm_id)) = (order.job_state(), order.firm_id) else {
                beside.push((
                    order,
                    "its order is being done, or offered to nobody".to_owned(),
                ));
                continue;
            };
            let id = firm_id.to_string();
            if planned_with.iter().all(|firm| firm.id != id) {
                let firm = self.firm(firm_id);
                beside.push((order, format!("{firm}, which has its order, is left out")));
                continue;
            }
            let Some(call_id) = order.call(ahead) else {
                beside.push((
                    order,
                    "no port call is known at its order's port and time".to_owned(),
                ));
                continue;
            };
            let port = ahead.iter().find(|call| call.id == call_id);
            let agreed = Agreed {
                vessel_id: order.vessel_id,
                order_id: order.id,
                state,
                call_id,
                firm_id,
                day: order.day(port.map(|call| call.port.as_str())),
            };
            self.agreed.insert(order.compass_id, agreed);
        }
        beside
    }

    /// Orders beside the plan, and why, with everybody's names.
    fn under_way(&self, beside: Vec<(&Order, String)>) -> Vec<UnderWay> {
        let named = beside.into_iter().filter_map(|(order, why)| {
            let (vessel_id, vessel_name, _) = self.compasses.get(&order.compass_id)?;
            Some(UnderWay {
                vessel_id: *vessel_id,
                vessel_name: vessel_name.clone(),
                compass: self.compass(order.compass_id),
                order_id: order.id,
                why,
            })
        });
        named.collect()
    }

    /// The orders that are jobs of the plan before.
    fn planned(&self, former: &Former) -> BTreeSet<OrderId> {
        let agreed = self.agreed.iter();
        agreed
            .filter(|(compass, _)| former.taken.contains(compass))
            .map(|(_, agreed)| agreed.order_id)
            .collect()
    }

    pub(super) fn compass(&self, id: CompassId) -> Compass {
        let known = self.compasses.get(&id);
        Compass {
            compass_id: id,
            compass_name: known.map_or_else(String::new, |(_, _, name)| name.clone()),
        }
    }

    pub(super) fn firm(&self, id: FirmId) -> String {
        self.firms.get(&id).cloned().unwrap_or_default()
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
