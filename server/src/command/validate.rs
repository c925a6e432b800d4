//! `validate`: checks on anyone's own recording whether predictions hold.

use super::analyse::{read_logbook, read_samples};
use super::{BadInput, json, print_result, table};
use crate::cli::Validate;
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::result::PredictionCoverage;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_tracking::Input;
use binnacle_tracking::validation::{HeldOut, PartCheck, Settled, Validation};
use serde::Serialize;
use std::process::ExitCode;

/// Courses below which a share says nothing: one course outside is then no sign.
const NEEDED_COURSES: u32 = 8;

/// Prints the predictions before use, and parts of the recording held against each other.
///
/// # Errors
/// Fails when standard output cannot be written.
pub fn validate(arguments: &Validate) -> anyhow::Result<ExitCode> {
    print_result(find(arguments).map(|found| {
        if arguments.json {
            json(&found)
        } else {
            describe(&found)
        }
    }))
}

fn find(arguments: &Validate) -> Result<Validation, BadInput> {
    let samples = read_samples(&arguments.file, arguments.gyro_speed_error)?;
    let logbook = read_logbook(arguments.logbook.as_deref())?;
    Ok(binnacle_tracking::validation::validate(&Input {
        samples: &samples,
        logbook: &logbook,
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: AnalysisSettings {
            gyro_speed_error: arguments.gyro_speed_error.into(),
            ..AnalysisSettings::default()
        },
    }))
}

fn describe(found: &Validation) -> String {
    let mut blocks = vec![
        describe_samples(found),
        describe_predictions(&found.predictions),
    ];
    blocks.extend(describe_changes(found));
    if let Some(refusal) = &found.refusal {
        blocks.push(format!("The whole recording has no model: {refusal}."));
    }
    blocks.extend(describe_stretch(found));
    blocks.extend(found.parts.iter().map(describe_part));
    blocks.join("\n\n")
}

fn describe_samples(found: &Validation) -> String {
    let settled = &found.settled;
    let mut lines = vec![describe_settled(settled)];
    let refused = found.refused.iter();
    let refused: Vec<String> = refused
        .map(|refused| format!("{} {}", words(&refused.reason), refused.samples))
        .collect();
    let not_used = if refused.is_empty() {
        "none refused".to_owned()
    } else {
        format!("refused: {}", refused.join(", "))
    };
    lines.push(format!("{} samples used, {not_used}", found.used));
    lines.join("\n")
}

fn describe_settled(settled: &Settled) -> String {
    let rows = settled.rows;
    let Some(seconds) = settled.sample_s else {
        return format!("{rows} rows read as settled samples");
    };
    format!(
        "{rows} rows read, settled to {} samples of at most {seconds} seconds\n\
         {:.0} of {:.0} minutes settled; left out: {:.0} at rest, {:.0} without a reference, the \
         others turning or just after a turn",
        settled.samples.len(),
        settled.minutes_settled,
        settled.minutes,
        settled.minutes_at_rest,
        settled.minutes_without_reference,
    )
}

fn describe_predictions(check: &PredictionCoverage) -> String {
    let disturbed = match check.watches_disturbed {
        0 => String::new(),
        count => format!(
            "\n{count} more watches lie between a reported change or fault and its detection, and do \
             not count"
        ),
    };
    format!(
        "Predicted before use\n\
         samples inside their 95 % band: {} of {}{}\n\
         watches inside their 95 % band: {} of {}, by chance {} to {}{disturbed}\n\
         {}",
        check.rows_inside,
        check.rows,
        percent(check.rows_inside, check.rows),
        check.watches_inside,
        check.watches,
        check.expected_from,
        check.expected_to,
        verdict(check),
    )
}

/// Returns the meaning of the check in words.
fn verdict(check: &PredictionCoverage) -> String {
    if check.watches < NEEDED_COURSES {
        return "The recording is too short for a conclusion: a watch is one heading, four hours \
                at most, and there are too few."
            .to_owned();
    }
    let scale = match check.widening {
        factor if factor >= 1.05 => format!(" The model's band is widened by {factor:.2}."),
        _ => String::new(),
    };
    let share = if check.falls_short() {
        "Fewer than chance explains: the band as predicted was too narrow."
    } else if check.watches_inside > check.expected_to {
        "More than chance explains: the band as predicted was wider than it need be."
    } else {
        "As many as a right band has."
    };
    share.to_owned() + &scale
}

fn describe_changes(found: &Validation) -> Option<String> {
    let changes = found.changes.iter();
    let lines: Vec<String> = changes
        .map(|change| format!("{}: {}", change.from, words(&change.cause)))
        .collect();
    (!lines.is_empty()).then(|| {
        format!(
            "Changes of the deviation were found; a model from before one does not hold after it\n{}",
            lines.join("\n")
        )
    })
}

/// Names the samples that the parts are of, if they are not all.
fn describe_stretch(found: &Validation) -> Option<String> {
    let stretch = found.stretch;
    let (from, to) = stretch.from.zip(stretch.to)?;
    (stretch.samples < found.used).then(|| {
        format!(
            "The parts below are of {} samples, {from} to {to}: the longest stretch without a change",
            stretch.samples
        )
    })
}

fn describe_part(part: &PartCheck) -> String {
    let title = format!(
        "{}, predicted by a model of the {}",
        capital(&words(&part.predicted)),
        words(&part.model_of)
    );
    match (&part.held_out, &part.refusal) {
        (Some(held_out), _) => format!("{title}\n{}", describe_held_out(held_out)),
        (None, Some(refusal)) => format!("{title}\nnot possible: {refusal}"),
        (None, None) => format!("{title}\nnot possible"),
    }
}

fn describe_held_out(held_out: &HeldOut) -> String {
    let few = if held_out.courses < NEEDED_COURSES {
        " (too few for a conclusion)"
    } else {
        ""
    };
    let rows: Vec<[String; 5]> = held_out
        .sectors
        .iter()
        .map(|sector| {
            [
                format!("{:03}-{:03}", sector.from_deg, sector.to_deg),
                sector.samples.to_string(),
                format!("{:+.2}", sector.mean_deg),
                format!("{:.2}", sector.rms_deg),
                format!("{:.2}", sector.band_deg),
            ]
        })
        .collect();
    format!(
        "courses inside the 95 % band: {} of {}, by chance {} to {}{few}\n\
         measured less predicted deviation of {} samples: mean {:+.2}°, rms {:.2}°; \
         the model's own band is ± {:.2}°\n{}",
        held_out.courses_inside,
        held_out.courses,
        held_out.expected_from,
        held_out.expected_to,
        held_out.samples,
        held_out.mean_deg,
        held_out.rms_deg,
        held_out.band_deg,
        table::render(["heading", "samples", "mean", "rms", "band"], &rows),
    )
}

fn percent(inside: u64, of: u64) -> String {
    if of == 0 {
        return String::new();
    }
    format!(" ({:.1} %)", 100.0 * inside as f64 / of as f64)
}

/// Returns the words of a value that is one word in JSON.
fn words(value: &impl Serialize) -> String {
    let json = serde_json::to_value(value).unwrap_or_default();
    json.as_str().unwrap_or_default().replace('_', " ")
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + letters.as_str()
    })
}
