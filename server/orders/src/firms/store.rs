//! Firms and their engagements in the database.

use binnacle_platform::db::{Db, Result, Tx, execute, row, rows};
use binnacle_platform::ids::{FirmId, OperatorId};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use futures_util::future::BoxFuture;
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

/// Company that adjusts compasses.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
pub(super) struct Firm {
    /// Its id.
    pub(super) id: FirmId,
    /// Its name.
    #[schema(example = "Nervión Compass")]
    pub(super) name: String,
    /// Time of its creation here.
    pub(super) created_at: Time,
    /// True if your operator has entered the firm and it works for no other: then your admins
    /// invite its users.
    pub(super) is_own: bool,
}

/// Creates a firm.
pub async fn create(tx: &mut Tx, name: &str, now: Time) -> Result<FirmId> {
    let id = FirmId::new();
    insert(tx, id, name, None, now).await?;
    Ok(id)
}

pub(super) async fn insert(
    tx: &mut Tx,
    id: FirmId,
    name: &str,
    founder: Option<OperatorId>,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO firms (id, name, founded_by, created_at) VALUES ($1, $2, $3, $4)",
        id,
        name,
        founder,
        now
    )?;
    Ok(())
}

/// Counts the firms that an operator has entered.
pub(super) fn count(tx: &mut Tx, tenant: Tenant, _: Time) -> BoxFuture<'_, Result<i64>> {
    Box::pin(async move {
        let found = row!(
            in tx,
            (i64,),
            "SELECT COUNT(*) FROM firms WHERE founded_by = $1",
            tenant.operator()
        )?;
        Ok(found.map_or(0, |(count,)| count))
    })
}

/// Returns whether a firm exists.
pub async fn exists(tx: &mut Tx, id: FirmId) -> Result<bool> {
    let found = row!(
        in tx,
        (FirmId,),
        "SELECT id FROM firms WHERE id = $1 ORDER BY id",
        id
    )?;
    Ok(found.is_some())
}

/// Finds the name of a firm that works for an operator.
pub async fn find_name(tx: &mut Tx, operator: OperatorId, firm: FirmId) -> Result<Option<String>> {
    let found = row!(
        in tx,
        (String,),
        "SELECT f.name FROM firms f
         JOIN operator_firms w ON w.firm_id = f.id AND w.operator_id = $1
         WHERE f.id = $2
         ORDER BY f.id",
        operator,
        firm
    )?;
    Ok(found.map(|(name,)| name))
}

/// Engages a firm for an operator; repetition has no effect.
pub async fn engage(tx: &mut Tx, operator: OperatorId, firm: FirmId, now: Time) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO operator_firms (operator_id, firm_id, created_at) VALUES ($1, $2, $3)
         ON CONFLICT (operator_id, firm_id) DO NOTHING",
        operator,
        firm,
        now
    )?;
    Ok(())
}

/// Ends a firm's engagement; returns whether there was one.
pub(super) async fn dismiss(tx: &mut Tx, operator: OperatorId, firm: FirmId) -> Result<bool> {
    let ended = execute!(
        tx,
        "DELETE FROM operator_firms WHERE operator_id = $1 AND firm_id = $2",
        operator,
        firm
    )?;
    Ok(ended > 0)
}

/// Counts an operator's unfinished orders that a firm has been offered or has. Other bookings of
/// the firm wait for the transaction.
pub(super) async fn count_open_orders(
    tx: &mut Tx,
    operator: OperatorId,
    firm: FirmId,
) -> Result<i64> {
    execute!(&mut *tx, "UPDATE firms SET name = name WHERE id = $1", firm)?;
    let found = row!(
        in tx,
        (i64,),
        "SELECT COUNT(*) FROM work_order_offers f
         JOIN work_orders o ON o.vessel_id = f.vessel_id AND o.id = f.order_id
         JOIN vessels v ON v.id = o.vessel_id
         WHERE f.firm_id = $1 AND v.operator_id = $2
           AND f.state IN ('waiting', 'open', 'proposed', 'accepted')
           AND o.state IN ('offered', 'proposed', 'accepted', 'on_board', 'measured', 'adjusting')",
        firm,
        operator
    )?;
    Ok(found.map_or(0, |(orders,)| orders))
}

/// Stores a firm's terms for an operator.
pub(super) async fn put_terms(
    tx: &mut Tx,
    operator: OperatorId,
    firm: FirmId,
    terms: &str,
    by: &str,
    now: Time,
) -> Result<()> {
    execute!(
        tx,
        "INSERT INTO firm_terms (operator_id, firm_id, terms, changed_at, changed_by)
         VALUES ($1, $2, $3, $4, $5)
         ON CONFLICT (operator_id, firm_id) DO UPDATE
         SET terms = excluded.terms, changed_at = excluded.changed_at,
             changed_by = excluded.changed_by",
        operator,
        firm,
        terms,
        now,
        by
    )?;
    Ok(())
}

/// Removes a firm's terms for an operator; returns whether there were any.
pub(super) async fn remove_terms(tx: &mut Tx, operator: OperatorId, firm: FirmId) -> Result<bool> {
    let removed = execute!(
        tx,
        "DELETE FROM firm_terms WHERE operator_id = $1 AND firm_id = $2",
        operator,
        firm
    )?;
    Ok(removed > 0)
}

/// Firm that works for an operator, as it is stored.
#[derive(sqlx::FromRow)]
pub(super) struct StoredFirm {
    pub(super) id: FirmId,
    pub(super) name: String,
    /// Terms for the operator, as JSON.
    pub(super) terms: Option<String>,
    /// The firm's own statement of its teams, as JSON.
    pub(super) teams: Option<String>,
}

/// Lists the firms that work for an operator.
pub(super) async fn list_with_terms(db: &Db, operator: OperatorId) -> Result<Vec<StoredFirm>> {
    rows!(
        db,
        StoredFirm,
        "SELECT f.id, f.name, t.terms, s.teams FROM firms f
         JOIN operator_firms w ON w.firm_id = f.id AND w.operator_id = $1
         LEFT JOIN firm_terms t ON t.firm_id = f.id AND t.operator_id = $1
         LEFT JOIN firm_teams s ON s.firm_id = f.id
         ORDER BY f.id",
        operator
    )
}

/// Lists a firm's terms, for all its operators.
pub(super) async fn list_terms(tx: &mut Tx, firm: FirmId) -> Result<Vec<(OperatorId, String)>> {
    rows!(
        in tx,
        (OperatorId, String),
        "SELECT t.operator_id, t.terms FROM firm_terms t
         JOIN operator_firms w ON w.firm_id = t.firm_id AND w.operator_id = t.operator_id
         WHERE t.firm_id = $1
         ORDER BY t.operator_id",
        firm
    )
}

/// Lists the firms that a tenant sees: all, those of an operator, or a firm itself.
pub(super) async fn list(
    db: &Db,
    who: Option<Tenant>,
    after: Option<Uuid>,
    limit: i64,
) -> Result<Vec<Firm>> {
    let (operator, firm) = (who.and_then(Tenant::operator), who.and_then(Tenant::firm));
    rows!(
        db,
        Firm,
        "SELECT id, name, created_at,
                COALESCE(founded_by = $1 AND NOT EXISTS (
                    SELECT 1 FROM operator_firms w
                    WHERE w.firm_id = firms.id AND w.operator_id <> $1), FALSE) AS is_own
         FROM firms
         WHERE ($1 IS NULL OR EXISTS (SELECT 1 FROM operator_firms w
                                      WHERE w.operator_id = $1 AND w.firm_id = firms.id))
           AND ($2 IS NULL OR id = $2)
           AND id > $3
         ORDER BY id
         LIMIT $4",
        operator,
        firm,
        after.unwrap_or_default(),
        limit
    )
}

/// Finds a firm that a tenant sees.
pub(super) async fn find(db: &Db, who: Option<Tenant>, id: FirmId) -> Result<Option<Firm>> {
    row!(
        db,
        Firm,
        "SELECT id, name, created_at,
                COALESCE(founded_by = $1 AND NOT EXISTS (
                    SELECT 1 FROM operator_firms w
                    WHERE w.firm_id = firms.id AND w.operator_id <> $1), FALSE) AS is_own
         FROM firms
         WHERE ($1 IS NULL OR EXISTS (SELECT 1 FROM operator_firms w
                                      WHERE w.operator_id = $1 AND w.firm_id = firms.id))
           AND ($2 IS NULL OR id = $2)
           AND id = $3
         ORDER BY id",
        who.and_then(Tenant::operator),
        who.and_then(Tenant::firm),
        id
    )
}
