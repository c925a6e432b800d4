//! Builder of a sample from consecutive settled windows on one heading.
//!
//! The difference of compass and reference is averaged, not each of them separately. A reference
//! that drops out for some windows then does not shift the mean of the others, and north needs no
//! special case.

use binnacle_compass::angle::{CompassHeading, CourseOverGround, TrueHeading, wrap_180};
use binnacle_compass::position::Position;
use binnacle_compass::sample::{Sample, SourceId};
use binnacle_compass::time::Timestamp;

use super::details::{Details, DirectionMean, Roll};

/// Seconds per window.
pub(crate) const WINDOW_S: i64 = 10;
/// Largest difference from the first window's heading.
const MAX_HEADING_CHANGE_DEG: f64 = 5.0;
/// Rejected windows in between that end a sample: more than a minute.
const MAX_GAP_WINDOWS: i64 = 6;
/// Standard deviations from the median above which a window is an outlier.
const OUTLIER_SIGMAS: f64 = 3.0;
/// Ratio of a normal distribution's standard deviation to its median absolute deviation.
const SIGMA_PER_MAD: f64 = 1.4826;
/// Distance from the median up to which no window is an outlier.
const MIN_OUTLIER_DEG: f64 = 0.2;

/// One settled window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    /// Tens of seconds since 1970.
    pub(crate) index: i64,
    pub(crate) compass_deg: f64,
    pub(crate) gyro_deg: Option<f64>,
    pub(crate) satellite_deg: Option<f64>,
    pub(crate) position: Position,
    /// Set if the position is by dead reckoning.
    pub(crate) is_reckoned: bool,
    pub(crate) sog_kn: f64,
    pub(crate) rate_of_turn_deg_min: Option<f64>,
    pub(crate) details: Details,
    /// Source of the gyro heading.
    pub(crate) gyro_source: Option<SourceId>,
    /// Source of the satellite-compass heading.
    pub(crate) satellite_source: Option<SourceId>,
}

impl Window {
    /// Returns true if gyro or satellite compass was read, and not the course over ground alone.
    fn has_reference(&self) -> bool {
        self.gyro_deg.or(self.satellite_deg).is_some()
    }
}

/// Settled windows of a sample in order of time, all on one heading.
#[derive(Clone, Debug, Default)]
pub(super) struct SampleBuilder {
    windows: Vec<Window>,
}

impl SampleBuilder {
    /// Adds a window. A window that does not belong to the open sample finishes it and begins the
    /// next.
    pub(super) fn add(&mut self, window: Window, sample_s: u32) -> Option<Sample> {
        let finished = if self.accepts(&window, sample_s) {
            None
        } else {
            self.finish()
        };
        self.windows.push(window);
        finished
    }

    /// Finishes the sample if no window after `index` can belong to it.
    pub(super) fn expire(&mut self, index: i64) -> Option<Sample> {
        let last = self.windows.last()?;
        if index - last.index <= MAX_GAP_WINDOWS {
            return None;
        }
        self.finish()
    }

    /// Finishes the sample.
    pub(super) fn finish(&mut self) -> Option<Sample> {
        let sample = build_sample(&self.windows);
        self.windows.clear();
        sample
    }

    fn accepts(&self, window: &Window, sample_s: u32) -> bool {
        let (Some(first), Some(last)) = (self.windows.first(), self.windows.last()) else {
            return true;
        };
        let length_s = (window.index - first.index + 1) * WINDOW_S;
        length_s <= i64::from(sample_s)
            && self.windows.len() < usize::from(u16::MAX)
            && window.index - last.index <= MAX_GAP_WINDOWS
            && wrap_180(window.compass_deg - first.compass_deg).abs() <= MAX_HEADING_CHANGE_DEG
            && first.has_reference() == window.has_reference()
            && first.is_reckoned == window.is_reckoned
            && !self.changes_source(window)
    }

    /// Returns whether a reference of the window is another instrument than before.
    fn changes_source(&self, window: &Window) -> bool {
        let differs = |of: fn(&Window) -> Option<SourceId>| {
            let before = first_of(&self.windows, of);
            before.zip(of(window)).is_some_and(|(a, b)| a != b)
        };
        differs(|w| w.gyro_source) || differs(|w| w.satellite_source)
    }
}

fn build_sample(windows: &[Window]) -> Option<Sample> {
    let kept = without_outliers(windows);
    let (first, last) = (windows.first()?, windows.last()?);
    let middle_s = (first.index + last.index + 1) * WINDOW_S / 2;
    let origin = first.compass_deg;
    let compass_deg = origin + mean(kept.iter().map(|w| wrap_180(w.compass_deg - origin)))?;
    let reference = |of: fn(&Window) -> Option<f64>| {
        let difference = mean_difference(&kept, of)?;
        TrueHeading::new(compass_deg - difference)
    };
    let time = Timestamp::from_micros(middle_s * 1_000_000).ok()?;
    let position = nearest_window(&kept, middle_s / WINDOW_S)?.position;
    let (gyro, satellite) = (reference(|w| w.gyro_deg), reference(|w| w.satellite_deg));
    let roll = mean_roll(&kept);
    Some(Sample {
        gyro,
        satellite,
        sog_kn: mean(kept.iter().map(|w| w.sog_kn)),
        rate_of_turn_deg_min: mean(kept.iter().filter_map(|w| w.rate_of_turn_deg_min)),
        spread_deg: spread(&kept),
        windows: kept.len() as u16,
        cog: mean_course(&kept),
        roll_deg: roll.map(|roll| roll.mean_deg),
        roll_spread_deg: roll.map(spread_of_roll),
        temperature_c: mean(kept.iter().filter_map(|w| w.details.temperature_c)),
        gyro_source: gyro.and_then(|_| first_of(&kept, |w| w.gyro_source)),
        satellite_source: satellite.and_then(|_| first_of(&kept, |w| w.satellite_source)),
        position_reckoned: first.is_reckoned,
        ..Sample::new(time, position, CompassHeading::new(compass_deg)?)
    })
}

/// Returns the mean of compass minus a reference, if at least half of the windows have it.
fn mean_difference(windows: &[Window], of: fn(&Window) -> Option<f64>) -> Option<f64> {
    let differences = differences(windows, of);
    if differences.is_empty() || differences.len() * 2 < windows.len() {
        return None;
    }
    let origin = differences[0];
    Some(
        origin
            + mean(
                differences
                    .iter()
                    .map(|difference| wrap_180(difference - origin)),
            )?,
    )
}

fn differences(windows: &[Window], of: fn(&Window) -> Option<f64>) -> Vec<f64> {
    let difference = |w: &Window| Some(wrap_180(w.compass_deg - of(w)?));
    windows.iter().filter_map(difference).collect()
}

/// Returns the reference that more windows have; the gyro when both have as many.
fn main_reference(windows: &[Window]) -> fn(&Window) -> Option<f64> {
    let gyros = windows.iter().filter(|w| w.gyro_deg.is_some()).count();
    let satellites = windows.iter().filter(|w| w.satellite_deg.is_some()).count();
    if gyros >= satellites {
        |w| w.gyro_deg
    } else {
        |w| w.satellite_deg
    }
}

/// Removes windows whose compass minus reference lies far from the median.
fn without_outliers(windows: &[Window]) -> Vec<Window> {
    let of = main_reference(windows);
    let differences = differences(windows, of);
    let Some(&origin) = differences.first() else {
        return windows.to_vec();
    };
    let middle = median(
        differences
            .iter()
            .map(|difference| wrap_180(difference - origin)),
    );
    let distance = |difference: f64| (wrap_180(difference - origin) - middle).abs();
    let mad = median(differences.iter().map(|difference| distance(*difference)));
    let limit = (OUTLIER_SIGMAS * SIGMA_PER_MAD * mad).max(MIN_OUTLIER_DEG);
    let near = |w: &&Window| of(w).is_none_or(|r| distance(wrap_180(w.compass_deg - r)) <= limit);
    windows.iter().filter(near).copied().collect()
}

/// Returns the standard deviation of compass minus reference; `None` for a single window.
fn spread(windows: &[Window]) -> Option<f64> {
    let differences = differences(windows, main_reference(windows));
    if differences.len() < 2 {
        return None;
    }
    let origin = differences[0];
    let middle = mean(
        differences
            .iter()
            .map(|difference| wrap_180(difference - origin)),
    )?;
    let squares = differences
        .iter()
        .map(|difference| (wrap_180(difference - origin) - middle).powi(2));
    Some((squares.sum::<f64>() / (differences.len() - 1) as f64).sqrt())
}

fn first_of(windows: &[Window], of: fn(&Window) -> Option<SourceId>) -> Option<SourceId> {
    windows.iter().find_map(of)
}

/// Returns the mean course, if at least half of the windows have one.
fn mean_course(windows: &[Window]) -> Option<CourseOverGround> {
    let courses: Vec<_> = windows.iter().filter_map(|w| w.details.cog).collect();
    if courses.len() * 2 < windows.len() {
        return None;
    }
    let mut mean = DirectionMean::default();
    for course in courses {
        mean.add(course);
    }
    mean.mean()
}

/// Returns the mean roll, if at least half of the windows have one.
fn mean_roll(windows: &[Window]) -> Option<Roll> {
    let rolls: Vec<_> = windows.iter().filter_map(|w| w.details.roll).collect();
    if rolls.len() * 2 < windows.len() {
        return None;
    }
    Some(Roll {
        mean_deg: mean(rolls.iter().map(|roll| roll.mean_deg))?,
        mean_square_deg2: mean(rolls.iter().map(|roll| roll.mean_square_deg2))?,
    })
}

/// Returns the standard deviation of all readings of roll. Rounding may make the variance of a
/// still ship negative.
fn spread_of_roll(roll: Roll) -> f64 {
    let variance = roll.mean_square_deg2 - roll.mean_deg * roll.mean_deg;
    variance.max(0.0).sqrt()
}

fn nearest_window(windows: &[Window], index: i64) -> Option<&Window> {
    windows.iter().min_by_key(|w| (w.index - index).abs())
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), v| (sum + v, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// Returns the median; zero for no values.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    f64::midpoint(sorted[last / 2], sorted[sorted.len() / 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(index: i64, compass_deg: f64, gyro_deg: Option<f64>) -> Window {
        Window {
            index,
            compass_deg,
            gyro_deg,
            satellite_deg: None,
            position: Position::new(43.0, index as f64 * 1e-3).unwrap(),
            is_reckoned: false,
            sog_kn: 12.0,
            rate_of_turn_deg_min: Some(0.5),
            details: Details::default(),
            gyro_source: None,
            satellite_source: None,
        }
    }

    fn sample(windows: &[Window]) -> Sample {
        build_sample(windows).unwrap()
    }

    #[test]
    fn means_on_either_side_of_north_are_right() {
        for offset in [-3.0, 0.0, 0.5, 3.0, 357.0] {
            let windows: Vec<Window> = (0..6)
                .map(|i| {
                    let compass = (f64::from(i as i32) - 2.5) * 0.4;
                    window(
                        i,
                        compass.rem_euclid(360.0),
                        Some((compass + offset).rem_euclid(360.0)),
                    )
                })
                .collect();
            let sample = sample(&windows);
            assert!(wrap_180(sample.compass.degrees()).abs() < 1e-9);
            let gyro = sample.gyro.unwrap().degrees();
            assert!(wrap_180(gyro - offset).abs() < 1e-9, "{gyro}");
            assert!(sample.spread_deg.unwrap() < 1e-9);
        }
    }

    #[test]
    fn an_outlier_is_left_out_and_not_counted() {
        let mut windows: Vec<Window> = (0..20)
            .map(|i| window(i, 100.0 + (i % 3) as f64 * 0.1, Some(98.0)))
            .collect();
        windows[7].gyro_deg = Some(91.0);
        let sample = sample(&windows);
        assert_eq!(sample.windows, 19);
        assert!((sample.gyro.unwrap().degrees() - 98.0).abs() < 0.01);
    }

    #[test]
    fn a_reference_that_is_there_half_the_time_keeps_its_difference() {
        // The heading creeps from 100 to 104; the satellite compass sees the end only.
        let windows: Vec<Window> = (0..40)
            .map(|i| {
                let heading = 100.0 + i as f64 * 0.1;
                let mut window = window(i, heading, Some(heading - 3.0));
                window.satellite_deg = (i >= 20).then_some(heading - 4.0);
                window
            })
            .collect();
        let sample = sample(&windows);
        let compass = sample.compass.degrees();
        assert!((compass - sample.satellite.unwrap().degrees() - 4.0).abs() < 1e-9);
        assert!((compass - sample.gyro.unwrap().degrees() - 3.0).abs() < 1e-9);
        let seldom = build_sample(&windows[..35]).unwrap();
        assert_eq!(seldom.satellite, None);
    }

    #[test]
    fn a_stretch_ends_by_length_by_heading_and_by_a_gap() {
        let mut sample_builder = SampleBuilder::default();
        for index in 0..60 {
            assert_eq!(
                sample_builder.add(window(index, 100.0, Some(98.0)), 600),
                None
            );
        }
        let whole = sample_builder
            .add(window(60, 100.0, Some(98.0)), 600)
            .unwrap();
        assert_eq!((whole.windows, whole.time.micros()), (60, 300_000_000));
        let turned = sample_builder
            .add(window(61, 105.5, Some(98.0)), 600)
            .unwrap();
        assert_eq!((turned.windows, turned.time.micros()), (1, 605_000_000));
        assert_eq!(sample_builder.add(window(67, 105.5, Some(98.0)), 600), None);
        assert_eq!(sample_builder.expire(73), None);
        assert_eq!(sample_builder.expire(74).unwrap().windows, 2);
    }
}
