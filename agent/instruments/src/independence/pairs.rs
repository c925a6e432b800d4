//! Pairs of compass and reference, one by one and as means.
//!
//! A copy of the compass comes late, now more and now less. One by one it is some reading of the
//! last moments, to its digits: where a compass is read once a second or the ship yaws much, that
//! shows. Where it is read often, any of its readings may be the one, and only means show that the
//! two never part. Displays and autopilots damp or average what they repeat: so the means are also
//! of the compass through the filter, whichever it is, by which its last minute comes closest to
//! the reference. An independent instrument differs either way.

use binnacle_analysis::fit::{HeadingPair, SharedNoise, weigh_independence};
use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation, wrap_180, wrap_360};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
use nalgebra::{SMatrix, SVector};
use std::collections::{BTreeMap, VecDeque};

/// Delay of a copy, seconds, within which a reading of the compass may be its original.
const DELAY_S: f64 = 0.6;
/// Least and greatest number of such readings.
const CANDIDATES: std::ops::RangeInclusive<usize> = 2..=12;
/// Readings of the reference in a mean, one a second: a copy's delays cancel out to some hundredths
/// of a degree, while those of a compass and a gyro leave twice as much at least.
const READINGS_OF_MEAN: usize = 20;
/// Readings from one mean to the next. Means that overlap are not counted twice: what counts is
/// the number of headings.
const READINGS_TO_NEXT: usize = 10;
/// Edges of the blocks of the compass's past of which a repeater's filter is made, seconds: within
/// a block all readings have one weight. A damping of 14 s has a fortieth of its weight beyond.
const BLOCK_EDGES_S: [f64; BLOCKS + 1] = [0.0, 1.0, 3.0, 6.0, 11.0, 18.0, 29.0, 47.0, 75.0];
const BLOCKS: usize = 8;
/// Usual weight of a block, and noise of a copy's mean beside it, degrees.
const USUAL_WEIGHT: f64 = 0.3;
const NOISE_OF_MEAN_DEG: f64 = 0.03;
/// Usual change of the deviation between two means on opposite headings, degrees.
const USUAL_DEVIATION_DEG: f64 = 10.0;
/// Time over which the rate of the compass is the mean, and after which it is silent, seconds.
const RATE_OVER_S: f64 = 30.0;
const SILENCE_S: f64 = 2.5;
/// Greatest rate of readings that are kept, Hz.
const MAX_RATE_HZ: f64 = 100.0;
/// Interval of the readings of the reference that count, seconds.
const INTERVAL_S: f64 = 1.0;
/// Longest gap within a mean, seconds: some receivers give the time every few seconds.
const MAX_GAP_S: f64 = 10.0;
/// Differences from which the usual one follows.
const DIFFERENCES: usize = 15;
/// Pairs that are kept of each degree of heading, enough for a decision on one course, and of all.
const PAIRS_OF_SECTOR: usize = 60;
const MAX_PAIRS: usize = 600;
/// Age of the oldest pair, seconds: another device may take the reference's place.
const MAX_AGE_S: f64 = 3_600.0;
/// New means after which all are weighed, before and after a decision.
const FIRST_MEANS: u32 = 5;
const NEXT_MEANS: u32 = 30;

/// Time and place of a reading.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circumstances {
    pub(super) time: Timestamp,
    pub(super) position: Position,
    pub(super) variation: Variation,
}

/// Mean of the compass in each block of its past, less its present reading, degrees.
type Past = [f64; BLOCKS];

/// Latest readings of the compass.
#[derive(Debug, Default)]
pub(super) struct RecentCompass {
    /// Headings without a step at north, the newest last, degrees, and the sum up to each.
    readings_deg: VecDeque<f64>,
    sums_deg: VecDeque<f64>,
    /// Readings since the clock advanced.
    since_advance: usize,
    advanced: Option<Timestamp>,
    /// Readings of late, and the time that they took, seconds.
    lately: (f64, f64),
    silent_s: f64,
}

impl RecentCompass {
    /// Applies the present time.
    pub(super) fn advance(&mut self, now: Timestamp) {
        let passed_s = self.advanced.map(|last| now.seconds_since(last));
        if passed_s.is_some_and(|passed_s| (0.0..INTERVAL_S).contains(&passed_s)) {
            return;
        }
        self.advanced = Some(now);
        let count = std::mem::take(&mut self.since_advance) as f64;
        let passed_s = passed_s.filter(|passed_s| (INTERVAL_S..=MAX_GAP_S).contains(passed_s));
        self.silent_s = match passed_s {
            Some(passed_s) if count <= 0.0 => self.silent_s + passed_s,
            _ => 0.0,
        };
        let Some(passed_s) = passed_s.filter(|_| self.silent_s <= SILENCE_S) else {
            // A compass that is read no more makes no pair.
            *self = RecentCompass {
                advanced: self.advanced,
                ..RecentCompass::default()
            };
            return;
        };
        let kept = (-passed_s / RATE_OVER_S).exp();
        let (readings, took_s) = self.lately;
        self.lately = (readings * kept + count, took_s * kept + passed_s);
    }

    fn rate_hz(&self) -> f64 {
        let (readings, took_s) = self.lately;
        if took_s > 0.0 { readings / took_s } else { 0.0 }
    }

    /// Adds a reading.
    pub(super) fn add(&mut self, compass: CompassHeading) {
        self.since_advance += 1;
        let degrees = self.readings_deg.back().map_or(compass.degrees(), |last| {
            last + wrap_180(compass.degrees() - last)
        });
        self.readings_deg.push_back(degrees);
        self.sums_deg
            .push_back(self.sums_deg.back().unwrap_or(&0.0) + degrees);
        let rate_hz = self.rate_hz().clamp(1.0, MAX_RATE_HZ);
        // Some more, for the rate is not quite steady.
        let kept = (1.2 * rate_hz * BLOCK_EDGES_S[BLOCKS]) as usize + 2;
        let old = self.readings_deg.len().saturating_sub(kept);
        self.readings_deg.drain(..old);
        self.sums_deg.drain(..old);
    }

    /// Returns the readings that a copy may repeat, the latest first.
    fn candidates(&self) -> impl Iterator<Item = CompassHeading> {
        let count =
            ((DELAY_S * self.rate_hz()) as usize).clamp(*CANDIDATES.start(), *CANDIDATES.end());
        let latest = self.readings_deg.iter().rev().take(count);
        latest.filter_map(|degrees| CompassHeading::new(wrap_360(*degrees)))
    }

    /// Returns the past of the compass; none where it is too short.
    fn past(&self) -> Option<Past> {
        let newest = self.readings_deg.len().checked_sub(1)?;
        let rate_hz = Some(self.rate_hz()).filter(|rate_hz| *rate_hz > 0.0)?;
        let place = |edge_s: f64| newest.checked_sub((edge_s * rate_hz) as usize);
        let mut past = Past::default();
        for (block_deg, edges_s) in past.iter_mut().zip(BLOCK_EDGES_S.windows(2)) {
            let to = place(edges_s[0])?;
            let from = place(edges_s[1])?.min(to.checked_sub(1)?);
            let mean_deg = (self.sums_deg[to] - self.sums_deg[from]) / (to - from) as f64;
            *block_deg = mean_deg - self.readings_deg[newest];
        }
        Some(past)
    }
}

/// Pairs of one reference.
#[derive(Debug, Default)]
pub(super) struct ReferencePairs {
    singles: Sectors<Single>,
    means: Means,
    paired: Option<Timestamp>,
    differences_deg: VecDeque<f64>,
    new_means: u32,
}

/// Means of the reference, the compass and its past.
#[derive(Debug, Default)]
struct Means {
    sectors: Sectors<Mean>,
    latest: VecDeque<Mean>,
}

/// A pair, and the past of its compass.
#[derive(Clone, Copy, Debug)]
struct Mean {
    pair: HeadingPair,
    past: Past,
}

/// Reading of the reference with the latest reading of the compass, and with the nearest.
#[derive(Clone, Copy, Debug)]
struct Single {
    latest: HeadingPair,
    nearest: HeadingPair,
    log_choices: f64,
}

impl ReferencePairs {
    /// Adds a reading of the reference.
    pub(super) fn add(
        &mut self,
        reference: TrueHeading,
        compass: &RecentCompass,
        at: Circumstances,
    ) {
        let is_soon = self
            .paired
            .is_some_and(|paired| (0.0..INTERVAL_S).contains(&at.time.seconds_since(paired)));
        let Some(latest) = compass.candidates().next().filter(|_| !is_soon) else {
            return;
        };
        self.paired = Some(at.time);
        let pair = |compass| HeadingPair {
            time: Some(at.time),
            position: Some(at.position),
            compass,
            reference,
            variation: at.variation,
            sog_kn: None,
        };
        let apart = |compass: CompassHeading| wrap_180(reference.degrees() - compass.degrees());
        let usual_deg = self.usual_difference(apart(latest));
        let off = |compass: &CompassHeading| wrap_180(apart(*compass) - usual_deg).abs();
        let nearest = compass
            .candidates()
            .min_by(|a, b| off(a).total_cmp(&off(b)));
        let single = Single {
            latest: pair(latest),
            nearest: pair(nearest.unwrap_or(latest)),
            log_choices: (compass.candidates().count() as f64).ln(),
        };
        self.singles.add(single);
        let Some(past) = compass.past() else {
            return;
        };
        let middle = middle(compass.candidates(), latest);
        let nearer_deg = wrap_180(latest.degrees() - middle.degrees());
        let mean = Mean {
            pair: pair(middle),
            past: past.map(|degrees| degrees + nearer_deg),
        };
        self.new_means += u32::from(self.means.add(mean, at.time));
    }

    /// Returns whether the pairs are to be weighed.
    pub(super) fn is_due(&self, is_decided: bool) -> bool {
        let enough = if is_decided { NEXT_MEANS } else { FIRST_MEANS };
        self.new_means >= enough
    }

    /// Weighs the pairs one by one, and the means; none where there are too few.
    pub(super) fn weigh(&mut self, now: Timestamp) -> Option<Vec<SharedNoise>> {
        self.new_means = 0;
        self.singles.forget(now);
        let mut weighed = self.means.weigh(now)?;
        let latest: Vec<_> = self.singles.all().map(|single| single.latest).collect();
        let nearest: Vec<_> = self.singles.all().map(|single| single.nearest).collect();
        let log_choices: f64 = self.singles.all().map(|single| single.log_choices).sum();
        let mean_log_choices = log_choices / latest.len().max(1) as f64;
        let latest = weigh_independence(&latest)?;
        let single = weigh_independence(&nearest)?.of_choice(latest, mean_log_choices);
        weighed.push(single);
        Some(weighed)
    }

    /// Returns the middle of the latest differences.
    fn usual_difference(&mut self, difference_deg: f64) -> f64 {
        if self.differences_deg.len() == DIFFERENCES {
            self.differences_deg.pop_front();
        }
        self.differences_deg.push_back(difference_deg);
        let apart = |difference: &f64| wrap_180(difference - difference_deg);
        let mut sorted: Vec<f64> = self.differences_deg.iter().map(apart).collect();
        sorted.sort_by(f64::total_cmp);
        difference_deg + sorted[sorted.len() / 2]
    }
}

impl Means {
    /// Adds a pair. Returns whether it makes a mean.
    fn add(&mut self, one: Mean, time: Timestamp) -> bool {
        let last = self.latest.back().and_then(|last| last.pair.time);
        if last.is_some_and(|last| time.seconds_since(last).abs() > MAX_GAP_S) {
            self.latest.clear();
        }
        self.latest.push_back(one);
        if self.latest.len() < READINGS_OF_MEAN {
            return false;
        }
        let mean = mean(&self.latest, one.pair);
        self.latest.drain(..READINGS_TO_NEXT);
        self.sectors.add(mean);
        true
    }

    /// Weighs the means with the compass as it is, and through a filter.
    fn weigh(&mut self, now: Timestamp) -> Option<Vec<SharedNoise>> {
        self.sectors.forget(now);
        let mut means: Vec<Mean> = self.sectors.all().copied().collect();
        means.sort_by_key(|mean| mean.pair.time);
        let pairs: Vec<_> = means.iter().map(|mean| mean.pair).collect();
        let mut weighed = vec![weigh_independence(&pairs)?];
        // Through a filter the compass may hardly turn: then it proves nothing.
        let filtered = filtered(&means);
        weighed.extend(filtered.and_then(|pairs| weigh_independence(&pairs)));
        Some(weighed)
    }
}

/// Number of unknowns of a filter: weights of its blocks, and the change of a deviation.
const UNKNOWNS: usize = BLOCKS + 4;

/// Returns the pairs with the compass through the filter that comes closest to the reference.
///
/// Its weights are found by least squares of the changes from mean to mean, beside those of a
/// deviation of four coefficients, each with a prior of its usual size.
fn filtered(means: &[Mean]) -> Option<Vec<HeadingPair>> {
    let mut usual = SVector::<f64, UNKNOWNS>::repeat(USUAL_DEVIATION_DEG);
    usual.rows_mut(0, BLOCKS).fill(USUAL_WEIGHT);
    let prior = usual.map(|usual| (NOISE_OF_MEAN_DEG / usual).powi(2));
    let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_diagonal(&prior);
    let mut right = SVector::<f64, UNKNOWNS>::zeros();
    for two in means.windows(2) {
        let column = columns(&two[1]) - columns(&two[0]);
        let difference = |mean: &Mean| {
            let compass_deg = mean.pair.compass.degrees() + mean.pair.variation.degrees_east();
            mean.pair.reference.degrees() - compass_deg
        };
        let change_deg = wrap_180(difference(&two[1]) - difference(&two[0]));
        normal += column * column.transpose();
        right += column * change_deg;
    }
    let weights = normal.cholesky()?.solve(&right);
    let filter = |mean: &Mean| {
        let off_deg: f64 = weights
            .iter()
            .zip(mean.past)
            .map(|(w, past)| w * past)
            .sum();
        let degrees = wrap_360(mean.pair.compass.degrees() + off_deg);
        let compass = CompassHeading::new(degrees).unwrap_or(mean.pair.compass);
        HeadingPair {
            compass,
            ..mean.pair
        }
    };
    Some(means.iter().map(filter).collect())
}

/// Returns the columns of a mean: the past of its compass, and a deviation on its heading.
fn columns(mean: &Mean) -> SVector<f64, UNKNOWNS> {
    let (sin, cos) = mean.pair.compass.radians().sin_cos();
    let deviation = [sin, cos, 2.0 * sin * cos, cos * cos - sin * sin];
    SVector::from_iterator(mean.past.into_iter().chain(deviation))
}

/// Returns the means of compass and reference, about one of the pairs.
fn mean(all: &VecDeque<Mean>, about: HeadingPair) -> Mean {
    let count = all.len() as f64;
    let mean_of = |heading: fn(&HeadingPair) -> f64| {
        let offs = all
            .iter()
            .map(|one| wrap_180(heading(&one.pair) - heading(&about)));
        heading(&about) + offs.sum::<f64>() / count
    };
    let compass = CompassHeading::new(mean_of(|pair| pair.compass.degrees()));
    let reference = TrueHeading::new(mean_of(|pair| pair.reference.degrees()));
    let past = |block: usize| all.iter().map(|one| one.past[block]).sum::<f64>() / count;
    Mean {
        pair: HeadingPair {
            compass: compass.unwrap_or(about.compass),
            reference: reference.unwrap_or(about.reference),
            ..about
        },
        past: std::array::from_fn(past),
    }
}

/// Returns the mean of readings about one of them.
fn middle(readings: impl Iterator<Item = CompassHeading>, about: CompassHeading) -> CompassHeading {
    let (sum, count) = readings.fold((0.0, 0.0), |(sum, count), reading| {
        let off = wrap_180(reading.degrees() - about.degrees());
        (sum + off, count + 1.0)
    });
    let mean = wrap_360(about.degrees() + if count > 0.0 { sum / count } else { 0.0 });
    CompassHeading::new(mean).unwrap_or(about)
}

/// Pairs by degree of compass heading, so that a steady course does not displace the others.
#[derive(Debug)]
struct Sectors<T>(BTreeMap<i64, VecDeque<T>>);

impl<T> Default for Sectors<T> {
    fn default() -> Sectors<T> {
        Sectors(BTreeMap::new())
    }
}

trait Paired {
    fn pair(&self) -> &HeadingPair;
}

impl Paired for Single {
    fn pair(&self) -> &HeadingPair {
        &self.latest
    }
}

impl Paired for Mean {
    fn pair(&self) -> &HeadingPair {
        &self.pair
    }
}

impl<T: Paired> Sectors<T> {
    fn add(&mut self, item: T) {
        let sector = item.pair().compass.degrees() as i64;
        let items = self.0.entry(sector).or_default();
        if items.len() == PAIRS_OF_SECTOR {
            items.pop_front();
        }
        items.push_back(item);
    }

    fn all(&self) -> impl Iterator<Item = &T> {
        self.0.values().flatten()
    }

    /// Forgets what is old, and the oldest where there is too much.
    fn forget(&mut self, now: Timestamp) {
        let age_s = |item: &T| {
            let time = item.pair().time;
            time.map_or(f64::INFINITY, |time| now.seconds_since(time))
        };
        let mut ages: Vec<f64> = self.all().map(age_s).collect();
        ages.sort_by(f64::total_cmp);
        let oldest_s = ages
            .get(MAX_PAIRS)
            .map_or(MAX_AGE_S, |age_s| age_s.min(MAX_AGE_S));
        for items in self.0.values_mut() {
            items.retain(|item| age_s(item) <= oldest_s);
        }
        self.0.retain(|_, items| !items.is_empty());
    }
}
