//! Loading of a report's figures from the database.

use super::report::{DueCompass, FeeFrom, Job, Report, Saving, UnderWay, WorstDeviation};
use super::settings::{self, Settings};
use crate::needs::{Facts, find_need, load_facts};
use crate::schedule_settings;
use binnacle_compass::time::Timestamp;
use binnacle_fleet::models::{self, StoredModel};
use binnacle_orders::completion::{self, CompletedOrder, CompletionPeriod};
use binnacle_orders::firms;
use binnacle_orders::work_orders::State;
use binnacle_platform::app::App;
use binnacle_platform::db::{Db, row, rows};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, OperatorId, OrderId, VesselId};
use binnacle_platform::time::Time;
use chrono::{Days, NaiveDate, NaiveTime};
use std::collections::{BTreeMap, BTreeSet};
use uuid::Uuid;

/// Maximum gap between two jobs of one visit, seconds.
const MAX_GAP_S: f64 = 86_400.0;

/// Returns the report of a fleet, with the jobs from one day to another. Earlier jobs that the server
/// received after `late_since` are included.
pub(super) async fn load_report(
    app: &App,
    operator: OperatorId,
    from: NaiveDate,
    to: NaiveDate,
    late_since: Option<Time>,
) -> Result<Report> {
    let made_at: Time = app.clock.now().into();
    let facts = load_facts(app, operator, None).await?;
    let all = (VesselId(Uuid::nil()), VesselId(Uuid::max()));
    let models = models::current_of_fleet(&app.db, operator, all.0, all.1).await?;
    let terms = schedule_settings::terms(&app.db, operator).await?;
    let under_way = list_orders_under_way(&app.db, operator).await?;
    let span = CompletionPeriod {
        from: start_of_day("from", from)?,
        until: start_of_day("to", to + Days::new(1))?,
        late_since,
        known_at: made_at,
    };
    let jobs = list_jobs(&app.db, operator, span).await?;
    let settings = settings::find(&app.db, operator).await?;
    let today = made_at.0.to_chrono().date_naive();
    let mut due: Vec<DueCompass> = facts
        .iter()
        .filter_map(|facts| find_need(facts, &terms, today))
        .map(|need| DueCompass {
            order: under_way.get(&need.compass_id).cloned(),
            vessel_id: need.vessel_id,
            vessel_name: need.vessel_name,
            compass_id: need.compass_id,
            compass_name: need.compass_name,
            due_on: need.due_on,
            urgency: need.urgency,
            reason: need.reason,
            adjusted_on: need.adjusted_on,
        })
        .collect();
    due.sort_by_key(|due| (due.due_on, due.compass_id));
    let vessels: BTreeSet<VesselId> = facts.iter().map(|facts| facts.vessel_id).collect();
    Ok(Report {
        operator_name: find_operator_name(&app.db, operator).await?,
        from,
        to,
        made_at,
        vessels: vessels.len(),
        compasses: facts.len(),
        due,
        // A thousand models on every heading take time: not on an async thread.
        deviation: tokio::task::spawn_blocking(move || worst_deviations(&facts, &models)).await?,
        saved: compute_saving(&jobs, &settings),
        jobs,
    })
}

async fn find_operator_name(db: &Db, operator: OperatorId) -> Result<String> {
    let found = row!(
        db,
        (String,),
        "SELECT name FROM operators WHERE id = $1 ORDER BY id",
        operator
    )?;
    let (name,) = found.ok_or(Error::NotFound("operator"))?;
    Ok(name)
}

/// Returns the order under way of each compass, of which there is one at most.
async fn list_orders_under_way(
    db: &Db,
    operator: OperatorId,
) -> Result<BTreeMap<CompassId, UnderWay>> {
    let found = rows!(
        db,
        (CompassId, OrderId, State, String, Time, Option<String>),
        "SELECT o.compass_id, o.id, o.state, o.port, o.planned_at, o.firm
         FROM work_orders o
         JOIN vessels v ON v.id = o.vessel_id
         WHERE v.operator_id = $1
           AND o.state NOT IN ('adjusted', 'verified', 'failed', 'closed',
                             'closed_unverified', 'cancelled')
         ORDER BY o.compass_id, o.id",
        operator
    )?;
    let read = |(compass, id, state, port, planned_at, firm)| {
        let order = UnderWay {
            id,
            state,
            port,
            planned_at,
            firm,
        };
        (compass, order)
    };
    Ok(found.into_iter().map(read).collect())
}

fn worst_deviations(facts: &[Facts], models: &[StoredModel]) -> Vec<WorstDeviation> {
    let models: BTreeMap<CompassId, &StoredModel> = models
        .iter()
        .map(|model| (model.compass_id, model))
        .collect();
    let worst = |facts: &Facts| {
        let model = models.get(&facts.compass_id);
        let worst = model.and_then(|model| model.worst());
        WorstDeviation {
            vessel_id: facts.vessel_id,
            vessel_name: facts.vessel_name.clone(),
            compass_id: facts.compass_id,
            compass_name: facts.compass_name.clone(),
            compass_deg: worst.map(|worst| worst.compass_deg),
            deviation_deg: worst.map(|worst| worst.deviation_deg),
            band95_deg: worst.and_then(|worst| worst.band95_deg),
            data_until: model.map(|model| model.data_until),
        }
    };
    let mut all: Vec<WorstDeviation> = facts.iter().map(worst).collect();
    let size = |one: &WorstDeviation| one.deviation_deg.map_or(-1.0, f64::abs);
    all.sort_by(|one, other| size(other).total_cmp(&size(one)));
    all
}

async fn list_jobs(db: &Db, operator: OperatorId, span: CompletionPeriod) -> Result<Vec<Job>> {
    let done = completion::completed_orders(db, operator, span).await?;
    let firms = firms::of_operator(db, operator).await?;
    let visits = number_visits(&done);
    let usual = |nth: usize| {
        let firm = done[nth].firm_id?;
        let engaged = firms.iter().find(|of| of.id == firm)?;
        let terms = engaged.terms.as_ref()?;
        let same =
            |before: usize| visits[before] == visits[nth] && done[before].firm_id == Some(firm);
        let is_further = (0..nth).any(same);
        Some(if is_further {
            f64::from(terms.extra_compass_eur)
        } else {
            f64::from(terms.fee_eur)
        })
    };
    let fee = |nth: usize| {
        let agreed = done[nth].agreed_eur.map(|eur| (eur, FeeFrom::Agreed));
        agreed.or_else(|| usual(nth).map(|eur| (eur, FeeFrom::Terms)))
    };
    let fees: Vec<Option<(f64, FeeFrom)>> = (0..done.len()).map(fee).collect();
    let job = |((done, visit), fee): ((CompletedOrder, usize), Option<(f64, FeeFrom)>)| Job {
        order_id: done.order_id,
        vessel_id: done.vessel_id,
        vessel_name: done.vessel_name,
        compass_id: done.compass_id,
        compass_name: done.compass_name,
        port: done.port,
        completed_at: done.completed_at,
        firm: done.firm,
        state: done.state,
        spared_swing: !done.disproved,
        fee_eur: fee.map(|(eur, _)| eur),
        fee_from: fee.map(|(_, from)| from),
        visit,
    };
    Ok(done.into_iter().zip(visits).zip(fees).map(job).collect())
}

/// Returns the number of each job's visit, in the jobs' order. A visit is a vessel's jobs in one
/// port, each within a day of the previous one.
fn number_visits(done: &[CompletedOrder]) -> Vec<usize> {
    let mut last: BTreeMap<VesselId, usize> = BTreeMap::new();
    let mut visits: Vec<usize> = Vec::with_capacity(done.len());
    for (nth, job) in done.iter().enumerate() {
        let before = last.insert(job.vessel_id, nth).filter(|before| {
            let before = &done[*before];
            let since_s = job.completed_at.0.seconds_since(before.completed_at.0);
            before.port == job.port && since_s < MAX_GAP_S
        });
        visits.push(before.map_or(nth, |before| visits[before]));
    }
    visits
}

fn start_of_day(field: &'static str, day: NaiveDate) -> Result<Time> {
    let midnight = day.and_time(NaiveTime::MIN).and_utc();
    let at = Timestamp::from_micros(midnight.timestamp_micros());
    at.map(Time).map_err(|error| Error::Invalid {
        field,
        detail: error.to_string(),
    })
}

fn compute_saving(jobs: &[Job], settings: &Settings) -> Saving {
    let without_swing = || jobs.iter().filter(|job| job.spared_swing);
    let swings: BTreeSet<usize> = without_swing().map(|job| job.visit).collect();
    let swings = swings.len();
    // The sum of an empty iterator is -0.0.
    let fees = jobs.iter().filter_map(|job| job.fee_eur);
    let fees_eur = fees.fold(0.0, |sum: f64, fee| sum + fee);
    Saving {
        jobs: without_swing().count(),
        swings,
        swing_eur: settings.swing_eur,
        swing_h: settings.swing_h,
        fees_eur,
        without_fee: jobs.iter().filter(|job| job.fee_eur.is_none()).count(),
        saved_eur: swings as f64 * settings.swing_eur - fees_eur,
        saved_h: swings as f64 * settings.swing_h,
    }
}
