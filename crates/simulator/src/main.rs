//! The fleet and voyage simulator.

mod atomic_file;
mod cli;
mod clock;
mod fleet;
mod line;
mod voyage;

use anyhow::Result;
use clap::Parser;
use cli::Command;
use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    rustls::crypto::ring::default_provider()
        .install_default()
        .expect("no other provider has been installed before");
    let command = cli::Cli::parse().command;
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build();
    let ended = runtime
        .map_err(anyhow::Error::from)
        .and_then(|runtime| runtime.block_on(run(command)));
    match ended {
        Ok(code) => code,
        Err(error) => {
            // A closed standard error cannot be reported.
            writeln!(std::io::stderr(), "binnacle-simulator: {error:#}").ok();
            let blames_input = error.is::<cli::BadInput>();
            ExitCode::from(if blames_input { 2 } else { 1 })
        }
    }
}

async fn run(command: Command) -> Result<ExitCode> {
    match command {
        Command::Voyage(args) => voyage::run(&args).await,
        Command::Fleet(args) => fleet::run(&args).await,
    }
}
