//! Observations near each heading of a card, compared with the card.

use binnacle_compass::angle::{CompassHeading, wrap_180};
use binnacle_compass::model::Model;
use binnacle_compass::result::{SampleDiagnostic, SampleReason};
use binnacle_compass::ship::EarthField;
use binnacle_platform::time::Time;

/// Degrees of compass heading from one line of a card to the next.
pub(super) const STEP_DEG: f64 = 15.0;
const SECTORS: usize = 24;

/// Observations within half a step of a heading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Observed {
    /// Number of samples that carried weight.
    pub(super) samples: u64,
    /// Their mean of measured less predicted deviation, by weight, degrees; none
    /// without samples.
    pub(super) residual_deg: Option<f64>,
}

/// Relation of the samples to a card's model.
#[derive(Clone, Copy)]
pub(super) enum SampleRole<'a> {
    /// It was fitted to those that carried weight.
    Fitted,
    /// It was predicted before them: each is compared with its prediction.
    Predicted(&'a Model),
}

/// Collects the observations of an epoch from `from` on, by lines of the card.
pub(super) fn observed(
    samples: &[SampleDiagnostic],
    from: Time,
    role: SampleRole<'_>,
) -> [Observed; SECTORS] {
    let mut sums = [(0_u64, 0.0_f64, 0.0_f64); SECTORS];
    for found in samples
        .iter()
        .filter(|found| Time(found.sample.time) >= from)
    {
        let Some((residual_deg, weighs)) = role.residual(found) else {
            continue;
        };
        let (samples, weight, sum) = &mut sums[sector(found.sample.compass)];
        *samples += 1;
        *weight += weighs;
        *sum += weighs * residual_deg;
    }
    sums.map(|(samples, weight, sum)| Observed {
        samples,
        residual_deg: (weight > 0.0).then(|| sum / weight),
    })
}

impl SampleRole<'_> {
    /// Returns measured less predicted deviation, and its weight.
    fn residual(self, sample: &SampleDiagnostic) -> Option<(f64, f64)> {
        match self {
            SampleRole::Fitted => {
                Some((sample.residual_deg?, sample.weight)).filter(|_| sample.used)
            }
            SampleRole::Predicted(model) => {
                if !matches!(sample.reason, None | Some(SampleReason::NoModel)) {
                    return None;
                }
                let earth = EarthField {
                    h_nt: sample.h_nt?,
                    z_nt: sample.z_nt?,
                };
                let predicted = model
                    .deviation(sample.sample.compass, earth)
                    .ok()?
                    .deviation;
                let residual_deg = sample.deviation_deg? - predicted.degrees_east();
                Some((wrap_180(residual_deg), 1.0))
            }
        }
    }
}

fn sector(compass: CompassHeading) -> usize {
    (compass.degrees() / STEP_DEG).round() as usize % SECTORS
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::time::Timestamp;

    fn from(text: &str) -> Time {
        Time(Timestamp::parse(text).unwrap())
    }

    fn samples(of: &[(f64, Option<f64>, f64, bool)]) -> Vec<SampleDiagnostic> {
        let sample =
            |&(compass_deg, residual_deg, weight, used): &(f64, Option<f64>, f64, bool)| {
                let diagnostic = serde_json::json!({
                    "time": "2026-11-21T07:00:00Z", "lat": 43.0, "lon": -8.0,
                    "compass_deg": compass_deg, "gyro_deg": 90.0, "satellite_deg": null,
                    "sog_kn": 12.0, "rate_of_turn_deg_min": 0.0, "spread_deg": 0.1, "windows": 60,
                    "variation_deg": null, "h_nt": null, "z_nt": null, "deviation_deg": null,
                    "predicted_deg": null, "residual_deg": residual_deg, "weight": weight,
                    "used": used, "reason": null,
                });
                serde_json::from_value(diagnostic).unwrap()
            };
        of.iter().map(sample).collect()
    }

    #[test]
    fn a_sample_belongs_to_the_nearest_line_also_across_north() {
        let samples = samples(&[
            (352.6, Some(1.0), 1.0, true),
            (7.4, Some(3.0), 1.0, true),
            (7.6, Some(-1.0), 0.5, true),
        ]);
        let found = observed(&samples, from("2026-11-01T00:00:00Z"), SampleRole::Fitted);
        assert_eq!((found[0].samples, found[0].residual_deg), (2, Some(2.0)));
        assert_eq!((found[1].samples, found[1].residual_deg), (1, Some(-1.0)));
        assert_eq!(found[2], Observed::default());
    }

    #[test]
    fn what_the_model_does_not_rest_on_is_no_observation() {
        let samples = samples(&[
            (90.0, Some(9.0), 0.0, false),
            (90.0, None, 1.0, true),
            (90.0, Some(1.0), 1.0, true),
            (90.0, Some(4.0), 0.5, true),
        ]);
        let found = observed(&samples, from("2026-11-01T00:00:00Z"), SampleRole::Fitted);
        assert_eq!((found[6].samples, found[6].residual_deg), (2, Some(2.0)));
        let later = observed(&samples, from("2026-11-21T07:00:01Z"), SampleRole::Fitted);
        assert_eq!(later[6], Observed::default());
    }
}
