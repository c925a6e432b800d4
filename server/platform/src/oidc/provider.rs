//! The provider's own description: its addresses and keys.
//!
//! Invariants: it is asked when someone wants to sign in, not before; once an hour
//! at most, but that a token by a key that is not known yet makes it be asked again; and
//! after a failure not again for some seconds, however many wait.

use super::http::Http;
use super::refusal::Refusal;
use crate::app::App;
use anyhow::Context;
use binnacle_compass::time::Timestamp;
use openidconnect::IssuerUrl;
use openidconnect::core::CoreProviderMetadata;
use std::sync::Arc;
use tokio::sync::Mutex;
use tracing::warn;

/// Time after which the provider is asked again, seconds.
const KEPT_S: f64 = 3600.0;
/// Minimum wait before another request for unknown keys, seconds.
pub(super) const NEW_KEYS_AFTER_S: f64 = 60.0;
/// Minimum wait after a failure, seconds.
const TRIED_AGAIN_AFTER_S: f64 = 5.0;

/// Cache of the last discovery, whether it succeeded or failed.
#[derive(Default)]
pub struct Provider {
    kept: Mutex<Option<Kept>>,
}

struct Kept {
    at: Timestamp,
    found: Option<Arc<Found>>,
}

/// A provider that has answered.
pub(super) struct Found {
    pub(super) metadata: CoreProviderMetadata,
    pub(super) http: Http,
}

/// Returns the provider's description, cached for less than `age_s` seconds or fetched anew.
pub(super) async fn find(app: &App, age_s: f64) -> Result<Arc<Found>, Refusal> {
    let mut kept = app.provider.kept.lock().await;
    let now = app.clock.now();
    if let Some(Kept { at, found }) = &*kept {
        let age = now.seconds_since(*at);
        match found {
            Some(found) if age < age_s => return Ok(Arc::clone(found)),
            None if age < TRIED_AGAIN_AFTER_S => return Err(Refusal::Unreachable),
            _ => {}
        }
    }
    let issuer = app.config.oidc.oidc_issuer.as_deref().unwrap_or_default();
    let found = discover(issuer).await.map(Arc::new);
    if let Err(cause) = &found {
        let error = format!("{cause:#}");
        warn!(issuer, error, "the sign-in provider cannot be reached");
    }
    let found = found.ok();
    *kept = Some(Kept {
        // It may have taken as long to find nothing.
        at: app.clock.now(),
        found: found.clone(),
    });
    found.ok_or(Refusal::Unreachable)
}

/// As it usually does.
pub(super) async fn current(app: &App) -> Result<Arc<Found>, Refusal> {
    find(app, KEPT_S).await
}

async fn discover(issuer: &str) -> anyhow::Result<Found> {
    let http = Http::of(issuer).await?;
    let issuer = IssuerUrl::new(issuer.to_owned())?;
    let metadata = CoreProviderMetadata::discover_async(issuer, &http).await?;
    metadata
        .token_endpoint()
        .context("it names no token endpoint")?;
    Ok(Found { metadata, http })
}
