//! Shared noise by the means of courses.
//!
//! On each course anew an independent pair has an error of its own: the card sticks at another
//! place, the deviation is another, slow errors have moved on. Noise that was added to a copy,
//! its delay, its smoothing and the dither of its digits average out on a course, and nothing
//! is left. Only a copy of the reading as it is shows it so: one that was corrected by a card
//! is weighed by its rows.

use super::likelihood::{COPY_DEG, independent_levels_deg, log_density};
use super::pair::HeadingPair;
use super::{SECTOR_DEG, SharedNoise, digits};
use binnacle_compass::angle::wrap_180;
use std::collections::BTreeSet;

/// Change of heading that ends a course, degrees, and longest gap and length of one, seconds.
const TURN_DEG: f64 = 7.5;
const GAP_S: f64 = 3600.0;
const COURSE_S: f64 = 4.0 * 3600.0;
/// Least length of a course of several rows, seconds: shorter ones are parts of a turn.
const LEAST_S: f64 = 300.0;
/// Delays of a copy that are tried, seconds: half of the length of its smoothing is one.
const DELAYS_S: [f64; 5] = [0.0, 1.0, 2.0, 5.0, 10.0];

/// Least scatter of headings on a course, as a part of the digits, for rounding errors to
/// average out: of a Gaussian of that size 4 % of a digit are left (Bennett 1948, dither).
const DITHER: f64 = 1.0 / 3.0;

/// Batches of a course whose means show the variance of its mean (batch means: Law & Kelton,
/// Simulation Modeling and Analysis, chapter 9): few, for errors of many rows.
const BATCHES: usize = 6;

/// Mean difference of reference and compass on a course.
struct CourseMean {
    compass_deg: f64,
    difference_deg: f64,
    /// Mean rate of turn, degrees a second.
    rate_deg_s: f64,
    rows: f64,
}

impl CourseMean {
    /// Returns the difference of compass and a reference without its delay.
    fn without_delay_deg(&self, delay_s: f64) -> f64 {
        self.difference_deg + delay_s * self.rate_deg_s
    }
}

/// Weighs shared against independent noise by the courses of pairs in order of time; none where
/// no course has several pairs, or where their headings move too little for the digits.
pub(super) fn weigh_courses(sorted: &[HeadingPair]) -> Option<SharedNoise> {
    let digits = digits(sorted);
    let courses = courses(sorted);
    let means: Vec<CourseMean> = courses.iter().filter_map(|course| mean(course)).collect();
    let heading_variance = variance_within(&courses, HeadingPair::compass_deg, usize::MAX)?;
    if heading_variance.sqrt() < DITHER * digits.compass_deg.max(digits.reference_deg) {
        return None;
    }
    let row_variance = variance_within(&courses, HeadingPair::difference_deg, BATCHES)?;
    let constants_deg = [0.0, middle_deg(&means)?];
    let best = |course_deg: f64, delays_s: &[f64]| {
        let tried = delays_s
            .iter()
            .flat_map(|&delay_s| constants_deg.map(|constant_deg| (delay_s, constant_deg)));
        let logs = tried.map(|(delay_s, constant_deg)| {
            let logs = means.iter().map(|mean| {
                let off_deg = wrap_180(mean.without_delay_deg(delay_s) - constant_deg);
                log_density(
                    off_deg,
                    (course_deg.powi(2) + row_variance / mean.rows).sqrt(),
                )
            });
            logs.sum::<f64>() / means.len() as f64
        });
        logs.fold(f64::NEG_INFINITY, f64::max)
    };
    let independent = independent_levels_deg().map(|level_deg| best(level_deg, &[0.0]));
    let sectors: BTreeSet<i64> = means
        .iter()
        .map(|mean| (mean.compass_deg / SECTOR_DEG) as i64)
        .collect();
    let choices = (constants_deg.len() * DELAYS_S.len()) as f64;
    let squares = means
        .iter()
        .map(|mean| wrap_180(mean.difference_deg - constants_deg[1]).powi(2));
    let of_rows = means.iter().map(|mean| row_variance / mean.rows);
    let least_variance =
        independent_levels_deg().next()?.powi(2) + of_rows.sum::<f64>() / means.len() as f64;
    Some(SharedNoise {
        shared: best(COPY_DEG, &DELAYS_S) - choices.ln() / means.len() as f64,
        independent: independent.fold(f64::NEG_INFINITY, f64::max),
        sectors: sectors.len() as f64,
        scatter_deg: (squares.sum::<f64>() / means.len() as f64).sqrt(),
        least_deg: least_variance.sqrt(),
    })
}

/// Returns the middle difference of courses; none without any.
fn middle_deg(means: &[CourseMean]) -> Option<f64> {
    let about = means.first()?.difference_deg;
    let mut offs: Vec<f64> = means
        .iter()
        .map(|mean| wrap_180(mean.difference_deg - about))
        .collect();
    offs.sort_by(f64::total_cmp);
    Some(wrap_180(about + offs[offs.len() / 2]))
}

/// Splits pairs in order of time into courses.
fn courses(sorted: &[HeadingPair]) -> Vec<&[HeadingPair]> {
    let mut courses = Vec::new();
    let mut begin = 0;
    for end in 1..=sorted.len() {
        let is_over = sorted.get(end).is_none_or(|next| {
            let turned = wrap_180(next.compass_deg() - sorted[begin].compass_deg());
            let since = |pair: &HeadingPair| match (pair.time, next.time) {
                (Some(then), Some(now)) => now.seconds_since(then),
                // Without times nothing shows that rows follow each other.
                _ => f64::INFINITY,
            };
            turned.abs() > TURN_DEG
                || since(&sorted[end - 1]) > GAP_S
                || since(&sorted[begin]) > COURSE_S
        });
        if is_over {
            courses.push(&sorted[begin..end]);
            begin = end;
        }
    }
    courses
}

/// Returns the mean of a course; none of a part of a turn.
fn mean(course: &[HeadingPair]) -> Option<CourseMean> {
    let (first, last) = (course.first()?, course.last()?);
    let rows = course.len() as f64;
    let length_s = first.time.zip(last.time);
    let length_s = length_s.map_or(0.0, |(first, last)| last.seconds_since(first));
    if course.len() > 1 && length_s < LEAST_S {
        return None;
    }
    let about = first.difference_deg();
    let offs = course
        .iter()
        .map(|pair| wrap_180(pair.difference_deg() - about));
    let turned_deg = wrap_180(last.compass_deg() - first.compass_deg());
    Some(CourseMean {
        compass_deg: first.compass_deg(),
        difference_deg: wrap_180(about + offs.sum::<f64>() / rows),
        rate_deg_s: turned_deg / length_s.max(LEAST_S),
        rows,
    })
}

/// Returns the variance of an angle of the rows about the mean of their course, by the means of
/// so many batches of each: errors of successive rows are not independent, those of batches
/// nearly. None where no course has several batches.
fn variance_within(
    courses: &[&[HeadingPair]],
    angle_deg: fn(&HeadingPair) -> f64,
    batches: usize,
) -> Option<f64> {
    let (mut squares, mut freedom) = (0.0, 0.0);
    for course in courses.iter().filter(|course| mean(course).is_some()) {
        let about = angle_deg(&course[0]);
        let mean_of = |rows: &[HeadingPair]| {
            let offs = rows.iter().map(|pair| wrap_180(angle_deg(pair) - about));
            offs.sum::<f64>() / rows.len() as f64
        };
        let middle = mean_of(course);
        let each = course.chunks(course.len().div_ceil(batches));
        freedom += each.len() as f64 - 1.0;
        squares += each
            .map(|batch| batch.len() as f64 * (mean_of(batch) - middle).powi(2))
            .sum::<f64>();
    }
    (freedom > 0.0).then(|| squares / freedom)
}
