//! Noise levels learnt from the rows so far.

use crate::change::filter::{Filter, NoiseVariances};
use crate::estimate::{Prior, Unknowns};
use crate::fit::fit_roughly;
use crate::observation::Observation;
use binnacle_compass::result::NoiseLevels;
use binnacle_compass::ship::PARAMETERS;

/// Days of data from which the noise levels are learnt again.
const LEARNING_DAYS: [f64; 3] = [10.0, 30.0, 90.0];

/// Noise learnt from some rows.
#[derive(Clone, Copy)]
pub(crate) struct LearntNoise {
    pub(crate) levels: NoiseLevels,
    pub(crate) noise: NoiseVariances,
    pub(crate) unknowns: Unknowns,
    /// Row after the last of them.
    pub(crate) until: usize,
}

impl LearntNoise {
    /// Returns the noise known `before`, or else that of the first days that suffice: a
    /// change within them would be learnt as noise.
    pub(crate) fn first(
        observations: &[Observation],
        prior: &Prior,
        before: Option<&NoiseLevels>,
    ) -> Option<LearntNoise> {
        if let Some(levels) = before {
            return Some(LearntNoise::from_known_levels(levels, prior));
        }
        LEARNING_DAYS.iter().find_map(|days| {
            let until = rows_within(observations, 0, *days);
            LearntNoise::from_rows(observations, 0..until, prior, None)
        })
    }

    fn from_known_levels(levels: &NoiseLevels, prior: &Prior) -> LearntNoise {
        let noise = noise(levels);
        LearntNoise {
            levels: *levels,
            noise,
            unknowns: Filter::new(prior, &noise).unknowns(),
            until: 0,
        }
    }

    /// Learns from `rows`, beginning with the levels learnt before.
    pub(crate) fn from_rows(
        observations: &[Observation],
        rows: std::ops::Range<usize>,
        prior: &Prior,
        before: Option<&NoiseLevels>,
    ) -> Option<LearntNoise> {
        let until = rows.end;
        let rough = fit_roughly(&observations[rows], prior, before)?;
        let noise = noise(&rough.levels);
        let mut mean = [rough.constant_deg; PARAMETERS + 1];
        mean[..PARAMETERS].copy_from_slice(&rough.parameters.to_array());
        let known = Prior {
            mean,
            covariance: prior.covariance,
        };
        Some(LearntNoise {
            levels: rough.levels,
            noise,
            unknowns: Filter::new(&known, &noise).unknowns(),
            until,
        })
    }
}

/// A vessel may drift more than it has yet.
fn noise(levels: &NoiseLevels) -> NoiseVariances {
    NoiseVariances::new(&NoiseLevels {
        drift_nt: levels.drift_nt.max(NoiseLevels::TYPICAL.drift_nt),
        ..*levels
    })
}

/// Next time at which the noise levels are learnt.
#[derive(Clone, Copy)]
pub(crate) struct LearningSchedule {
    /// Row of the learning.
    pub(crate) at: usize,
    /// Days of data used.
    pub(crate) days: f64,
}

impl LearningSchedule {
    /// Returns the next learning after row `k`, from at least so many days since row
    /// `from`; at `usize::MAX` when there is none.
    pub(crate) fn next(
        observations: &[Observation],
        from: usize,
        k: usize,
        days: f64,
    ) -> LearningSchedule {
        let lengths = LEARNING_DAYS.iter().filter(|lengths| **lengths >= days);
        let mut schedules = lengths.map(|&days| LearningSchedule {
            at: rows_within(observations, from, days),
            days,
        });
        schedules
            .find(|next_learning| next_learning.at > k)
            .unwrap_or(LearningSchedule {
                at: usize::MAX,
                days,
            })
    }
}

/// Returns the row after the last within `days` of row `from`.
fn rows_within(observations: &[Observation], from: usize, days: f64) -> usize {
    let start = observations.get(from).and_then(|o| o.time);
    from + observations[from..].partition_point(|o| match (o.time, start) {
        (Some(time), Some(start)) => time.seconds_since(start) <= days * 86_400.0,
        _ => true,
    })
}
