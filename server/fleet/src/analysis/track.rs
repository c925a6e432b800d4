//! Recent places of a ship, as few as a map of the fleet shows.
//!
//! Invariant: a track depends on the samples alone, not on the order of their arrival. It has the
//! last place of each twelve hours with samples, over the month before the last sample.

use binnacle_compass::result::SampleDiagnostic;
use serde::{Deserialize, Serialize};

const STEP_MICROS: i64 = 12 * 3_600 * 1_000_000;
/// A month of steps.
const MOST_STEPS: i64 = 60;

/// Places in order of time: degrees north and east, to a hundredth.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Track(pub Vec<(f64, f64)>);

impl TryFrom<String> for Track {
    type Error = serde_json::Error;

    fn try_from(text: String) -> Result<Track, serde_json::Error> {
        serde_json::from_str(&text)
    }
}

/// Returns the track of samples in order of time.
pub(super) fn track(samples: &[SampleDiagnostic]) -> Track {
    let step = |sample: &SampleDiagnostic| sample.sample.time.micros().div_euclid(STEP_MICROS);
    let Some(last) = samples.last().map(step) else {
        return Track::default();
    };
    let begin = samples.partition_point(|sample| step(sample) <= last - MOST_STEPS);
    let places = samples[begin..]
        .chunk_by(|x, y| step(x) == step(y))
        .filter_map(<[_]>::last)
        .map(|diagnostic| {
            let position = diagnostic.sample.position;
            (hundredth(position.lat_deg()), hundredth(position.lon_deg()))
        });
    Track(places.collect())
}

fn hundredth(degrees: f64) -> f64 {
    (degrees * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Returns a sample every three hours, each a quarter of a degree further east.
    fn passage(samples: u32) -> Vec<SampleDiagnostic> {
        (0..samples)
            .map(|i| {
                let (day, hour) = (1 + i / 8, 3 * (i % 8));
                let time = match day {
                    ..=31 => format!("2026-10-{day:02}T{hour:02}:00:00Z"),
                    _ => format!("2026-11-{:02}T{hour:02}:00:00Z", day - 31),
                };
                let diagnostic = json!({
                    "time": time, "lat": 43.126, "lon": f64::from(i) * 0.25 - 170.0,
                    "compass_deg": 90.0, "gyro_deg": 90.0, "satellite_deg": null, "sog_kn": 12.0,
                    "rate_of_turn_deg_min": 0.0, "spread_deg": 0.1, "windows": 60,
                    "variation_deg": null, "h_nt": null, "z_nt": null, "deviation_deg": null,
                    "predicted_deg": null, "residual_deg": null, "weight": 1.0, "used": true,
                    "reason": null,
                });
                serde_json::from_value(diagnostic).unwrap()
            })
            .collect()
    }

    #[test]
    fn a_track_keeps_the_last_place_of_each_half_day() {
        assert_eq!(track(&passage(6)).0, [(43.13, -169.25), (43.13, -168.75)]);
        assert_eq!(track(&[]).0, []);
    }

    #[test]
    fn a_track_goes_back_a_month() {
        let track = track(&passage(8 * 45)).0;
        assert_eq!(track.len(), 60);
        assert_eq!(track.last(), Some(&(43.13, -80.25)));
    }
}
