//! Outbox: outgoing messages of every channel, in one queue per receiver.
//!
//! Invariants:
//!
//! - A message is queued in the transaction that makes it true, and sent at least once. By its
//!   id a receiver recognises a repeated message.
//! - Each receiver gets the messages about one thing in sequence, and likewise those about none.
//!   The next one is sent only after this one was delivered, refused permanently, or given up
//!   after a day. A delay of one sequence does not delay the others.
//! - Pending messages survive a restart, and any server process may send them.

mod delivery;
mod history;
mod kind;
mod queue;
mod receivers;
mod worker;

pub use delivery::{Channel, Delivery, DeliveryList, Filter, Message};
pub use history::{list, queue_one, send_again};
pub use kind::Kind;
pub use queue::{Claimed, queue};
pub use receivers::{delete, enable, ensure, forget, insert};
pub use worker::{Attempt, Carrier, Sent, run, step};
