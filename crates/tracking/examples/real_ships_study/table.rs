//! Figures of the printed tables.

/// Returns the quantile of a set, infinite values included.
pub(crate) fn quantile(of: &[f64], q: f64) -> f64 {
    let mut sorted = of.to_vec();
    sorted.sort_by(f64::total_cmp);
    if sorted.is_empty() {
        return f64::NAN;
    }
    sorted[((sorted.len() - 1) as f64 * q).round() as usize]
}

/// Returns a share in per cent.
pub(crate) fn share<T>(of: &[T], such: impl Fn(&T) -> bool) -> f64 {
    100.0 * of.iter().filter(|x| such(x)).count() as f64 / of.len() as f64
}

/// Returns a figure and its target, with a mark where it is missed.
pub(crate) fn at_most(figure: f64, target: f64, decimals: usize) -> String {
    let mark = if figure <= target { ' ' } else { '!' };
    format!("{figure:.decimals$}{mark}<={target}")
}

/// Returns a percentage and its target, with a mark where it is missed.
pub(crate) fn at_least(percent: f64, target: f64) -> String {
    let mark = if percent >= target { ' ' } else { '!' };
    format!("{percent:.1}{mark}>={target}")
}

/// Returns the share that a band of 95 % held, with a mark outside 93–97 %.
pub(crate) fn held(percent: f64) -> String {
    let mark = if (93.0..=97.0).contains(&percent) {
        ' '
    } else {
        '!'
    };
    format!("{percent:.1}{mark}")
}
