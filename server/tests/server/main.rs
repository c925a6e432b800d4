//! Commands and documents of the server, tested as a program and over real HTTP.

#![allow(clippy::unwrap_used, reason = "these are tests")]

mod backup;
mod commands;
mod dashboard;
mod documentation_examples;
mod fit;
mod metrics;
mod migration;
mod openapi;
mod outages;
mod plan;
mod roles;
mod schedule;
mod service_manager;
mod validate;

use binnacle_server_testing::program;
use std::path::Path;
use std::process::Output;

/// Runs the server's program in a folder.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    program::run(env!("CARGO_BIN_EXE_binnacle-server"), folder, arguments)
}
