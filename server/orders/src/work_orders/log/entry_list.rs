//! Page of an order's log, as a response.

use binnacle_platform::signing_keys::Seal;
use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;

/// An entry of an order's log: a line of canonical JSON with its hash.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrderEntry)]
pub(crate) struct EntryLine {
    /// Number of the entry, from 1.
    pub(crate) seq: i64,
    /// SHA-256 of the line as it stands in the archive, hexadecimal.
    pub(crate) sha256: String,
    /// The server's signature over the entry; none of one from before servers signed.
    #[schema(required)]
    pub(crate) seal: Option<Seal>,
    /// The entry: `kind`, `at`, `author`, `previous_sha256` and `content`.
    #[schema(value_type = Object)]
    pub(crate) entry: Value,
}

/// A page of an order's log.
#[derive(Serialize, ToSchema)]
#[schema(as = WorkOrderEntryList)]
pub(crate) struct EntryList {
    /// In order.
    pub(crate) items: Vec<EntryLine>,
    /// `after` of the next page.
    #[schema(required)]
    pub(crate) next: Option<String>,
}
