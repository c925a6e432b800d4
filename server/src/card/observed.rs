//! What was observed near each heading of a card, beside what the card says.

use crate::error::Result;
use crate::time::Time;
use serde::Deserialize;

/// Degrees of compass heading from one line of a card to the next.
pub(super) const STEP_DEG: f64 = 15.0;
const SECTORS: usize = 24;

/// Observations within half a step of a heading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Observed {
    /// How many samples carried weight.
    pub(super) samples: u64,
    /// Their mean of measured less predicted deviation, by weight, degrees; none
    /// without samples.
    pub(super) residual_deg: Option<f64>,
}

/// What of a sample is looked at.
#[derive(Deserialize)]
struct Seen {
    time: Time,
    compass_deg: f64,
    residual_deg: Option<f64>,
    weight: f64,
    used: bool,
}

/// What was observed in an epoch from `from` on, by lines of the card; `chunks` are
/// JSON arrays of samples.
pub(super) fn observed(chunks: &[String], from: Time) -> Result<[Observed; SECTORS]> {
    let mut sums = [(0_u64, 0.0_f64, 0.0_f64); SECTORS];
    for chunk in chunks {
        for seen in serde_json::from_str::<Vec<Seen>>(chunk)? {
            let Some(residual_deg) = seen.residual_deg.filter(|_| seen.used) else {
                continue;
            };
            if seen.time < from {
                continue;
            }
            let (samples, weight, sum) = &mut sums[sector(seen.compass_deg)];
            *samples += 1;
            *weight += seen.weight;
            *sum += seen.weight * residual_deg;
        }
    }
    Ok(sums.map(|(samples, weight, sum)| Observed {
        samples,
        residual_deg: (weight > 0.0).then(|| sum / weight),
    }))
}

fn sector(compass_deg: f64) -> usize {
    (compass_deg / STEP_DEG).round() as usize % SECTORS
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_magnetics::time::Timestamp;

    fn from(text: &str) -> Time {
        Time(Timestamp::parse(text).unwrap())
    }

    fn chunk(samples: &[(f64, Option<f64>, f64, bool)]) -> String {
        let samples = samples
            .iter()
            .map(|(compass_deg, residual_deg, weight, used)| {
                serde_json::json!({
                    "time": "2026-11-21T07:00:00Z", "compass_deg": compass_deg,
                    "residual_deg": residual_deg, "weight": weight, "used": used,
                })
            });
        serde_json::Value::from(samples.collect::<Vec<_>>()).to_string()
    }

    #[test]
    fn a_sample_belongs_to_the_nearest_line_also_across_north() {
        let chunks = [chunk(&[
            (352.6, Some(1.0), 1.0, true),
            (7.4, Some(3.0), 1.0, true),
            (7.6, Some(-1.0), 0.5, true),
        ])];
        let found = observed(&chunks, from("2026-11-01T00:00:00Z")).unwrap();
        assert_eq!((found[0].samples, found[0].residual_deg), (2, Some(2.0)));
        assert_eq!((found[1].samples, found[1].residual_deg), (1, Some(-1.0)));
        assert_eq!(found[2], Observed::default());
    }

    #[test]
    fn what_the_model_does_not_rest_on_is_no_observation() {
        let chunks = [chunk(&[
            (90.0, Some(9.0), 0.0, false),
            (90.0, None, 1.0, true),
            (90.0, Some(1.0), 1.0, true),
            (90.0, Some(4.0), 0.5, true),
        ])];
        let found = observed(&chunks, from("2026-11-01T00:00:00Z")).unwrap();
        assert_eq!((found[6].samples, found[6].residual_deg), (2, Some(2.0)));
        let later = observed(&chunks, from("2026-11-21T07:00:01Z")).unwrap();
        assert_eq!(later[6], Observed::default());
    }
}
