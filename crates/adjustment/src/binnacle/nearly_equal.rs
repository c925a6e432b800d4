//! Comparison of lengths and angles in written forms.

/// Whether two lengths or angles of a form are the same one.
pub(crate) fn nearly_equal(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}
