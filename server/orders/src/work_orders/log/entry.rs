//! Entries of an order's log, each chained to the one before.
//!
//! Invariants: an entry is one line of canonical JSON and is kept as that text. Its hash is the
//! SHA-256 of the text, and the next entry names it. A log can therefore be checked with nothing
//! but SHA-256.

use crate::work_orders::events::OrderEvent;
use binnacle_platform::ids::{FirmId, OrderId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Entry of an order's log.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Entry {
    /// Version of this format: 1.
    pub version: u32,
    /// The order.
    pub order: OrderId,
    /// Number of the entry, from 1.
    pub seq: i64,
    /// The entry's id.
    pub id: Uuid,
    /// SHA-256 of the line before; `None` for the first.
    pub previous_sha256: Option<String>,
    /// Time of writing.
    pub at: Time,
    /// Author.
    pub author: Author,
    /// The event.
    #[serde(flatten)]
    pub content: OrderEvent,
}

/// Author of an entry.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Author {
    /// Id of the user; `None` for the server itself.
    pub id: Option<Uuid>,
    /// Their name.
    pub name: String,
    /// Firm of the user; `None` for users of the operator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub firm_id: Option<FirmId>,
}

impl Author {
    /// The server itself.
    pub(crate) fn server() -> Author {
        Author {
            id: None,
            name: "Binnacle".to_owned(),
            firm_id: None,
        }
    }
}
