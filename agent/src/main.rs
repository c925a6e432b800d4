//! The shipboard agent.

use std::process::ExitCode;

fn main() -> ExitCode {
    rustls::crypto::ring::default_provider()
        .install_default()
        .expect("no other provider has been installed before");
    binnacle_agent::commands::main()
}
