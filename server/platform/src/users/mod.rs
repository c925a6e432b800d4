//! Users of an operator, and their roles.
//!
//! Invariants: an operator always has at least one admin who can sign in. Nobody learns
//! another's password: an admin passes on a one-time code, and the user sets the password.
//! Disabling a user ends all sessions and tokens at once. A token may change none of this.

mod codes;
mod invitation;
mod letter;
mod store;

pub use invitation::{AccessEnded, Invitation, reset};

use crate::access::{AdminReader, AdminWriter};
use crate::app::App;
use crate::audit::RequestContext;
use crate::error::{Error, Problem, Result};
use crate::http::{Id, Json, Listed, Page, Valid, text};
use crate::idempotency::{self, Key};
use crate::ids::UserId;
use crate::quotas::Quota;
use crate::second_factor;
use crate::session::{Role, normal_email};
use crate::tenants::Tenant;
use crate::time::Time;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use lettre::Address;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Quota of a company's users.
pub const QUOTA: Quota = Quota::new("users", "users", 1000, store::count);

/// Routes of the users of an operator.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_users, invite_user))
        .routes(routes!(change_user, remove_user))
        .routes(routes!(reset_second_factor))
        .routes(routes!(find_sign_in_rules, change_sign_in_rules))
        .merge(invitation::router())
}

/// User of the operator.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
#[schema(as = User)]
struct Person {
    /// The user's id.
    id: UserId,
    /// E-mail address used to sign in.
    #[schema(example = "ada@example.com")]
    email: String,
    /// The user's name.
    #[schema(example = "Ada Lovelace")]
    name: String,
    /// Role of the user.
    role: Role,
    /// State of the account.
    state: AccountState,
    /// True if the user has a second factor.
    second_factor: bool,
    /// Creation time of the user.
    created_at: Time,
    /// Time of the last use among the user's active sessions, to ten minutes.
    #[schema(required)]
    last_seen_at: Option<Time>,
    /// Expiry time of the user's one-time code, if it is unused.
    #[schema(required)]
    invitation_expires_at: Option<Time>,
}

/// State of a user's account.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = UserState)]
enum AccountState {
    /// The user has not set a password yet.
    Invited,
    /// The user can sign in.
    Active,
    /// The user was disabled by an admin.
    Disabled,
}

/// Page of users.
#[derive(Serialize, ToSchema)]
struct UserList {
    /// Users in the order in which they were invited.
    items: Vec<Person>,
    /// Value of `after` for the next page.
    #[schema(required)]
    next: Option<String>,
}

/// User to be invited.
#[derive(Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({ "email": "ada@example.com", "name": "Ada Lovelace", "role": "viewer" }))]
struct NewUser {
    /// E-mail address to sign in with.
    #[schema(max_length = 200)]
    email: String,
    /// The user's name.
    #[schema(min_length = 1, max_length = 200)]
    name: String,
    /// Role of the user.
    role: FleetRole,
}

/// Role of an operator's user.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum FleetRole {
    /// Sees and changes the operator's fleet.
    Admin,
    /// Sees the operator's fleet.
    Viewer,
}

impl From<FleetRole> for Role {
    fn from(role: FleetRole) -> Role {
        match role {
            FleetRole::Admin => Role::Admin,
            FleetRole::Viewer => Role::Viewer,
        }
    }
}

/// Invited user, with the invitation.
#[derive(Serialize, ToSchema)]
struct InvitedUser {
    /// The user.
    user: Person,
    /// Invitation to pass on.
    invitation: Invitation,
}

/// User of a company to be invited by who manages the company.
#[derive(Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({ "email": "rosa@example.com", "name": "Rosa Sáez" }))]
pub struct NewCompanyUser {
    /// E-mail address to sign in with.
    #[schema(max_length = 200)]
    pub email: String,
    /// The user's name.
    #[schema(min_length = 1, max_length = 200)]
    pub name: String,
}

/// Invites a user of a company, who sets a password with the invitation. An admin of an operator is
/// invited this way only while it has none who can sign in: those who run the server have no fleet.
///
/// # Errors
/// [`Error::WrongState`] when the e-mail address has an account, or the operator an admin;
/// [`Error::Invalid`] for a field; the quota's problem.
pub async fn invite(
    app: &App,
    request: &RequestContext,
    new: &NewCompanyUser,
    tenant: Tenant,
    role: Role,
) -> Result<Invitation> {
    let email = checked_email(&new.email)?;
    let name = text("name", &new.name)?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    request.concerns(tenant);
    if let Some(operator) = tenant.operator() {
        store::lock(&mut tx, operator).await?;
        if store::has_active_admin(&mut tx, operator).await? {
            let has = "the operator has an admin, who invites its other users";
            return Err(Error::WrongState(has.to_owned()));
        }
    }
    QUOTA.must_have_room(&mut tx, tenant, now).await?;
    let created = store::insert(&mut tx, tenant, &email, &name, role, now);
    let id = created.await?.ok_or_else(|| has_account(&email))?;
    let invitation = invitation::make(&mut tx, app, id).await?;
    tx.commit().await?;
    invitation.mail_to(app, id, request.tenant()).await
}

fn has_account(email: &str) -> Error {
    Error::WrongState(format!(
        "{email} already has an account, with this company or another"
    ))
}

/// Changes to a user; omitted fields stay as they are.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({ "role": "admin" }))]
struct ChangedUser {
    /// The user's name.
    #[schema(min_length = 1, max_length = 200)]
    name: Option<String>,
    /// Role of the user.
    role: Option<FleetRole>,
    /// True to disable the user.
    disabled: Option<bool>,
}

/// Sign-in rules of an operator.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, ToSchema, sqlx::FromRow)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({ "second_factor_required": true }))]
struct SignInRules {
    /// True if everyone needs a second factor. Users without one can then only set one up, and
    /// their tokens stop working until they do.
    second_factor_required: bool,
}

/// List your operator's users
#[utoipa::path(get, path = "/users", tag = "people", params(Page),
    responses((status = 200, body = UserList), (status = 401, body = Problem)))]
async fn list_users(
    State(app): State<App>,
    admin: AdminReader,
    page: Page,
) -> Result<Json<UserList>> {
    let after = page.after_id()?;
    let found = store::list(&app.db, admin.operator, after, page.fetch()).await?;
    let Listed { items, next } = page.cut(found, |user| user.id.to_string());
    Ok(Json(UserList { items, next }))
}

/// Invite a user
///
/// The server mails the link where mail is set up. Otherwise pass the link or the code on to the
/// user, who sets a password with it. It works once, for a week.
#[utoipa::path(post, path = "/users", tag = "people", params(Key), request_body = NewUser,
    responses((status = 201, body = InvitedUser), (status = 401, body = Problem),
              (status = 409, description = "The e-mail address already has an account", body = Problem)))]
async fn invite_user(
    State(app): State<App>,
    request: RequestContext,
    admin: AdminWriter,
    key: Key,
    Valid(new): Valid<NewUser>,
) -> Result<(StatusCode, Json<InvitedUser>)> {
    let request_hash = idempotency::request_hash("user", &new)?;
    let email = checked_email(&new.email)?;
    let name = text("name", &new.name)?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    key.shown_once(&mut tx, admin.operator, &request_hash, now)
        .await?;
    QUOTA.must_have_room(&mut tx, admin.operator, now).await?;
    let tenant = admin.operator.into();
    let created = store::insert(&mut tx, tenant, &email, &name, new.role.into(), now);
    let id = created.await?.ok_or_else(|| has_account(&email))?;
    let invitation = invitation::make(&mut tx, &app, id).await?;
    let user = store::find(&mut tx, admin.operator, id).await?;
    tx.commit().await?;
    let user = user.ok_or(Error::NotFound("user"))?;
    let invitation = invitation.mail_to(&app, id, Some(tenant)).await?;
    Ok((StatusCode::CREATED, Json(InvitedUser { user, invitation })))
}

/// Change a user's name or role, or disable the user
///
/// A disabled user is signed out at once. The last admin cannot be disabled or demoted.
#[utoipa::path(patch, path = "/users/{id}", tag = "people", params(("id" = UserId, Path)),
    request_body = ChangedUser,
    responses((status = 200, body = Person), (status = 401, body = Problem),
              (status = 404, body = Problem),
              (status = 409, description = "The user is the last admin", body = Problem)))]
async fn change_user(
    State(app): State<App>,
    request: RequestContext,
    admin: AdminWriter,
    Id(id): Id<UserId>,
    Valid(change): Valid<ChangedUser>,
) -> Result<Json<Person>> {
    let name = change
        .name
        .as_deref()
        .map(|name| text("name", name))
        .transpose()?;
    let role = change.role.map(Role::from);
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    store::lock(&mut tx, admin.operator).await?;
    let before = store::find(&mut tx, admin.operator, id).await?;
    before.ok_or(Error::NotFound("user"))?;
    store::update(&mut tx, id, name.as_deref(), role).await?;
    match change.disabled {
        Some(true) => store::disable(&mut tx, id, now).await?,
        Some(false) => store::enable(&mut tx, id).await?,
        None => {}
    }
    store::must_have_admin(&mut tx, admin.operator).await?;
    let after = store::find(&mut tx, admin.operator, id).await?;
    tx.commit().await?;
    Ok(Json(after.ok_or(Error::NotFound("user"))?))
}

/// Remove a user
///
/// Sessions and tokens are removed too. Entries by the user keep the name.
#[utoipa::path(delete, path = "/users/{id}", tag = "people", params(("id" = UserId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "The user is the last admin", body = Problem)))]
async fn remove_user(
    request: RequestContext,
    admin: AdminWriter,
    Id(id): Id<UserId>,
) -> Result<StatusCode> {
    let mut tx = request.begin().await?;
    store::lock(&mut tx, admin.operator).await?;
    if !store::delete(&mut tx, admin.operator, id).await? {
        return Err(Error::NotFound("user"));
    }
    store::must_have_admin(&mut tx, admin.operator).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Remove a user's second factor
///
/// For a user who lost the phone and the recovery codes.
#[utoipa::path(delete, path = "/users/{id}/second-factor", tag = "people",
    params(("id" = UserId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 404, body = Problem)))]
async fn reset_second_factor(
    request: RequestContext,
    admin: AdminWriter,
    Id(id): Id<UserId>,
) -> Result<StatusCode> {
    let mut tx = request.begin().await?;
    let user = store::find(&mut tx, admin.operator, id).await?;
    user.ok_or(Error::NotFound("user"))?;
    second_factor::remove(&mut tx, id).await?;
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Show your operator's sign-in rules
#[utoipa::path(get, path = "/sign-in-rules", tag = "people",
    responses((status = 200, body = SignInRules), (status = 401, body = Problem)))]
async fn find_sign_in_rules(
    State(app): State<App>,
    admin: AdminReader,
) -> Result<Json<SignInRules>> {
    Ok(Json(store::rules(&app.db, admin.operator).await?))
}

/// Change your operator's sign-in rules
///
/// Only an admin with a second factor may require one of others.
#[utoipa::path(put, path = "/sign-in-rules", tag = "people", request_body = SignInRules,
    responses((status = 200, body = SignInRules), (status = 401, body = Problem),
              (status = 409, description = "You have no second factor yourself", body = Problem)))]
async fn change_sign_in_rules(
    request: RequestContext,
    admin: AdminWriter,
    Valid(rules): Valid<SignInRules>,
) -> Result<Json<SignInRules>> {
    let mut tx = request.begin().await?;
    let asking = store::find(&mut tx, admin.operator, admin.user).await?;
    if rules.second_factor_required && !asking.is_some_and(|user| user.second_factor) {
        let first = "set up a second factor of your own first";
        return Err(Error::WrongState(first.to_owned()));
    }
    store::set_rules(&mut tx, admin.operator, rules).await?;
    tx.commit().await?;
    Ok(Json(rules))
}

/// Returns an e-mail address as it is stored, if it is a valid address.
///
/// # Errors
/// [`Error::Invalid`] for the field `email`.
pub fn checked_email(email: &str) -> Result<String> {
    let email = normal_email(&text("email", email)?);
    if !email.is_ascii() || email.parse::<Address>().is_err() {
        return Err(Error::Invalid {
            field: "email",
            detail: "is not an address like name@example.com".to_owned(),
        });
    }
    Ok(email)
}
