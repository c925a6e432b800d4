//! Orders and their logs in the database.

mod idempotency_keys;
mod queries;
mod stored_order;
mod write;

pub(crate) use idempotency_keys::{find as find_written, once as write_once};
pub(crate) use queries::{
    ListedOrders, StoredLine, find, find_last_completed, find_names, find_photo, find_record,
    find_summary, find_vessel, find_vessel_for_firm, list, list_lines, list_overdue, lock,
};
pub(crate) use stored_order::StoredOrder;
pub use write::lock_compass;
pub(crate) use write::{
    append, insert, insert_photo, is_adjusting, is_under_way, store_completion, store_verification,
};
