//! Timeline of a compass: its epochs, the changes between them with their causes, and the
//! deviation in each epoch.
//!
//! Invariants: the timeline shows the last analysis. All curves are of the place of the last
//! sample, so that they can be compared.

mod api;
mod store;
mod timeline;

pub use api::router;
