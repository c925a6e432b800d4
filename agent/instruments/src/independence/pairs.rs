//! Pairs of compass and reference, one by one and as means.
//!
//! A copy of the compass comes late, now more and now less. One by one it is some reading of the
//! last moments, to its digits: where a compass is read once a second or the ship yaws much, that
//! shows. Where it is read often, any of its readings may be the one, and only means show that the
//! two never part. Displays and autopilots damp or average what they repeat: so the means are also of
//! the compass smoothed. An independent instrument differs either way.

use binnacle_analysis::fit::{HeadingPair, SharedNoise, weigh_independence};
use binnacle_compass::angle::{CompassHeading, TrueHeading, Variation, wrap_180, wrap_360};
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;
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
/// Time constants by which a repeater may damp the compass, seconds, in steps. Between two of them it
/// is a mix of both, very nearly.
const DAMPING_S: [f64; DAMPINGS] = [2.0, 3.0, 4.5, 6.5, 9.5, 12.0, 15.0];
const DAMPINGS: usize = 7;
/// Times over which it may average, seconds, likewise.
const AVERAGE_S: [f64; AVERAGES] = [3.0, 4.0, 5.0, 6.5, 8.0, 10.0, 12.5, 16.0, 20.0];
const AVERAGES: usize = 9;
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

/// Latest readings of the compass.
#[derive(Debug, Default)]
pub(super) struct RecentCompass {
    readings: VecDeque<CompassHeading>,
    /// Readings of the longest average, without a step at north, the newest last, degrees.
    averaged_deg: VecDeque<f64>,
    /// Readings since the clock advanced, and a second before.
    since_advance: usize,
    rate_hz: f64,
    advanced: Option<Timestamp>,
    /// Compass as each time constant damps it, degrees.
    damped_deg: Option<[f64; DAMPINGS]>,
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
        self.rate_hz = passed_s.map_or(0.0, |passed_s| count / passed_s);
        // A compass that is read no more makes no pair.
        if self.rate_hz <= 0.0 {
            self.readings.clear();
            self.averaged_deg.clear();
            self.damped_deg = None;
        }
    }

    /// Adds a reading.
    pub(super) fn add(&mut self, compass: CompassHeading) {
        self.since_advance += 1;
        if self.readings.len() == *CANDIDATES.end() {
            self.readings.pop_front();
        }
        self.readings.push_back(compass);
        self.damp(compass.degrees());
        let last = self.averaged_deg.back().copied();
        let step = last.map(|last| last + wrap_180(compass.degrees() - last));
        self.averaged_deg
            .push_back(step.unwrap_or(compass.degrees()));
        let kept = self.readings_in(AVERAGE_S[AVERAGES - 1]);
        let old = self.averaged_deg.len().saturating_sub(kept);
        self.averaged_deg.drain(..old);
    }

    fn damp(&mut self, compass_deg: f64) {
        let known = self.damped_deg.filter(|_| self.rate_hz > 0.0);
        let mut damped_deg = known.unwrap_or([compass_deg; DAMPINGS]);
        for (damped, constant_s) in damped_deg.iter_mut().zip(DAMPING_S) {
            let share = -(-1.0 / (self.rate_hz * constant_s)).exp_m1();
            *damped += share.min(1.0) * wrap_180(compass_deg - *damped);
        }
        self.damped_deg = Some(damped_deg);
    }

    /// Returns the number of readings in a time.
    fn readings_in(&self, seconds: f64) -> usize {
        ((self.rate_hz * seconds).round() as usize).max(1)
    }

    /// Returns how far the compass is from a heading once it is smoothed, degrees.
    fn smoothed_off(&self, heading: CompassHeading) -> Option<SmoothedOff> {
        let off = |degrees: f64| wrap_180(degrees - heading.degrees());
        let mean = |seconds: f64| {
            let count = self.readings_in(seconds).min(self.averaged_deg.len());
            let sum: f64 = self.averaged_deg.iter().rev().take(count).sum();
            sum / count as f64
        };
        let averaged = (!self.averaged_deg.is_empty()).then(|| AVERAGE_S.map(mean))?;
        Some(SmoothedOff {
            damped_deg: self.damped_deg?.map(off),
            averaged_deg: averaged.map(off),
        })
    }

    /// Returns the readings that a copy may repeat, the latest first.
    fn candidates(&self) -> impl Iterator<Item = CompassHeading> {
        let count =
            ((DELAY_S * self.rate_hz) as usize).clamp(*CANDIDATES.start(), *CANDIDATES.end());
        self.readings.iter().rev().take(count).copied()
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

/// Means of the reference and of the compass, as it is and smoothed.
#[derive(Debug, Default)]
struct Means {
    sectors: Sectors<Smoothed>,
    latest: VecDeque<Smoothed>,
}

/// A pair, and how far the compass is from its own reading once it is smoothed.
#[derive(Clone, Copy, Debug)]
struct Smoothed {
    pair: HeadingPair,
    off: SmoothedOff,
}

/// Differences of the compass, damped and averaged, from its own reading.
#[derive(Clone, Copy, Debug)]
struct SmoothedOff {
    damped_deg: [f64; DAMPINGS],
    averaged_deg: [f64; AVERAGES],
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
        let middle = middle(compass.candidates(), latest);
        let Some(off) = compass.smoothed_off(middle) else {
            return;
        };
        let pair = pair(middle);
        self.new_means += u32::from(self.means.add(Smoothed { pair, off }, at.time));
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
    fn add(&mut self, one: Smoothed, time: Timestamp) -> bool {
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

    /// Weighs the means with the compass as it is, and as it is between each two steps of smoothing.
    fn weigh(&mut self, now: Timestamp) -> Option<Vec<SharedNoise>> {
        self.sectors.forget(now);
        let mut means: Vec<Smoothed> = self.sectors.all().copied().collect();
        means.sort_by_key(|mean| mean.pair.time);
        let pairs: Vec<_> = means.iter().map(|mean| mean.pair).collect();
        let mut weighed = vec![weigh_independence(&pairs)?];
        let none = |_: &Smoothed| 0.0;
        let mut mix = |less: &Smoothing<'_>, more: &Smoothing<'_>| {
            // A smoothed compass may hardly turn: then it proves nothing.
            weighed.extend(weigh_independence(&mixed(&means, less, more)));
        };
        mix(&none, &|mean| mean.off.damped_deg[0]);
        for step in 1..DAMPINGS {
            mix(&|mean| mean.off.damped_deg[step - 1], &|mean| {
                mean.off.damped_deg[step]
            });
        }
        mix(&none, &|mean| mean.off.averaged_deg[0]);
        for step in 1..AVERAGES {
            mix(&|mean| mean.off.averaged_deg[step - 1], &|mean| {
                mean.off.averaged_deg[step]
            });
        }
        Some(weighed)
    }
}

/// Difference of a smoothed compass from its own reading, degrees.
type Smoothing<'a> = dyn Fn(&Smoothed) -> f64 + 'a;

/// Returns pairs with the mix of the compass between two steps of smoothing that the reference
/// follows best.
fn mixed(means: &[Smoothed], less: &Smoothing<'_>, more: &Smoothing<'_>) -> Vec<HeadingPair> {
    let (mut product, mut square) = (0.0, 0.0);
    for two in means.windows(2) {
        let change = |value: &Smoothing<'_>| wrap_180(value(&two[1]) - value(&two[0]));
        let smoother = change(&|mean| more(mean) - less(mean));
        let apart = change(&|mean| {
            let compass_deg = mean.pair.compass.degrees() + less(mean);
            mean.pair.reference.degrees() - compass_deg
        });
        product += smoother * apart;
        square += smoother * smoother;
    }
    let share = if square > 0.0 {
        (product / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mix = |mean: &Smoothed| {
        let off_deg = less(mean) * (1.0 - share) + more(mean) * share;
        let compass = CompassHeading::new(mean.pair.compass.degrees() + off_deg);
        HeadingPair {
            compass: compass.unwrap_or(mean.pair.compass),
            ..mean.pair
        }
    };
    means.iter().map(mix).collect()
}

/// Returns the means of compass and reference, about one of the pairs.
fn mean(all: &VecDeque<Smoothed>, about: HeadingPair) -> Smoothed {
    let count = all.len() as f64;
    let mean_of = |heading: fn(&HeadingPair) -> f64| {
        let offs = all
            .iter()
            .map(|one| wrap_180(heading(&one.pair) - heading(&about)));
        heading(&about) + offs.sum::<f64>() / count
    };
    let compass = CompassHeading::new(mean_of(|pair| pair.compass.degrees()));
    let reference = TrueHeading::new(mean_of(|pair| pair.reference.degrees()));
    let mean = |value: &Smoothing<'_>| all.iter().map(value).sum::<f64>() / count;
    Smoothed {
        pair: HeadingPair {
            compass: compass.unwrap_or(about.compass),
            reference: reference.unwrap_or(about.reference),
            ..about
        },
        off: SmoothedOff {
            damped_deg: std::array::from_fn(|step| mean(&|one| one.off.damped_deg[step])),
            averaged_deg: std::array::from_fn(|step| mean(&|one| one.off.averaged_deg[step])),
        },
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

impl Paired for Smoothed {
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
