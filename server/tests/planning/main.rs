//! Port calls and schedule of the server, tested over real HTTP on both databases.

#![allow(clippy::unwrap_used, reason = "these are tests")]

mod calendar;
mod notifications;
mod out_of_service;
mod port_calls;
mod reports;
mod schedule;
