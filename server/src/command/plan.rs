//! `plan`: plans the setting of the correctors from a model, a binnacle and a reading at the
//! berth. With another reading after the steps it checks the result.
//!
//! A refusal is a regular result, with its reason and its cures. If a mistake in a file alone
//! explains readings that do not fit, the file is invalid input.

use super::{BadInput, input, json, print_result};
use crate::cli::Plan;
use binnacle_adjustment::adjust::{
    AdjustError, Adjustment, BerthForm, CompletedStep, Outcome, PostCheckForm,
    check_second_reading, plan as find_plans,
};
use binnacle_adjustment::binnacle::Binnacle;
use binnacle_compass::model::Model;
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;

/// Printed result.
#[derive(Serialize)]
struct Planned {
    /// `planned` or `refused`.
    verdict: &'static str,
    #[serde(flatten)]
    outcome: Outcome,
}

/// Prints the best plans, or the reasons why there is none, as JSON.
///
/// # Errors
/// Fails when standard output cannot be written.
pub fn plan(arguments: &Plan) -> anyhow::Result<ExitCode> {
    print_result(find(arguments))
}

fn find(arguments: &Plan) -> Result<String, BadInput> {
    let model: Model = input::json_file(&arguments.model)?;
    model
        .check()
        .map_err(|error| file_error(&arguments.model, error))?;
    let binnacle: Binnacle = input::json_file(&arguments.binnacle)?;
    let form: BerthForm = input::json_file(&arguments.berth)?;
    if let Some(mistake) = form.explain_misreadings(&model, &binnacle) {
        return Err(file_error(&arguments.berth, mistake));
    }
    let berth = form
        .parse()
        .map_err(|error| file_error(&arguments.berth, error))?;
    let outcome = find_plans(&berth.adjustment(&model, &binnacle));
    let outcome = outcome.map_err(|error| match error {
        AdjustError::Binnacle(error) => file_error(&arguments.binnacle, error),
        AdjustError::Deviation(error) => file_error(&arguments.model, error),
        error => file_error(&arguments.berth, error),
    })?;
    if let Some(after) = &arguments.after {
        return read_after(
            arguments,
            after,
            &form,
            &berth.adjustment(&model, &binnacle),
            outcome,
        );
    }
    let refused = !outcome.refusals.is_empty();
    Ok(json(&Planned {
        verdict: if refused { "refused" } else { "planned" },
        outcome,
    }))
}

/// Checks the steps of a plan against the magnetometer reading after them.
fn read_after(
    arguments: &Plan,
    file: &Path,
    form: &BerthForm,
    adjustment: &Adjustment<'_>,
    mut outcome: Outcome,
) -> Result<String, BadInput> {
    if let Some(refused) = outcome.refusals.first() {
        return Err(file_error(
            &arguments.berth,
            format!("no plan is possible: {}", refused.words),
        ));
    }
    let after: PostCheckForm = input::json_file(file)?;
    let plans = outcome.plans.len();
    if after.plan == 0 || after.plan > plans {
        return Err(file_error(
            file,
            format!("plan: there are plans 1 to {plans}"),
        ));
    }
    let plan = outcome.plans.remove(after.plan - 1);
    if after.turned_deg.len() > plan.steps.len() {
        let steps = plan.steps.len();
        return Err(file_error(
            file,
            format!("turned_deg: the plan has {steps} steps"),
        ));
    }
    let there = form
        .parse_after(&after)
        .map_err(|error| file_error(file, error))?;
    let steps = plan.steps.into_iter().enumerate();
    let done: Vec<CompletedStep> = steps
        .map(|(index, step)| CompletedStep {
            step,
            turned_deg: after.turned_deg.get(index).copied().flatten(),
        })
        .collect();
    let adjustment = Adjustment {
        now: Some(&plan.setting),
        ..adjustment.clone()
    };
    let checked = check_second_reading(
        &adjustment,
        &done,
        &there.reading,
        there.vertical,
        after.reading.compass_deg,
        after.reading.unit,
    );
    Ok(json(&checked.map_err(|error| file_error(file, error))?))
}

fn file_error(file: &Path, what: impl std::fmt::Display) -> BadInput {
    BadInput(format!("{}: {what}", file.display()))
}
