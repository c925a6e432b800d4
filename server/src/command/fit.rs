//! `fit`: a model from a file.

use super::{BadInput, answer, input, json, table};
use crate::config::{Fit, Method};
use binnacle_magnetics::deviation::NAMES;
use binnacle_magnetics::fit::{
    FitError, GyroSpeedError, Observation, REFERENCE_CONSTANT_SD_DEG, RobustOptions, fit_ols,
    fit_paper, fit_robust, readings_from_csv, refer,
};
use binnacle_magnetics::model::{Model, Quality};
use std::process::ExitCode;

/// Prints the model, as a table or as JSON.
///
/// # Errors
/// When standard output cannot be written.
pub fn fit(arguments: &Fit) -> anyhow::Result<ExitCode> {
    answer(find(arguments).map(|model| {
        if arguments.json {
            json(&model)
        } else {
            describe(&model)
        }
    }))
}

fn find(arguments: &Fit) -> Result<Model, BadInput> {
    let table = input::Table::read(&arguments.file)?;
    let readings = readings_from_csv(&table.rows, GyroSpeedError::Corrected)
        .map_err(|error| table.complaint(&error))?;
    let refused = |error: FitError| BadInput(format!("{}: {error}", arguments.file.display()));
    let referred = refer(&readings, REFERENCE_CONSTANT_SD_DEG).map_err(refused)?;
    let observations: Vec<Observation> = referred.observations.into_iter().flatten().collect();
    let fitted = match arguments.method {
        Method::Paper => fit_paper(&observations),
        Method::Ols => fit_ols(&observations),
        Method::Robust => {
            let options = RobustOptions::of_any_ship(referred.check.constant_sd_deg);
            fit_robust(&observations, &options).map(|fit| fit.model)
        }
    };
    let mut model = fitted.map_err(refused)?;
    model.samples_rejected += (readings.len() - observations.len()) as u64;
    Ok(model)
}

fn describe(model: &Model) -> String {
    let values = model.parameters_over_lambda.to_array();
    let identifiable = model.identifiable.map(|known| {
        [
            known.bx_nt,
            known.chi13,
            known.by_nt,
            known.chi23,
            known.chi11_minus_chi22,
            known.chi12,
            known.chi21,
            known.constant_deg,
        ]
    });
    let rows: Vec<[String; 4]> = NAMES
        .iter()
        .zip(values.into_iter().chain([model.constant_deg]))
        .enumerate()
        .map(|(index, (name, value))| {
            let error = model
                .covariance
                .map(|covariance| covariance[index][index].sqrt());
            let from_data = match identifiable.map(|known| known[index]) {
                Some(true) => "yes",
                Some(false) => "no",
                None => "",
            };
            [
                (*name).to_owned(),
                number(name, value),
                error.map_or(String::new(), |error| number(name, error)),
                from_data.to_owned(),
            ]
        })
        .collect();
    let rms = model
        .rms_deg
        .map_or(String::new(), |rms| format!(", rms {rms:.2}°"));
    format!(
        "{}\n{} samples used, {} rejected{rms}",
        table::render(
            ["over lambda", "value", "std error", "from the data"],
            &rows
        ),
        model.samples_used,
        model.samples_rejected
    ) + &model.quality.as_ref().map_or_else(String::new, worth)
}

/// What the samples are worth, and what not to trust the model for.
fn worth(quality: &Quality) -> String {
    let samples = quality.effective_samples;
    let worth = format!("\nworth {samples:.0} samples with independent errors");
    let cautions = quality.cautions.iter();
    cautions.fold(worth, |lines, caution| {
        lines + "\ncaution: " + &caution.to_string()
    })
}

/// Fields to the nanotesla, angles to the hundredth, ratios to the fourth place.
fn number(name: &str, value: f64) -> String {
    if name.ends_with("_nt") {
        format!("{value:.0}")
    } else if name.ends_with("_deg") {
        format!("{value:.2}")
    } else {
        format!("{value:.4}")
    }
}
