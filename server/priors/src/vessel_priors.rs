//! Priors of compasses in the database.

use binnacle_analysis::fleet_prior::{Class, ShipPrior};
use binnacle_compass::result::ESTIMATOR;
use binnacle_fleet::compasses::Role;
use binnacle_platform::db::{self, Db, execute, row};
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, OperatorId, VesselId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};

/// Prior of a compass, as it was chosen.
#[derive(Clone, Debug)]
pub struct VesselPrior {
    /// Estimator whose analyses begin with it.
    pub estimator: String,
    /// Time at which it was chosen.
    pub chosen_at: Time,
    /// The prior.
    pub prior: ShipPrior,
    /// Classes that were too small.
    pub refused: Vec<RefusedClass>,
    text: String,
}

/// A class with too few vessels to inform one.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RefusedClass {
    /// The class.
    pub class: Class,
    /// Number of other vessels with evidence.
    pub ships: usize,
}

/// Columns of a prior.
#[derive(sqlx::FromRow)]
struct Stored {
    estimator: String,
    chosen_at: Time,
    prior: String,
    refused: String,
}

/// Columns that decide to which classes a compass belongs.
#[derive(Clone, Debug, sqlx::FromRow)]
pub(crate) struct Membership {
    pub(crate) operator_id: OperatorId,
    pub(crate) sister_class: Option<String>,
    pub(crate) role: Role,
}

impl VesselPrior {
    /// Returns the prior as it was stored, for the hash of an input; none for the population's.
    pub fn text_from_fleet(&self) -> Option<&str> {
        self.prior.basis.as_ref().map(|_| self.text.as_str())
    }
}

impl Stored {
    fn read(self) -> Result<VesselPrior> {
        Ok(VesselPrior {
            estimator: self.estimator,
            chosen_at: self.chosen_at,
            prior: serde_json::from_str(&self.prior)?,
            refused: serde_json::from_str(&self.refused)?,
            text: self.prior,
        })
    }
}

/// Finds the prior of a compass for this program's estimator.
pub(crate) async fn find(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<VesselPrior>> {
    let found = row!(
        db,
        Stored,
        "SELECT estimator, chosen_at, prior, refused FROM vessel_priors
         WHERE vessel_id = $1 AND compass_id = $2 AND estimator = $3
         ORDER BY estimator",
        vessel,
        compass,
        ESTIMATOR
    )?;
    found.map(Stored::read).transpose()
}

/// Finds the prior that the latest analysis of a compass began with.
pub(crate) async fn find_of_analysis(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Option<VesselPrior>> {
    let found = row!(
        db,
        Stored,
        "SELECT p.estimator, p.chosen_at, p.prior, p.refused FROM vessel_priors p
         JOIN analyses a ON a.vessel_id = p.vessel_id AND a.compass_id = p.compass_id
                        AND a.estimator = p.estimator
         WHERE p.vessel_id = $1 AND p.compass_id = $2
         ORDER BY p.estimator",
        vessel,
        compass
    )?;
    found.map(Stored::read).transpose()
}

/// Stores the prior of a compass. When another process stored one first, that one stays.
pub(crate) async fn insert(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    prior: &ShipPrior,
    refused: &[RefusedClass],
    now: Time,
) -> Result<()> {
    let mut tx = db.begin().await?;
    execute!(
        &mut tx,
        "INSERT INTO vessel_priors (vessel_id, compass_id, estimator, chosen_at, prior, refused)
         VALUES ($1, $2, $3, $4, $5, $6)
         ON CONFLICT (vessel_id, compass_id, estimator) DO NOTHING",
        vessel,
        compass,
        ESTIMATOR,
        now,
        serde_json::to_string(prior)?,
        serde_json::to_string(refused)?
    )?;
    Ok(tx.commit().await?)
}

/// Tells whether this program's estimator has analysed a compass.
pub(crate) async fn is_derived(db: &Db, vessel: VesselId, compass: CompassId) -> db::Result<bool> {
    let found = row!(
        db,
        (i64,),
        "SELECT COUNT(*) FROM analyses
         WHERE vessel_id = $1 AND compass_id = $2 AND estimator = $3",
        vessel,
        compass,
        ESTIMATOR
    )?;
    Ok(found.is_some_and(|(analyses,)| analyses > 0))
}

/// Finds what a compass's classes follow from.
pub(crate) async fn find_membership(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
) -> Result<Membership> {
    let found = row!(
        db,
        Membership,
        "SELECT v.operator_id, v.sister_class, c.role FROM vessels v
         JOIN compasses c ON c.vessel_id = v.id
         WHERE v.id = $1 AND c.id = $2
         ORDER BY c.id",
        vessel,
        compass
    )?;
    found.ok_or(Error::NotFound("compass"))
}
