//! Commands of the command line.
//!
//! Invariants: invalid input ends with exit code 2 and one line on standard error that names
//! the file, the line and the field. Nothing is printed on standard output before all of the
//! input was read and found valid.

mod admin;
mod analyse;
mod backup;
mod deviation;
mod field;
mod fit;
mod health;
mod ingest;
mod input;
mod logbook;
mod operate;
mod plan;
mod schedule;
mod table;
mod validate;
mod verify_evidence;

pub use admin::{Account, Sandbox, admin, create_sandbox};
pub use analyse::analyse;
pub use backup::{back_up, restore};
pub use deviation::deviation;
pub use field::field;
pub use fit::fit;
pub use health::health;
pub use ingest::{Import, ImportedSamples, bursts, import, import_samples};
pub use operate::{migrate, openapi, run, serve};
pub use plan::plan;
pub use schedule::schedule;
pub use validate::validate;
pub use verify_evidence::verify_evidence;

use serde::Serialize;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

/// Description of invalid input, in one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
struct BadInput(String);

impl BadInput {
    /// Describes an invalid command-line option.
    fn option(option: &str, detail: impl Display) -> BadInput {
        BadInput(format!("{option}: {detail}"))
    }
}

/// Prints a command's result, or the problem of its input.
fn print_result(result: Result<String, BadInput>) -> anyhow::Result<ExitCode> {
    match result {
        Ok(text) => {
            print(text.trim_end())?;
            Ok(ExitCode::SUCCESS)
        }
        Err(error) => {
            writeln!(std::io::stderr().lock(), "binnacle-server: {error}")?;
            Ok(ExitCode::from(2))
        }
    }
}

/// Prints on standard output; a closed pipe (`| head`) is not an error.
fn print(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        printed => printed,
    }
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).expect("numbers, words and lists are JSON")
}
