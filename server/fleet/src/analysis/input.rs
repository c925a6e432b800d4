//! Input of an analysis, and the hash that names it.

use crate::{azimuths, logbook, settings};
use anyhow::Context;
use binnacle_compass::azimuth::Azimuth;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::ESTIMATOR;
use binnacle_compass::sample::Sample;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use binnacle_platform::db::{Db, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, VesselId};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Input of an analysis of one compass.
#[derive(Clone, Debug)]
pub struct Input {
    /// Distinct, in order of time.
    pub samples: Vec<Sample>,
    /// Entries of the logbook.
    pub logbook: Vec<LogbookEntry>,
    /// Azimuths taken with the compass, in order of time.
    pub azimuths: Vec<Azimuth>,
    /// Settings of the operator.
    pub settings: AnalysisSettings,
    /// Prior from the vessel's fleet, as JSON; none: the population's.
    pub prior: Option<String>,
}

/// Stored input of a compass, with its batches as received.
pub struct StoredInput {
    batches: Vec<(Vec<u8>,)>,
    logbook: Vec<LogbookEntry>,
    azimuths: Vec<Azimuth>,
    settings: AnalysisSettings,
    /// Time at which the next future-dated entry takes effect.
    pub next_entry_at: Option<Timestamp>,
}

/// Reads the stored input of a compass. Future-dated logbook entries are left out: the card
/// holds until the planned work is done.
pub async fn load(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    now: Timestamp,
) -> Result<StoredInput> {
    let batches = rows!(
        db,
        (Vec<u8>,),
        "SELECT b.bytes FROM batches b
         JOIN streams s ON s.vessel_id = b.vessel_id AND s.id = b.stream
         WHERE b.vessel_id = $1 AND s.compass_id = $2
         ORDER BY b.stream, b.seq",
        vessel,
        compass
    )?;
    let (logbook, ahead): (Vec<_>, Vec<_>) = logbook::of_compass(db, vessel, compass)
        .await?
        .into_iter()
        .partition(|entry| entry.from <= now);
    let azimuths = azimuths::of_compass(db, vessel, compass, None, None).await?;
    Ok(StoredInput {
        batches,
        logbook,
        azimuths: azimuths.into_iter().map(|stored| stored.azimuth).collect(),
        next_entry_at: ahead.iter().map(|entry| entry.from).min(),
        settings: settings::find(db, vessel).await?.analysis,
    })
}

impl StoredInput {
    /// Tells whether the compass has no batches.
    pub fn is_empty(&self) -> bool {
        self.batches.is_empty()
    }

    /// Decodes the batches. It takes long, so it must not run on an async thread.
    pub fn decode(self, prior: Option<String>) -> anyhow::Result<Input> {
        let mut samples = Vec::new();
        for (bytes,) in self.batches {
            let batch = binnacle_wire::decode(&bytes).context("a stored batch cannot be read")?;
            samples.extend(batch.samples);
        }
        Ok(Input {
            samples: distinct(samples)?,
            logbook: self.logbook,
            azimuths: self.azimuths,
            settings: self.settings,
            prior,
        })
    }
}

/// Sorts samples by time and removes repetitions: a batch sent again in a new stream counts once.
fn distinct(samples: Vec<Sample>) -> anyhow::Result<Vec<Sample>> {
    let mut keyed = Vec::with_capacity(samples.len());
    for sample in samples {
        keyed.push((sample.time, serde_json::to_string(&sample)?, sample));
    }
    keyed.sort_by(|x, y| (x.0, &x.1).cmp(&(y.0, &y.1)));
    keyed.dedup_by(|x, y| x.1 == y.1);
    Ok(keyed.into_iter().map(|(_, _, sample)| sample).collect())
}

/// Returns the SHA-256 of estimator, settings, prior, logbook, azimuths and samples, as
/// hexadecimal. The population's prior is the estimator's own, and adds nothing.
///
/// # Errors
/// Fails when they cannot be written as JSON.
pub fn input_hash(input: &Input) -> anyhow::Result<String> {
    let mut hash = Sha256::new();
    hash.update(ESTIMATOR);
    update(&mut hash, &input.settings)?;
    if let Some(prior) = &input.prior {
        hash.update(b"\n");
        hash.update(prior);
    }
    update(&mut hash, &input.logbook)?;
    for azimuth in &input.azimuths {
        update(&mut hash, azimuth.form())?;
    }
    for sample in &input.samples {
        update(&mut hash, sample)?;
    }
    let mut text = String::with_capacity(64);
    for byte in hash.finalize() {
        write!(text, "{byte:02x}")?;
    }
    Ok(text)
}

fn update(hash: &mut Sha256, value: &impl Serialize) -> anyhow::Result<()> {
    hash.update(b"\n");
    hash.update(serde_json::to_string(value)?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::angle::CourseOverGround;
    use binnacle_compass::azimuth::AzimuthForm;
    use binnacle_compass::sample::SourceId;
    use std::collections::BTreeSet;

    fn sample(second: u32, compass_deg: f64) -> Sample {
        serde_json::from_value(serde_json::json!({
            "time": format!("2026-11-21T07:00:{second:02}Z"), "lat": 43.0, "lon": -3.0,
            "compass_deg": compass_deg, "gyro_deg": 90.0, "satellite_deg": null, "sog_kn": 12.0,
            "rate_of_turn_deg_min": 0.0, "spread_deg": 0.1, "windows": 60,
        }))
        .unwrap()
    }

    fn hash(samples: Vec<Sample>) -> String {
        let settings = AnalysisSettings::default();
        let samples = distinct(samples).unwrap();
        input_hash(&Input {
            samples,
            logbook: Vec::new(),
            azimuths: Vec::new(),
            settings,
            prior: None,
        })
        .unwrap()
    }

    #[test]
    fn each_value_counts_in_the_hash_and_an_absent_one_does_not() {
        let bare = sample(0, 91.0);
        let with = |change: fn(&mut Sample)| {
            let mut changed = bare;
            change(&mut changed);
            hash(vec![changed])
        };
        let hashes = [
            with(|_| {}),
            with(|s| s.cog = CourseOverGround::new(91.0)),
            with(|s| s.roll_deg = Some(1.0)),
            with(|s| s.roll_spread_deg = Some(1.0)),
            with(|s| s.temperature_c = Some(1.0)),
            with(|s| s.gyro_source = Some(SourceId::new(1))),
            with(|s| s.satellite_source = Some(SourceId::new(1))),
            with(|s| s.position_reckoned = true),
        ];
        let distinct: BTreeSet<&String> = hashes.iter().collect();
        assert_eq!(distinct.len(), hashes.len());
        assert!(!serde_json::to_string(&bare).unwrap().contains("roll"));
    }

    /// Returns the hash of no samples with azimuths of a quay in some true direction each.
    fn hash_of_azimuths(quays_deg: &[f64]) -> String {
        let azimuth = |quay_deg: &f64| -> Azimuth {
            let form: AzimuthForm = serde_json::from_value(serde_json::json!({
                "time": "2026-11-21T07:00:00Z", "lat": 43.0, "lon": -3.0,
                "compass_heading_deg": 91.0, "kind": "quay", "name": "Muelle 3",
                "true_bearing_deg": quay_deg,
            }))
            .unwrap();
            Azimuth::new(form).unwrap()
        };
        input_hash(&Input {
            samples: Vec::new(),
            logbook: Vec::new(),
            azimuths: quays_deg.iter().map(azimuth).collect(),
            settings: AnalysisSettings::default(),
            prior: None,
        })
        .unwrap()
    }

    #[test]
    fn each_azimuth_counts_in_the_hash() {
        let hashes = [&[][..], &[95.0], &[96.0], &[95.0, 96.0], &[95.0, 95.0]];
        let distinct: BTreeSet<String> = hashes.map(hash_of_azimuths).into_iter().collect();
        assert_eq!(distinct.len(), hashes.len());
        assert_eq!(hash_of_azimuths(&[95.0]), hash_of_azimuths(&[95.0]));
    }

    #[test]
    fn the_prior_counts_in_the_hash() {
        let of = |prior: Option<&str>| {
            let input = Input {
                samples: vec![sample(0, 91.0)],
                logbook: Vec::new(),
                azimuths: Vec::new(),
                settings: AnalysisSettings::default(),
                prior: prior.map(str::to_owned),
            };
            input_hash(&input).unwrap()
        };
        let hashes = [None, Some(r#"{"basis":1}"#), Some(r#"{"basis":2}"#)].map(of);
        let distinct: BTreeSet<&String> = hashes.iter().collect();
        assert_eq!(distinct.len(), hashes.len());
        assert_eq!(hashes[0], hash(vec![sample(0, 91.0)]));
        assert_eq!(of(Some(r#"{"basis":1}"#)), hashes[1]);
    }

    #[test]
    fn order_and_repetition_do_not_change_the_hash() {
        let (first, second) = (sample(0, 91.0), sample(10, 92.0));
        assert_eq!(hash(vec![first, second]), hash(vec![second, first, second]));
        assert_ne!(hash(vec![first, second]), hash(vec![first]));
        assert_ne!(
            hash(vec![first, second]),
            hash(vec![first, sample(10, 92.1)])
        );
    }
}
