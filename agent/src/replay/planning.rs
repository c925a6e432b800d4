//! Plan of several recordings that are read as one: they are surveyed first, and one helps with
//! the times of another.

use anyhow::Context;
use binnacle_compass::time::Timestamp;
use binnacle_nmea::recording::DateOrder;
use binnacle_observation::recording::{Instruments, LoggerClock, Plan, Survey};
use std::path::{Path, PathBuf};

/// Difference between the errors of clocks that are one logger's.
const SAME_LOGGER_MICROS: u64 = 60_000_000;

/// A recording that is going to be read.
#[derive(Clone, Debug)]
pub(super) struct Planned {
    pub(super) path: PathBuf,
    pub(super) plan: Plan,
    /// First time, corrected.
    pub(super) start: Option<Timestamp>,
    /// Set if a logger gave its lines their times.
    pub(super) is_stamped: bool,
    pub(super) instruments: Instruments,
}

/// Surveys recordings and returns them in the order of their first times.
///
/// # Errors
/// Fails when a file cannot be read.
pub(super) fn plan(files: &[PathBuf], roll_overs: i64) -> anyhow::Result<Vec<Planned>> {
    let survey =
        |file: &Path, near| Survey::of(file, near).with_context(|| file.display().to_string());
    let mut surveys = Vec::with_capacity(files.len());
    for file in files {
        surveys.push(survey(file, None)?);
    }
    let common = Common::of(&surveys);
    for (file, found) in files.iter().zip(&mut surveys) {
        // A time of day alone says nothing without the date of another recording.
        if found.first.is_none() && common.near.is_some() {
            *found = survey(file, common.near)?;
        }
    }
    let planned = files.iter().zip(&surveys);
    let mut planned: Vec<Planned> = planned
        .map(|(path, survey)| common.planned(path, survey, roll_overs))
        .collect();
    planned.sort_by(|one, other| {
        let key = |recording: &Planned| (recording.start, recording.instruments);
        key(one)
            .cmp(&key(other))
            .then_with(|| one.path.cmp(&other.path))
    });
    Ok(planned)
}

/// Findings that hold for recordings which do not show them themselves.
struct Common {
    order: DateOrder,
    logger_ahead_micros: i64,
    near: Option<Timestamp>,
}

impl Common {
    fn of(surveys: &[Survey]) -> Common {
        let errors: Vec<i64> = surveys
            .iter()
            .filter_map(|survey| match survey.clock {
                LoggerClock::Unknown => None,
                LoggerClock::Agrees => Some(0),
                LoggerClock::Ahead(micros) => Some(micros),
            })
            .collect();
        let first_error = errors.first().copied().unwrap_or_default();
        let is_one_logger = errors
            .iter()
            .all(|error| error.abs_diff(first_error) < SAME_LOGGER_MICROS);
        Common {
            order: surveys
                .iter()
                .find_map(|survey| survey.order)
                .unwrap_or_default(),
            logger_ahead_micros: if is_one_logger { first_error } else { 0 },
            near: surveys.iter().find_map(|survey| survey.first),
        }
    }

    fn planned(&self, path: &Path, survey: &Survey, roll_overs: i64) -> Planned {
        let mut plan = Plan {
            roll_overs,
            order: survey.order.unwrap_or(self.order),
            ..survey.plan()
        };
        if survey.clock == LoggerClock::Unknown {
            plan.logger_ahead_micros = self.logger_ahead_micros;
        }
        plan.near = survey.first.or(self.near);
        let error_s = if survey.is_stamped {
            plan.logger_ahead_micros as f64 / 1e6
        } else {
            0.0
        };
        Planned {
            path: path.to_owned(),
            plan,
            start: survey.first.map(|first| first.plus_seconds(-error_s)),
            is_stamped: survey.is_stamped,
            instruments: survey.instruments,
        }
    }
}
