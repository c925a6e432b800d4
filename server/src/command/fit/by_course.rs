//! Fits by the course over ground, for tables without true headings.
//!
//! Current and leeway make its error, which only the tracker estimates: the model is that of the
//! present epoch of an analysis.

use super::FitResult;
use crate::cli::{Fit, Method};
use crate::command::{BadInput, analyse, input};
use binnacle_analysis::advice::sail_next;
use binnacle_analysis::fleet_prior::ShipPrior;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_tracking::Input;

/// Fits a table whose only reference is the course over ground.
pub(super) fn find(arguments: &Fit, table: &input::Table) -> Result<FitResult, BadInput> {
    let refused = |what: String| BadInput(format!("{}: {what}", arguments.file.display()));
    if !matches!(arguments.method, Method::Robust) {
        return Err(refused(
            "there is no true heading, and a course over ground needs --method robust".to_owned(),
        ));
    }
    let samples = analyse::samples(table, arguments.gyro_speed_error)?;
    let analysis = binnacle_tracking::analyse(&Input {
        samples: &samples,
        logbook: &[],
        azimuths: &[],
        prior: &ShipPrior::population(),
        settings: AnalysisSettings::default(),
    });
    let sail_next = sail_next(&analysis);
    let mut notices = analysis.notices.clone();
    let Some(epoch) = analysis.current_epoch() else {
        return Err(refused("there is no sample".to_owned()));
    };
    if let Some(from) = epoch.from {
        notices.push(format!(
            "the compass changed: the model is of the time since {from}"
        ));
    }
    let model = match (&epoch.model, &epoch.refusal) {
        (Some(model), _) => model.clone(),
        (None, Some(refusal)) => return Err(refused(refusal.to_string())),
        (None, None) => return Err(refused("there is no sample with a course".to_owned())),
    };
    Ok(FitResult {
        model,
        check: None,
        sail_next,
        notices,
    })
}
