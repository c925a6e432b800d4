//! One-time codes with which users set their password.
//!
//! Invariants: a code is stored as a hash and works once, for a week. Its user sets a password
//! and gets no other access; the sign-in follows with the password.

use crate::access::AdminWriter;
use crate::app::App;
use crate::audit::{Actor, Refusal, RequestContext};
use crate::db::{Db, DomainEvent, Tx, execute, row};
use crate::error::{Error, Problem, Result};
use crate::http::{Id, Json, Valid};
use crate::ids::{FirmId, OperatorId, UserId};
use crate::tenants::Tenant;
use crate::time::Time;
use crate::{oidc, password, second_factor, secret, session, tokens};
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

const VALID_FOR_S: f64 = 7.0 * 86_400.0;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(invite_again))
        .routes(routes!(accept_invitation))
}

/// Invitation to set a password.
#[derive(Serialize, ToSchema)]
#[schema(example = json!({
    "code": "7QWM-0V3N-KX2D-9RTA",
    "link": "https://binnacle.example.com/invitation#7QWM-0V3N-KX2D-9RTA",
    "expires_at": "2026-11-28T07:00:00Z"
}))]
pub(super) struct Invitation {
    /// One-time code; never shown again.
    code: String,
    /// Link to the page that uses the code, if the server knows its public address. The part
    /// after the # is sent to no server and appears in no log.
    #[schema(required)]
    link: Option<String>,
    /// Expiry time.
    expires_at: Time,
}

/// Code, and the password to be set with it.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({
    "code": "7QWM-0V3N-KX2D-9RTA", "password": "seven gulls over the quay"
}))]
struct Acceptance {
    /// Code; case and hyphens do not matter.
    code: String,
    /// New password: at least 12 characters, neither common nor easily guessed.
    #[schema(format = Password)]
    password: String,
}

/// User who can now sign in.
#[derive(Serialize, ToSchema)]
struct Accepted {
    /// E-mail address to sign in with.
    #[schema(example = "ada@example.com")]
    email: String,
    /// The user's name.
    #[schema(example = "Ada Lovelace")]
    name: String,
}

#[derive(sqlx::FromRow)]
struct Invited {
    user_id: UserId,
    email: String,
    name: String,
    operator_id: Option<OperatorId>,
    firm_id: Option<FirmId>,
    company: Option<String>,
    expires_at: Time,
}

/// Give a user another one-time code
///
/// For a user whose code expired or who forgot the password. The password stays valid until the
/// code is used. Earlier codes stop working.
#[utoipa::path(post, path = "/users/{id}/invitation", tag = "people",
    params(("id" = UserId, Path)),
    responses((status = 201, body = Invitation), (status = 401, body = Problem),
              (status = 404, body = Problem),
              (status = 409, description = "The user is disabled", body = Problem)))]
async fn invite_again(
    State(app): State<App>,
    request: RequestContext,
    admin: AdminWriter,
    Id(id): Id<UserId>,
) -> Result<(StatusCode, Json<Invitation>)> {
    let mut tx = request.begin().await?;
    let user = super::store::find(&mut tx, admin.operator, id).await?;
    let user = user.ok_or(Error::NotFound("user"))?;
    if user.state == super::AccountState::Disabled {
        return Err(Error::WrongState("the user is disabled".to_owned()));
    }
    let invitation = make(&mut tx, &app, id).await?;
    tx.commit().await?;
    Ok((StatusCode::CREATED, Json(invitation)))
}

/// Set a password with a one-time code
///
/// All sessions, tokens and calendar feeds of the user end, and the binding to a sign-in
/// provider is removed: more than the password may have been lost. A second factor stays.
#[utoipa::path(post, path = "/invitations/accept", tag = "people", security(()),
    request_body = Acceptance,
    responses((status = 200, body = Accepted),
              (status = 404, description = "There is no such code", body = Problem),
              (status = 410, description = "The code has expired", body = Problem)))]
async fn accept_invitation(
    State(app): State<App>,
    request: RequestContext,
    Valid(acceptance): Valid<Acceptance>,
) -> Result<Json<Accepted>> {
    let code_hash = secret::hash(&secret::normal_code(&acceptance.code));
    let now = app.clock.now();
    let Some(invited) = find(&app.db, &code_hash).await? else {
        request.refuse(Refusal::InvalidCode, None);
        return Err(Error::NotFound("code"));
    };
    if invited.expires_at.0 <= now {
        request.refuse(Refusal::InvalidCode, Some(&invited.email));
        return Err(Error::Gone("this code has expired; ask for another"));
    }
    let company = invited.company.as_deref().unwrap_or_default();
    let about = [invited.email.as_str(), &invited.name, company];
    password::check("password", &acceptance.password, &about)?;
    let hash = app
        .hashing
        .acquire()
        .await?
        .hash(acceptance.password)
        .await?;
    let mut tx = request.begin().await?;
    let used = execute!(
        &mut tx,
        "DELETE FROM invitations WHERE user_id = $1 AND code_hash = $2",
        invited.user_id,
        code_hash.as_slice()
    )?;
    if used == 0 {
        return Err(Error::NotFound("code"));
    }
    session::set_password(&mut tx, invited.user_id, &hash).await?;
    end_access(&mut tx, invited.user_id).await?;
    let tenant = invited.operator_id.map(Tenant::Operator);
    let tenant = tenant.or(invited.firm_id.map(Tenant::Firm));
    request.record_actor(Actor::person(invited.user_id, &invited.name, tenant));
    tx.commit().await?;
    Ok(Json(Accepted {
        email: invited.email,
        name: invited.name,
    }))
}

/// Creates a code for a user, in place of any earlier one.
pub(super) async fn make(tx: &mut Tx, app: &App, user: UserId) -> Result<Invitation> {
    let now = app.clock.now();
    let (code, expires_at) = insert(tx, user, now.into()).await?;
    let at = app.config.mail.public_url.as_deref();
    let link = at.map(|at| format!("{}/invitation#{code}", at.trim_end_matches('/')));
    Ok(Invitation {
        code,
        link,
        expires_at,
    })
}

/// Resets a user: removes password, second factor, sessions, tokens, calendar feeds and the
/// binding to a sign-in provider. Returns the code that sets a new password; `None` when no
/// user has the e-mail address.
///
/// # Errors
/// Fails when the database fails.
pub async fn reset(
    request: &RequestContext,
    email: &str,
    now: Time,
) -> Result<Option<(String, Time)>> {
    let mut tx = request.begin().await?;
    let user = row!(
        in &mut tx,
        (UserId, Option<OperatorId>, Option<FirmId>),
        "SELECT id, operator_id, firm_id FROM users WHERE email = $1 ORDER BY id",
        session::normal_email(email)
    )?;
    let Some((user, operator, firm)) = user else {
        return Ok(None);
    };
    let tenant = operator.map(Tenant::Operator);
    if let Some(tenant) = tenant.or(firm.map(Tenant::Firm)) {
        request.concerns(tenant);
    }
    session::set_password(&mut tx, user, "").await?;
    end_access(&mut tx, user).await?;
    second_factor::remove(&mut tx, user).await?;
    let made = insert(&mut tx, user, now).await?;
    tx.commit().await?;
    Ok(Some(made))
}

/// End of all access of a user, also of a stolen one.
pub struct AccessEnded {
    /// User concerned.
    pub user: UserId,
}

impl DomainEvent for AccessEnded {}

/// Ends all access of a user, also a stolen one.
async fn end_access(tx: &mut Tx, user: UserId) -> Result<()> {
    session::end_all(tx, user, None).await?;
    session::forget_devices(tx, user).await?;
    tokens::delete_all(tx, user).await?;
    tx.publish(&AccessEnded { user }).await?;
    oidc::forget(tx, user).await?;
    Ok(())
}

async fn insert(tx: &mut Tx, user: UserId, now: Time) -> Result<(String, Time)> {
    let code = secret::new_code();
    let expires_at = Time(now.0.plus_seconds(VALID_FOR_S));
    execute!(
        tx,
        "INSERT INTO invitations (user_id, code_hash, created_at, expires_at)
         VALUES ($1, $2, $3, $4)
         ON CONFLICT (user_id) DO UPDATE
         SET code_hash = excluded.code_hash, created_at = excluded.created_at,
             expires_at = excluded.expires_at",
        user,
        secret::hash(&secret::normal_code(&code)),
        now,
        expires_at
    )?;
    Ok((code, expires_at))
}

async fn find(db: &Db, code_hash: &[u8]) -> Result<Option<Invited>> {
    let found = row!(
        db,
        Invited,
        "SELECT i.user_id, u.email, u.name, u.operator_id, u.firm_id,
                COALESCE(o.name, f.name) AS company, i.expires_at
         FROM invitations i
         JOIN users u ON u.id = i.user_id
         LEFT JOIN operators o ON o.id = u.operator_id
         LEFT JOIN firms f ON f.id = u.firm_id
         WHERE i.code_hash = $1 AND u.disabled_at IS NULL
         ORDER BY i.user_id",
        code_hash
    )?;
    Ok(found)
}
