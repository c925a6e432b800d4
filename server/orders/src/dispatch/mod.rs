//! Dispatch of a work order to firms: offers with answers and deadlines, rescheduling, and
//! changes of the port call.

pub(crate) mod call_links;
pub(crate) mod messages;
mod new_port_calls;
pub(crate) mod offer_api;
mod offer_expiry;
pub(crate) mod offer_requests;
mod offer_sequence;
pub(crate) mod port_call_changes;
pub(crate) mod port_call_check;
pub(crate) mod reschedule;

pub use call_links::link_once;
pub use messages::QUOTA as MESSAGES_QUOTA;
pub use new_port_calls::{NewCall, attach_new_calls};
pub use offer_expiry::{lapse, watch};
pub use port_call_changes::{CallUpdate, announce_call_updates};
