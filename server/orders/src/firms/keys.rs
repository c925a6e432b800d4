//! Public keys with which a firm signs records.
//!
//! Invariants: whoever registers a key has proved possession of its private half. A key belongs to
//! one firm. A revoked key vouches for nothing signed afterwards.

use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::{Caller, PartyWriter};
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::{Db, Tx, execute, row, rows};
use binnacle_platform::ed25519;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{Id, Json, Page, Valid, text};
use binnacle_platform::idempotency::{self, Key as RequestKey};
use binnacle_platform::ids::{FirmId, KeyId};
use binnacle_platform::session;
use binnacle_platform::tenants::Tenant;
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_keys, register_key))
        .routes(routes!(revoke_key))
}

/// A public key.
#[derive(Clone, Debug, Serialize, ToSchema, sqlx::FromRow)]
struct FirmKey {
    /// Its id.
    id: KeyId,
    /// The firm's name for it.
    #[schema(example = "Office, 2026")]
    name: String,
    /// Ed25519 (RFC 8032), 64 hexadecimal digits.
    public_key: String,
    /// Time of registration.
    created_at: Time,
    /// Author of the registration.
    created_by: String,
    /// Time of the revocation.
    #[schema(required)]
    revoked_at: Option<Time>,
}

/// Page of keys.
#[derive(Serialize, ToSchema)]
struct FirmKeyList {
    /// Keys in the order of their registration.
    items: Vec<FirmKey>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// Key to register.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({
    "name": "Office, 2026",
    "public_key": "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a",
    "proof": "0".repeat(128)
}))]
struct NewFirmKey {
    /// The firm's name for it.
    #[schema(min_length = 1, max_length = 200, example = "Office, 2026")]
    name: String,
    /// Ed25519 (RFC 8032), 64 hexadecimal digits.
    #[schema(min_length = 64, max_length = 64)]
    public_key: String,
    /// The key's signature over `binnacle firm key ` and the firm's id, as text: 128
    /// hexadecimal digits.
    #[schema(min_length = 128, max_length = 128)]
    proof: String,
}

impl NewFirmKey {
    fn checked(self, firm: FirmId) -> Result<NewFirmKey> {
        let key = ed25519::key(&self.public_key)?;
        let statement = format!("binnacle firm key {firm}");
        let name_of_statement = format!("{statement:?}");
        ed25519::must_be_signed(
            &key,
            "proof",
            &self.proof,
            statement.as_bytes(),
            &name_of_statement,
        )?;
        Ok(NewFirmKey {
            name: text("name", &self.name)?,
            public_key: self.public_key.to_ascii_lowercase(),
            proof: self.proof,
        })
    }
}

/// List a firm's keys
///
/// Including revoked ones.
#[utoipa::path(get, path = "/firms/{id}/keys", tag = "adjusting",
    params(("id" = FirmId, Path), Page),
    responses((status = 200, body = FirmKeyList), (status = 401, body = Problem),
              (status = 404, body = Problem)))]
async fn list_keys(
    State(app): State<App>,
    caller: Caller,
    Id(firm): Id<FirmId>,
    page: Page,
) -> Result<Json<FirmKeyList>> {
    caller.must_have_second_factor()?;
    let seen = super::store::find(&app.db, caller.tenant(), firm).await?;
    seen.ok_or(Error::NotFound("firm"))?;
    let found = rows(&app.db, firm, &page).await?;
    let listed = page.cut(found, |key: &FirmKey| key.id.to_string());
    Ok(Json(FirmKeyList {
        items: listed.items,
        next: listed.next,
    }))
}

async fn rows(db: &Db, firm: FirmId, page: &Page) -> Result<Vec<FirmKey>> {
    Ok(rows!(
        db,
        FirmKey,
        "SELECT id, name, public_key, created_at, created_by, revoked_at FROM firm_keys
         WHERE firm_id = $1 AND id > $2
         ORDER BY id
         LIMIT $3",
        firm,
        page.after_id()?.unwrap_or_default(),
        page.fetch()
    )?)
}

/// Refuses anyone but the firm's own adjusters. For others the firm does not exist.
fn require_own_keys(writer: PartyWriter, firm: FirmId) -> Result<()> {
    if writer.tenant == Tenant::Firm(firm) {
        return Ok(());
    }
    Err(Error::NotFound("firm"))
}

/// Register a key of your firm
///
/// With a signature by it, so that nobody registers another's key.
#[utoipa::path(post, path = "/firms/{id}/keys", tag = "adjusting",
    params(("id" = FirmId, Path), RequestKey), request_body = NewFirmKey,
    responses((status = 201, body = FirmKey), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 404, body = Problem),
              (status = 409, description = "It is registered already", body = Problem),
              (status = 422, body = Problem)))]
async fn register_key(
    State(app): State<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id(firm): Id<FirmId>,
    key: RequestKey,
    Valid(new): Valid<NewFirmKey>,
) -> Result<(StatusCode, Json<FirmKey>)> {
    require_own_keys(writer, firm)?;
    let request_hash = idempotency::request_hash("firm key", &new)?;
    let new = new.checked(firm)?;
    let now = app.clock.now().into();
    let wanted = KeyId::new();
    let mut tx = request.begin().await?;
    let made = key
        .once(&mut tx, firm, &request_hash, wanted.0, now)
        .await?;
    if made == wanted.0 {
        let by = session::name_of(&mut tx, writer.user).await?;
        insert(&mut tx, wanted, firm, &new, &by, now).await?;
    }
    let made = find(&mut tx, firm, KeyId(made)).await?;
    tx.commit().await?;
    Ok((StatusCode::CREATED, Json(made)))
}

async fn insert(
    tx: &mut Tx,
    id: KeyId,
    firm: FirmId,
    new: &NewFirmKey,
    by: &str,
    now: Time,
) -> Result<()> {
    let written = execute!(
        tx,
        "INSERT INTO firm_keys (id, firm_id, public_key, name, created_at, created_by)
         VALUES ($1, $2, $3, $4, $5, $6)
         ON CONFLICT (public_key) WHERE revoked_at IS NULL DO NOTHING",
        id,
        firm,
        new.public_key.as_str(),
        new.name.as_str(),
        now,
        by
    )?;
    if written == 0 {
        return Err(Error::WrongState(
            "the key is registered already".to_owned(),
        ));
    }
    Ok(())
}

async fn find(tx: &mut Tx, firm: FirmId, id: KeyId) -> Result<FirmKey> {
    let found = row!(
        in tx,
        FirmKey,
        "SELECT id, name, public_key, created_at, created_by, revoked_at FROM firm_keys
         WHERE firm_id = $1 AND id = $2
         ORDER BY id",
        firm,
        id
    )?;
    found.ok_or(Error::NotFound("key"))
}

/// Revoke a key of your firm
///
/// Earlier signatures stay valid; from now on it vouches for nothing.
#[utoipa::path(delete, path = "/firms/{id}/keys/{key}", tag = "adjusting",
    params(("id" = FirmId, Path), ("key" = KeyId, Path)),
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem),
              (status = 404, body = Problem)))]
async fn revoke_key(
    State(app): State<App>,
    request: RequestContext,
    writer: PartyWriter,
    Id((firm, key)): Id<(FirmId, KeyId)>,
) -> Result<StatusCode> {
    require_own_keys(writer, firm)?;
    let now: Time = app.clock.now().into();
    let mut tx = request.begin().await?;
    let revoked = execute!(
        &mut tx,
        "UPDATE firm_keys SET revoked_at = $3
         WHERE firm_id = $1 AND id = $2 AND revoked_at IS NULL",
        firm,
        key,
        now
    )?;
    if revoked == 0 {
        return Err(Error::NotFound("key"));
    }
    tx.commit().await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Active key of a firm.
pub(crate) struct ActiveKey {
    /// The key's id.
    pub id: KeyId,
    /// The firm's name for it.
    pub name: String,
    /// The firm.
    pub firm_id: FirmId,
    /// The firm's name.
    pub firm_name: String,
}

/// Finds the key of an order's firm, if it is registered and not revoked.
pub(crate) async fn find_active(
    tx: &mut Tx,
    firm: Option<FirmId>,
    public_key: &str,
) -> Result<Option<ActiveKey>> {
    let found = row!(
        in tx,
        (KeyId, String, FirmId, String),
        "SELECT k.id, k.name, f.id, f.name FROM firm_keys k
         JOIN firms f ON f.id = k.firm_id
         WHERE k.firm_id = $1 AND k.public_key = $2 AND k.revoked_at IS NULL
         ORDER BY k.id",
        firm,
        public_key.to_ascii_lowercase()
    )?;
    Ok(found.map(|(id, name, firm_id, firm_name)| ActiveKey {
        id,
        name,
        firm_id,
        firm_name,
    }))
}
