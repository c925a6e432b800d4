//! Quotas: how much of something an operator or a firm may have, so that one of them, or a program
//! with a leaked token, cannot fill the server for all.
//!
//! Each capability declares its quotas and asks [`Quota::must_have_room`] in the transaction that
//! makes something. A platform admin may set other limits for an operator.

mod store;

use crate::db::{self, Db, Tx};
use crate::error::{DomainProblem, Result};
use crate::tenants::Tenant;
use crate::time::Time;
use axum::http::StatusCode;
use futures_util::future::BoxFuture;
use serde_json::Map;
use std::sync::Arc;

pub(crate) use store::set;

/// Function that counts what a tenant has.
pub type Count = for<'a> fn(&'a mut Tx, Tenant, Time) -> BoxFuture<'a, db::Result<i64>>;

/// Quota, declared by the capability whose things it limits.
#[derive(Clone, Copy, Debug)]
pub struct Quota {
    name: &'static str,
    things: &'static str,
    most: i64,
    count: Count,
}

/// All quotas of the server, in the order in which the API lists them.
#[derive(Clone, Debug)]
pub struct QuotaList(Arc<[Quota]>);

impl FromIterator<Quota> for QuotaList {
    fn from_iter<I: IntoIterator<Item = Quota>>(declared: I) -> QuotaList {
        QuotaList(declared.into_iter().collect())
    }
}

impl QuotaList {
    /// Returns the quota with a name.
    pub(crate) fn find(&self, name: &str) -> Option<&Quota> {
        self.0.iter().find(|quota| quota.name == name)
    }

    /// Returns the name of each quota, what a tenant has, and what it may have.
    pub(crate) async fn uses(
        &self,
        db: &Db,
        tenant: Tenant,
        now: Time,
    ) -> db::Result<Vec<(&'static str, i64, i64)>> {
        let mut tx = db.begin_reading().await?;
        let mut uses = Vec::new();
        for quota in self.0.iter() {
            let used = (quota.count)(&mut tx, tenant, now).await?;
            uses.push((
                quota.name,
                used,
                store::limit(&mut tx, tenant, quota).await?,
            ));
        }
        Ok(uses)
    }
}

impl Quota {
    /// Declares a quota: its name in the API, the things in words, and the limit by default.
    pub const fn new(name: &'static str, things: &'static str, most: i64, count: Count) -> Quota {
        Quota {
            name,
            things,
            most,
            count,
        }
    }

    /// Refuses to make one more if a tenant has as many as it may have.
    ///
    /// # Errors
    /// A problem of the type `quota-exceeded` with the limit.
    pub async fn must_have_room(
        &self,
        tx: &mut Tx,
        tenant: impl Into<Tenant>,
        now: Time,
    ) -> Result<()> {
        let tenant = tenant.into();
        let used = (self.count)(tx, tenant, now).await?;
        self.must_be_above(tx, tenant, used).await
    }

    /// Refuses what was made in this transaction if a tenant has more than it may have.
    ///
    /// # Errors
    /// A problem of the type `quota-exceeded` with the limit.
    pub async fn must_hold(&self, tx: &mut Tx, tenant: impl Into<Tenant>, now: Time) -> Result<()> {
        let tenant = tenant.into();
        let used = (self.count)(tx, tenant, now).await?;
        self.must_be_above(tx, tenant, used - 1).await
    }

    /// Refuses to make one more beside those that the caller has counted.
    ///
    /// # Errors
    /// A problem of the type `quota-exceeded` with the limit.
    pub async fn must_be_above(&self, tx: &mut Tx, tenant: Tenant, used: i64) -> Result<()> {
        let most = store::limit(tx, tenant, self).await?;
        if used < most {
            return Ok(());
        }
        let things = self.things;
        Err(DomainProblem {
            status: StatusCode::CONFLICT,
            kind: "quota-exceeded",
            title: "Quota used up",
            detail: format!("the limit on {things} is {most}; ask who runs this server for more"),
            extra: Map::from_iter([("quota".to_owned(), self.name.into())]),
        }
        .into())
    }
}
