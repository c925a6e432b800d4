//! Metadata of the OpenID Connect provider: its addresses and keys.
//!
//! Invariants: the provider is asked only when someone wants to sign in, and at most once
//! an hour. Only a token signed with an unknown key makes the server ask again earlier.
//! After a failure the provider is not asked again for some seconds, however many people
//! wait.

mod http;

use crate::clock::Clock;
use anyhow::Context;
use binnacle_compass::time::Timestamp;
use http::Http;
use openidconnect::IssuerUrl;
use openidconnect::core::CoreProviderMetadata;
use std::sync::Arc;
use tokio::sync::Mutex;
use tracing::warn;

/// Time after which the provider is asked again, seconds.
const CACHED_S: f64 = 3600.0;
/// Minimum wait before another request for unknown keys, seconds.
const NEW_KEYS_AFTER_S: f64 = 60.0;
/// Minimum wait after a failure, seconds.
const RETRY_AFTER_S: f64 = 5.0;

/// Cache of the last discovery, whether it succeeded or failed.
#[derive(Default)]
pub struct Provider {
    cached: Mutex<Option<CachedDiscovery>>,
}

struct CachedDiscovery {
    at: Timestamp,
    found: Option<Arc<Discovery>>,
}

/// Metadata of a provider that has responded, and the client for further requests to it.
pub(crate) struct Discovery {
    pub(crate) metadata: CoreProviderMetadata,
    pub(crate) http: Http,
}

/// The provider cannot be reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unreachable;

impl Provider {
    /// Returns the metadata, cached for at most an hour or fetched anew.
    pub(crate) async fn current(
        &self,
        issuer: &str,
        clock: &Clock,
    ) -> Result<Arc<Discovery>, Unreachable> {
        self.find(issuer, clock, CACHED_S).await
    }

    /// Returns the metadata with the keys of now, fetched anew unless that was just done.
    pub(crate) async fn with_new_keys(
        &self,
        issuer: &str,
        clock: &Clock,
    ) -> Result<Arc<Discovery>, Unreachable> {
        self.find(issuer, clock, NEW_KEYS_AFTER_S).await
    }

    /// Returns the metadata, cached for less than `age_s` seconds or fetched anew.
    async fn find(
        &self,
        issuer: &str,
        clock: &Clock,
        age_s: f64,
    ) -> Result<Arc<Discovery>, Unreachable> {
        let mut cached = self.cached.lock().await;
        let now = clock.now();
        if let Some(CachedDiscovery { at, found }) = &*cached {
            let age = now.seconds_since(*at);
            match found {
                Some(found) if age < age_s => return Ok(Arc::clone(found)),
                None if age < RETRY_AFTER_S => return Err(Unreachable),
                _ => {}
            }
        }
        let found = discover(issuer).await.map(Arc::new);
        if let Err(cause) = &found {
            let error = format!("{cause:#}");
            warn!(issuer, error, "the sign-in provider cannot be reached");
        }
        let found = found.ok();
        *cached = Some(CachedDiscovery {
            // A failed attempt may have taken long too.
            at: clock.now(),
            found: found.clone(),
        });
        found.ok_or(Unreachable)
    }
}

async fn discover(issuer: &str) -> anyhow::Result<Discovery> {
    let http = Http::for_issuer(issuer).await?;
    let issuer = IssuerUrl::new(issuer.to_owned())?;
    let metadata = CoreProviderMetadata::discover_async(issuer, &http).await?;
    metadata
        .token_endpoint()
        .context("it names no token endpoint")?;
    Ok(Discovery { metadata, http })
}
