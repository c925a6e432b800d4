//! Ed25519 keys (RFC 8032) by which the server counter-signs what is kept as evidence.
//!
//! Invariants: a key signs until the next one is made, and stays published with its dates, so that
//! what it signed can be checked after a rotation. The servers of one database have one key.

mod store;

pub(crate) use store::reseal;
pub use store::{current, list, of_server, rotate};

use crate::app::App;
use crate::ed25519::{self, to_hex};
use crate::error::Result;
use crate::http::Json;
use crate::time::Time;
use axum::extract::{FromRef, State as Shared};
use ed25519_dalek::{Signer, SigningKey};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Key of the server.
#[derive(Clone, Debug)]
pub struct ServerKey(SigningKey);

/// Public key of the server, with the time in which it signed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::FromRow)]
pub struct PublishedKey {
    /// Ed25519 public key, 64 hexadecimal digits.
    #[schema(example = "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c")]
    pub public_key: String,
    /// Time since which it signs.
    pub created_at: Time,
    /// Time until which it signed; none while it does.
    #[schema(required)]
    pub retired_at: Option<Time>,
}

/// Public keys of the server, as it publishes them.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = SigningKeyList)]
pub struct PublishedKeys {
    /// The oldest first.
    pub items: Vec<PublishedKey>,
}

/// Signature by a key of the server.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = CounterSignature)]
pub struct Seal {
    /// Ed25519 public key, 64 hexadecimal digits.
    pub key: String,
    /// Signature, 128 hexadecimal digits.
    pub signature: String,
}

impl ServerKey {
    fn from_secret(secret: &[u8]) -> Option<ServerKey> {
        let bytes: [u8; 32] = secret.try_into().ok()?;
        Some(ServerKey(SigningKey::from_bytes(&bytes)))
    }

    /// Returns the public key, 64 hexadecimal digits.
    pub fn public_key(&self) -> String {
        to_hex(self.0.verifying_key().as_bytes())
    }

    /// Signs a text.
    pub fn sign(&self, text: &[u8]) -> Seal {
        Seal {
            key: self.public_key(),
            signature: to_hex(&self.0.sign(text).to_bytes()),
        }
    }
}

impl Seal {
    /// Verifies the signature over a text. `called` names the text in the error.
    ///
    /// # Errors
    /// Names the invalid key or signature.
    pub fn check(&self, text: &[u8], called: &str) -> Result<()> {
        let key = ed25519::key(&self.key)?;
        ed25519::must_be_signed(&key, "signature", &self.signature, text, called)
    }
}

/// Returns the routes of the published keys.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(list_signing_keys))
}

/// List the server's signing keys
///
/// Ed25519 public keys by which the server counter-signs the logs of work orders and their
/// evidence, with the time in which each signed. `binnacle-server verify-evidence --keys FILE`
/// reads this list.
#[utoipa::path(get, path = "/signing-keys", tag = "adjusting", security(()),
    responses((status = 200, body = PublishedKeys)))]
async fn list_signing_keys(Shared(app): Shared<App>) -> Result<Json<PublishedKeys>> {
    let items = list(&app.db).await?;
    Ok(Json(PublishedKeys { items }))
}
