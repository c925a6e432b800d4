//! Stretches of days over which gyro and satellite compass stand apart otherwise than they
//! usually do: by less than shows in one reading, and for too long to be noise.
//!
//! What always holds: the usual difference is that of the days before, not of the many days
//! that a fault may have lasted since; and readings without times are never parted.

use super::check::{difference_deg, median, robust_sd};
use super::reading::HeadingReading;
use binnacle_compass::angle::wrap_180;
use binnacle_compass::time::Timestamp;
use std::ops::Range;

/// What two sound references differ by, variance in degrees².
const SOUND_DEG2: f64 = 2.0 * 0.5 * 0.5;
/// However far two stand apart, it is so unlikely at most, nats: faults are what it is.
const SELDOM_NATS: f64 = 8.0;
/// The first days are those of sound references unless this speaks against it, nats.
const FIRST_NATS: f64 = 3.0;
const FIRST_DAYS: usize = 14;
/// Fewer days with both do not show what is usual.
const NEEDED_DAYS: usize = 4;
/// A day has as many pairs at least.
const NEEDED_OF_A_DAY: usize = 6;
/// Days differ by less where nothing has failed, degrees.
const SAME_DEG: f64 = 1.0;

/// Half of the smallest difference that is looked for, degrees, and what departures beyond
/// it must add up to, as many times the former, in days.
const HALF_DEG: f64 = 1.0;
const DAYS: f64 = 5.0;
/// So large where a day's difference wanders by this standard deviation, degrees, or less;
/// else more, up to so many times as much.
const USUAL_SD_DEG: f64 = 0.45;
const MOST_WANDER: f64 = 1.3;
/// The difference of two days that follow each other, as a part of that: what a gyro wanders
/// it forgets in three days.
const OF_A_DAY: f64 = 0.75;
/// A departure counts for so many times [`HALF_DEG`] at most.
const COUNTED: f64 = 3.0;
/// A reading stands for the time since the one before, but for no more than this, days.
const LONGEST_DAYS: f64 = 0.5 / 24.0;
/// Rounds in which the usual difference is taken from what is not parted.
const ROUNDS: usize = 3;

const DAY_S: f64 = 86_400.0;

/// Gyro and satellite compass, read together.
pub(super) struct Pair {
    /// The reading's place.
    pub(super) index: usize,
    /// Gyro less satellite compass, degrees.
    pub(super) difference_deg: f64,
    time: Timestamp,
    /// How long it stands for.
    days: f64,
}

/// What was found of a ship's pairs.
pub(super) struct Parted {
    /// Stretches of pairs, in order of time.
    pub(super) stretches: Vec<Range<usize>>,
}

/// The pairs of the readings at `places`, which are in order of time; none if any of them has
/// no time.
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

/// Parts pairs; none where too few days have them.
pub(super) fn part(pairs: &[Pair]) -> Option<Parted> {
    let days = days(pairs);
    let mut usual_deg = first_guess(&days)?;
    let mut stretches = Vec::new();
    let scale = (wander_deg(&days)? / USUAL_SD_DEG).clamp(1.0, MOST_WANDER);
    for _ in 0..ROUNDS {
        stretches = parted(pairs, usual_deg, HALF_DEG * scale);
        let off = sound(pairs, &stretches).map(|pair| wrap_180(pair.difference_deg - usual_deg));
        usual_deg = wrap_180(usual_deg + median(off.collect())?);
    }
    Some(Parted { stretches })
}

/// Pairs of no stretch.
fn sound<'a>(pairs: &'a [Pair], stretches: &[Range<usize>]) -> impl Iterator<Item = &'a Pair> {
    let mut is_sound = vec![true; pairs.len()];
    for stretch in stretches {
        is_sound[stretch.clone()].fill(false);
    }
    let all = pairs.iter().zip(is_sound);
    all.filter_map(|(pair, is_sound)| is_sound.then_some(pair))
}

impl Parted {
    /// The pairs of references that stand as usual, in order of time.
    pub(super) fn sound<'a>(&self, pairs: &'a [Pair]) -> impl Iterator<Item = &'a Pair> {
        sound(pairs, &self.stretches)
    }
}

/// The usual difference of a day.
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

/// The difference by which two sound references stand apart: that of the first days, unless
/// another is so much nearer to none, and was there for so many days, that those were wrong.
fn first_guess(days: &[Day]) -> Option<f64> {
    if days.len() < NEEDED_DAYS {
        return None;
    }
    let score = |deg: f64| {
        let near = days.iter().filter(|day| is_near(day.deg, deg)).count();
        let by_size = (deg * deg / (2.0 * SOUND_DEG2)).min(SELDOM_NATS);
        (near.max(1) as f64 / days.len() as f64).ln() - by_size
    };
    let middle = |days: &[Day]| median(days.iter().map(|day| day.deg).collect());
    let first = middle(&days[..days.len().min(FIRST_DAYS)])?;
    let others = days.windows(3).filter_map(middle);
    let others = others.map(|deg| (score(deg), deg));
    let (best, other) = others.max_by(|a, b| a.0.total_cmp(&b.0))?;
    if best < score(first) + FIRST_NATS {
        return Some(first);
    }
    let near = days.iter().map(|day| day.deg);
    median(near.filter(|deg| is_near(*deg, other)).collect())
}

/// Standard deviation of a day's difference beside what is usual, degrees: from how much one
/// differs from the next, in which a fault that lasts has no part.
fn wander_deg(days: &[Day]) -> Option<f64> {
    let steps: Vec<f64> = days
        .windows(2)
        .map(|two| wrap_180(two[1].deg - two[0].deg))
        .collect();
    Some(robust_sd(&steps)? / OF_A_DAY)
}

fn is_near(a: f64, b: f64) -> bool {
    wrap_180(a - b).abs() < SAME_DEG
}

/// Stretches by Page's cumulative sums: since departures to one side last added up to
/// nothing, they have come to far more than `half_deg` a day; and as much the other way since
/// they last did, when it is over.
fn parted(pairs: &[Pair], usual_deg: f64, half_deg: f64) -> Vec<Range<usize>> {
    let most = COUNTED * half_deg;
    let off = |pair: &Pair| wrap_180(pair.difference_deg - usual_deg).clamp(-most, most);
    let enough = half_deg * DAYS;
    let mut stretches = Vec::new();
    let mut from = 0;
    while let Some((begin, side, told)) = [1.0, -1.0]
        .into_iter()
        .filter_map(|side| {
            let beyond = |pair: &Pair| (side * off(pair) - half_deg) * pair.days;
            let (begin, told) = passes(&pairs[from..], beyond, enough)?;
            Some((from + begin, side, from + told))
        })
        .min_by_key(|(_, _, told)| *told)
    {
        let within = |pair: &Pair| (half_deg - side * off(pair)) * pair.days;
        let end = passes(&pairs[told..], within, enough).map_or(pairs.len(), |(end, _)| told + end);
        stretches.push(begin..end);
        from = end;
    }
    stretches
}

/// Where a sum that never falls below nothing first comes to `enough`, and where it last rose
/// from nothing before.
fn passes(pairs: &[Pair], part: impl Fn(&Pair) -> f64, enough: f64) -> Option<(usize, usize)> {
    let (mut sum, mut begin) = (0.0, 0);
    for (place, pair) in pairs.iter().enumerate() {
        sum += part(pair);
        if sum <= 0.0 {
            (sum, begin) = (0.0, place + 1);
        } else if sum > enough {
            return Some((begin, place));
        }
    }
    None
}
