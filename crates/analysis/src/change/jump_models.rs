//! Jump models: changes of vessel, references or field applied to a filter.
//!
//! A jump never reduces uncertainty, except where an earlier state is restored.

use super::filter::{
    CONSTANT_STATE, Filter, Measurement, NoiseVariances, OFFSET, STATES, TransientNoise, VARIATION,
};
use super::hypothesis_kind::HypothesisKind;
use crate::change::priors;
use crate::change::thresholds::SEVERE_TRANSIENT_DEG;
use crate::estimate::{OFFSET_SD_DEG, POPULATION_SD};
use binnacle_compass::model::Parameters;
use binnacle_compass::ship::PARAMETERS;

/// A state before a change that may be restored.
#[derive(Clone, Copy, Debug)]
pub(crate) enum EarlierState<'a> {
    Vessel(&'a Filter),
    Reference(&'a Filter),
    /// The alignment of the compass.
    Alignment(&'a Filter),
}

impl EarlierState<'_> {
    /// Returns the filter with that part restored.
    pub(crate) fn restore(self, now: &Filter) -> Filter {
        match self {
            EarlierState::Vessel(before) => restore_vessel(now, before),
            EarlierState::Reference(before) => {
                restore_instruments(now, before, &[CONSTANT_STATE, OFFSET])
            }
            EarlierState::Alignment(before) => {
                let moved_deg = before.mean[CONSTANT_STATE] - now.mean[CONSTANT_STATE];
                let mut back = now.clone();
                back.mean = mean_of_turned_compass(now, moved_deg);
                restore_instruments(&back, before, &[CONSTANT_STATE])
            }
        }
    }
}

pub(crate) const USUAL_TRANSIENT: TransientNoise = TransientNoise {
    variance: priors::TRANSIENT_SD_DEG * priors::TRANSIENT_SD_DEG,
    memory_s: priors::TRANSIENT_CORRELATION_S,
};

/// Returns the filter after a jump of unknown size at this time.
pub(crate) fn apply_jump(now: &Filter, kind: HypothesisKind) -> Filter {
    // Other kinds set in within their correlation time, not at once.
    match kind {
        HypothesisKind::Step => apply_step(now, priors::STEP_SD),
        HypothesisKind::LargeStep => {
            let mut jumped = apply_large_step(now);
            jumped.log_likelihood -= priors::AGAINST_LARGE_STEP_LOG_ODDS;
            jumped
        }
        _ => now.clone(),
    }
}

/// Returns the filter after a large step of unknown size.
pub(crate) fn apply_large_step(now: &Filter) -> Filter {
    apply_step(now, priors::LARGE_STEP_SD)
}

fn apply_step(now: &Filter, permanent_sd: f64) -> Filter {
    let mut jumped = now.clone();
    for j in 0..PARAMETERS {
        let step = if matches!(j, 0 | 2) {
            permanent_sd
        } else {
            priors::INDUCED_STEP_SD
        };
        jumped.covariance.add(j, j, step * step);
    }
    jumped
}

/// Returns the filter after a reference's step just before `next` was read.
///
/// A gyro's step moves its difference from the satellite compass and, by half, their mean.
/// The satellite compass's step moves the two in opposite directions. A lone reference's
/// step moves the constant. The step may be as large as the innovation: a filter never
/// learns what it holds to be impossible.
pub(crate) fn apply_reference_step(
    now: &Filter,
    next: &Measurement,
    which: HypothesisKind,
) -> Filter {
    let mut jumped = now.clone();
    let size = now.innovation_deg(next).max(priors::REFERENCE_STEP_SD_DEG);
    let constant = if next.difference.is_some() {
        size / 2.0
    } else {
        size
    };
    let sign = if which == HypothesisKind::SatelliteStep {
        -1.0
    } else {
        1.0
    };
    let steps = [
        (CONSTANT_STATE, constant),
        (OFFSET, sign * size / OFFSET_SD_DEG),
    ];
    for (n, (i, a)) in steps.into_iter().enumerate() {
        for (j, b) in &steps[..=n] {
            jumped.covariance.add(i, *j, a * b);
        }
    }
    jumped
}

/// Returns the filter after an alignment change of about `moved_deg`, where rows are
/// linearised; its size is unknown within `size_deg`.
pub(crate) fn apply_alignment_step(now: &Filter, moved_deg: f64, size_deg: f64) -> Filter {
    let mut jumped = now.clone();
    jumped.mean = mean_of_turned_compass(now, moved_deg);
    let [less, more] = [-1.0, 1.0].map(|by| mean_of_turned_compass(now, moved_deg + by));
    let slope: [f64; STATES] = std::array::from_fn(|i| (more[i] - less[i]) / 2.0);
    for i in 0..=CONSTANT_STATE {
        jumped.mean[i] -= moved_deg * slope[i];
        for j in 0..=i {
            jumped
                .covariance
                .add(i, j, size_deg * size_deg * slope[i] * slope[j]);
        }
    }
    jumped
}

/// Returns the filter's mean for a constant that is larger by `moved_deg`: the vessel's own
/// iron turns by as much relative to the lubber line.
fn mean_of_turned_compass(now: &Filter, moved_deg: f64) -> [f64; STATES] {
    let own = |j: usize| now.mean[j] * POPULATION_SD[j];
    let mean_of_turned_compass = Parameters::from_array(std::array::from_fn(own))
        .with_compass_turned(-moved_deg.to_radians())
        .to_array();
    let mut mean = now.mean;
    for j in 0..PARAMETERS {
        mean[j] = mean_of_turned_compass[j] / POPULATION_SD[j];
    }
    mean[CONSTANT_STATE] += moved_deg;
    mean
}

/// Returns the filter with some of the instruments' lasting errors as in `before`.
fn restore_instruments(now: &Filter, before: &Filter, lasting: &[usize]) -> Filter {
    let mut jumped = now.clone();
    for &i in lasting {
        jumped.mean[i] = before.mean[i];
        for j in 0..STATES {
            let known = if lasting.contains(&j) {
                before.covariance.at(i, j)
            } else {
                0.0
            };
            jumped.covariance.set(i, j, known);
        }
    }
    jumped
}

/// Returns the filter with the vessel's parameters as in `base`.
pub(crate) fn restore_vessel(now: &Filter, base: &Filter) -> Filter {
    let mut jumped = now.clone();
    jumped.mean[..PARAMETERS].copy_from_slice(&base.mean[..PARAMETERS]);
    for i in 0..PARAMETERS {
        for j in 0..STATES {
            let of_the_ship = j < PARAMETERS;
            let known = if of_the_ship {
                base.covariance.at(i, j)
            } else {
                0.0
            };
            jumped.covariance.set(i, j, known);
        }
    }
    for j in [0, 2] {
        jumped
            .covariance
            .add(j, j, priors::RETURN_SD * priors::RETURN_SD);
    }
    jumped
}

/// Returns the noise of a transient with this greatest innovation: a severe one is as
/// large.
pub(crate) fn transient_noise(disturbance_deg: f64) -> TransientNoise {
    let deg = if disturbance_deg > SEVERE_TRANSIENT_DEG {
        disturbance_deg
    } else {
        priors::TRANSIENT_SD_DEG
    };
    TransientNoise {
        variance: deg * deg,
        ..USUAL_TRANSIENT
    }
}

/// Returns the filter with the variation's error at its usual level: a severe disturbance
/// ends at once.
pub(crate) fn reset_variation(now: &Filter, noise: &NoiseVariances) -> Filter {
    let mut jumped = now.clone();
    jumped.mean[VARIATION] = 0.0;
    for j in 0..STATES {
        jumped.covariance.set(VARIATION, j, 0.0);
    }
    jumped
        .covariance
        .set(VARIATION, VARIATION, noise.variation());
    jumped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Prior;
    use binnacle_compass::result::NoiseLevels;

    #[test]
    fn a_ship_set_back_is_known_as_she_was_and_no_worse() {
        let noise = NoiseVariances::new(&NoiseLevels::TYPICAL);
        let mut base = Filter::new(&Prior::population(0.5), &noise);
        for i in 0..STATES {
            for j in 0..=i {
                base.covariance
                    .add(i, j, 0.01 / (1.0 + i.abs_diff(j) as f64));
            }
        }
        let back = restore_vessel(&apply_jump(&base, HypothesisKind::Step), &base);
        assert!((back.covariance.at(1, 3) - base.covariance.at(1, 3)).abs() < 1e-12);
        assert!(back.covariance.at(1, CONSTANT_STATE).abs() < 1e-12);
    }
}
