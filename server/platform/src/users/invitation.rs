//! One-time codes with which users set their password.
//!
//! Invariants: a code works once, for a week; an hour where someone asked for it without a session.
//! Its user sets a password and gets no other access; the sign-in follows with the password.

use super::codes;
use super::letter::Letter;
use crate::access::AdminWriter;
use crate::app::App;
use crate::audit::{Actor, Refusal, RequestContext};
use crate::client_address::Origin;
use crate::db::{DomainEvent, Tx, row};
use crate::error::{Error, Problem, Result};
use crate::http::{Id, Json, Valid, text};
use crate::ids::{FirmId, OperatorId, UserId};
use crate::tenants::Tenant;
use crate::time::Time;
use crate::{oidc, second_factor, secret, session, tokens};
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use tracing::error;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

const VALID_FOR_S: f64 = 7.0 * 86_400.0;
/// Time for which a code is valid that someone asked for who need not be the user, seconds.
const VALID_BY_MAIL_S: f64 = 3_600.0;
/// Time after which another code may be sent to an address, seconds.
const BETWEEN_LETTERS_S: f64 = 300.0;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(invite_again))
        .routes(routes!(accept_invitation))
        .routes(routes!(request_password_reset))
}

/// Invitation to set a password.
#[derive(Serialize, ToSchema)]
#[schema(example = json!({
    "code": "7QWM-0V3N-KX2D-9RTA",
    "link": "https://binnacle.example.com/invitation#7QWM-0V3N-KX2D-9RTA",
    "expires_at": "2026-11-28T07:00:00Z", "mailed": true
}))]
pub struct Invitation {
    /// One-time code; never shown again.
    code: String,
    /// Link to the page that uses the code, if the server knows its public address. The part
    /// after the # is sent to no server and appears in no log.
    #[schema(required)]
    link: Option<String>,
    /// Expiry time.
    expires_at: Time,
    /// True if the server has mailed the link to the user. It has not where mail is not set up, the
    /// relay refused the letter, or too many were sent today.
    mailed: bool,
}

/// Address of a user who forgot the password.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({ "email": "ada@example.com" }))]
struct Forgotten {
    /// E-mail address used to sign in.
    email: String,
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
    let by = Some(admin.operator.into());
    let invitation = invitation.mail_to(&app, id, by).await?;
    Ok((StatusCode::CREATED, Json(invitation)))
}

/// Ask for a code to set a new password
///
/// For anyone who forgot the password: the server mails a code, valid for an hour. The response is
/// the same whether or not the address has an account. Whoever signs in by a provider gets none.
#[utoipa::path(post, path = "/password-resets", tag = "people", security(()),
    request_body = Forgotten,
    responses((status = 202, description = "A letter is sent if the address has an account"),
              (status = 400, body = Problem),
              (status = 409, description = "Mail is not set up on this server", body = Problem),
              (status = 422, body = Problem), (status = 429, body = Problem)))]
async fn request_password_reset(
    State(app): State<App>,
    request: RequestContext,
    from: Origin,
    Valid(forgotten): Valid<Forgotten>,
) -> Result<StatusCode> {
    if !app.config.mail.is_set_up() {
        let ask = "this server sends no mail: ask your administrator for a code";
        return Err(Error::WrongState(ask.to_owned()));
    }
    let email = session::normal_email(&text("email", &forgotten.email)?);
    let now = app.clock.now();
    let permit = app.letters.for_stranger(&from.network(), now)?;
    // Not awaited: the time of the response would say who has an account.
    tokio::spawn(async move {
        let sent = send_reset(&app, &request, &email, now.into()).await;
        drop(permit);
        if let Err(error) = sent {
            error!(?error, "a code for a new password was not sent");
        }
    });
    Ok(StatusCode::ACCEPTED)
}

/// Sends a code to the user of an address, if there is one who may have it.
async fn send_reset(app: &App, request: &RequestContext, email: &str, now: Time) -> Result<()> {
    let Some(forgetful) = codes::find_forgetful(&app.db, email).await? else {
        return Ok(());
    };
    let request = request.after_response(Actor::unidentified(forgetful.tenant));
    let mut tx = request.begin().await?;
    let expires_at = Time(now.0.plus_seconds(VALID_BY_MAIL_S));
    let last_before = Time(now.0.plus_seconds(-BETWEEN_LETTERS_S));
    let user = forgetful.user;
    let Some(code) = codes::insert_reset(&mut tx, user, last_before, now, expires_at).await? else {
        return Ok(());
    };
    tx.commit().await?;
    let name = &forgetful.name;
    let letter = Letter {
        address: email,
        subject: "Set a new password",
        paragraphs: &[
            &*format!("{name}, someone asked to set a new password for {email} at Binnacle."),
            "Set it on the page below within an hour. If it was not you, ignore this letter: the \
             password stays as it is.",
        ],
    };
    letter.send(app, &code).await;
    Ok(())
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
    let Some(invited) = codes::find(&app.db, &code_hash).await? else {
        request.refuse(Refusal::InvalidCode, None);
        return Err(Error::NotFound("code"));
    };
    if invited.expires_at.0 <= now {
        request.refuse(Refusal::InvalidCode, Some(&invited.email));
        return Err(Error::Gone("this code has expired; ask for another"));
    }
    let company = invited.company.as_deref().unwrap_or_default();
    let about = [invited.email.as_str(), &invited.name, company];
    let permit = app.hashing.acquire().await?;
    let hash = permit
        .hash_new("password", acceptance.password, &about)
        .await?;
    let mut tx = request.begin().await?;
    if !codes::use_up(&mut tx, invited.user_id, &code_hash).await? {
        return Err(Error::NotFound("code"));
    }
    session::set_password(&mut tx, invited.user_id, &hash).await?;
    end_access(&mut tx, invited.user_id).await?;
    let actor = Actor::person(invited.user_id, &invited.name, invited.tenant());
    request.record_actor(actor);
    tx.commit().await?;
    Ok(Json(Accepted {
        email: invited.email,
        name: invited.name,
    }))
}

/// Creates a code for a user, in place of any earlier one.
pub(super) async fn make(tx: &mut Tx, app: &App, user: UserId) -> Result<Invitation> {
    let now = app.clock.now();
    let expires_at = Time(now.plus_seconds(VALID_FOR_S));
    let code = codes::insert_invitation(tx, user, now.into(), expires_at).await?;
    let at = app.config.mail.public_url.as_deref();
    let link = at.map(|at| format!("{}/invitation#{code}", at.trim_end_matches('/')));
    Ok(Invitation {
        code,
        link,
        expires_at,
        mailed: false,
    })
}

impl Invitation {
    /// Mails the invitation to its user, if mail is set up and the company that invites has not
    /// invited too many today.
    pub(super) async fn mail_to(
        self,
        app: &App,
        user: UserId,
        by: Option<Tenant>,
    ) -> Result<Invitation> {
        if !app.letters.may_invite(by, app.clock.now()) {
            return Ok(self);
        }
        let found = row!(
            app.db,
            (String, Option<String>),
            "SELECT u.email, COALESCE(o.name, f.name) FROM users u
             LEFT JOIN operators o ON o.id = u.operator_id
             LEFT JOIN firms f ON f.id = u.firm_id
             WHERE u.id = $1 ORDER BY u.id",
            user
        )?;
        let Some((address, company)) = found else {
            return Ok(self);
        };
        let company = company.map_or(String::new(), |name| format!(" as a user of “{name}”"));
        let paragraphs = [
            &*format!("You are invited to Binnacle{company}. You sign in as {address}."),
            "Set your password on the page below within a week.",
        ];
        let letter = Letter {
            address: &address,
            subject: "Your invitation to Binnacle",
            paragraphs: &paragraphs,
        };
        let mailed = letter.send(app, &self.code).await;
        Ok(Invitation { mailed, ..self })
    }
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
    let expires_at = Time(now.0.plus_seconds(VALID_FOR_S));
    let code = codes::insert_invitation(&mut tx, user, now, expires_at).await?;
    tx.commit().await?;
    Ok(Some((code, expires_at)))
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
