//! Port calls in the database.

use super::call::{CheckedFilter, Content, PortCall, Revision, Source};
use super::heading::{EarlierHeadings, heading_alongside};
use anyhow::Context;
use binnacle_orders::work_orders::Alongside;
use binnacle_platform::db::{Db, Tx, execute, row, rows};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CallId, OperatorId, UserId, VesselId};
use binnacle_platform::session;
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use binnacle_schedule::ports::{self, PortCode};
use futures_util::future::BoxFuture;
use uuid::Uuid;

/// A call's columns, with its vessel's name.
#[derive(Clone, Debug, sqlx::FromRow)]
#[allow(missing_docs, reason = "they are the columns")]
pub struct StoredCall {
    pub vessel_id: VesselId,
    pub vessel_name: String,
    pub id: CallId,
    pub reference: String,
    pub port: String,
    pub berth: Option<String>,
    pub eta: Time,
    pub eta_uncertainty_h: f64,
    pub etd: Time,
    pub etd_uncertainty_h: f64,
    pub berth_heading_deg: Option<f64>,
    pub lay_heading_deg: Option<f64>,
    pub source: Source,
    pub revision: i64,
    pub created_at: Time,
    pub created_by: String,
    pub revised_at: Option<Time>,
    pub revised_by: Option<String>,
    pub withdrawn_at: Option<Time>,
    pub withdrawn_by: Option<String>,
    pub withdrawal_reason: Option<String>,
}

/// Author and time of a write.
pub(super) struct Author {
    pub(super) id: UserId,
    pub(super) name: String,
    pub(super) at: Time,
}

impl Author {
    pub(super) async fn from_user(tx: &mut Tx, id: UserId, at: Time) -> Result<Author> {
        let name = session::name_of(tx, id).await?;
        Ok(Author { id, name, at })
    }
}

impl StoredCall {
    /// Returns the content of the call.
    ///
    /// # Errors
    /// Fails when the stored port is not a UN/LOCODE.
    pub fn content(&self) -> Result<Content> {
        Ok(Content {
            reference: self.reference.clone(),
            port: PortCode::parse(&self.port).context("stored port")?,
            berth: self.berth.clone(),
            eta: self.eta,
            eta_uncertainty_h: self.eta_uncertainty_h,
            etd: self.etd,
            etd_uncertainty_h: self.etd_uncertainty_h,
            berth_heading_deg: self.berth_heading_deg,
        })
    }

    /// Returns the port and times of the call, as a work order uses them.
    ///
    /// # Errors
    /// As [`StoredCall::content`].
    pub fn alongside(&self) -> Result<Alongside> {
        let port = PortCode::parse(&self.port).context("stored port")?;
        Ok(Alongside::new(port, self.eta, self.etd))
    }

    pub(super) fn into_call(self, earlier: &EarlierHeadings) -> Result<PortCall> {
        let content = self.content()?;
        Ok(PortCall {
            berth_heading: heading_alongside(&content, self.lay_heading_deg, earlier),
            port_name: ports::find(content.port).map_or("", |port| port.name),
            content,
            id: self.id,
            vessel_id: self.vessel_id,
            vessel_name: self.vessel_name,
            source: self.source,
            revision: u32::try_from(self.revision).context("revision number")?,
            created_at: self.created_at,
            created_by: self.created_by,
            revised_at: self.revised_at,
            revised_by: self.revised_by,
            withdrawn_at: self.withdrawn_at,
            withdrawn_by: self.withdrawn_by,
            withdrawal_reason: self.withdrawal_reason,
        })
    }
}

/// Returns a page of the calls of the fleet in service or of one vessel, in order of time.
pub(super) async fn list(
    db: &Db,
    operator: OperatorId,
    vessel: Option<VesselId>,
    filter: &CheckedFilter,
    after: i64,
    after_id: Uuid,
    limit: i64,
) -> Result<Vec<StoredCall>> {
    Ok(rows!(
        db,
        StoredCall,
        "SELECT c.*, v.name AS vessel_name FROM port_calls c
         JOIN vessels v ON v.id = c.vessel_id
         WHERE v.operator_id = $1
           AND (c.vessel_id = $2 OR ($2 IS NULL AND v.out_of_service_at IS NULL))
           AND (c.eta, c.id) > ($3, $4)
           AND c.etd > $5 AND c.eta < $6
           AND ($7 IS NULL OR c.port = $7)
           AND ($8 OR c.withdrawn_at IS NULL)
         ORDER BY c.eta, c.id
         LIMIT $9",
        operator,
        vessel,
        after,
        after_id,
        filter.from.map_or(i64::MIN, |time| time.0.micros()),
        filter.to.map_or(i64::MAX, |time| time.0.micros()),
        filter.port.map(|port| port.to_string()),
        filter.withdrawn,
        limit
    )?)
}

/// Returns the current and future calls of the fleet in service, in order of vessel and time.
pub async fn upcoming_of_fleet(
    db: &Db,
    operator: OperatorId,
    now: Time,
) -> Result<Vec<StoredCall>> {
    let (first, last) = (VesselId(Uuid::nil()), VesselId(Uuid::max()));
    upcoming_within(db, operator, first, last, now).await
}

/// Returns the current and future calls of the operator's vessels in service within a
/// range of ids, in order of vessel and time.
pub async fn upcoming_within(
    db: &Db,
    operator: OperatorId,
    first: VesselId,
    last: VesselId,
    now: Time,
) -> Result<Vec<StoredCall>> {
    Ok(rows!(
        db,
        StoredCall,
        "SELECT c.*, v.name AS vessel_name FROM port_calls c
         JOIN vessels v ON v.id = c.vessel_id
         WHERE v.operator_id = $1 AND v.id BETWEEN $2 AND $3
           AND v.out_of_service_at IS NULL AND c.etd > $4 AND c.withdrawn_at IS NULL
         ORDER BY c.vessel_id, c.eta",
        operator,
        first,
        last,
        now
    )?)
}

/// Returns the current and future calls of one vessel.
pub(super) async fn upcoming_of_vessel(
    db: &Db,
    vessel: VesselId,
    now: Time,
) -> Result<Vec<StoredCall>> {
    Ok(rows!(
        db,
        StoredCall,
        "SELECT c.*, v.name AS vessel_name FROM port_calls c
         JOIN vessels v ON v.id = c.vessel_id
         WHERE c.vessel_id = $1 AND c.etd > $2 AND c.withdrawn_at IS NULL
         ORDER BY c.eta",
        vessel,
        now
    )?)
}

/// Returns a call of the vessel.
///
/// # Errors
/// Fails with [`Error::NotFound`] when the vessel has no such call.
pub(super) async fn must_find(db: &Db, vessel: VesselId, id: CallId) -> Result<StoredCall> {
    row!(
        db,
        StoredCall,
        "SELECT c.*, v.name AS vessel_name FROM port_calls c
         JOIN vessels v ON v.id = c.vessel_id
         WHERE c.vessel_id = $1 AND c.id = $2
         ORDER BY c.id",
        vessel,
        id
    )?
    .ok_or(Error::NotFound("port call"))
}

/// Locks a vessel's calls and returns them all, withdrawn ones included.
///
/// # Errors
/// Fails with [`Error::NotFound`] when the vessel is not in the operator's fleet.
pub(super) async fn lock(
    tx: &mut Tx,
    operator: OperatorId,
    vessel: VesselId,
) -> Result<Vec<StoredCall>> {
    let locked = execute!(
        &mut *tx,
        "UPDATE vessels SET name = name WHERE id = $2 AND operator_id = $1",
        operator,
        vessel
    )?;
    if locked == 0 {
        return Err(Error::NotFound("vessel"));
    }
    Ok(rows!(
        in tx,
        StoredCall,
        "SELECT c.*, v.name AS vessel_name FROM port_calls c
         JOIN vessels v ON v.id = c.vessel_id
         WHERE c.vessel_id = $1
         ORDER BY c.eta, c.id",
        vessel
    )?)
}

pub(super) async fn insert(
    tx: &mut Tx,
    vessel: VesselId,
    id: CallId,
    call: &Content,
    source: Source,
    author: &Author,
) -> Result<()> {
    execute!(
        &mut *tx,
        "INSERT INTO port_calls (vessel_id, id, reference, port, berth, eta, eta_uncertainty_h,
                                 etd, etd_uncertainty_h, berth_heading_deg, source, revision,
                                 created_at, created_by)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, 1, $12, $13)",
        vessel,
        id,
        call.reference.as_str(),
        call.port.to_string(),
        call.berth.as_deref(),
        call.eta,
        call.eta_uncertainty_h,
        call.etd,
        call.etd_uncertainty_h,
        call.berth_heading_deg,
        source,
        author.at,
        author.name.as_str()
    )?;
    insert_revision(tx, vessel, id, 1, call, source, author).await
}

/// Stores a new revision of a call; a withdrawn call counts again.
pub(super) async fn revise(
    tx: &mut Tx,
    before: &StoredCall,
    call: &Content,
    source: Source,
    author: &Author,
) -> Result<()> {
    let revision = before.revision + 1;
    execute!(
        &mut *tx,
        "UPDATE port_calls
         SET port = $3, berth = $4, eta = $5, eta_uncertainty_h = $6, etd = $7,
             etd_uncertainty_h = $8, berth_heading_deg = $9, source = $10, revision = $11,
             revised_at = $12, revised_by = $13, withdrawn_at = NULL, withdrawn_by = NULL,
             withdrawal_reason = NULL
         WHERE vessel_id = $1 AND id = $2",
        before.vessel_id,
        before.id,
        call.port.to_string(),
        call.berth.as_deref(),
        call.eta,
        call.eta_uncertainty_h,
        call.etd,
        call.etd_uncertainty_h,
        call.berth_heading_deg,
        source,
        revision,
        author.at,
        author.name.as_str()
    )?;
    insert_revision(
        tx,
        before.vessel_id,
        before.id,
        revision,
        call,
        source,
        author,
    )
    .await
}

async fn insert_revision(
    tx: &mut Tx,
    vessel: VesselId,
    id: CallId,
    revision: i64,
    call: &Content,
    source: Source,
    author: &Author,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO port_call_revisions (vessel_id, call_id, revision, at, source, author_id,
                                          author_name, call)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
        vessel,
        id,
        revision,
        author.at,
        source,
        author.id,
        author.name.as_str(),
        serde_json::to_string(call)?
    )?;
    Ok(())
}

/// Marks a call as withdrawn.
pub(super) async fn withdraw(
    tx: &mut Tx,
    call: &StoredCall,
    reason: Option<&str>,
    author: &Author,
) -> Result<()> {
    execute!(
        tx,
        "UPDATE port_calls SET withdrawn_at = $3, withdrawn_by = $4, withdrawal_reason = $5
         WHERE vessel_id = $1 AND id = $2",
        call.vessel_id,
        call.id,
        author.at,
        author.name.as_str(),
        reason
    )?;
    Ok(())
}

/// Returns the revisions of a call.
pub(super) async fn revisions(db: &Db, vessel: VesselId, id: CallId) -> Result<Vec<Revision>> {
    let found = rows!(
        db,
        (i64, Time, Source, String, String),
        "SELECT revision, at, source, author_name, call FROM port_call_revisions
         WHERE vessel_id = $1 AND call_id = $2
         ORDER BY revision",
        vessel,
        id
    )?;
    let read = |(number, at, source, author_name, call): (i64, Time, Source, String, String)| {
        Ok(Revision {
            number: u32::try_from(number).context("revision number")?,
            at,
            source,
            author_name,
            call: serde_json::from_str(&call)?,
        })
    };
    found.into_iter().map(read).collect()
}

/// Stores the heading alongside that was read during the vessel's current call.
pub(super) async fn set_lay_heading(
    tx: &mut Tx,
    vessel: VesselId,
    at: Time,
    heading_deg: f64,
) -> Result<()> {
    execute!(
        tx,
        "UPDATE port_calls SET lay_heading_deg = $3
         WHERE vessel_id = $1 AND eta <= $2 AND etd >= $2 AND withdrawn_at IS NULL",
        vessel,
        at,
        heading_deg
    )?;
    Ok(())
}

/// Counts the port calls of an operator's vessels.
pub(super) fn count(
    tx: &mut Tx,
    tenant: Tenant,
    _: Time,
) -> BoxFuture<'_, binnacle_platform::db::Result<i64>> {
    Box::pin(async move {
        let found = row!(
            in tx,
            (i64,),
            "SELECT COUNT(*) FROM port_calls c
             JOIN vessels v ON v.id = c.vessel_id
             WHERE v.operator_id = $1",
            tenant.operator()
        )?;
        Ok(found.map_or(0, |(count,)| count))
    })
}
