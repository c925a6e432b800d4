//! `fit`: fits a model to a file.

mod by_course;

use super::{BadInput, input, json, print_result, table};
use crate::cli::{Fit, Method};
use binnacle_analysis::advice::{Question, advise};
use binnacle_analysis::fit::{
    Observation, RobustFit, RobustOptions, check_references, fit_ols, fit_paper, fit_robust,
    observe_readings, readings_from_csv, reference_grade,
};
use binnacle_compass::coverage::coverage;
use binnacle_compass::deviation::PARAMETER_NAMES;
use binnacle_compass::model::{Model, Quality, ReferenceGrade};
use binnacle_compass::result::{FitError, HeadingRange, ReferenceCheck, SailNext};
use binnacle_compass::settings::REFERENCE_CONSTANT_SD_DEG;
use binnacle_compass::ship::EarthField;
use std::process::ExitCode;

/// Result of a fit.
struct FitResult {
    model: Model,
    /// Comparison of the references; none of a course over ground.
    check: Option<ReferenceCheck>,
    /// Advice on headings; only with the product's estimator.
    sail_next: Option<SailNext>,
    /// Remarks on the samples.
    notices: Vec<String>,
}

/// Prints the model, as a table or as JSON.
///
/// # Errors
/// Fails when standard output cannot be written.
pub fn fit(arguments: &Fit) -> anyhow::Result<ExitCode> {
    print_result(find(arguments).map(|found| {
        if arguments.json {
            json(&found.model)
        } else {
            describe(&found)
        }
    }))
}

fn find(arguments: &Fit) -> Result<FitResult, BadInput> {
    let table = input::Table::read(&arguments.file)?;
    if reference_grade(&table.rows) == ReferenceGrade::CourseOverGround {
        return by_course::find(arguments, &table);
    }
    let readings = readings_from_csv(&table.rows, arguments.gyro_speed_error.into())
        .map_err(|error| table.error_at(&error))?;
    let refused = |error: FitError| BadInput(format!("{}: {error}", arguments.file.display()));
    check_references(&readings).map_err(refused)?;
    let referred = observe_readings(&readings, REFERENCE_CONSTANT_SD_DEG).map_err(refused)?;
    let observations: Vec<Observation> = referred.observations.into_iter().flatten().collect();
    let mut sail_next = None;
    let fitted = match arguments.method {
        Method::Paper => fit_paper(&observations),
        Method::Ols => fit_ols(&observations),
        Method::Robust => {
            let options = RobustOptions::for_unknown_vessel(referred.check.constant_sd_deg);
            fit_robust(&observations, &options).map(|fit| {
                sail_next = advise_headings(&fit, &observations, &referred.check);
                fit.model
            })
        }
    };
    let mut model = fitted.map_err(refused)?;
    let reckoned = table
        .rows
        .iter()
        .filter(|row| row.position_reckoned)
        .count();
    model.samples_rejected += (reckoned + readings.len() - observations.len()) as u64;
    Ok(FitResult {
        model,
        check: Some(referred.check),
        sail_next,
        notices: Vec::new(),
    })
}

/// Advises on headings that would narrow the confidence band at the vessel's last position.
fn advise_headings(
    fit: &RobustFit,
    observations: &[Observation],
    check: &ReferenceCheck,
) -> Option<SailNext> {
    let last = observations.last()?;
    let samples = observations.iter().map(|o| (o.compass, o.h_nt, o.z_nt));
    advise(&Question {
        model: &fit.model,
        noise: &fit.noise,
        reference_constant_sd_deg: check.constant_sd_deg,
        // Beside a satellite compass the gyro has little weight.
        gyro_share: if last.gyro_share < 1.0 { 0.0 } else { 1.0 },
        here: EarthField {
            h_nt: last.h_nt,
            z_nt: last.z_nt,
        },
        elsewhere: &[],
        coverage: &coverage(samples),
    })
    .ok()
}

fn describe(found: &FitResult) -> String {
    let model = &found.model;
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
    let rows: Vec<[String; 4]> = PARAMETER_NAMES
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
    ) + &model
        .quality
        .as_ref()
        .map_or_else(String::new, describe_quality)
        + &found
            .check
            .as_ref()
            .map_or_else(String::new, describe_rejected)
        + &found
            .sail_next
            .as_ref()
            .map_or_else(String::new, describe_band)
        + &found
            .notices
            .iter()
            .flat_map(|notice| ["\n", notice.as_str()])
            .collect::<String>()
}

/// Names the reference that was rejected.
fn describe_rejected(check: &ReferenceCheck) -> String {
    let line = |name: &str, count: u64| match count {
        0 => String::new(),
        _ => format!(
            "\n{name} rejected in {count} samples: stuck, or in disagreement with the other reference"
        ),
    };
    line("gyro", check.gyro_dropped) + &line("satellite compass", check.satellite_dropped)
}

/// Describes the confidence band, here and elsewhere, and the headings that would narrow it.
fn describe_band(next: &SailNext) -> String {
    let here = &next.here;
    let mut lines = vec![format!(
        "95 % band at the last position: ± {:.1}°, on the worst heading {:.1}°",
        here.band.rms_deg, here.band.worst_deg
    )];
    lines.extend(here.suggestions.first().map(|best| {
        format!(
            "to sail next: {:.0} hours on {}, for ± {:.1}°",
            next.watch_hours,
            headings(best.range),
            best.after_one.rms_deg
        )
    }));
    if let Some(elsewhere) = &next.elsewhere {
        lines.push(format!(
            "95 % band in other waters: ± {:.1}°, at worst {:.1}°",
            elsewhere.band.rms_deg, elsewhere.band.worst_deg
        ));
        lines.extend(elsewhere.suggestions.first().map(|best| {
            let on: Vec<String> = best.headings.iter().map(|&range| headings(range)).collect();
            format!(
                "to sail next: magnetic latitude {} to {}, on {}, for ± {:.1}°",
                latitude(best.magnetic_latitude_from_deg),
                latitude(best.magnetic_latitude_to_deg),
                on.join(", "),
                best.after_three.rms_deg
            )
        }));
    }
    format!("\n{}", lines.join("\n"))
}

fn latitude(degrees: i16) -> String {
    match degrees {
        0 => "0°".to_owned(),
        south if south < 0 => format!("{}° S", -south),
        north => format!("{north}° N"),
    }
}

fn headings(range: HeadingRange) -> String {
    let HeadingRange {
        heading_from_deg: from,
        heading_to_deg: to,
    } = range;
    if (from, to) == (0, 360) {
        return "any heading".to_owned();
    }
    format!("headings {from:03} to {to:03}")
}

/// Describes the quality of the samples and the limits of the model.
fn describe_quality(quality: &Quality) -> String {
    let samples = quality.effective_samples;
    let condition = quality.condition.map_or_else(
        || "open: the data leave one combination of parameters unknown".to_owned(),
        |condition| format!("{condition:.0}"),
    );
    let worth =
        format!("\nworth {samples:.0} samples with independent errors\ncondition {condition}");
    let cautions = quality.cautions.iter();
    cautions.fold(worth, |lines, caution| {
        lines + "\ncaution: " + &caution.to_string()
    })
}

/// Formats a value: fields to a nanotesla, angles to 0.01°, ratios to 0.0001.
fn number(name: &str, value: f64) -> String {
    if name.ends_with("_nt") {
        format!("{value:.0}")
    } else if name.ends_with("_deg") {
        format!("{value:.2}")
    } else {
        format!("{value:.4}")
    }
}
