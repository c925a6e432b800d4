//! Replay of recorded sentences through the same roles and sampler as live ones.
//!
//! Nothing is written before everything was read, so an existing table is complete.

use crate::acquisition::Acquisition;
use crate::config::{RolesConfig, SilenceConfig};
use crate::input;
use crate::sampler::Tally;
use anyhow::Context;
use binnacle_compass::angle::{CourseOverGround, TrueHeading};
use binnacle_compass::sample::{Sample, SourceId};
use binnacle_wire::messages::Settings;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use tokio::time::Instant;

/// Result of replayed recordings.
#[derive(Clone, Debug, Default)]
pub(crate) struct Replayed {
    /// Samples in the order in which they were finished.
    pub(crate) samples: Vec<Sample>,
    /// Ten-second windows by outcome.
    pub(crate) windows: Tally,
    /// Sentences that were read.
    pub(crate) sentences: binnacle_nmea::Tally,
}

/// The tally as it is printed.
#[derive(Debug, Serialize)]
struct Report {
    samples: usize,
    windows: BTreeMap<String, u64>,
    sentences: BTreeMap<&'static str, u64>,
    rejected: BTreeMap<&'static str, u64>,
}

/// Reads recordings one after another, as one voyage. Inputs have no names in a recording: sources
/// are distinguished by talker and sentence.
///
/// # Errors
/// Fails when a file cannot be read, or has no sentence in it.
pub(crate) fn replay(
    files: &[PathBuf],
    roles: &RolesConfig,
    silence: &SilenceConfig,
) -> anyhow::Result<Replayed> {
    let mut acquisition = Acquisition::new(
        &roles.without_input_names(),
        silence,
        Settings::default(),
        None,
    );
    let mut replayed = Replayed::default();
    let heard = Instant::now();
    for file in files {
        let read = input::replay(file, |observations| {
            for observation in observations {
                acquisition.observe(observation, heard);
            }
            replayed.samples.extend(acquisition.sampler.take_samples());
            // Recordings raise no alerts.
            drop(acquisition.sampler.take_settled());
        });
        let read = read.with_context(|| file.display().to_string())?;
        anyhow::ensure!(
            read.total_read() > 0,
            "{}: none of its {} lines is a sentence with a valid checksum",
            file.display(),
            read.total_rejected()
        );
        replayed.sentences.add(&read);
    }
    acquisition.sampler.finish();
    replayed.samples.extend(acquisition.sampler.take_samples());
    replayed.windows = acquisition.sampler.take_tally();
    Ok(replayed)
}

impl Replayed {
    /// Returns the tally as one line of JSON.
    pub(crate) fn report(&self) -> String {
        let report = Report {
            samples: self.samples.len(),
            windows: self.windows.by_name(),
            sentences: self.sentences.sentences().collect(),
            rejected: self.sentences.rejected().collect(),
        };
        serde_json::to_string(&report).expect("counts and names are always JSON")
    }

    /// Returns the samples as the table that `fit` reads.
    pub(crate) fn csv(&self) -> anyhow::Result<Vec<u8>> {
        let mut table = csv::Writer::from_writer(Vec::new());
        table.write_record([
            "time",
            "lat",
            "lon",
            "compass_deg",
            "gyro_deg",
            "satellite_deg",
            "sog_kn",
            "rate_of_turn_deg_min",
            "spread_deg",
            "windows",
            "cog_deg",
            "roll_deg",
            "roll_spread_deg",
            "temperature_c",
            "gyro_source",
            "satellite_source",
        ])?;
        for sample in &self.samples {
            table.write_record(record(sample))?;
        }
        Ok(table.into_inner()?)
    }
}

fn record(sample: &Sample) -> [String; 16] {
    let heading = |heading: Option<TrueHeading>| number(heading.map(TrueHeading::degrees), 3);
    let source =
        |source: Option<SourceId>| source.map_or(String::new(), |s| s.number().to_string());
    [
        sample.time.to_string(),
        number(Some(sample.position.lat_deg()), 5),
        number(Some(sample.position.lon_deg()), 5),
        number(Some(sample.compass.degrees()), 3),
        heading(sample.gyro),
        heading(sample.satellite),
        number(sample.sog_kn, 2),
        number(sample.rate_of_turn_deg_min, 2),
        number(sample.spread_deg, 3),
        sample.windows.to_string(),
        number(sample.cog.map(CourseOverGround::degrees), 2),
        number(sample.roll_deg, 2),
        number(sample.roll_spread_deg, 2),
        number(sample.temperature_c, 1),
        source(sample.gyro_source),
        source(sample.satellite_source),
    ]
}

/// Formats a number; an empty field is unknown, never zero.
fn number(value: Option<f64>, decimals: usize) -> String {
    value
        .map(|value| format!("{value:.decimals$}"))
        .unwrap_or_default()
}
