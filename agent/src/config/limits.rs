//! Checked numbers of the configuration.

use serde::Deserialize;

/// Megabytes (of a million bytes), from 4 to 100 000.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct SpoolLimit(f64);

impl SpoolLimit {
    /// Returns the limit in bytes.
    pub(crate) fn bytes(self) -> u64 {
        (self.0 * 1e6) as u64
    }
}

impl Default for SpoolLimit {
    fn default() -> SpoolLimit {
        SpoolLimit(64.0)
    }
}

impl TryFrom<f64> for SpoolLimit {
    type Error = String;
    fn try_from(megabytes: f64) -> Result<SpoolLimit, String> {
        if (4.0..=100_000.0).contains(&megabytes) {
            Ok(SpoolLimit(megabytes))
        } else {
            Err(format!("{megabytes} is not from 4 to 100000 megabytes"))
        }
    }
}

/// Megabytes (of a million bytes), from 1 to 10 000, or 0 for none.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct RawLogLimit(f64);

impl RawLogLimit {
    /// Returns the limit in bytes.
    pub(crate) fn bytes(self) -> u64 {
        (self.0 * 1e6) as u64
    }
}

impl Default for RawLogLimit {
    fn default() -> RawLogLimit {
        RawLogLimit(64.0)
    }
}

impl TryFrom<f64> for RawLogLimit {
    type Error = String;
    fn try_from(megabytes: f64) -> Result<RawLogLimit, String> {
        if megabytes == 0.0 || (1.0..=10_000.0).contains(&megabytes) {
            Ok(RawLogLimit(megabytes))
        } else {
            Err(format!(
                "{megabytes} is neither 0 nor from 1 to 10000 megabytes"
            ))
        }
    }
}
