//! `schedule`: plans adjustments from vessels, needs, port calls and firms.

use super::{BadInput, input, json, print_result};
use crate::cli::Schedule;
use binnacle_schedule::input::read;
use binnacle_schedule::plan::plan;
use std::process::ExitCode;

/// Prints the schedule as JSON.
///
/// # Errors
/// Fails when standard output cannot be written.
pub fn schedule(arguments: &Schedule) -> anyhow::Result<ExitCode> {
    print_result(find(arguments))
}

fn find(arguments: &Schedule) -> Result<String, BadInput> {
    let text = input::text_file(&arguments.input)?;
    let checked =
        read(&text).map_err(|error| BadInput(format!("{}: {error}", arguments.input.display())))?;
    Ok(json(&plan(&checked)))
}
