//! The first run: an empty server's operator and its first admin.
//!
//! Invariants: it is open only while the server has no user at all, and needs a code that the
//! machine's administrator has printed on its command line. A code is stored as a hash, and appears
//! in no log.

use super::store;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::app::App;
use binnacle_platform::audit::{Actor, Refusal, RequestContext};
use binnacle_platform::db::{Db, Tx, execute, row};
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Json, Valid, text};
use binnacle_platform::ids::{OperatorId, UserId};
use binnacle_platform::session::{self, Role};
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use binnacle_platform::{secret, users};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Time for which a code is valid, seconds.
const VALID_FOR_S: f64 = 86_400.0;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(find_first_run, begin))
}

/// State of a server's first run.
#[derive(Serialize, ToSchema)]
struct FirstRun {
    /// True while the server has no user: its first operator can be made.
    open: bool,
}

/// First operator of a server, and its first admin.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({
    "code": "7QWM-0V3N-KX2D-9RTA", "operator_name": "Armada del Sur",
    "name": "Ada Lovelace", "email": "ada@example.com", "password": "seven gulls over the quay"
}))]
struct NewFirstOperator {
    /// Code that `binnacle-server admin first-run` has printed; case and hyphens do not matter.
    code: String,
    /// Name of the operator.
    #[schema(min_length = 1, max_length = 200)]
    operator_name: String,
    /// Name of the admin.
    #[schema(min_length = 1, max_length = 200)]
    name: String,
    /// E-mail address that the admin signs in with.
    #[schema(max_length = 200)]
    email: String,
    /// Password: at least 12 characters, neither common nor easily guessed.
    #[schema(format = Password)]
    password: String,
}

/// Admin who can now sign in.
#[derive(Serialize, ToSchema)]
struct FirstAdmin {
    /// E-mail address to sign in with.
    #[schema(example = "ada@example.com")]
    email: String,
}

/// Tell whether the server is empty
#[utoipa::path(get, path = "/first-run", tag = "session", security(()),
    responses((status = 200, body = FirstRun)))]
async fn find_first_run(State(app): State<App>) -> Result<Json<FirstRun>> {
    let open = is_empty(&app.db).await?;
    Ok(Json(FirstRun { open }))
}

/// Make the first operator and its admin
///
/// On a server without any user, with the one-time code that its administrator has printed.
#[utoipa::path(post, path = "/first-run", tag = "session", security(()),
    request_body = NewFirstOperator,
    responses((status = 201, body = FirstAdmin),
              (status = 404, description = "There is no such code", body = Problem),
              (status = 409, description = "The server has users", body = Problem),
              (status = 410, description = "The code has expired", body = Problem),
              (status = 422, body = Problem)))]
async fn begin(
    State(app): State<App>,
    request: RequestContext,
    Valid(new): Valid<NewFirstOperator>,
) -> Result<(StatusCode, Json<FirstAdmin>)> {
    if !is_empty(&app.db).await? {
        return Err(has_users());
    }
    let operator_name = text("operator_name", &new.operator_name)?;
    let name = text("name", &new.name)?;
    let email = users::checked_email(&new.email)?;
    let now: Time = app.clock.now().into();
    if !is_code(&app.db, &new.code).await? {
        return Err(refused(&request));
    }
    let about = [email.as_str(), &name, &operator_name];
    let permit = app.hashing.acquire().await?;
    let hash = permit.hash_new("password", new.password, &about).await?;
    let mut tx = request.begin().await?;
    if !use_code(&mut tx, &new.code, now).await? {
        return Err(refused(&request));
    }
    let operator = OperatorId::new();
    store::insert(&mut tx, operator, &operator_name, now).await?;
    let tenant = Tenant::Operator(operator);
    let created = session::create_user(
        &mut tx,
        Some(tenant),
        &email,
        &name,
        Role::Admin,
        &hash,
        now,
    );
    let id = created.await?;
    if has_others(&mut tx, id).await? {
        return Err(has_users());
    }
    request.record_actor(Actor::person(id, &name, Some(tenant)));
    tx.commit().await?;
    Ok((StatusCode::CREATED, Json(FirstAdmin { email })))
}

/// Makes a code for the first run; `None` where the server has users.
///
/// # Errors
/// Fails when the database fails.
pub async fn make_code(
    db: &Db,
    request: &RequestContext,
    now: Time,
) -> Result<Option<(String, Time)>> {
    if !is_empty(db).await? {
        return Ok(None);
    }
    let code = secret::new_code();
    let expires_at = Time(now.0.plus_seconds(VALID_FOR_S));
    let mut tx = request.begin().await?;
    // The table has one row: of two codes that are printed at once the later one is valid.
    execute!(
        &mut tx,
        "INSERT INTO first_run_codes (id, code_hash, expires_at) VALUES (1, $1, $2)
         ON CONFLICT (id) DO UPDATE SET code_hash = $1, expires_at = $2",
        secret::hash(&secret::normal_code(&code)),
        expires_at
    )?;
    tx.commit().await?;
    Ok(Some((code, expires_at)))
}

fn has_users() -> Error {
    Error::WrongState("this server has users: ask one of them for an invitation".to_owned())
}

fn refused(request: &RequestContext) -> Error {
    request.refuse(Refusal::InvalidCode, None);
    Error::NotFound("code")
}

/// Tells whether there is such a code, before anything costly is done for it.
async fn is_code(db: &Db, code: &str) -> Result<bool> {
    let found = row!(
        db,
        (Time,),
        "SELECT expires_at FROM first_run_codes WHERE code_hash = $1 ORDER BY code_hash",
        secret::hash(&secret::normal_code(code))
    )?;
    Ok(found.is_some())
}

/// Uses a code up; its deletion makes other requests with the same code wait. Returns false where
/// there is none.
async fn use_code(tx: &mut Tx, code: &str, now: Time) -> Result<bool> {
    let used = row!(
        in tx,
        (Time,),
        "DELETE FROM first_run_codes WHERE code_hash = $1 RETURNING expires_at",
        secret::hash(&secret::normal_code(code))
    )?;
    match used {
        None => Ok(false),
        Some((expires_at,)) if expires_at <= now => {
            Err(Error::Gone("this code has expired; print another"))
        }
        Some(_) => Ok(true),
    }
}

async fn is_empty(db: &Db) -> Result<bool> {
    let found = row!(db, (UserId,), "SELECT id FROM users ORDER BY id LIMIT 1")?;
    Ok(found.is_none())
}

async fn has_others(tx: &mut Tx, id: UserId) -> Result<bool> {
    let found = row!(
        in tx,
        (UserId,),
        "SELECT id FROM users WHERE id <> $1 ORDER BY id LIMIT 1",
        id
    )?;
    Ok(found.is_some())
}
