//! Handler of events that end calendar feeds.

use super::store;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::users::AccessEnded;
use futures_util::future::BoxFuture;

/// Deletes the calendar feeds of a user whose access ends.
pub fn delete_feeds<'a>(tx: &'a mut Tx, event: &'a AccessEnded) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move {
        store::delete_all_of(tx, event.user).await?;
        Ok(())
    })
}
