//! Accounts, connections and messages of the server, tested over real HTTP on both databases.

#![allow(clippy::unwrap_used, reason = "these are tests")]

mod audit;
mod authorisation;
mod defences;
mod events;
mod first_run;
mod headers;
mod mail;
mod people;
mod requests;
mod sandbox;
mod second_factor;
mod secrets;
mod sessions;
mod sign_in_provider;
mod tenants;
mod tls;
mod webhooks;

use binnacle_server_testing::program;
use std::path::Path;
use std::process::Output;

/// Runs the server's program in a folder.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    program::run(env!("CARGO_BIN_EXE_binnacle-server"), folder, arguments)
}
