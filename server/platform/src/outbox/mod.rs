//! Messages on their way out, whatever carries them: a queue for each receiver.
//!
//! Invariants:
//!
//! - A message is queued in the transaction that makes it true, and sent at least
//!   once; its id tells a receiver that it had it before.
//! - Each receiver gets the messages of a work order in order, and those that are of
//!   none: the next is not sent before this one was delivered, refused for good, or
//!   given up after a day of tries. What holds up one order holds up no other.
//! - What waits survives a restart, and any server process may send it.

mod delivery;
mod history;
mod queue;
mod receivers;
mod worker;

pub use delivery::{Channel, Delivery, DeliveryList, Filter, Kind, Message};
pub use history::{list, queue_one, send_again};
pub use queue::{Claimed, queue};
pub use receivers::{delete, enable, ensure, forget, insert};
pub use worker::{Carrier, Sent, Tried, run, step};
