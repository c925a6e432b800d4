//! Loading of the facts for needs from the database, a few queries for a whole fleet, and
//! storage of what they found.

use super::facts::{Completed, Facts, Stored, UpcomingCall, Work, assess_compass};
use super::order::OpenOrder;
use super::over_limit_since::{self, DeviationHistory};
use crate::port_calls;
use binnacle_compass::logbook::LogbookKind;
use binnacle_fleet::analysis::Findings;
use binnacle_fleet::compasses::{self, Compass};
use binnacle_fleet::models::{self, StoredModel};
use binnacle_fleet::particulars::Particulars;
use binnacle_fleet::settings::AlertLimits;
use binnacle_orders::work_orders::State;
use binnacle_platform::app::App;
use binnacle_platform::db::{Db, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use serde_json::Value;
use std::collections::BTreeMap;
use uuid::Uuid;

/// Vessel and compass: the key of what is stored of a compass.
type CompassKey = (VesselId, CompassId);

/// Vessels of an operator in a range of ids.
#[derive(Clone, Copy)]
struct Which {
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
}

/// Stored records of a fleet, by vessel or by compass.
struct FleetRecords {
    vessels: Vec<(VesselId, String, Option<String>)>,
    compasses: Vec<Compass>,
    particulars: BTreeMap<VesselId, Particulars>,
    work: BTreeMap<VesselId, Vec<Work>>,
    completed: BTreeMap<CompassKey, Completed>,
    orders: BTreeMap<CompassKey, OpenOrder>,
    failed: BTreeMap<CompassKey, (Time, f64)>,
    models: Vec<StoredModel>,
    findings: BTreeMap<CompassKey, Findings>,
    limits: BTreeMap<VesselId, AlertLimits>,
    calls: BTreeMap<VesselId, Vec<UpcomingCall>>,
    histories: BTreeMap<CompassKey, DeviationHistory>,
}

/// Returns the facts about a fleet's compasses, or about one vessel's in it.
pub async fn load_facts(
    app: &App,
    operator: OperatorId,
    vessel: Option<VesselId>,
) -> Result<Vec<Facts>> {
    let now = app.clock.now().into();
    let records = FleetRecords::load(&app.db, operator, vessel, now).await?;
    // Predicting deviation at a thousand ships' calls takes time: not on an async thread.
    Ok(tokio::task::spawn_blocking(move || records.facts(now)).await?)
}

impl FleetRecords {
    async fn load(
        db: &Db,
        operator: OperatorId,
        vessel: Option<VesselId>,
        now: Time,
    ) -> Result<FleetRecords> {
        let (first, last) = vessel.map_or((VesselId(Uuid::nil()), VesselId(Uuid::max())), |one| {
            (one, one)
        });
        let which = Which {
            operator,
            first,
            last,
        };
        let mut calls: BTreeMap<VesselId, Vec<UpcomingCall>> = BTreeMap::new();
        for call in port_calls::upcoming_within(db, operator, first, last, now).await? {
            let (port, at) = (call.content()?.port, call.eta);
            let at = at.max(now);
            let of_vessel = calls.entry(call.vessel_id).or_default();
            of_vessel.push(UpcomingCall { port, at });
        }
        Ok(FleetRecords {
            vessels: rows!(
                db,
                (VesselId, String, Option<String>),
                "SELECT id, name, flag FROM vessels
                 WHERE operator_id = $1 AND id BETWEEN $2 AND $3
                   AND out_of_service_at IS NULL
                 ORDER BY id",
                operator,
                first,
                last
            )?,
            compasses: compasses::of_fleet(db, operator, first, last).await?,
            particulars: load_particulars(db, which).await?,
            work: load_work(db, which).await?,
            completed: load_completed(db, which).await?,
            orders: load_open_orders(db, which).await?,
            failed: load_failed(db, which).await?,
            models: models::current_of_fleet(db, operator, first, last).await?,
            findings: load_findings(db, which).await?,
            limits: load_limits(db, which).await?,
            calls,
            histories: over_limit_since::list_histories(db, operator, first, last).await?,
        })
    }

    fn facts(&self, now: Time) -> Vec<Facts> {
        let names: BTreeMap<VesselId, &(VesselId, String, Option<String>)> = self
            .vessels
            .iter()
            .map(|vessel| (vessel.0, vessel))
            .collect();
        let models: BTreeMap<CompassKey, &StoredModel> = self
            .models
            .iter()
            .map(|model| ((model.vessel_id, model.compass_id), model))
            .collect();
        let (default, no_work, no_history) = (
            Particulars::default(),
            Vec::new(),
            DeviationHistory::default(),
        );
        let facts = self.compasses.iter().filter_map(|one| {
            let vessel = one.vessel_id;
            let key = (vessel, one.id);
            let (_, name, flag) = names.get(&vessel)?;
            let particulars = self.particulars.get(&vessel).unwrap_or(&default);
            let work = self.work.get(&vessel).unwrap_or(&no_work).iter();
            let stored = Stored {
                work: work
                    .filter(|work| work.compass_id.is_none_or(|only| only == one.id))
                    .collect(),
                completed: self.completed.get(&key).copied(),
                failed: self.failed.get(&key).copied(),
                model: models.get(&key).copied(),
                findings: self.findings.get(&key),
                limits: self.limits.get(&vessel).copied().unwrap_or_default(),
                calls: self.calls.get(&vessel).map_or(&[], Vec::as_slice),
                history: self.histories.get(&key).unwrap_or(&no_history),
            };
            let (compass, predicted, history) = assess_compass(&stored, particulars, now);
            let changed_history = Some(history).filter(|history| history != stored.history);
            Some(Facts {
                vessel_id: vessel,
                vessel_name: name.clone(),
                compass_id: one.id,
                compass_name: one.name.clone(),
                ship: particulars.ship(flag.as_deref()),
                licence: particulars.licence.clone(),
                compass,
                predicted,
                order: self.orders.get(&key).cloned(),
                changed_history,
            })
        });
        facts.collect()
    }
}

async fn load_particulars(db: &Db, which: Which) -> Result<BTreeMap<VesselId, Particulars>> {
    let found = rows!(
        db,
        (VesselId, String),
        "SELECT p.vessel_id, p.particulars FROM vessel_particulars p
         JOIN vessels v ON v.id = p.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
         ORDER BY p.vessel_id",
        which.operator,
        which.first,
        which.last
    )?;
    let read = |(vessel, text): (VesselId, String)| Ok((vessel, serde_json::from_str(&text)?));
    found.into_iter().map(read).collect()
}

/// Returns the work in the logbooks.
async fn load_work(db: &Db, which: Which) -> Result<BTreeMap<VesselId, Vec<Work>>> {
    let found = rows!(
        db,
        (VesselId, Option<CompassId>, String, Time, Option<Time>),
        "SELECT e.vessel_id, e.compass_id, e.kind, e.from_at, e.to_at
         FROM logbook_entries e JOIN vessels v ON v.id = e.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
           AND e.withdrawn_at IS NULL
           AND e.kind IN ('adjustment', 'compass_moved', 'dry_docking', 'repair', 'welding')
         ORDER BY e.vessel_id, e.from_at, e.id",
        which.operator,
        which.first,
        which.last
    )?;
    let mut work: BTreeMap<VesselId, Vec<Work>> = BTreeMap::new();
    for (vessel, compass_id, kind, from, to) in found {
        let kind: LogbookKind = serde_json::from_value(Value::String(kind))?;
        work.entry(vessel).or_default().push(Work {
            compass_id,
            kind,
            from,
            to,
        });
    }
    Ok(work)
}

/// Returns the last completed adjustment of each compass.
async fn load_completed(db: &Db, which: Which) -> Result<BTreeMap<CompassKey, Completed>> {
    let found = rows!(
        db,
        (VesselId, CompassId, Time, State),
        "SELECT o.vessel_id, o.compass_id, o.completed_at, o.state
         FROM work_orders o JOIN vessels v ON v.id = o.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
           AND o.completed_at IS NOT NULL
         ORDER BY o.vessel_id, o.completed_at, o.id",
        which.operator,
        which.first,
        which.last
    )?;
    let keyed = |(vessel, compass, at, state)| {
        // An order closed without verification stays a prediction.
        let awaits_verification = matches!(state, State::Adjusted | State::ClosedUnverified);
        let completed = Completed {
            at,
            awaits_verification,
        };
        ((vessel, compass), completed)
    };
    // Rows are in order of time: the last of a compass stays.
    Ok(found.into_iter().map(keyed).collect())
}

/// Returns the last opened order of each compass that is not over.
async fn load_open_orders(db: &Db, which: Which) -> Result<BTreeMap<CompassKey, OpenOrder>> {
    let found = rows!(
        db,
        (VesselId, CompassId, OrderId, State, String, Time, Time),
        "SELECT o.vessel_id, o.compass_id, o.id, o.state, o.port, o.planned_at,
                o.planned_at + o.job_us
         FROM work_orders o JOIN vessels v ON v.id = o.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
           AND o.state NOT IN ('closed', 'closed_unverified', 'cancelled')
         ORDER BY o.vessel_id, o.id",
        which.operator,
        which.first,
        which.last
    )?;
    let keyed = |(vessel, compass, id, state, port, from, until)| {
        let order = OpenOrder {
            id,
            state,
            port,
            from,
            until,
        };
        ((vessel, compass), order)
    };
    // Ids are in the order of opening: the last of a compass stays.
    Ok(found.into_iter().map(keyed).collect())
}

/// Returns the last failed verification of each compass without a later completed order: time of
/// the last heading at sea, and the largest error in degrees.
async fn load_failed(db: &Db, which: Which) -> Result<BTreeMap<CompassKey, (Time, f64)>> {
    let found = rows!(
        db,
        (VesselId, CompassId, Time, String),
        "SELECT o.vessel_id, o.compass_id, o.completed_at, e.line
         FROM work_orders o
         JOIN vessels v ON v.id = o.vessel_id
         JOIN work_order_entries e ON e.vessel_id = o.vessel_id AND e.order_id = o.id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
           AND o.completed_at IS NOT NULL
           AND (o.state = 'failed' OR (o.state = 'closed' AND o.verified_at IS NULL))
           AND NOT EXISTS (
               SELECT 1 FROM work_orders later
               WHERE later.vessel_id = o.vessel_id AND later.compass_id = o.compass_id
                 AND later.completed_at > o.completed_at)
         ORDER BY o.vessel_id, o.completed_at, e.seq",
        which.operator,
        which.first,
        which.last
    )?;
    let mut failed = BTreeMap::new();
    for (vessel, compass, _, line) in found {
        let entry: Value = serde_json::from_str(&line)?;
        let content = &entry["content"];
        let off_deg = content["verification"]["off_deg"].as_f64();
        if let Some(off_deg) = off_deg {
            let until: Time = serde_json::from_value(content["until"].clone())?;
            failed.insert((vessel, compass), (until, off_deg));
        }
    }
    Ok(failed)
}

async fn load_findings(db: &Db, which: Which) -> Result<BTreeMap<CompassKey, Findings>> {
    let found = rows!(
        db,
        (VesselId, CompassId, Option<String>),
        "SELECT a.vessel_id, a.compass_id, a.findings
         FROM analyses a JOIN vessels v ON v.id = a.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
         ORDER BY a.vessel_id, a.compass_id",
        which.operator,
        which.first,
        which.last
    )?;
    let mut findings = BTreeMap::new();
    for (vessel, compass, text) in found {
        if let Some(text) = text {
            findings.insert((vessel, compass), serde_json::from_str(&text)?);
        }
    }
    Ok(findings)
}

async fn load_limits(db: &Db, which: Which) -> Result<BTreeMap<VesselId, AlertLimits>> {
    let found = rows!(
        db,
        (VesselId, String),
        "SELECT s.vessel_id, s.alerts FROM vessel_settings s JOIN vessels v ON v.id = s.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
         ORDER BY s.vessel_id",
        which.operator,
        which.first,
        which.last
    )?;
    let read = |(vessel, text): (VesselId, String)| Ok((vessel, serde_json::from_str(&text)?));
    found.into_iter().map(read).collect()
}

/// Stores the deviation histories that have changed.
pub async fn store_deviation_histories(app: &App, facts: &[Facts]) -> Result<()> {
    for facts in facts {
        if let Some(history) = &facts.changed_history {
            let mut tx = app.db.begin().await?;
            over_limit_since::store_history(&mut tx, facts.vessel_id, facts.compass_id, history)
                .await?;
            tx.commit().await?;
        }
    }
    Ok(())
}
