//! Reference drift: stretches of days with an unusual difference between gyro and satellite
//! compass, too small to show in one reading and too long to be noise.
//!
//! The usual difference is that of the days before, not of the many days that a fault may
//! have lasted since. Readings without times have no stretches.

use super::check::difference_deg;
use super::reading::HeadingReading;
use crate::robust_scale::{median, robust_sd};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// Variance of the difference of two sound references, degrees².
const SOUND_DEG2: f64 = 2.0 * 0.5 * 0.5;
/// Greatest log-likelihood ratio against a difference, however large: faults cause it.
const LARGEST_LOG_LIKELIHOOD_RATIO: f64 = 8.0;
/// Log-likelihood ratio from which the first days are not those of sound references.
const FIRST_DAYS_LOG_LIKELIHOOD_RATIO: f64 = 3.0;
const FIRST_DAYS: usize = 14;
/// Least number of days that show the usual difference.
const NEEDED_DAYS: usize = 4;
/// Least number of pairs in a day.
const NEEDED_OF_A_DAY: usize = 6;
/// Difference between days up to which nothing has failed, degrees.
const SAME_DEG: f64 = 1.0;

/// Half of the smallest difference to be found, degrees, and the sum of departures beyond
/// it that shows a stretch, as a multiple of it, in days.
const HALF_DEG: f64 = 1.0;
const THRESHOLD_DAYS: f64 = 5.0;
/// Standard deviation of a day's difference for which that holds, degrees, and the greatest
/// factor for larger ones.
const USUAL_SD_DEG: f64 = 0.45;
const LARGEST_WANDER_FACTOR: f64 = 1.3;
/// Change from day to day, as a part of that standard deviation: a gyro forgets its wander
/// in three days.
const DAY_TO_DAY_SHARE: f64 = 0.75;
/// Greatest departure that counts, as a multiple of [`HALF_DEG`].
const LARGEST_DEPARTURE: f64 = 3.0;
/// Greatest time for which a reading stands, days.
const LONGEST_DAYS: f64 = 0.5 / 24.0;
/// Rounds in which the usual difference is taken from the other readings.
const ROUNDS: usize = 3;

const DAY_S: f64 = 86_400.0;

/// Gyro and satellite compass, read together.
pub(super) struct Pair {
    /// Place of the reading.
    pub(super) index: usize,
    /// Gyro less satellite compass, degrees.
    pub(super) difference_deg: f64,
    time: Timestamp,
    /// Time for which the pair stands.
    days: f64,
}

/// Stretches found among the pairs.
pub(super) struct DriftStretches {
    /// Stretches of pairs, in order of time.
    pub(super) stretches: Vec<Range<usize>>,
}

/// Returns the pairs of the readings at `places`, which are in order of time; none if any
/// of them has no time.
pub(super) fn pairs(
    readings: &[HeadingReading],
    places: impl Iterator<Item = usize>,
) -> Option<Vec<Pair>> {
    let mut before: Option<Timestamp> = None;
    let mut pairs = Vec::new();
    for index in places {
        let reading = &readings[index];
        let time = reading.time?;
        let Some((gyro, satellite)) = reading.gyro.zip(reading.satellite) else {
            continue;
        };
        let days = before.map_or(0.0, |before| time.seconds_since(before) / DAY_S);
        before = Some(time);
        pairs.push(Pair {
            index,
            difference_deg: difference_deg(gyro, satellite),
            time,
            days: days.clamp(0.0, LONGEST_DAYS),
        });
    }
    Some(pairs)
}

/// Finds the stretches; none where too few days have pairs.
pub(super) fn find_stretches(pairs: &[Pair]) -> Option<DriftStretches> {
    let days = days(pairs);
    let mut usual_deg = first_guess(&days)?;
    let mut stretches = Vec::new();
    let scale = (wander_deg(&days)? / USUAL_SD_DEG).clamp(1.0, LARGEST_WANDER_FACTOR);
    for _ in 0..ROUNDS {
        stretches = drifts(pairs, usual_deg, HALF_DEG * scale);
        let off = sound(pairs, &stretches).map(|pair| wrap_180(pair.difference_deg - usual_deg));
        usual_deg = wrap_180(usual_deg + median(off.collect())?);
    }
    Some(DriftStretches { stretches })
}

/// Returns the pairs outside all stretches.
fn sound<'a>(pairs: &'a [Pair], stretches: &[Range<usize>]) -> impl Iterator<Item = &'a Pair> {
    let mut is_sound = vec![true; pairs.len()];
    for stretch in stretches {
        is_sound[stretch.clone()].fill(false);
    }
    let all = pairs.iter().zip(is_sound);
    all.filter_map(|(pair, is_sound)| is_sound.then_some(pair))
}

impl DriftStretches {
    /// Returns the pairs of sound references, in order of time.
    pub(super) fn sound<'a>(&self, pairs: &'a [Pair]) -> impl Iterator<Item = &'a Pair> {
        sound(pairs, &self.stretches)
    }
}

/// Usual difference of a day.
struct Day {
    deg: f64,
}

fn days(pairs: &[Pair]) -> Vec<Day> {
    let number = |pair: &Pair| (pair.time.micros() as f64 / 1e6 / DAY_S).floor() as i64;
    let days = pairs.chunk_by(|a, b| number(a) == number(b));
    days.filter(|day| day.len() >= NEEDED_OF_A_DAY)
        .filter_map(|day| {
            let deg = median(day.iter().map(|pair| pair.difference_deg).collect())?;
            Some(Day { deg })
        })
        .collect()
}

/// Returns the difference of two sound references: that of the first days, unless another
/// is so much smaller and lasted for so many days that the first ones were wrong.
fn first_guess(days: &[Day]) -> Option<f64> {
    if days.len() < NEEDED_DAYS {
        return None;
    }
    let score = |deg: f64| {
        let near = days.iter().filter(|day| is_near(day.deg, deg)).count();
        let by_size = (deg * deg / (2.0 * SOUND_DEG2)).min(LARGEST_LOG_LIKELIHOOD_RATIO);
        (near.max(1) as f64 / days.len() as f64).ln() - by_size
    };
    let middle = |days: &[Day]| median(days.iter().map(|day| day.deg).collect());
    let first = middle(&days[..days.len().min(FIRST_DAYS)])?;
    let others = days.windows(3).filter_map(middle);
    let others = others.map(|deg| (score(deg), deg));
    let (best, other) = others.max_by(|a, b| a.0.total_cmp(&b.0))?;
    if best < score(first) + FIRST_DAYS_LOG_LIKELIHOOD_RATIO {
        return Some(first);
    }
    let near = days.iter().map(|day| day.deg);
    median(near.filter(|deg| is_near(*deg, other)).collect())
}

/// Returns the standard deviation of a day's difference, degrees, from the changes between
/// days, in which a lasting fault has no part.
fn wander_deg(days: &[Day]) -> Option<f64> {
    let steps: Vec<f64> = days
        .windows(2)
        .map(|two| wrap_180(two[1].deg - two[0].deg))
        .collect();
    let middle = median(steps.clone())?;
    Some(robust_sd(steps.into_iter(), middle)? / DAY_TO_DAY_SHARE)
}

fn is_near(a: f64, b: f64) -> bool {
    wrap_180(a - b).abs() < SAME_DEG
}

/// Returns the stretches by Page's cumulative sums. One begins where departures to one
/// side, since their sum was last zero, exceed `half_deg` a day by far; it ends likewise.
fn drifts(pairs: &[Pair], usual_deg: f64, half_deg: f64) -> Vec<Range<usize>> {
    let most = LARGEST_DEPARTURE * half_deg;
    let off = |pair: &Pair| wrap_180(pair.difference_deg - usual_deg).clamp(-most, most);
    let enough = half_deg * THRESHOLD_DAYS;
    let mut stretches = Vec::new();
    let mut from = 0;
    while let Some((begin, side, shown)) = [1.0, -1.0]
        .into_iter()
        .filter_map(|side| {
            let beyond = |pair: &Pair| (side * off(pair) - half_deg) * pair.days;
            let (begin, shown) = crossing(&pairs[from..], beyond, enough)?;
            Some((from + begin, side, from + shown))
        })
        .min_by_key(|(_, _, shown)| *shown)
    {
        let within = |pair: &Pair| (half_deg - side * off(pair)) * pair.days;
        let end =
            crossing(&pairs[shown..], within, enough).map_or(pairs.len(), |(end, _)| shown + end);
        stretches.push(begin..end);
        from = end;
    }
    stretches
}

/// Returns where a sum that never falls below zero first reaches `enough`, and where it
/// last rose from zero.
fn crossing(
    pairs: &[Pair],
    increment: impl Fn(&Pair) -> f64,
    enough: f64,
) -> Option<(usize, usize)> {
    let (mut sum, mut begin) = (0.0, 0);
    for (place, pair) in pairs.iter().enumerate() {
        sum += increment(pair);
        if sum <= 0.0 {
            (sum, begin) = (0.0, place + 1);
        } else if sum > enough {
            return Some((begin, place));
        }
    }
    None
}
