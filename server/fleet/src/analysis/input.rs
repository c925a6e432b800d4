//! Input of an analysis: the log by segments, and the keys that name what is derived from it.
//!
//! The key of a segment is the hash of all that an analysis knows at its end: estimator, settings
//! and prior, the logbook and the azimuths until then, and the samples of this segment and of all
//! before. So whatever changes the input changes the keys from its own segment on, and no other.

use crate::{azimuths, logbook, settings};
use anyhow::Context;
use binnacle_compass::azimuth::Azimuth;
use binnacle_compass::logbook::LogbookEntry;
use binnacle_compass::result::{ESTIMATOR, STATE_FORM};
use binnacle_compass::sample::{Sample, sort_distinct};
use binnacle_compass::segment::Segment;
use binnacle_compass::settings::AnalysisSettings;
use binnacle_compass::time::Timestamp;
use binnacle_platform::db::{Db, rows};
use binnacle_platform::error::Result;
use binnacle_platform::ids::{CompassId, VesselId};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fmt;
use uuid::Uuid;

/// SHA-256.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hash(pub [u8; 32]);

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Stored input of a compass, without the batches themselves.
pub struct StoredInput {
    /// Segments of the log, the first first.
    pub segments: Vec<LoggedSegment>,
    /// Entries of the logbook.
    pub logbook: Vec<LogbookEntry>,
    /// Azimuths taken with the compass, in order of time.
    pub azimuths: Vec<Azimuth>,
    /// Settings of the operator.
    pub settings: AnalysisSettings,
    /// Time at which the next future-dated entry takes effect.
    pub next_entry_at: Option<Timestamp>,
}

/// Segment of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoggedSegment {
    /// The segment. Samples of a batch in between belong to the next that is logged.
    pub segment: Segment,
    /// Hash of the numbers of the batches with samples in it.
    pub batches: Hash,
}

/// Batches of a stream that begin in one segment and end in one. A batch is never changed, so that
/// their number says whether they are those of before.
#[derive(Clone, sqlx::FromRow)]
struct LoggedBatches {
    stream: Uuid,
    first_segment: i64,
    last_segment: i64,
    batches: i64,
}

/// Lists the stored input of a compass. Future-dated logbook entries are left out: the card
/// holds until the planned work is done.
pub async fn load(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    now: Timestamp,
) -> Result<StoredInput> {
    let batches = rows!(
        db,
        LoggedBatches,
        "SELECT stream, first_segment, last_segment, COUNT(*) AS batches
         FROM (SELECT b.stream, b.first_sample_at / $3 AS first_segment,
                      b.last_sample_at / $3 AS last_segment
               FROM batches b
               JOIN streams s ON s.vessel_id = b.vessel_id AND s.id = b.stream
               WHERE b.vessel_id = $1 AND s.compass_id = $2
                 AND b.first_sample_at IS NOT NULL AND b.last_sample_at IS NOT NULL) logged
         GROUP BY stream, first_segment, last_segment
         ORDER BY stream, first_segment, last_segment",
        vessel,
        compass,
        Segment::MICROS
    )?;
    let (logbook, ahead): (Vec<_>, Vec<_>) = logbook::of_compass(db, vessel, compass)
        .await?
        .into_iter()
        .partition(|entry| entry.from <= now);
    let azimuths = azimuths::of_compass(db, vessel, compass, None, None).await?;
    Ok(StoredInput {
        segments: segments(batches),
        logbook,
        azimuths: azimuths.into_iter().map(|stored| stored.azimuth).collect(),
        next_entry_at: ahead.iter().map(|entry| entry.from).min(),
        settings: settings::find(db, vessel).await?.analysis,
    })
}

/// Returns the segments in which batches begin or end.
fn segments(mut batches: Vec<LoggedBatches>) -> Vec<LoggedSegment> {
    let ends = |batches: &LoggedBatches| [batches.first_segment, batches.last_segment];
    let segments: BTreeSet<i64> = batches.iter().flat_map(ends).collect();
    batches.sort_unstable_by_key(|batches| {
        (batches.first_segment, batches.last_segment, batches.stream)
    });
    let mut before: Option<i64> = None;
    let mut logged = Vec::with_capacity(segments.len());
    for segment in segments {
        let mut hash = Sha256::new();
        let later = batches.partition_point(|batches| batches.first_segment <= segment);
        for batches in &batches[..later] {
            if before.is_none_or(|before| batches.last_segment > before) {
                hash.update(batches.stream.as_bytes());
                for number in [batches.first_segment, batches.last_segment, batches.batches] {
                    hash.update(number.to_le_bytes());
                }
            }
        }
        logged.push(LoggedSegment {
            segment: Segment::new(segment),
            batches: Hash(hash.finalize().into()),
        });
        before = Some(segment);
    }
    logged
}

/// Reads the batches of a compass with samples from one time to another.
pub async fn load_batches(
    db: &Db,
    vessel: VesselId,
    compass: CompassId,
    from: Option<Timestamp>,
    to: Option<Timestamp>,
) -> Result<Vec<(Vec<u8>,)>> {
    let batches = rows!(
        db,
        (Vec<u8>,),
        "SELECT b.bytes FROM batches b
         JOIN streams s ON s.vessel_id = b.vessel_id AND s.id = b.stream
         WHERE b.vessel_id = $1 AND s.compass_id = $2
           AND b.last_sample_at >= $3 AND b.first_sample_at <= $4
         ORDER BY b.stream, b.seq",
        vessel,
        compass,
        from.map_or(i64::MIN, Timestamp::micros),
        to.map_or(i64::MAX, Timestamp::micros)
    )?;
    Ok(batches)
}

/// Decodes batches to distinct samples in order of time. It takes long, so it must not run on an
/// async thread.
///
/// # Errors
/// Fails when a batch cannot be read.
pub fn decode(batches: &[(Vec<u8>,)]) -> anyhow::Result<Vec<Sample>> {
    let mut samples = Vec::new();
    for (bytes,) in batches {
        let batch = binnacle_wire::decode(bytes).context("a stored batch cannot be read")?;
        samples.extend(batch.samples);
    }
    sort_distinct(&mut samples);
    Ok(samples)
}

/// Returns the hash of samples in order.
///
/// # Errors
/// Fails when they cannot be written as JSON.
pub fn hash_samples(samples: &[Sample]) -> anyhow::Result<Hash> {
    let mut hash = Sha256::new();
    for sample in samples {
        update(&mut hash, sample)?;
    }
    Ok(Hash(hash.finalize().into()))
}

impl StoredInput {
    /// Returns the key before the first segment: of estimator, form of states, settings and prior. The
    /// population's prior is the estimator's own, and adds nothing.
    ///
    /// # Errors
    /// Fails when they cannot be written as JSON.
    pub fn first_key(&self, prior: Option<&str>) -> anyhow::Result<Hash> {
        let mut hash = Sha256::new();
        hash.update(ESTIMATOR);
        update(&mut hash, &STATE_FORM)?;
        update(&mut hash, &self.settings)?;
        if let Some(prior) = prior {
            hash.update(b"\n");
            hash.update(prior);
        }
        Ok(Hash(hash.finalize().into()))
    }

    /// Returns the key of the segment with a place, from the one before it and the hash of its
    /// samples.
    ///
    /// # Errors
    /// Fails when the logbook or the azimuths cannot be written as JSON.
    pub fn key(&self, before: Hash, place: usize, samples: Hash) -> anyhow::Result<Hash> {
        let end = self.end(place);
        let mut hash = Sha256::new();
        hash.update(before.0);
        update(&mut hash, &end)?;
        // What was known before is in the key before.
        let begin = place.checked_sub(1).and_then(|before| self.end(before));
        let is_new = |time: Timestamp| begin.is_none_or(|begin| time >= begin);
        for entry in &self.logbook {
            let known = match end {
                Some(end) => entry.known_before(end),
                None => Some(entry.clone()),
            };
            if let Some(entry) = known.filter(|e| is_new(e.from) || e.to.is_some_and(is_new)) {
                update(&mut hash, &entry)?;
            }
        }
        let azimuths = self
            .azimuths
            .iter()
            .filter(|azimuth| is_new(azimuth.time()));
        for azimuth in azimuths.filter(|azimuth| end.is_none_or(|end| azimuth.time() < end)) {
            update(&mut hash, azimuth.form())?;
        }
        hash.update(samples.0);
        Ok(Hash(hash.finalize().into()))
    }

    /// Returns the instant after the end of the segment with a place; none of the last.
    pub fn end(&self, place: usize) -> Option<Timestamp> {
        if place + 1 == self.segments.len() {
            return None;
        }
        self.segments[place].segment.end()
    }

    /// Returns the samples of each segment from a place on, from samples in order of time.
    pub fn split<'a>(&self, from: usize, samples: &'a [Sample]) -> Vec<&'a [Sample]> {
        let begin = from.checked_sub(1).and_then(|before| self.end(before));
        let before = |time: Timestamp| samples.partition_point(|sample| sample.time < time);
        let mut begin = begin.map_or(0, before);
        let mut split = Vec::new();
        for place in from..self.segments.len() {
            let end = self.end(place).map_or(samples.len(), before);
            split.push(&samples[begin..end]);
            begin = end;
        }
        split
    }
}

fn update(hash: &mut Sha256, value: &impl Serialize) -> anyhow::Result<()> {
    hash.update(serde_json::to_vec(value)?);
    hash.update(b"\n");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::angle::CourseOverGround;
    use binnacle_compass::azimuth::AzimuthForm;
    use binnacle_compass::logbook::LogbookKind;
    use binnacle_compass::sample::SourceId;

    fn time(text: &str) -> Timestamp {
        Timestamp::parse(text).unwrap()
    }

    fn sample(second: u32, compass_deg: f64) -> Sample {
        serde_json::from_value(serde_json::json!({
            "time": format!("2026-11-21T07:00:{second:02}Z"), "lat": 43.0, "lon": -3.0,
            "compass_deg": compass_deg, "gyro_deg": 90.0, "satellite_deg": null, "sog_kn": 12.0,
            "rate_of_turn_deg_min": 0.0, "spread_deg": 0.1, "windows": 60,
        }))
        .unwrap()
    }

    fn hash(mut samples: Vec<Sample>) -> Hash {
        sort_distinct(&mut samples);
        hash_samples(&samples).unwrap()
    }

    #[test]
    fn each_value_counts_in_the_hash_and_an_absent_one_does_not() {
        let bare = sample(0, 91.0);
        let with = |change: fn(&mut Sample)| {
            let mut changed = bare;
            change(&mut changed);
            hash(vec![changed]).to_string()
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

    /// Returns so many batches with the first and last sample at some times.
    fn logged(batches: i64, from: &str, to: &str) -> LoggedBatches {
        let segment = |text: &str| Segment::of(time(text)).number();
        LoggedBatches {
            stream: Uuid::nil(),
            first_segment: segment(from),
            last_segment: segment(to),
            batches,
        }
    }

    /// Returns the batches of five segments; one lies across the end of the second.
    fn batches() -> Vec<LoggedBatches> {
        vec![
            logged(1, "2026-09-20T00:00:00Z", "2026-09-20T06:00:00Z"),
            logged(1, "2026-10-03T20:00:00Z", "2026-10-04T06:00:00Z"),
            logged(2, "2026-10-20T00:00:00Z", "2026-10-21T06:00:00Z"),
            logged(1, "2026-11-20T00:00:00Z", "2026-11-20T06:00:00Z"),
        ]
    }

    fn input(batches: Vec<LoggedBatches>, logbook: Vec<LogbookEntry>) -> StoredInput {
        StoredInput {
            segments: segments(batches),
            logbook,
            azimuths: Vec::new(),
            settings: AnalysisSettings::default(),
            next_entry_at: None,
        }
    }

    /// Returns the keys of all segments, as if each had one sample.
    fn keys(input: &StoredInput, prior: Option<&str>) -> Vec<Hash> {
        let samples = hash(vec![sample(0, 91.0)]);
        let mut before = input.first_key(prior).unwrap();
        let mut keys = Vec::new();
        for place in 0..input.segments.len() {
            before = input.key(before, place, samples).unwrap();
            keys.push(before);
        }
        keys
    }

    fn same(a: &[Hash], b: &[Hash]) -> usize {
        a.iter().zip(b).take_while(|(a, b)| a == b).count()
    }

    #[test]
    fn a_batch_counts_in_the_segments_that_it_has_samples_of() {
        let logged = segments(batches());
        let mut reversed = batches();
        reversed.reverse();
        assert_eq!(segments(reversed), logged);
        let without = |number: usize| {
            let mut batches = batches();
            batches[number].batches -= 1;
            batches.retain(|batches| batches.batches > 0);
            let other = segments(batches);
            let place = |of: &LoggedSegment| other.iter().find(|o| o.segment == of.segment);
            let is_same = |of: &LoggedSegment| place(of).is_some_and(|o| o.batches == of.batches);
            logged.iter().map(is_same).collect::<Vec<bool>>()
        };
        assert_eq!(logged.len(), 5, "{logged:?}");
        assert_eq!(without(0), [false, true, true, true, true]);
        assert_eq!(without(1), [true, false, false, true, true]);
        assert_eq!(without(2), [true, true, true, false, true]);
        assert_eq!(without(3), [true, true, true, true, false]);
    }

    #[test]
    fn an_entry_changes_the_keys_from_the_segment_in_which_it_is_known() {
        let entry = |from: &str, to: Option<&str>| LogbookEntry {
            from: time(from),
            to: to.map(time),
            kind: LogbookKind::Berth,
            cargo: None,
            note: String::new(),
        };
        let bare = keys(&input(batches(), Vec::new()), None);
        let of = |entry: LogbookEntry| keys(&input(batches(), vec![entry]), None);
        assert_eq!(same(&bare, &of(entry("2026-10-20T03:00:00Z", None))), 3);
        let open = of(entry("2026-09-20T03:00:00Z", None));
        assert_eq!(same(&bare, &open), 0);
        // An end is known from its own segment on.
        let ended = of(entry("2026-09-20T03:00:00Z", Some("2026-11-20T03:00:00Z")));
        assert_eq!(same(&open, &ended), 4);
    }

    #[test]
    fn prior_and_settings_change_all_keys() {
        let bare = input(batches(), Vec::new());
        let known = keys(&bare, None);
        for prior in [r#"{"basis":1}"#, r#"{"basis":2}"#] {
            assert_eq!(same(&known, &keys(&bare, Some(prior))), 0);
        }
        let mut other = input(batches(), Vec::new());
        other.settings.reference_constant_sd_deg = 0.7;
        assert_eq!(same(&known, &keys(&other, None)), 0);
    }

    #[test]
    fn each_azimuth_counts_in_the_keys_from_its_segment_on() {
        let azimuth = |quay_deg: f64| -> Azimuth {
            let form: AzimuthForm = serde_json::from_value(serde_json::json!({
                "time": "2026-10-21T07:00:00Z", "lat": 43.0, "lon": -3.0,
                "compass_heading_deg": 91.0, "kind": "quay", "name": "Muelle 3",
                "true_bearing_deg": quay_deg,
            }))
            .unwrap();
            Azimuth::new(form).unwrap()
        };
        let of = |quays_deg: &[f64]| {
            let mut input = input(batches(), Vec::new());
            input.azimuths = quays_deg.iter().copied().map(azimuth).collect();
            keys(&input, None)
        };
        let bare = of(&[]);
        assert_eq!(same(&bare, &of(&[95.0])), 3);
        assert_eq!(same(&of(&[95.0]), &of(&[96.0])), 3);
        assert_eq!(same(&of(&[95.0]), &of(&[95.0, 95.0])), 3);
        assert_eq!(same(&of(&[95.0]), &of(&[95.0])), 5);
    }

    #[test]
    fn samples_are_split_at_the_ends_of_segments() {
        let input = input(batches(), Vec::new());
        let at = |text: &str| Sample {
            time: time(text),
            ..sample(0, 91.0)
        };
        let samples = [
            at("2026-09-20T00:00:00Z"),
            at("2026-10-03T20:00:00Z"),
            at("2026-10-04T06:00:00Z"),
            at("2026-11-20T00:00:00Z"),
        ];
        let counts = |from: usize| {
            let split = input.split(from, &samples);
            split.iter().map(|own| own.len()).collect::<Vec<usize>>()
        };
        assert_eq!(counts(0).iter().sum::<usize>(), samples.len());
        assert_eq!(counts(1), counts(0)[1..]);
    }
}
