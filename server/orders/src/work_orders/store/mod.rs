//! Orders and their logs in the database.

mod idempotency_keys;
mod queries;
mod stored_order;
mod write;

pub(crate) use idempotency_keys::{find as find_written, once as write_once};
pub(crate) use queries::{
    find, last_completed, lines, list, lock, names, overdue, photo, record, summary, vessel_of,
    vessel_of_asked,
};
pub(crate) use stored_order::StoredOrder;
pub use write::lock_compass;
pub(crate) use write::{
    append, complete, insert, insert_photo, is_adjusting, is_under_way, verified,
};
