//! Median, and the standard deviation that follows from medians, which outliers do not move.

/// Median of |x| of a Gaussian, as a part of its standard deviation.
const MEDIAN_TO_SD: f64 = 0.674_489_8;

/// Returns the median; none of no numbers.
pub(crate) fn median(mut numbers: Vec<f64>) -> Option<f64> {
    let middle = numbers.len() / 2;
    if numbers.is_empty() {
        return None;
    }
    Some(*numbers.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Returns the standard deviation of a Gaussian with the same median distance from `centre`;
/// none of no numbers.
pub(crate) fn robust_sd(numbers: impl Iterator<Item = f64>, centre: f64) -> Option<f64> {
    let distances = numbers.map(|x| (x - centre).abs());
    Some(median(distances.collect())? / MEDIAN_TO_SD)
}
