//! Counter-signature of the server over an entry of an order's log.
//!
//! Invariants: it covers the order, the number of the entry and so the length of the log until
//! then, the hash of its line and so of all lines before, and who may read it: an entry that is for
//! all parties cannot be passed off as withheld.

use crate::work_orders::events::Audience;
use crate::work_orders::log::canonical_json::canonical;
use binnacle_platform::error::Result;
use binnacle_platform::signing_keys::{Seal, ServerKey};
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Entry as the server signs it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SealedEntry {
    /// Number of the entry, from 1.
    pub(crate) seq: i64,
    /// SHA-256 of its line, hexadecimal.
    pub(crate) sha256: String,
    /// Readers: `parties`, `operator`, or the id of a firm.
    pub(crate) readers: String,
    /// Signature; none of entries from before servers signed.
    pub(crate) seal: Option<Seal>,
}

/// Readers of an entry for all parties.
pub(crate) const PARTIES: &str = "parties";
/// Readers of an entry for the operator alone, and of an archive for it.
pub(crate) const OPERATOR: &str = "operator";

/// Names the readers of an entry.
pub(crate) fn readers(audience: Audience) -> String {
    match audience {
        Audience::Operator => OPERATOR.to_owned(),
        Audience::Firm(firm) => firm.to_string(),
        Audience::Parties => PARTIES.to_owned(),
    }
}

impl SealedEntry {
    /// Returns the text that is signed: canonical JSON.
    ///
    /// # Errors
    /// Fails when it cannot be written as JSON.
    pub(crate) fn text(&self, order: &str) -> Result<String> {
        canonical(&json!({
            "what": "entry of a work order", "order": order, "seq": self.seq,
            "sha256": self.sha256, "readers": self.readers,
        }))
    }

    /// Signs the entry.
    ///
    /// # Errors
    /// Fails when it cannot be written as JSON.
    pub(crate) fn sign(&mut self, order: &str, key: &ServerKey) -> Result<()> {
        self.seal = Some(key.sign(self.text(order)?.as_bytes()));
        Ok(())
    }
}
