//! Comparison of lengths and angles in written forms.

/// Returns true when two lengths or angles of a form are equal within rounding.
pub(crate) fn nearly_equal(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}
