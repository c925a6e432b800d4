//! The log of an order: what happened, each entry chained to the one before.
//!
//! What always holds: an entry is one line of JSON with its keys in order and no blanks,
//! and is kept as that text; its hash is the SHA-256 of the text, and the next entry
//! names it. So a log can be checked with nothing but SHA-256.

use crate::work_orders::events::OrderEvent;
use binnacle_platform::ids::{FirmId, OrderId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// An entry of an order's log.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Entry {
    /// Of this form: 1.
    pub version: u32,
    /// The order.
    pub order: OrderId,
    /// Counts from 1.
    pub seq: i64,
    /// The entry's id.
    pub id: Uuid,
    /// SHA-256 of the line before; none for the first.
    pub previous_sha256: Option<String>,
    /// When it was written.
    pub at: Time,
    /// Who wrote it.
    pub author: Author,
    /// What happened.
    #[serde(flatten)]
    pub content: OrderEvent,
}

/// Who wrote an entry.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Author {
    /// Their id; none for the server itself.
    pub id: Option<Uuid>,
    /// Their name.
    pub name: String,
    /// The firm that they are of; none for the operator's people.
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
