//! Firms and work orders of the server, tested over real HTTP on both databases.

#![allow(clippy::unwrap_used, reason = "these are tests")]

mod firms;
mod offers;
mod work_orders;

use binnacle_server_testing::program;
use std::path::Path;
use std::process::Output;

/// Runs the server's program in a folder.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    program::run(env!("CARGO_BIN_EXE_binnacle-server"), folder, arguments)
}
