//! Request context for handlers: it begins the transactions that carry the audit line.

use super::refusal::{Refusal, Refused};
use super::trail::{Actor, AuditTrail, Facts, FindVessel};
use crate::db::{self, Db, Tx};
use crate::error::{Error, Result};
use crate::ids::VesselId;
use crate::tenants::Tenant;
use crate::time::Time;
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use std::sync::{Arc, Mutex};
use uuid::Uuid;

/// Context of a request or a command that may change something.
///
/// Handlers name it in their arguments and pass it to every function that writes. A
/// transaction begun by it contains the request's audit line when it is committed.
#[derive(Clone)]
pub struct RequestContext {
    db: Db,
    trail: Arc<AuditTrail>,
}

impl RequestContext {
    pub(super) fn new(db: Db, trail: Arc<AuditTrail>) -> RequestContext {
        RequestContext { db, trail }
    }

    /// Creates the context of a command on the server itself.
    pub fn of_command(db: &Db, command: &str, now: Time) -> RequestContext {
        let facts = Facts {
            actor: Some(Actor::command_line()),
            is_change: true,
            ..Facts::default()
        };
        let trail = AuditTrail {
            id: Uuid::now_v7(),
            at: now,
            address: String::new(),
            network: String::new(),
            method: String::new(),
            route: command.to_owned(),
            path: command.to_owned(),
            facts: Mutex::new(facts),
        };
        RequestContext::new(db.clone(), Arc::new(trail))
    }

    /// Returns the context of a request from its parts.
    ///
    /// # Errors
    /// Fails when the request has not passed the audit middleware.
    pub fn of(parts: &Parts) -> Result<&RequestContext> {
        let found = parts.extensions.get::<RequestContext>();
        found.ok_or_else(|| Error::Internal(anyhow::anyhow!("a route without the audit log")))
    }

    /// Returns the database, for reading.
    pub fn db(&self) -> &Db {
        &self.db
    }

    /// Begins a transaction that carries the audit line.
    pub async fn begin(&self) -> db::Result<Tx> {
        let hook = Arc::clone(&self.trail);
        Ok(self.db.begin().await?.with_hook(hook))
    }

    /// Records the actor as soon as it is known.
    pub fn record_actor(&self, actor: impl Into<Actor>) {
        self.trail.facts().actor = Some(actor.into());
    }

    /// Records that a sign-in, a code or a token was refused, and the e-mail address that was
    /// tried. This belongs before the transaction that counts the failure.
    pub fn refuse(&self, why: Refusal, account: Option<&str>) {
        self.trail.facts().refused = Some(Refused::new(why, account));
    }

    /// Records the tenant concerned, where the path does not identify it.
    pub fn concerns(&self, tenant: Tenant) {
        self.trail.facts().tenant = Some(tenant);
    }

    /// Records the vessel concerned where the path does not identify it, and what of it the
    /// request is about, if that is a single thing.
    pub fn concerns_vessel(&self, vessel: VesselId, about: Option<Uuid>) {
        let mut facts = self.trail.facts();
        facts.vessel = Some(vessel);
        facts.about = about.or(facts.about);
    }

    /// Records what the request is about, of an unknown vessel. The vessel is looked up when the
    /// line is written, and only for a successful request: a refusal must not reveal the owner.
    pub fn is_about(&self, about: Uuid, find_vessel: FindVessel) {
        let mut facts = self.trail.facts();
        facts.about = Some(about);
        facts.find_vessel = Some(find_vessel);
    }

    /// Returns the tenant of the actor, if both are known.
    pub fn tenant(&self) -> Option<Tenant> {
        let facts = self.trail.facts();
        facts.actor.as_ref().and_then(Actor::tenant)
    }

    /// Returns the context of what a request starts and does not wait for. It has a line of its own,
    /// since that of the request may be written before.
    #[must_use]
    pub fn after_response(&self, actor: Actor) -> RequestContext {
        let trail = self.trail.after_response(actor);
        RequestContext::new(self.db.clone(), Arc::new(trail))
    }

    /// Logs reads by firms on this request.
    pub fn log_reads_of_firms(&self) {
        self.trail.facts().logs_firms = true;
    }

    /// Logs the request as a change, though its method is a safe one.
    pub fn log_as_change(&self) {
        self.trail.facts().is_change = true;
    }

    /// Excludes a change from the audit log: what it writes is a log itself.
    pub fn leave_out(&self) {
        self.trail.facts().is_change = false;
    }
}

impl<S: Send + Sync> FromRequestParts<S> for RequestContext {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<RequestContext> {
        RequestContext::of(parts).cloned()
    }
}
