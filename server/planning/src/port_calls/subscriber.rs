//! Handler of events that port calls learn from.

use super::store;
use binnacle_orders::berth_session::BerthHeadingRead;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use futures_util::future::BoxFuture;

/// Notes how a vessel lies in the call that it is in, as it was read alongside.
pub fn note_berth_heading<'a>(
    tx: &'a mut Tx,
    read: &'a BerthHeadingRead,
) -> BoxFuture<'a, Result<()>> {
    Box::pin(
        async move { store::set_lay_heading(tx, read.vessel, read.at, read.heading_deg).await },
    )
}
