//! Requests to other servers, and the addresses that they may reach.
//!
//! Invariants: no redirect is followed and no proxy is used, so that a request goes only to
//! an address that was checked. Nothing is sent to an address outside the public internet,
//! unless the caller allows it.

mod address;
mod client;

pub use address::is_public;
pub use client::{Reach, check_url, client};
