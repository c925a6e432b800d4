//! Published priors in the database.

use crate::evidence::Group;
use binnacle_analysis::fleet_prior::{Class, FleetPrior, METHOD};
use binnacle_compass::result::ESTIMATOR;
use binnacle_fleet::compasses::Role;
use binnacle_platform::db::{Db, Result, execute, row, rows};
use binnacle_platform::error;
use binnacle_platform::ids::{FleetPriorId, OperatorId};
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Newest publication of a class.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(crate) struct Newest {
    pub(crate) edition: i64,
    pub(crate) published_at: Time,
    prior: String,
}

impl Newest {
    /// Reads the artefact.
    pub(crate) fn read(&self) -> error::Result<FleetPrior> {
        Ok(serde_json::from_str(&self.prior)?)
    }
}

/// Description of a publication.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(crate) struct Listed {
    pub(crate) id: FleetPriorId,
    pub(crate) published_at: Time,
    pub(crate) estimator: String,
    pub(crate) method: i64,
    pub(crate) class_kind: String,
    pub(crate) class_name: String,
    pub(crate) role: Role,
    pub(crate) ships: i64,
}

/// Returns the kind and the name of a class, as the columns have them.
fn columns(class: &Class) -> (&'static str, &str) {
    match class {
        Class::Sisters(name) => ("sisters", name),
        Class::Operator(id) => ("operator", id),
    }
}

/// Finds the newest publication of a group for this program's estimator and method.
pub(crate) async fn find_newest(db: &Db, group: &Group) -> Result<Option<Newest>> {
    let (kind, name) = columns(&group.class);
    row!(
        db,
        Newest,
        "SELECT edition, published_at, prior FROM fleet_priors
         WHERE operator_id = $1 AND estimator = $2 AND method = $3 AND class_kind = $4
           AND class_name = $5 AND role = $6
         ORDER BY edition DESC
         LIMIT 1",
        group.operator,
        ESTIMATOR,
        i64::from(METHOD),
        kind,
        name,
        group.role
    )
}

/// Stores a publication as an edition of its group. When another process stored that edition
/// first, that one stays.
pub(crate) async fn publish(
    db: &Db,
    group: &Group,
    edition: i64,
    prior: &FleetPrior,
) -> error::Result<()> {
    let (kind, name) = columns(&group.class);
    let text = serde_json::to_string(prior)?;
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "INSERT INTO fleet_priors (operator_id, id, published_at, estimator, method, class_kind,
                                   class_name, role, edition, ships, prior)
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)
         ON CONFLICT (operator_id, estimator, method, class_kind, class_name, role, edition)
         DO NOTHING",
        group.operator,
        FleetPriorId::new(),
        Time(prior.made_at()),
        ESTIMATOR,
        i64::from(prior.method()),
        kind,
        name,
        group.role,
        edition,
        prior.ships().len() as i64,
        text
    )?;
    Ok(tx.commit().await?)
}

/// Lists an operator's publications before an id, the newest first.
pub(crate) async fn list(
    db: &Db,
    operator: OperatorId,
    before: Option<Uuid>,
    limit: i64,
) -> Result<Vec<Listed>> {
    rows!(
        db,
        Listed,
        "SELECT id, published_at, estimator, method, class_kind, class_name, role, ships
         FROM fleet_priors
         WHERE operator_id = $1 AND id < $2
         ORDER BY id DESC
         LIMIT $3",
        operator,
        before.unwrap_or(Uuid::max()),
        limit
    )
}
