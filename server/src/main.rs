//! Entry point of the server.

use anyhow::{Result, anyhow};
use binnacle_server::cli::{Cli, Command};
use binnacle_server::command;
use clap::Parser;
use std::process::ExitCode;

fn main() -> Result<ExitCode> {
    rustls::crypto::ring::default_provider()
        .install_default()
        .map_err(|_| anyhow!("another TLS provider is installed"))?;
    match Cli::parse().command {
        Command::Serve(serve) => command::serve(*serve),
        Command::Health(arguments) => command::health(&arguments),
        Command::Migrate(database) => command::migrate(&database),
        Command::Backup(arguments) => command::back_up(&arguments),
        Command::Restore(arguments) => command::restore(&arguments),
        Command::Admin(admin) => command::admin(admin),
        Command::Bursts(arguments) => command::bursts(&arguments),
        Command::Import(arguments) => command::import(&arguments),
        Command::Openapi => command::openapi(),
        Command::Field(arguments) => command::field(&arguments),
        Command::Fit(arguments) => command::fit(&arguments),
        Command::Deviation(arguments) => command::deviation(&arguments),
        Command::Analyse(arguments) => command::analyse(&arguments),
        Command::Validate(arguments) => command::validate(&arguments),
        Command::VerifyEvidence(arguments) => command::verify_evidence(&arguments),
        Command::Plan(arguments) => command::plan(&arguments),
        Command::Schedule(arguments) => command::schedule(&arguments),
    }
}
