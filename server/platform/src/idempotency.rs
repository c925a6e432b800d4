//! Idempotency keys: a repeated create request creates nothing more.
//!
//! Invariants: the key and the created resource are stored in one transaction, so that either
//! both exist or neither. A key belongs to one operator or firm and is deleted after a day.
//! A secret is shown once: a repeated request for one is refused.
//! A capability may keep the keys of its own resources with them instead.

use crate::db::{Tx, execute, row};
use crate::error::{Error, Result};
use crate::secret;
use crate::tenants::Tenant;
use crate::time::Time;
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use serde::Serialize;
use utoipa::openapi::path::{Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::{ObjectBuilder, Required, Type};
use uuid::Uuid;

const HEADER: &str = "Idempotency-Key";
const MAX_BYTES: usize = 255;
const KEPT_FOR_S: f64 = 86_400.0;

/// Idempotency key of a request, if it has one.
pub struct Key(Option<String>);

impl Key {
    /// Returns the SHA-256 of the key, if there is one.
    pub fn hash(&self) -> Option<Vec<u8>> {
        self.0.as_deref().map(secret::hash)
    }

    /// Returns the id to create: `wanted`, or the id that the same request created earlier with
    /// this key.
    ///
    /// # Errors
    /// Fails when the key was used for another request.
    pub async fn once(
        &self,
        tx: &mut Tx,
        tenant: impl Into<Tenant>,
        request_hash: &[u8],
        wanted: Uuid,
        now: Time,
    ) -> Result<Uuid> {
        let Some(key_hash) = self.hash() else {
            return Ok(wanted);
        };
        let tenant = tenant.into().id();
        let outdated = Time(now.0.plus_seconds(-KEPT_FOR_S));
        execute!(
            &mut *tx,
            "DELETE FROM idempotency_keys WHERE tenant_id = $1 AND created_at < $2",
            tenant,
            outdated
        )?;
        execute!(
            &mut *tx,
            "INSERT INTO idempotency_keys (tenant_id, key_hash, request_hash, resource_id, created_at)
             VALUES ($1, $2, $3, $4, $5)
             ON CONFLICT (tenant_id, key_hash) DO NOTHING",
            tenant,
            key_hash.as_slice(),
            request_hash,
            wanted,
            now
        )?;
        let (made_for, id) = row!(
            in &mut *tx,
            (Vec<u8>, Uuid),
            "SELECT request_hash, resource_id FROM idempotency_keys
             WHERE tenant_id = $1 AND key_hash = $2
             ORDER BY key_hash",
            tenant,
            key_hash.as_slice()
        )?
        .ok_or_else(|| anyhow::anyhow!("an idempotency key is missing"))?;
        if made_for != request_hash {
            return Err(Error::KeyReused);
        }
        Ok(id)
    }
}

impl Key {
    /// Records that the request makes something whose secret the response shows.
    ///
    /// # Errors
    /// [`Error::ShownOnce`] when the same request was done before; fails also when the key was
    /// used for another request.
    pub async fn shown_once(
        &self,
        tx: &mut Tx,
        tenant: impl Into<Tenant>,
        request_hash: &[u8],
        now: Time,
    ) -> Result<()> {
        let wanted = Uuid::now_v7();
        let made = self.once(tx, tenant, request_hash, wanted, now).await?;
        if made == wanted {
            Ok(())
        } else {
            Err(Error::ShownOnce)
        }
    }
}

/// Returns the hash that identifies a request, over the kind of resource and the content.
///
/// # Errors
/// Fails when the content cannot be written as JSON.
pub fn request_hash(what: &str, content: &impl Serialize) -> Result<Vec<u8>> {
    let content = serde_json::to_string(content)?;
    Ok(secret::hash(&format!("{what} {content}")))
}

impl<S: Send + Sync> FromRequestParts<S> for Key {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Key> {
        let Some(value) = parts.headers.get(HEADER) else {
            return Ok(Key(None));
        };
        let key = value.to_str().unwrap_or_default();
        if key.is_empty() || key.len() > MAX_BYTES {
            return Err(Error::BadRequest(format!(
                "{HEADER} is not 1 to {MAX_BYTES} visible characters"
            )));
        }
        Ok(Key(Some(key.to_owned())))
    }
}

impl utoipa::IntoParams for Key {
    fn into_params(_: impl Fn() -> Option<ParameterIn>) -> Vec<Parameter> {
        vec![
            ParameterBuilder::new()
                .name(HEADER)
                .parameter_in(ParameterIn::Header)
                .required(Required::False)
                .description(Some(
                    "Key of the request; the same request with the same key creates nothing more",
                ))
                .schema(Some(ObjectBuilder::new().schema_type(Type::String)))
                .build(),
        ]
    }
}
