//! Facts of a request, gathered while it is served and then written as a line.

use super::refusal::Refused;
use super::{ActorKind, Line, store};
use crate::app::App;
use crate::db::{self, CommitHook, Tx};
use crate::ids::{AgentId, OrderId, TokenId, UserId, VesselId};
use crate::tenants::{OwnerOf, Tenant};
use crate::time::Time;
use axum::http::StatusCode;
use futures_util::future::BoxFuture;
use std::sync::{Mutex, MutexGuard, PoisonError};
use tracing::{error, warn};
use uuid::Uuid;

/// Function that finds the vessel of what a request is about.
pub type FindVessel = for<'a> fn(&'a mut Tx, Uuid) -> BoxFuture<'a, db::Result<Option<VesselId>>>;

/// Actor of a request.
#[derive(Clone, Debug)]
pub struct Actor {
    kind: ActorKind,
    id: Option<Uuid>,
    name: String,
    token: Option<TokenId>,
    tenant: Option<Tenant>,
    vessel: Option<VesselId>,
}

impl Actor {
    /// Returns the actor for a person.
    pub fn person(id: UserId, name: &str, tenant: Option<Tenant>) -> Actor {
        Actor {
            kind: ActorKind::User,
            id: Some(id.0),
            name: name.to_owned(),
            token: None,
            tenant,
            vessel: None,
        }
    }

    /// Sets the API token that acts for the person, if there is one.
    #[must_use]
    pub fn with_token(self, token: Option<TokenId>) -> Actor {
        let kind = match token {
            Some(_) => ActorKind::Token,
            None => self.kind,
        };
        Actor {
            kind,
            token,
            ..self
        }
    }

    /// Returns the actor for a vessel's agent.
    pub fn agent(id: AgentId, vessel: VesselId) -> Actor {
        Actor {
            kind: ActorKind::Agent,
            id: Some(id.0),
            name: String::new(),
            token: None,
            tenant: None,
            vessel: Some(vessel),
        }
    }

    /// Returns the actor for the server's own command line.
    pub(super) fn command_line() -> Actor {
        Actor::without_id(ActorKind::Command, "command line")
    }

    /// Returns the actor for somebody who did not prove who they are, and the tenant whose account it
    /// is about.
    pub fn unidentified(tenant: Option<Tenant>) -> Actor {
        Actor {
            tenant,
            ..Actor::without_id(ActorKind::Unidentified, "")
        }
    }

    /// Returns the actor's tenant.
    pub(super) fn tenant(&self) -> Option<Tenant> {
        self.tenant
    }

    fn without_id(kind: ActorKind, name: &str) -> Actor {
        Actor {
            kind,
            id: None,
            name: name.to_owned(),
            token: None,
            tenant: None,
            vessel: None,
        }
    }
}

/// Audit record of a request: the facts known from the start, and those found while it is
/// served.
pub(super) struct AuditTrail {
    pub(super) id: Uuid,
    pub(super) at: Time,
    pub(super) address: String,
    /// Network of the address, under which refusals are counted.
    pub(super) network: String,
    pub(super) method: String,
    pub(super) route: String,
    pub(super) path: String,
    pub(super) facts: Mutex<Facts>,
}

#[derive(Clone, Default)]
pub(super) struct Facts {
    pub(super) actor: Option<Actor>,
    pub(super) tenant: Option<Tenant>,
    pub(super) vessel: Option<VesselId>,
    /// Id of what the request is about, if that is a single thing of the vessel.
    pub(super) about: Option<Uuid>,
    /// Lookup of the vessel, where only `about` is known.
    pub(super) find_vessel: Option<FindVessel>,
    /// Refusal of a sign-in, a code or a token.
    pub(super) refused: Option<Refused>,
    /// True if the request is logged as a change, in the transaction of the change.
    pub(super) is_change: bool,
    /// True if reads by a firm are logged.
    pub(super) logs_firms: bool,
    /// True if the line is on disk.
    pub(super) is_written: bool,
}

impl Facts {
    /// Returns true if a request of a known actor has a line though it changed nothing.
    fn is_due_of(&self, actor: &Actor, status: StatusCode) -> bool {
        let is_read =
            status.is_success() && self.logs_firms && matches!(actor.tenant, Some(Tenant::Firm(_)));
        let is_tried = self.is_change && status != StatusCode::METHOD_NOT_ALLOWED;
        is_read || is_tried
    }
}

impl CommitHook for AuditTrail {
    /// Writes the line, if this is a change by a known actor or a refusal, and has no line yet.
    fn before_commit<'a>(&'a self, tx: &'a mut Tx) -> BoxFuture<'a, db::Result<bool>> {
        Box::pin(async move {
            let is_due = {
                let facts = self.facts();
                (facts.is_change || facts.refused.is_some()) && !facts.is_written
            };
            if !is_due {
                return Ok(false);
            }
            self.write(tx, None).await
        })
    }

    fn committed(&self) {
        self.facts().is_written = true;
    }

    fn token(&self) -> Option<TokenId> {
        self.facts().actor.as_ref().and_then(|actor| actor.token)
    }
}

impl AuditTrail {
    pub(super) fn facts(&self) -> MutexGuard<'_, Facts> {
        self.facts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the record of what the request starts and does not wait for.
    pub(super) fn after_response(&self, actor: Actor) -> AuditTrail {
        let facts = Facts {
            actor: Some(actor),
            is_change: true,
            ..Facts::default()
        };
        AuditTrail {
            id: Uuid::now_v7(),
            at: self.at,
            address: self.address.clone(),
            network: self.network.clone(),
            method: self.method.clone(),
            route: self.route.clone(),
            path: self.path.clone(),
            facts: Mutex::new(facts),
        }
    }

    pub(super) fn is_of_agent(&self) -> bool {
        let facts = self.facts();
        let actor = facts.actor.as_ref();
        actor.is_some_and(|actor| actor.kind == ActorKind::Agent)
    }

    /// Records the status of the response. Returns true if there is a line.
    pub(super) async fn finish(&self, app: &App, status: StatusCode) -> db::Result<bool> {
        let (db, facts) = (&app.db, self.facts().clone());
        if let Some(refused) = &facts.refused {
            self.log(refused);
        }
        let code = i64::from(status.as_u16());
        if facts.is_written {
            // The line and the change are stored, so the response stands.
            if let Err(cause) = store::set_status(db, self.id, code).await {
                error!(error = ?cause, id = %self.id, "a status is missing in the audit log");
            }
            return Ok(true);
        }
        let is_due = match (&facts.refused, &facts.actor) {
            (Some(refused), _) => {
                let now_s = u64::try_from(self.at.0.micros() / 1_000_000).unwrap_or(0);
                refused.is_listed(&app.refusal_rates, &self.network, now_s)
            }
            (None, Some(actor)) => facts.is_due_of(actor, status),
            (None, None) => false,
        };
        if !is_due {
            return Ok(false);
        }
        let mut tx = db.begin().await?;
        let written = self.write(&mut tx, Some(status)).await?;
        tx.commit().await?;
        Ok(written)
    }

    /// Writes a refusal into the server's own log. The address comes before what a stranger wrote,
    /// which is quoted.
    fn log(&self, refused: &Refused) {
        warn!(
            target: "binnacle::refused",
            refusal = refused.why.name(),
            address = %self.address,
            account = refused.account.as_deref().unwrap_or_default(),
            route = self.route.as_str(),
            request = %self.id,
            "refused"
        );
    }

    /// Writes the line, if the actor is known or was refused. Without a status it records a
    /// completed change.
    async fn write(&self, tx: &mut Tx, status: Option<StatusCode>) -> db::Result<bool> {
        let facts = self.facts().clone();
        let stranger = facts.refused.as_ref().map(|_| Actor::unidentified(None));
        let Some(actor) = facts.actor.or(stranger) else {
            return Ok(false);
        };
        let is_done = facts.refused.is_none() && status.is_none_or(|status| status.is_success());
        let tried = match &facts.refused {
            Some(refused) => refused.tenant(tx).await?,
            None => None,
        };
        let named = facts.vessel.or(actor.vessel);
        let mut vessel = named.or(self.id_after("/api/v1/vessels/{id}").map(VesselId));
        // A refused request reveals nothing, and appears only in the caller's own log.
        let mut owner = None;
        if is_done {
            if let (None, Some(about), Some(find)) = (vessel, facts.about, facts.find_vessel) {
                vessel = find(tx, about).await?;
            }
            if let Some(vessel) = vessel {
                owner = tx.ask(&OwnerOf(vessel)).await?;
            }
        }
        let owner_id = owner.as_ref().map(|owner| owner.operator_id.0);
        let (operator_id, firm_id) = match facts.tenant.or(actor.tenant).or(tried) {
            Some(Tenant::Operator(operator)) => (Some(operator.0), None),
            Some(Tenant::Firm(firm)) => (owner_id, Some(firm.0)),
            None => (
                owner_id.or(self.id_after("/api/v1/operators/{id}")),
                self.id_after("/api/v1/firms/{id}"),
            ),
        };
        let actor_name = match (actor.kind, owner) {
            (ActorKind::Agent, Some(owner)) => owner.name,
            _ => actor.name,
        };
        let line = Line {
            id: self.id,
            at: self.at,
            actor_kind: actor.kind,
            actor_id: actor.id,
            actor_name,
            token_id: actor.token,
            operator_id,
            firm_id,
            address: self.address.clone(),
            method: self.method.clone(),
            route: self.route.clone(),
            path: self.path.clone(),
            vessel_id: vessel,
            order_id: facts.about.map(OrderId),
            status: status.map(|status| i64::from(status.as_u16())),
            refusal: facts.refused.as_ref().map(|refused| refused.why),
            account: facts.refused.and_then(|refused| refused.account),
        };
        store::insert(tx, &line).await?;
        Ok(true)
    }

    /// Returns the id in the path, if the route begins with the given text.
    fn id_after(&self, route: &str) -> Option<Uuid> {
        let begins = self.route.starts_with(route);
        let mut segments = self.path.split('/').filter(|_| begins);
        segments.find_map(|segment| Uuid::parse_str(segment).ok())
    }
}
