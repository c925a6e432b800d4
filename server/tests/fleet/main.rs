//! Fleet of the server, tested over real HTTP on both databases.

#![allow(clippy::unwrap_used, reason = "these are tests")]

mod agent_alerts;
mod alert_handling;
mod alerts;
mod analysis;
mod azimuths;
mod binnacles;
mod card;
mod card_check;
mod changes;
mod course_over_ground;
mod deviation_book;
mod enrolment;
mod fleet_prior;
mod ingest;
mod logbook;
mod overview;
mod vessels;

use binnacle_server_testing::program;
use std::path::Path;
use std::process::Output;

/// Runs the server's program in a folder.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    program::run(env!("CARGO_BIN_EXE_binnacle-server"), folder, arguments)
}
