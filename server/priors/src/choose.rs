//! Choice of a compass's prior: the newest publication of its class, or a new one.

use crate::evidence::{self, Group};
use crate::publications;
use crate::vessel_priors::{self, Membership, RefusedClass, VesselPrior};
use anyhow::Context;
use binnacle_analysis::fleet_prior::{Class, FEWEST_SHIPS, FleetPrior, FleetPriorError, ShipPrior};
use binnacle_platform::db::Db;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use tracing::info;

/// Age at which a publication may be renewed, seconds: 30 days.
const RENEWED_AFTER_S: f64 = 30.0 * 86_400.0;

/// Returns the prior of a compass, which the first analysis by an estimator chooses. No
/// transaction may be open: a choice may publish, and computes in between.
///
/// # Errors
/// Fails when the database does, or holds what cannot be read.
pub async fn find_or_choose(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    now: Time,
) -> Result<VesselPrior> {
    if let Some(found) = vessel_priors::find(db, vessel, compass).await? {
        return Ok(found);
    }
    // An analysis without a prior of its own was made with the population's.
    let (prior, refused) = if vessel_priors::is_derived(db, vessel, compass).await? {
        (ShipPrior::population(), Vec::new())
    } else {
        choose(db, vessel, compass, now).await?
    };
    vessel_priors::insert(db, vessel, compass, &prior, &refused, now).await?;
    let stored = vessel_priors::find(db, vessel, compass).await?;
    Ok(stored.context("a prior that was just stored is gone")?)
}

/// Chooses the prior by the smallest class that is large enough. Returns it with the classes
/// that were not.
async fn choose(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    now: Time,
) -> Result<(ShipPrior, Vec<RefusedClass>)> {
    let membership = vessel_priors::find_membership(db, vessel, compass).await?;
    let mut refused = Vec::new();
    for group in groups(membership) {
        match by_group(db, group, vessel, now).await? {
            Ok(prior) => return Ok((prior, refused)),
            Err(too_small) => refused.push(too_small),
        }
    }
    Ok((ShipPrior::population(), refused))
}

/// Returns the groups that may inform a compass, the likest first.
fn groups(of: Membership) -> Vec<Group> {
    let sisters = of.sister_class.map(Class::Sisters);
    let fleet = Class::Operator(of.operator_id.to_string());
    let classes = sisters.into_iter().chain([fleet]);
    classes
        .map(|class| Group {
            operator: of.operator_id,
            class,
            role: of.role,
        })
        .collect()
}

/// Returns the prior by a group, or its refusal when it has too few other vessels.
async fn by_group(
    db: &Db,
    group: Group,
    vessel: VesselId,
    now: Time,
) -> Result<std::result::Result<ShipPrior, RefusedClass>> {
    let class = group.class.clone();
    let newest = publications::find_newest(db, &group).await?;
    let current = newest
        .as_ref()
        .filter(|newest| now.0.seconds_since(newest.published_at.0) < RENEWED_AFTER_S);
    let published = if let Some(newest) = current {
        newest.read()?
    } else {
        let edition = newest.map_or(1, |newest| newest.edition + 1);
        match publish(db, group, edition, vessel, now).await? {
            Ok(published) => published,
            Err(ships) => return Ok(Err(RefusedClass { class, ships })),
        }
    };
    let name = vessel.to_string();
    let prior = tokio::task::spawn_blocking(move || published.prior_for(&name)).await?;
    match prior {
        Ok(prior) => Ok(Ok(prior)),
        Err(FleetPriorError::TooFewShips { class, ships }) => {
            Ok(Err(RefusedClass { class, ships }))
        }
        Err(other) => Err(Error::Internal(other.into())),
    }
}

/// Publishes an edition of a group. Returns the number of vessels besides the one in question
/// when there are too few.
async fn publish(
    db: &Db,
    group: Group,
    edition: i64,
    vessel: VesselId,
    now: Time,
) -> Result<std::result::Result<FleetPrior, usize>> {
    let analysed = evidence::list(db, &group).await?;
    let ships = tokio::task::spawn_blocking(move || evidence::of_vessels(&analysed)).await?;
    let name = vessel.to_string();
    let others = ships.iter().filter(|ship| ship.vessel() != name).count();
    if others < FEWEST_SHIPS {
        return Ok(Err(others));
    }
    let prior = FleetPrior::new(group.class.clone(), ships, now.0).map_err(anyhow::Error::from)?;
    publications::publish(db, &group, edition, &prior).await?;
    info!(operator = %group.operator, ships = prior.ships().len(), "a fleet's prior was published");
    let newest = publications::find_newest(db, &group).await?;
    let newest = newest.context("a prior that was just published is gone")?;
    Ok(Ok(newest.read()?))
}
