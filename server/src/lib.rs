//! Binnacle server: commands, routes, the analysis worker and the dashboard.
//!
//! One folder or file per capability, in reading order:

#![allow(
    clippy::missing_errors_doc,
    reason = "a function that asks the database errs when that does; others say more"
)]
#![allow(
    clippy::cast_possible_wrap,
    reason = "counts go into BIGINT and are far from its end"
)]

pub mod kinds;
pub mod state;
pub mod subscriptions;

pub mod backup;
pub mod dashboard;
pub mod health;
pub mod routes;
pub mod worker;

pub mod cli;
pub mod command;
