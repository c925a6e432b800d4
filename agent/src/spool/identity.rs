//! Identity of the agent towards the server.

use super::database::{Spool, get, put};
use super::keys::IDENTITY;
use binnacle_wire::batch::StreamId;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Identity of the agent towards the server.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Identity {
    /// URL of the server, as `https://host`.
    pub(crate) server: String,
    /// Bearer token; never logged.
    pub(crate) token: String,
    /// Token that the server may know instead: a new one that may not be active yet, or the
    /// previous one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) other_token: Option<String>,
    /// Stream that batches are numbered in.
    pub(crate) stream: StreamId,
    /// Name of the vessel, for the local page.
    pub(crate) vessel_name: String,
    /// Name of the compass, for the local page.
    pub(crate) compass_name: String,
}

impl Identity {
    /// Returns whether both identities are of the same compass of the same vessel.
    pub(super) fn is_same_compass(&self, other: &Identity) -> bool {
        (&self.vessel_name, &self.compass_name) == (&other.vessel_name, &other.compass_name)
    }
}

impl fmt::Debug for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at {} (token withheld)", self.stream, self.server)
    }
}

impl Spool {
    /// Returns the identity, once the agent is enrolled.
    pub(crate) async fn identity(&self) -> sqlx::Result<Option<Identity>> {
        self.get(IDENTITY).await
    }

    /// Saves another token beside the active one.
    pub(crate) async fn save_other_token(&self, token: &str) -> sqlx::Result<()> {
        let mut tx = self.write().await?;
        if let Some(mut identity) = get::<Identity>(&mut tx, IDENTITY).await? {
            identity.other_token = Some(token.to_owned());
            put(&mut tx, IDENTITY, &identity).await?;
        }
        tx.commit().await
    }

    /// Activates the other token if `in_use` is still the active one. Returns whether there is
    /// another token.
    pub(crate) async fn swap_tokens(&self, in_use: &str) -> sqlx::Result<bool> {
        let mut tx = self.write().await?;
        let Some(mut identity) = get::<Identity>(&mut tx, IDENTITY).await? else {
            return Ok(false);
        };
        let Some(other) = identity.other_token.take() else {
            return Ok(false);
        };
        if identity.token == in_use {
            identity.other_token = Some(std::mem::replace(&mut identity.token, other));
            put(&mut tx, IDENTITY, &identity).await?;
            tx.commit().await?;
        }
        Ok(true)
    }
}
