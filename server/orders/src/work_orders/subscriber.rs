//! Subscribers that refuse events which orders under way do not allow.

use crate::work_orders::store;
use binnacle_fleet::binnacles::BinnacleAmended;
use binnacle_fleet::compasses;
use binnacle_fleet::vessel_api::ServiceChanged;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Result};
use futures_util::future::BoxFuture;

/// Refuses to take a vessel out of service while one of its orders is under way.
pub fn refuse_leave_of_service<'a>(
    tx: &'a mut Tx,
    change: &'a ServiceChanged,
) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move {
        if change.in_service {
            return Ok(());
        }
        for compass in compasses::ids(tx, change.vessel).await? {
            if store::is_under_way(tx, change.vessel, compass).await? {
                return Err(Error::WrongState(format!(
                    "a work order of {} is under way: cancel it first, or have it done",
                    change.vessel_name
                )));
            }
        }
        Ok(())
    })
}

/// Refuses a revision of a binnacle whose correctors are being moved.
pub fn refuse_amended_binnacle<'a>(
    tx: &'a mut Tx,
    amended: &'a BinnacleAmended,
) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move {
        if !store::is_adjusting(tx, amended.vessel, amended.compass).await? {
            return Ok(());
        }
        Err(Error::WrongState(
            "this compass is being adjusted: report the settings of its correctors to its work \
                order, which revises the binnacle when it is completed or cancelled"
                .to_owned(),
        ))
    })
}
