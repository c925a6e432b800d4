//! Handlers of events that end calendar feeds, and what API tokens have made.

use super::store;
use binnacle_platform::db::Tx;
use binnacle_platform::error::Result;
use binnacle_platform::tokens::{Made, MadeByTokens, RevokedWithMade};
use binnacle_platform::users::AccessEnded;
use binnacle_platform::{db, ids::TokenId};
use futures_util::future::BoxFuture;

/// Deletes the calendar feeds of a user whose access ends.
pub fn delete_feeds<'a>(tx: &'a mut Tx, event: &'a AccessEnded) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move {
        store::delete_all_of(tx, event.user).await?;
        Ok(())
    })
}

/// Deletes the calendar feeds that a token made, which is revoked with them.
pub fn delete_made<'a>(tx: &'a mut Tx, event: &'a RevokedWithMade) -> BoxFuture<'a, Result<()>> {
    Box::pin(async move {
        store::delete_made_by(tx, event.token).await?;
        Ok(())
    })
}

/// Answers what a user's tokens have made here: calendar feeds and recipients of the report.
pub fn list_made<'a>(
    tx: &'a mut Tx,
    question: &'a MadeByTokens,
) -> BoxFuture<'a, db::Result<Vec<(TokenId, Made)>>> {
    Box::pin(async move { store::list_made(tx, question.0).await })
}
