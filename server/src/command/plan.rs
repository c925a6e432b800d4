//! `plan`: from a model, a binnacle and a reading at the berth, how to set the
//! correctors.
//!
//! A refusal is an answer: it says why, and what would cure it. A mistake in a file that
//! alone explains a berth that does not fit is bad input.

use super::{BadInput, answer, input, json};
use crate::config::Plan;
use binnacle_magnetics::adjust::{AdjustError, BerthForm, Outcome, plan as find_plans};
use binnacle_magnetics::binnacle::Binnacle;
use binnacle_magnetics::model::Model;
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;

/// What is printed.
#[derive(Serialize)]
struct Planned {
    /// `planned` or `refused`.
    verdict: &'static str,
    #[serde(flatten)]
    outcome: Outcome,
}

/// Prints the best few plans, or why there is none, as JSON.
///
/// # Errors
/// When standard output cannot be written.
pub fn plan(arguments: &Plan) -> anyhow::Result<ExitCode> {
    answer(find(arguments))
}

fn find(arguments: &Plan) -> Result<String, BadInput> {
    let model: Model = input::json_file(&arguments.model)?;
    model.check().map_err(|error| of(&arguments.model, error))?;
    let binnacle: Binnacle = input::json_file(&arguments.binnacle)?;
    let form: BerthForm = input::json_file(&arguments.berth)?;
    if let Some(mistake) = form.mistaken(&model, &binnacle) {
        return Err(of(&arguments.berth, mistake));
    }
    let berth = form.read().map_err(|error| of(&arguments.berth, error))?;
    let outcome = find_plans(&berth.adjustment(&model, &binnacle));
    let outcome = outcome.map_err(|error| match error {
        AdjustError::Binnacle(error) => of(&arguments.binnacle, error),
        AdjustError::Deviation(error) => of(&arguments.model, error),
        error => of(&arguments.berth, error),
    })?;
    let refused = !outcome.refusals.is_empty();
    Ok(json(&Planned {
        verdict: if refused { "refused" } else { "planned" },
        outcome,
    }))
}

fn of(file: &Path, what: impl std::fmt::Display) -> BadInput {
    BadInput(format!("{}: {what}", file.display()))
}
