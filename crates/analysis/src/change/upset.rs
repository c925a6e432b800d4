//! What may have happened to ship, references or field, done to a filter.
//!
//! What always holds: what is upset is known less afterwards, never better, but for what
//! is again as it was known to be before.

use super::bank::Kind;
use super::filter::{Burst, CONSTANT_STATE, Filter, Measurement, Noise, OFFSET, STATES, VARIATION};
use crate::estimate::{OFFSET_SD_DEG, POPULATION_SD};
use binnacle_compass::model::Parameters;
use binnacle_compass::ship::PARAMETERS;

/// Standard deviation of a step in bx and by, in population units (1500 nT), and
/// in what is induced.
const STEP: f64 = 0.8;
const STEP_INDUCED: f64 = 0.3;
/// Of a large one in bx and by, and by how much that is less likely beforehand, nats.
const LARGE: f64 = 6.0;
const LARGE_AGAINST_NATS: f64 = 2.0;
/// Of a step of either reference, degrees, unless the first reading after it is
/// further off.
const REFERENCE_DEG: f64 = 5.0;
/// Of the variation in a storm or over an anomaly, degrees where H is 24 µT, how
/// long it stays the same, and how long it may go on.
const BURST_DEG: f64 = 1.2;
const BURST_MEMORY_S: f64 = 3600.0;
/// A compass that is further astray than this, degrees where H is 24 µT, may go wild.
pub(super) const WILD_DEG: f64 = 3.5;
/// How far a ship that is herself again may differ from what she was, in
/// population units.
const SLACK: f64 = 0.06;

/// What something was before it changed, and may become again.
#[derive(Clone, Copy, Debug)]
pub(super) enum Earlier<'a> {
    Ship(&'a Filter),
    Reference(&'a Filter),
    /// The compass's own zero.
    Zero(&'a Filter),
}

impl Earlier<'_> {
    /// The filter with that as it was.
    pub(super) fn again(self, now: &Filter) -> Filter {
        match self {
            Earlier::Ship(before) => set_back(now, before),
            Earlier::Reference(before) => mended(now, before, &[CONSTANT_STATE, OFFSET]),
            Earlier::Zero(before) => {
                let moved_deg = before.mean[CONSTANT_STATE] - now.mean[CONSTANT_STATE];
                let mut back = now.clone();
                back.mean = turned(now, moved_deg);
                mended(&back, before, &[CONSTANT_STATE])
            }
        }
    }
}

pub(super) const BURST: Burst = Burst {
    variance: BURST_DEG * BURST_DEG,
    memory_s: BURST_MEMORY_S,
};

/// The filter with that having happened just now, by how much not being known.
pub(super) fn upset(now: &Filter, kind: Kind) -> Filter {
    // All else sets in as it goes on: within its memory, not at once.
    match kind {
        Kind::Step => stepped(now, STEP),
        Kind::Large => {
            let mut copy = struck(now);
            copy.log_likelihood -= LARGE_AGAINST_NATS;
            copy
        }
        _ => now.clone(),
    }
}

/// The filter of a ship that may have been struck by far harder than she is as a rule.
pub(super) fn struck(now: &Filter) -> Filter {
    stepped(now, LARGE)
}

fn stepped(now: &Filter, permanent: f64) -> Filter {
    let mut copy = now.clone();
    for j in 0..PARAMETERS {
        let step = if matches!(j, 0 | 2) {
            permanent
        } else {
            STEP_INDUCED
        };
        copy.covariance.add(j, j, step * step);
    }
    copy
}

/// The filter with a reference's step having happened just before `next` was read.
///
/// A gyro's step moves both its difference from the satellite compass and, by half,
/// their mean; the satellite compass's moves them in opposite senses; alone, either is
/// the constant's. The step may be as large as the reading is astray: what is believed
/// to be impossible is never learnt.
pub(super) fn misled(now: &Filter, next: &Measurement, which: Kind) -> Filter {
    let mut copy = now.clone();
    let size = now.astray_deg(next).max(REFERENCE_DEG);
    let constant = if next.difference.is_some() {
        size / 2.0
    } else {
        size
    };
    let sense = if which == Kind::Satellite { -1.0 } else { 1.0 };
    let steps = [
        (CONSTANT_STATE, constant),
        (OFFSET, sense * size / OFFSET_SD_DEG),
    ];
    for (n, (i, a)) in steps.into_iter().enumerate() {
        for (j, b) in &steps[..=n] {
            copy.covariance.add(i, *j, a * b);
        }
    }
    copy
}

/// The filter with the compass's zero having moved so that the constant is about another by
/// `moved_deg`, where rows are to be linearised; how far, is not known but for its size.
pub(super) fn misaligned(now: &Filter, moved_deg: f64, size_deg: f64) -> Filter {
    let mut copy = now.clone();
    copy.mean = turned(now, moved_deg);
    let [less, more] = [-1.0, 1.0].map(|by| turned(now, moved_deg + by));
    let slope: [f64; STATES] = std::array::from_fn(|i| (more[i] - less[i]) / 2.0);
    for i in 0..=CONSTANT_STATE {
        copy.mean[i] -= moved_deg * slope[i];
        for j in 0..=i {
            copy.covariance
                .add(i, j, size_deg * size_deg * slope[i] * slope[j]);
        }
    }
    copy
}

/// What the filter expects with a constant that is more by so much, degrees: the ship's own
/// iron lies as much nearer to the lubber line.
fn turned(now: &Filter, moved_deg: f64) -> [f64; STATES] {
    let own = |j: usize| now.mean[j] * POPULATION_SD[j];
    let turned = Parameters::from_array(std::array::from_fn(own))
        .with_compass_turned(-moved_deg.to_radians())
        .to_array();
    let mut mean = now.mean;
    for j in 0..PARAMETERS {
        mean[j] = turned[j] / POPULATION_SD[j];
    }
    mean[CONSTANT_STATE] += moved_deg;
    mean
}

/// The filter with some of the instruments' lasting errors as `before` had them.
fn mended(now: &Filter, before: &Filter, lasting: &[usize]) -> Filter {
    let mut copy = now.clone();
    for &i in lasting {
        copy.mean[i] = before.mean[i];
        for j in 0..STATES {
            let known = if lasting.contains(&j) {
                before.covariance.at(i, j)
            } else {
                0.0
            };
            copy.covariance.set(i, j, known);
        }
    }
    copy
}

/// The filter with the ship's own parameters as `base` had them.
pub(super) fn set_back(now: &Filter, base: &Filter) -> Filter {
    let mut copy = now.clone();
    copy.mean[..PARAMETERS].copy_from_slice(&base.mean[..PARAMETERS]);
    for i in 0..PARAMETERS {
        for j in 0..STATES {
            let of_the_ship = j < PARAMETERS;
            let known = if of_the_ship {
                base.covariance.at(i, j)
            } else {
                0.0
            };
            copy.covariance.set(i, j, known);
        }
    }
    for j in [0, 2] {
        copy.covariance.add(j, j, SLACK * SLACK);
    }
    copy
}

/// A burst in which the furthest reading was so far astray: a wild one is as large.
pub(super) fn burst_of(astray_deg: f64) -> Burst {
    let deg = if astray_deg > WILD_DEG {
        astray_deg
    } else {
        BURST_DEG
    };
    Burst {
        variance: deg * deg,
        ..BURST
    }
}

/// The filter with the variation as if it had never been astray: what swung wildly is
/// itself again at once.
pub(super) fn calmed(now: &Filter, noise: &Noise) -> Filter {
    let mut copy = now.clone();
    copy.mean[VARIATION] = 0.0;
    for j in 0..STATES {
        copy.covariance.set(VARIATION, j, 0.0);
    }
    copy.covariance.set(VARIATION, VARIATION, noise.variation());
    copy
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Prior;
    use binnacle_compass::result::NoiseLevels;

    #[test]
    fn a_ship_set_back_is_known_as_she_was_and_no_worse() {
        let noise = Noise::new(&NoiseLevels::TYPICAL);
        let mut base = Filter::new(&Prior::population(0.5), &noise);
        for i in 0..STATES {
            for j in 0..=i {
                base.covariance
                    .add(i, j, 0.01 / (1.0 + i.abs_diff(j) as f64));
            }
        }
        let back = set_back(&upset(&base, Kind::Step), &base);
        assert!((back.covariance.at(1, 3) - base.covariance.at(1, 3)).abs() < 1e-12);
        assert!(back.covariance.at(1, CONSTANT_STATE).abs() < 1e-12);
    }
}
