//! Kinds of references: copies of the compass, and instruments of their own.

use super::ship::{Reading, gauss, rounded};
use rand_chacha::ChaCha8Rng;

/// Kind of reference, with the digits of the compass.
pub(crate) struct Kind {
    pub(crate) name: &'static str,
    pub(crate) compass_digit_deg: f64,
    /// True heading by the reference, of the readings until now, the latest last.
    pub(crate) reference: fn(&[Reading], &mut ChaCha8Rng) -> f64,
}

/// Compass as shown so many seconds ago, with the variation of now.
fn copy(readings: &[Reading], seconds: usize) -> f64 {
    let now = readings[readings.len() - 1];
    let then = readings[readings.len().saturating_sub(1 + seconds)];
    then.shown + now.variation_deg
}

fn smoothed(readings: &[Reading], seconds: usize) -> f64 {
    let now = readings[readings.len() - 1];
    let last = &readings[readings.len().saturating_sub(seconds)..];
    last.iter().map(|reading| reading.shown).sum::<f64>() / last.len() as f64 + now.variation_deg
}

fn own(readings: &[Reading], digit_deg: f64) -> f64 {
    rounded(readings[readings.len() - 1].satellite_deg, digit_deg)
}

const fn kind(
    name: &'static str,
    compass_digit_deg: f64,
    reference: fn(&[Reading], &mut ChaCha8Rng) -> f64,
) -> Kind {
    Kind {
        name,
        compass_digit_deg,
        reference,
    }
}

pub(crate) const KINDS: [Kind; 17] = [
    kind("own, tenths", 0.1, |r, _| own(r, 0.1)),
    kind("own, no digits", 0.0, |r, _| own(r, 0.0)),
    kind("own, compass whole", 1.0, |r, _| own(r, 0.1)),
    kind("own, both half", 0.5, |r, _| own(r, 0.5)),
    kind("own, both whole", 1.0, |r, _| own(r, 1.0)),
    kind("copy", 0.1, |r, _| copy(r, 0)),
    kind("copy, both whole", 1.0, |r, _| rounded(copy(r, 0), 1.0)),
    kind("copy, each whole", 1.0, |r, _| {
        let now = r[r.len() - 1];
        rounded(now.raw + now.variation_deg, 1.0)
    }),
    kind("copy in tenths of whole", 1.0, |r, _| {
        let now = r[r.len() - 1];
        rounded(now.raw + now.variation_deg, 0.1)
    }),
    kind("copy, noise 0.05", 0.1, |r, rng| {
        copy(r, 0) + 0.05 * gauss(rng)
    }),
    kind("copy, noise 0.2", 0.1, |r, rng| {
        copy(r, 0) + 0.2 * gauss(rng)
    }),
    kind("copy, 1 s late", 0.1, |r, _| copy(r, 1)),
    kind("copy, 2 s late", 0.1, |r, _| copy(r, 2)),
    kind("copy, 5 s late", 0.1, |r, _| copy(r, 5)),
    kind("copy, mean of 11 s", 0.1, |r, _| smoothed(r, 11)),
    kind("copy, mean of 11 s, whole", 1.0, |r, _| {
        rounded(smoothed(r, 11), 1.0)
    }),
    kind("copy by a card", 0.1, |r, _| {
        let now = r[r.len() - 1];
        now.shown + 3.0 * now.shown.to_radians().sin() + now.variation_deg
    }),
];
