//! Calendar feeds in the database, and the records that they show.

use super::feed::{Feed, Scope};
use binnacle_orders::work_orders::CallFit;
use binnacle_orders::work_orders::State;
use binnacle_platform::db::{Db, Result, Tx, execute, row, rows};
use binnacle_platform::ids::{
    CallId, CompassId, FeedId, FirmId, OperatorId, OrderId, TokenId, UserId, VesselId,
};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use binnacle_platform::tokens::{Made, MadeKind, named};
use futures_util::future::BoxFuture;
use uuid::Uuid;

/// Age to which past orders are shown, seconds.
const PAST_ORDERS_S: f64 = 400.0 * 86_400.0;
/// Age to which past port calls are shown, seconds.
const PAST_CALLS_S: f64 = 90.0 * 86_400.0;
/// Maximum number of orders in a calendar, the latest.
const MAX_ORDERS: i64 = 2000;
/// Maximum number of port calls in a calendar, the latest.
const MAX_CALLS: i64 = 10_000;

/// Port call as a calendar shows it.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(super) struct CalendarCall {
    pub id: CallId,
    pub vessel_id: VesselId,
    pub vessel_name: String,
    pub port: String,
    pub berth: Option<String>,
    pub eta: Time,
    pub eta_uncertainty_h: f64,
    pub etd: Time,
    pub etd_uncertainty_h: f64,
    pub revision: i64,
    pub created_at: Time,
    pub revised_at: Option<Time>,
    pub withdrawn_at: Option<Time>,
    pub withdrawal_reason: Option<String>,
}

/// Due date as a calendar shows it.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(super) struct CalendarDueDate {
    pub vessel_id: VesselId,
    pub vessel_name: String,
    pub compass_id: CompassId,
    pub compass_name: String,
    #[sqlx(rename = "due_on")]
    pub day: String,
    pub urgency: String,
    pub reason: String,
    pub version: i64,
    pub changed_at: Time,
}

/// Work order as a calendar shows it.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(super) struct CalendarOrder {
    pub id: OrderId,
    pub state: State,
    pub port: String,
    pub berth: Option<String>,
    pub planned_at: Time,
    pub planned_until: Time,
    pub vessel_name: String,
    pub compass_name: String,
    pub operator_name: String,
    pub firm: Option<String>,
    pub adjuster_name: Option<String>,
    /// Number of the last log entry, which grows with each change.
    pub last_seq: i64,
    /// The last log entry, as JSON.
    pub line: String,
    /// Fit of the planned time to the port call, where the call moved after the time was agreed.
    pub call_fit: Option<CallFit>,
}

pub(super) async fn list(
    db: &Db,
    tenant: Tenant,
    after: Option<Uuid>,
    limit: i64,
) -> Result<Vec<Feed>> {
    rows!(
        db,
        Feed,
        "SELECT id, name, vessel_id, created_at, created_by FROM calendar_feeds
         WHERE (operator_id = $1 OR firm_id = $2) AND id > $3
         ORDER BY id
         LIMIT $4",
        tenant.operator(),
        tenant.firm(),
        after.unwrap_or_default(),
        limit
    )
}

pub(super) async fn insert(
    tx: &mut Tx,
    tenant: Tenant,
    user: UserId,
    feed: &Feed,
    hash: &[u8],
) -> Result<()> {
    let by = tx.token();
    execute!(
        tx,
        "INSERT INTO calendar_feeds (id, operator_id, firm_id, vessel_id, token_hash, name,
                                     created_at, created_by, user_id, made_by_token)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)",
        feed.id,
        tenant.operator(),
        tenant.firm(),
        feed.vessel_id,
        hash,
        feed.name.as_str(),
        feed.created_at,
        feed.created_by.as_str(),
        user,
        by
    )?;
    Ok(())
}

pub(super) async fn delete(tx: &mut Tx, tenant: Tenant, id: FeedId) -> Result<bool> {
    let deleted = execute!(
        tx,
        "DELETE FROM calendar_feeds WHERE (operator_id = $1 OR firm_id = $2) AND id = $3",
        tenant.operator(),
        tenant.firm(),
        id
    )?;
    Ok(deleted > 0)
}

/// Deletes all calendar feeds that a user created.
pub(super) async fn delete_all_of(tx: &mut Tx, user: UserId) -> Result<u64> {
    execute!(tx, "DELETE FROM calendar_feeds WHERE user_id = $1", user)
}

/// Deletes the calendar feeds that an API token made.
pub(super) async fn delete_made_by(tx: &mut Tx, token: TokenId) -> Result<u64> {
    execute!(
        tx,
        "DELETE FROM calendar_feeds WHERE made_by_token = $1",
        token
    )
}

/// Returns the calendar feeds and the recipients of the report that a user's API tokens made.
pub(super) async fn list_made(tx: &mut Tx, user: UserId) -> Result<Vec<(TokenId, Made)>> {
    let feeds = rows!(
        in &mut *tx,
        (TokenId, Uuid, String),
        "SELECT f.made_by_token, f.id, f.name FROM calendar_feeds f
         JOIN api_tokens t ON t.id = f.made_by_token
         WHERE t.user_id = $1
         ORDER BY f.id",
        user
    )?;
    let recipients = rows!(
        in tx,
        (TokenId, Uuid, String),
        "SELECT r.made_by_token, p.id, p.address FROM report_recipients p
         JOIN receivers r ON r.id = p.id
         JOIN api_tokens t ON t.id = r.made_by_token
         WHERE t.user_id = $1
         ORDER BY p.id",
        user
    )?;
    let mut made = named(MadeKind::CalendarFeed, feeds);
    made.extend(named(MadeKind::ReportRecipient, recipients));
    Ok(made)
}

/// Counts the calendar feeds of a tenant.
pub(super) fn count(tx: &mut Tx, tenant: Tenant, _: Time) -> BoxFuture<'_, Result<i64>> {
    Box::pin(async move {
        let found = row!(
            in tx,
            (i64,),
            "SELECT COUNT(*) FROM calendar_feeds WHERE operator_id = $1 OR firm_id = $2",
            tenant.operator(),
            tenant.firm()
        )?;
        Ok(found.map_or(0, |(count,)| count))
    })
}

/// Returns the owner of the calendar with this token, unless its creator is disabled.
pub(super) async fn find(db: &Db, token_hash: &[u8]) -> Result<Option<Scope>> {
    let found = row!(
        db,
        (String, Option<OperatorId>, Option<FirmId>, Option<VesselId>),
        "SELECT f.name, f.operator_id, f.firm_id, f.vessel_id FROM calendar_feeds f
         LEFT JOIN users u ON u.id = f.user_id
         WHERE f.token_hash = $1 AND u.disabled_at IS NULL
         ORDER BY f.id",
        token_hash
    )?;
    let scope = |(name, operator, firm, vessel): (_, Option<OperatorId>, Option<FirmId>, _)| {
        let tenant = operator.map(Tenant::Operator).or(firm.map(Tenant::Firm))?;
        Some(Scope {
            name,
            tenant,
            vessel,
        })
    };
    Ok(found.and_then(scope))
}

/// Returns the orders that a tenant sees, of one vessel or of all.
pub(super) async fn list_orders(
    db: &Db,
    tenant: Tenant,
    vessel: Option<VesselId>,
    now: Time,
) -> Result<Vec<CalendarOrder>> {
    rows!(
        db,
        CalendarOrder,
        "SELECT o.id, o.port, o.berth, o.planned_at,
                o.planned_at + o.job_us AS planned_until,
                v.name AS vessel_name,
                c.name AS compass_name, p.name AS operator_name, o.firm, o.adjuster_name,
                o.last_seq, e.line, o.call_fit,
                CASE f.state WHEN 'open' THEN 'offered' WHEN 'proposed' THEN 'proposed'
                             ELSE o.state END AS state
         FROM work_orders o
         JOIN vessels v ON v.id = o.vessel_id
         JOIN operators p ON p.id = v.operator_id
         JOIN compasses c ON c.vessel_id = o.vessel_id AND c.id = o.compass_id
         JOIN work_order_entries e ON e.vessel_id = o.vessel_id AND e.order_id = o.id
                                  AND e.seq = o.last_seq
         LEFT JOIN work_order_offers f ON f.vessel_id = o.vessel_id AND f.order_id = o.id
                                      AND f.firm_id = $1
         WHERE (v.operator_id = $2 OR f.state IN ('open', 'proposed', 'accepted'))
           AND ($3 IS NULL OR o.vessel_id = $3)
           AND o.planned_at > $4
         ORDER BY o.planned_at DESC, o.id DESC
         LIMIT $5",
        tenant.firm(),
        tenant.operator(),
        vessel,
        Time(now.0.plus_seconds(-PAST_ORDERS_S)),
        MAX_ORDERS
    )
}

/// Returns the port calls of a fleet or of one vessel, withdrawn ones included.
pub(super) async fn list_calls(
    db: &Db,
    operator: OperatorId,
    vessel: Option<VesselId>,
    now: Time,
) -> Result<Vec<CalendarCall>> {
    rows!(
        db,
        CalendarCall,
        "SELECT c.id, c.vessel_id, v.name AS vessel_name, c.port, c.berth, c.eta, c.eta_uncertainty_h, c.etd,
                c.etd_uncertainty_h, c.revision, c.created_at, c.revised_at, c.withdrawn_at,
                c.withdrawal_reason
         FROM port_calls c
         JOIN vessels v ON v.id = c.vessel_id
         WHERE v.operator_id = $1 AND c.etd > $3
           AND (c.vessel_id = $2 OR ($2 IS NULL AND v.out_of_service_at IS NULL))
         ORDER BY c.eta DESC, c.id DESC
         LIMIT $4",
        operator,
        vessel,
        Time(now.0.plus_seconds(-PAST_CALLS_S)),
        MAX_CALLS
    )
}

/// Returns the recorded due dates of a fleet or of one vessel.
pub(super) async fn list_due_dates(
    db: &Db,
    operator: OperatorId,
    vessel: Option<VesselId>,
) -> Result<Vec<CalendarDueDate>> {
    rows!(
        db,
        CalendarDueDate,
        "SELECT n.vessel_id, v.name AS vessel_name, n.compass_id, c.name AS compass_name,
                n.due_on, n.urgency, n.reason, n.version, n.changed_at
         FROM needs_told n
         JOIN vessels v ON v.id = n.vessel_id
         JOIN compasses c ON c.vessel_id = n.vessel_id AND c.id = n.compass_id
         WHERE v.operator_id = $1 AND ($2 IS NULL OR n.vessel_id = $2)
           AND n.urgency <> 'unknown'
         ORDER BY n.due_on, n.compass_id",
        operator,
        vessel
    )
}
