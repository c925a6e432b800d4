//! Pages of lists: `?limit=&after=`, where `after` is the `next` of the previous page.

use super::json::time;
use crate::error::{Error, Result};
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use binnacle_compass::time::Timestamp;
use serde::Deserialize;
use utoipa::IntoParams;
use uuid::Uuid;

/// Requested part of a list.
#[derive(Clone, Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Page {
    /// Maximum number of items; 100 by default.
    #[param(minimum = 1, maximum = 10_000)]
    limit: Option<u32>,
    /// `next` of the previous page.
    after: Option<String>,
}

/// Period of a list.
#[derive(Clone, Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Period {
    /// Only from this instant on, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    from: Option<String>,
    /// Only before this instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime)]
    to: Option<String>,
}

impl Period {
    /// Returns the first instant of the period, and the first after it, microseconds since 1970.
    ///
    /// # Errors
    /// Fails when one of them is not RFC 3339.
    pub fn micros(&self) -> Result<(i64, i64)> {
        let from = time("from", self.from.as_deref())?;
        let to = time("to", self.to.as_deref())?;
        Ok((
            from.map_or(i64::MIN, Timestamp::micros),
            to.map_or(i64::MAX, Timestamp::micros),
        ))
    }
}

/// Page of a list.
pub struct Listed<T> {
    /// Items on this page.
    pub items: Vec<T>,
    /// Value of `after` for the next page.
    pub next: Option<String>,
}

const DEFAULT_LIMIT: u32 = 100;
const MAX_LIMIT: u32 = 10_000;

impl Page {
    /// Returns the id after which the page begins.
    ///
    /// # Errors
    /// Fails when the cursor is not of this list.
    pub fn after_id(&self) -> Result<Option<Uuid>> {
        let Some(after) = &self.after else {
            return Ok(None);
        };
        let id = Uuid::parse_str(after).map_err(|_| bad_cursor(after))?;
        Ok(Some(id))
    }

    /// Returns the number after which the page begins.
    ///
    /// # Errors
    /// Fails when the cursor is not of this list.
    pub fn after_number(&self) -> Result<Option<i64>> {
        let Some(after) = &self.after else {
            return Ok(None);
        };
        let number = after.parse().map_err(|_| bad_cursor(after))?;
        Ok(Some(number))
    }

    /// Returns the cursor of a list that is sorted by a number which several items may share. It
    /// consists of the number and the count of listed items with that number.
    ///
    /// # Errors
    /// Fails when the cursor is not of this list.
    pub fn after_shared(&self) -> Result<Option<(i64, usize)>> {
        let Some(after) = &self.after else {
            return Ok(None);
        };
        let parts = after.split_once('.');
        let read =
            parts.and_then(|(number, listed)| Some((number.parse().ok()?, listed.parse().ok()?)));
        read.map(Some).ok_or_else(|| bad_cursor(after))
    }

    /// Returns the cursor of a list that is sorted by time: an item's time and its id.
    ///
    /// # Errors
    /// Fails when the cursor is not of this list.
    pub fn after_time(&self) -> Result<Option<(i64, Uuid)>> {
        let Some(after) = &self.after else {
            return Ok(None);
        };
        let parts = after.split_once('.');
        let read = parts.and_then(|(micros, id)| Some((micros.parse().ok()?, id.parse().ok()?)));
        read.map(Some).ok_or_else(|| bad_cursor(after))
    }

    /// Returns the maximum number of items on a page.
    pub fn limit(&self) -> usize {
        self.limit.unwrap_or(DEFAULT_LIMIT) as usize
    }

    /// Returns the number of rows to fetch: one extra row shows that a next page exists.
    pub fn fetch(&self) -> i64 {
        self.limit() as i64 + 1
    }

    /// Cuts the fetched items to a page, see [`Page::fetch`].
    pub fn cut<T>(&self, mut items: Vec<T>, cursor: impl Fn(&T) -> String) -> Listed<T> {
        let more = items.len() > self.limit();
        items.truncate(self.limit());
        let next = items.last().filter(|_| more).map(cursor);
        Listed { items, next }
    }
}

fn bad_cursor(after: &str) -> Error {
    Error::BadRequest(format!("after: {after:?} is not a cursor of this list"))
}

impl<S: Send + Sync> FromRequestParts<S> for Page {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Page> {
        let axum::extract::Query(page): axum::extract::Query<Page> =
            axum::extract::Query::from_request_parts(parts, state).await?;
        if !(1..=MAX_LIMIT as usize).contains(&page.limit()) {
            let outside = format!("limit: {} is outside 1 to {MAX_LIMIT}", page.limit());
            return Err(Error::BadRequest(outside));
        }
        Ok(page)
    }
}
