//! Handler of headings read alongside.

use super::store;
use binnacle_orders::berth_session::BerthHeadingRead;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use futures_util::future::BoxFuture;

/// Stores a heading read alongside with the vessel's current call.
pub fn note_berth_heading<'a>(
    tx: &'a mut Tx,
    read: &'a BerthHeadingRead,
) -> BoxFuture<'a, Result<()>> {
    Box::pin(
        async move { store::set_lay_heading(tx, read.vessel, read.at, read.heading_deg).await },
    )
}
