//! Numbers in error messages.

use std::fmt;

/// A number in an error message, with an exponent where it would be long.
#[derive(Clone, Copy, Debug)]
pub struct CompactNumber(pub f64);

impl fmt::Display for CompactNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size != 0.0 && !(1e-6..1e9).contains(&size) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}
