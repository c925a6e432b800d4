//! Access control: extractors that a handler names in its arguments.
//!
//! Invariants: a [`Reader`] and a [`Writer`] belong to one operator, and every query about
//! a fleet takes that operator's id. A [`PartyReader`] and a [`PartyWriter`] belong to an
//! operator or a firm, and see nothing of any other tenant. A request authenticated by
//! cookie may change something only with the header `X-Binnacle-Request`, which another
//! site's form cannot send.

use crate::app::App;
use crate::audit::{Actor, Refusal, RequestContext};
use crate::error::{Error, Result};
use crate::ids::{FirmId, OperatorId, SessionId, TokenId, UserId};
use crate::secret;
use crate::session::{self, Role, User, cookie};
use crate::tenants::Tenant;
use crate::tokens::{self, Scope};
use axum::extract::{FromRef, FromRequestParts};
use axum::http::header::AUTHORIZATION;
use axum::http::request::Parts;

/// Header that our own pages send with every change.
pub const REQUEST_HEADER: &str = "x-binnacle-request";

/// Authenticated caller: a person, or a token that acts for one.
#[derive(Clone, Debug)]
pub struct Caller {
    /// User who calls, or for whom the token acts.
    pub user: User,
    /// True if the token may only read.
    pub read_only: bool,
    /// Session, if a cookie identified one.
    pub session: Option<SessionId>,
    /// API token, if one was sent.
    pub token: Option<TokenId>,
}

/// Caller who may see an operator's fleet.
#[derive(Clone, Copy, Debug)]
pub struct Reader {
    /// Operator of the fleet.
    pub operator: OperatorId,
    /// Calling user.
    pub user: UserId,
}

/// Caller who may change an operator's fleet.
#[derive(Clone, Copy, Debug)]
pub struct Writer {
    /// Operator of the fleet.
    pub operator: OperatorId,
    /// Calling user.
    pub user: UserId,
}

/// Operator's admin, who may read what only admins may.
#[derive(Clone, Copy, Debug)]
pub struct AdminReader {
    /// Operator that the admin belongs to.
    pub operator: OperatorId,
    /// Calling user.
    pub user: UserId,
}

/// Operator's admin with a session, who may manage users and sign-in rules. A leaked token
/// must not be able to create users or to take over an account.
#[derive(Clone, Copy, Debug)]
pub struct AdminWriter {
    /// Operator that the admin belongs to.
    pub operator: OperatorId,
    /// Calling user.
    pub user: UserId,
}

/// Caller of an operator or a firm, who may read what the two share.
#[derive(Clone, Copy, Debug)]
pub struct PartyReader {
    /// Operator or firm of the caller.
    pub tenant: Tenant,
    /// Calling user.
    pub user: UserId,
}

/// Caller of an operator or a firm, who may change what the two share.
#[derive(Clone, Copy, Debug)]
pub struct PartyWriter {
    /// Operator or firm of the caller.
    pub tenant: Tenant,
    /// Calling user.
    pub user: UserId,
}

impl From<Writer> for PartyWriter {
    fn from(writer: Writer) -> PartyWriter {
        PartyWriter {
            tenant: Tenant::Operator(writer.operator),
            user: writer.user,
        }
    }
}

/// Caller who may read the audit log: of one tenant, or all of it if that is `None`.
#[derive(Clone, Copy, Debug)]
pub struct Auditor {
    tenant: Option<Tenant>,
}

/// Caller who may enter a firm: a platform admin, or an operator's admin for the operator.
#[derive(Clone, Copy, Debug)]
pub struct Founder {
    /// Operator of the caller; `None` for a platform admin.
    pub operator: Option<OperatorId>,
    /// Owner of the caller's idempotency keys.
    pub key_owner: Tenant,
    is_in_person: bool,
}

/// Caller who manages operators and firms.
#[derive(Clone, Copy, Debug)]
pub struct Platform {
    user: UserId,
    read_only: bool,
    is_in_person: bool,
}

impl Caller {
    /// Returns the session, for actions that need a person at a screen.
    ///
    /// # Errors
    /// Fails when the caller is a token.
    pub fn must_be_signed_in(&self) -> Result<SessionId> {
        self.session
            .ok_or(Error::Forbidden("a token cannot do this; sign in"))
    }

    /// Returns the caller's tenant; `None` for a platform admin.
    pub fn tenant(&self) -> Option<Tenant> {
        self.user.tenant()
    }

    /// Returns the owner of the caller's idempotency keys.
    pub fn key_owner(&self) -> Tenant {
        // No tenant has a user's id, and idempotency keys are separated by it alone.
        let own = Tenant::Operator(OperatorId(self.user.user_id.0));
        self.tenant().unwrap_or(own)
    }

    /// Refuses a caller without the second factor that the operator requires.
    ///
    /// # Errors
    /// [`Error::SecondFactorRequired`].
    pub fn must_have_second_factor(&self) -> Result<()> {
        if self.user.lacks_second_factor() {
            return Err(Error::SecondFactorRequired);
        }
        Ok(())
    }

    /// Returns true if the caller's session or token is still valid.
    ///
    /// # Errors
    /// Fails when the database fails.
    pub async fn is_still_valid(&self, app: &App) -> Result<bool> {
        let now = app.clock.now().into();
        let found = match (self.session, self.token) {
            (Some(session), _) => session::is_valid(&app.db, session, now).await?,
            (None, Some(token)) => tokens::is_valid(&app.db, token, now).await?,
            (None, None) => false,
        };
        Ok(found)
    }

    fn operator(&self) -> Result<OperatorId> {
        self.must_have_second_factor()?;
        let operator = self.user.operator_id;
        operator.ok_or(Error::Forbidden("only an operator's users have a fleet"))
    }

    /// Returns the caller's tenant.
    ///
    /// # Errors
    /// Fails when the caller has none, or a second factor is missing.
    pub fn party(&self) -> Result<Tenant> {
        self.must_have_second_factor()?;
        let none = "a platform admin has neither a fleet nor orders";
        self.tenant().ok_or(Error::Forbidden(none))
    }

    /// Refuses who may not change what an operator and a firm share, nor their receivers of messages.
    ///
    /// # Errors
    /// Fails for a viewer.
    pub fn must_change_shared(&self) -> Result<()> {
        if !self.user.role.may_change_shared() {
            let who = "only an admin or an adjuster may change this";
            return Err(Error::Forbidden(who));
        }
        Ok(())
    }

    fn must_be_admin(&self) -> Result<()> {
        if !self.user.role.may_change_fleet() {
            return Err(Error::Forbidden("only an admin may do this"));
        }
        Ok(())
    }

    /// Refuses a read-only token.
    ///
    /// # Errors
    /// Fails when the caller is one.
    pub fn must_not_only_read(&self) -> Result<()> {
        if self.read_only {
            return Err(Error::Forbidden("this token may only read"));
        }
        Ok(())
    }
}

impl From<&Caller> for Actor {
    fn from(caller: &Caller) -> Actor {
        Actor::from(&caller.user).with_token(caller.token)
    }
}

impl Auditor {
    /// Returns the operator to whose lines the log is limited.
    pub fn operator(&self) -> Option<OperatorId> {
        self.tenant.and_then(Tenant::operator)
    }

    /// Returns the firm to whose lines the log is limited.
    pub fn firm(&self) -> Option<FirmId> {
        self.tenant.and_then(Tenant::firm)
    }
}

impl Founder {
    /// Refuses a token, which must not be able to create users.
    ///
    /// # Errors
    /// Fails when the caller is one.
    pub fn must_be_in_person(&self) -> Result<()> {
        must_be_in_person(self.is_in_person)
    }
}

fn must_be_in_person(is_in_person: bool) -> Result<()> {
    let token = "a token cannot do this; sign in";
    is_in_person.then_some(()).ok_or(Error::Forbidden(token))
}

impl Platform {
    /// Refuses a token, which must not be able to create users.
    ///
    /// # Errors
    /// Fails when the caller is one.
    pub fn must_be_in_person(&self) -> Result<()> {
        must_be_in_person(self.is_in_person)
    }

    /// Returns the owner of the admin's idempotency keys; refuses a read-only token.
    pub fn must_be_writer(&self) -> Result<Tenant> {
        if self.read_only {
            return Err(Error::Forbidden("this token may only read"));
        }
        // No tenant has this id, and idempotency keys are separated by it alone.
        Ok(Tenant::Operator(OperatorId(self.user.0)))
    }
}

impl<S> FromRequestParts<S> for Caller
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Caller> {
        let caller = Caller::find(parts, &App::from_ref(state)).await?;
        RequestContext::of(parts)?.record_actor(&caller);
        Ok(caller)
    }
}

impl Caller {
    async fn find(parts: &Parts, app: &App) -> Result<Caller> {
        let now = app.clock.now().into();
        if let Some(token) = bearer(parts) {
            let Some(holder) = tokens::find_holder(&app.db, token, now).await? else {
                RequestContext::of(parts)?.refuse(Refusal::InvalidToken, None);
                return Err(Error::Unauthenticated);
            };
            app.accepted.note(secret::hash(token));
            return Ok(Caller {
                user: holder.user,
                read_only: holder.scope == Scope::Read,
                session: None,
                token: Some(holder.token_id),
            });
        }
        let token = cookie::token(parts, &app.config).ok_or(Error::Unauthenticated)?;
        let (user, session) = session::find_user(&app.db, &secret::hash(token), now, app.idle_s())
            .await?
            .ok_or(Error::Unauthenticated)?;
        app.accepted.note(secret::hash(token));
        if !parts.method.is_safe() && !parts.headers.contains_key(REQUEST_HEADER) {
            return Err(Error::Forbidden(
                "a change authenticated by cookie needs the header X-Binnacle-Request: 1",
            ));
        }
        Ok(Caller {
            user,
            read_only: false,
            session: Some(session),
            token: None,
        })
    }
}

impl<S> FromRequestParts<S> for Reader
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Reader> {
        let caller = Caller::from_request_parts(parts, state).await?;
        let operator = caller.operator()?;
        Ok(Reader {
            operator,
            user: caller.user.user_id,
        })
    }
}

impl<S> FromRequestParts<S> for Writer
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Writer> {
        let caller = Caller::from_request_parts(parts, state).await?;
        let operator = caller.operator()?;
        caller.must_be_admin()?;
        caller.must_not_only_read()?;
        Ok(Writer {
            operator,
            user: caller.user.user_id,
        })
    }
}

impl<S> FromRequestParts<S> for AdminReader
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<AdminReader> {
        let caller = Caller::from_request_parts(parts, state).await?;
        let operator = caller.operator()?;
        caller.must_be_admin()?;
        Ok(AdminReader {
            operator,
            user: caller.user.user_id,
        })
    }
}

impl<S> FromRequestParts<S> for AdminWriter
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<AdminWriter> {
        let caller = Caller::from_request_parts(parts, state).await?;
        let operator = caller.operator()?;
        caller.must_be_admin()?;
        caller.must_be_signed_in()?;
        Ok(AdminWriter {
            operator,
            user: caller.user.user_id,
        })
    }
}

impl<S> FromRequestParts<S> for PartyReader
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<PartyReader> {
        let caller = Caller::from_request_parts(parts, state).await?;
        Ok(PartyReader {
            tenant: caller.party()?,
            user: caller.user.user_id,
        })
    }
}

impl<S> FromRequestParts<S> for PartyWriter
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<PartyWriter> {
        let caller = Caller::from_request_parts(parts, state).await?;
        let tenant = caller.party()?;
        caller.must_change_shared()?;
        caller.must_not_only_read()?;
        Ok(PartyWriter {
            tenant,
            user: caller.user.user_id,
        })
    }
}

impl<S> FromRequestParts<S> for Auditor
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Auditor> {
        let caller = Caller::from_request_parts(parts, state).await?;
        caller.must_have_second_factor()?;
        if caller.user.role == Role::Viewer {
            return Err(Error::Forbidden("only an admin may do this"));
        }
        Ok(Auditor {
            tenant: caller.tenant(),
        })
    }
}

impl<S> FromRequestParts<S> for Founder
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Founder> {
        let caller = Caller::from_request_parts(parts, state).await?;
        let operator = match caller.user.role {
            Role::PlatformAdmin => None,
            _ => Some(caller.operator()?),
        };
        if operator.is_some() {
            caller.must_be_admin()?;
        }
        caller.must_not_only_read()?;
        Ok(Founder {
            operator,
            key_owner: caller.key_owner(),
            is_in_person: caller.session.is_some(),
        })
    }
}

impl<S> FromRequestParts<S> for Platform
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Platform> {
        let caller = Caller::from_request_parts(parts, state).await?;
        if caller.user.role != Role::PlatformAdmin {
            return Err(Error::Forbidden("only a platform admin may do this"));
        }
        Ok(Platform {
            user: caller.user.user_id,
            read_only: caller.read_only,
            is_in_person: caller.session.is_some(),
        })
    }
}

/// Returns the bearer token of a request's `Authorization` header.
pub fn bearer(parts: &Parts) -> Option<&str> {
    let value = parts.headers.get(AUTHORIZATION)?.to_str().ok()?;
    let (scheme, token) = value.split_once(' ')?;
    scheme
        .eq_ignore_ascii_case("bearer")
        .then_some(token.trim())
}
