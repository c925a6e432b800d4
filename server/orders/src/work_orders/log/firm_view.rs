//! View of an order's log for a firm: exchanges with other firms are withheld.
//!
//! Invariant: a withheld entry leaves its number, its hash and that of the entry before, so that
//! the log can be checked without it.

use crate::work_orders::log::canonical_json::canonical;
use crate::work_orders::log::entry::Entry;
use binnacle_platform::error::Result;
use binnacle_platform::tenants::Tenant;
use serde_json::json;

/// Returns a line of a log as a tenant may read it.
///
/// # Errors
/// Fails when it cannot be written as JSON.
pub(crate) fn line(tenant: Tenant, entry: &Entry, line: String, sha256: &str) -> Result<String> {
    let seen = |firm| entry.content.event().audience().includes(firm);
    if tenant.firm().is_none_or(seen) {
        return Ok(line);
    }
    canonical(&json!({
        "order": entry.order, "seq": entry.seq, "previous_sha256": entry.previous_sha256,
        "withheld_sha256": sha256,
    }))
}
