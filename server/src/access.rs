//! Who is asking: extractors that a handler names in its arguments.
//!
//! What always holds: a [`Reader`] and a [`Writer`] belong to one operator, and
//! every query about a fleet takes that operator's id; an [`Agent`] belongs to one
//! vessel. A request that a cookie vouches for may change something only with the
//! header `X-Binnacle-Request`, which another site's form cannot send.

use crate::app::App;
use crate::error::{Error, Result};
use crate::ids::{AgentId, CompassId, OperatorId, UserId, VesselId};
use crate::session::{self, COOKIE, User};
use crate::{enrolment, secret, tokens};
use axum::extract::FromRequestParts;
use axum::http::header::{AUTHORIZATION, COOKIE as COOKIE_HEADER};
use axum::http::request::Parts;

/// The header that a page of our own sends with every change.
pub const REQUEST_HEADER: &str = "x-binnacle-request";

/// A person, or a token that stands for one.
#[derive(Clone, Debug)]
pub struct Caller {
    /// The person.
    pub user: User,
    /// Whether a token limits the person to reading.
    pub read_only: bool,
    /// The session's token, when a cookie brought it.
    pub session: Option<String>,
}

/// Someone who may see an operator's fleet.
#[derive(Clone, Copy, Debug)]
pub struct Reader {
    /// Whose fleet.
    pub operator: OperatorId,
    /// Who.
    pub user: UserId,
}

/// Someone who may change an operator's fleet.
#[derive(Clone, Copy, Debug)]
pub struct Writer {
    /// Whose fleet.
    pub operator: OperatorId,
    /// Who.
    pub user: UserId,
}

/// A ship's agent.
#[derive(Clone, Copy, Debug, sqlx::FromRow)]
pub struct Agent {
    /// The ship.
    pub vessel_id: VesselId,
    /// The installation.
    pub agent_id: AgentId,
    /// The compass whose streams it may feed.
    pub compass_id: CompassId,
}

impl FromRequestParts<App> for Caller {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Caller> {
        let now = app.clock.now().into();
        if let Some(token) = bearer(parts) {
            return tokens::caller(&app.db, token, now)
                .await?
                .ok_or(Error::Unauthenticated);
        }
        let token = session_cookie(parts).ok_or(Error::Unauthenticated)?;
        let user = session::find_user(&app.db, &secret::hash(token), now)
            .await?
            .ok_or(Error::Unauthenticated)?;
        if !parts.method.is_safe() && !parts.headers.contains_key(REQUEST_HEADER) {
            return Err(Error::Forbidden(
                "a change asked for with a cookie needs the header X-Binnacle-Request: 1",
            ));
        }
        Ok(Caller {
            user,
            read_only: false,
            session: Some(token.to_owned()),
        })
    }
}

impl FromRequestParts<App> for Reader {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Reader> {
        let caller = Caller::from_request_parts(parts, app).await?;
        let operator = caller
            .user
            .operator_id
            .ok_or(Error::Forbidden("a platform admin has no fleet"))?;
        Ok(Reader {
            operator,
            user: caller.user.user_id,
        })
    }
}

impl FromRequestParts<App> for Writer {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Writer> {
        let caller = Caller::from_request_parts(parts, app).await?;
        let operator = caller
            .user
            .operator_id
            .ok_or(Error::Forbidden("a platform admin has no fleet"))?;
        if !caller.user.role.may_change_fleet() {
            return Err(Error::Forbidden("only an admin may change this"));
        }
        if caller.read_only {
            return Err(Error::Forbidden("this token may only read"));
        }
        Ok(Writer {
            operator,
            user: caller.user.user_id,
        })
    }
}

impl FromRequestParts<App> for Agent {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Agent> {
        let token = bearer(parts).ok_or(Error::Unauthenticated)?;
        let vessel = secret::vessel_of_token(token).ok_or(Error::Unauthenticated)?;
        enrolment::find_agent(&app.db, VesselId(vessel), &secret::hash(token))
            .await?
            .ok_or(Error::Unauthenticated)
    }
}

fn bearer(parts: &Parts) -> Option<&str> {
    let value = parts.headers.get(AUTHORIZATION)?.to_str().ok()?;
    let (scheme, token) = value.split_once(' ')?;
    scheme
        .eq_ignore_ascii_case("bearer")
        .then_some(token.trim())
}

fn session_cookie(parts: &Parts) -> Option<&str> {
    parts
        .headers
        .get_all(COOKIE_HEADER)
        .iter()
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(';'))
        .filter_map(|pair| pair.trim().split_once('='))
        .find_map(|(name, value)| (name == COOKIE).then_some(value))
}
