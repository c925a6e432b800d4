//! A simulated voyage that feeds an agent, with its truth.

use crate::feed::{Feed, Pace};
use crate::process::program;
use anyhow::{Context, Result, ensure};
use binnacle_compass::time::Timestamp;
use serde::Deserialize;
use std::fs::File;
use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use tokio::process::Child;

/// A running simulator, and the bridge that forwards its sentences.
#[derive(Debug)]
pub struct Voyage {
    /// The bridge.
    pub feed: Feed,
    simulator: Child,
    truth: PathBuf,
}

/// The part of the simulator's truth that the tests need.
#[derive(Debug, Deserialize)]
pub struct Truth {
    /// The deviation on all headings at the voyage's end.
    pub at_the_end: Place,
}

/// The true deviation at a place.
#[derive(Debug, Deserialize)]
pub struct Place {
    /// Latitude, degrees north.
    pub lat: f64,
    /// Longitude, degrees east.
    pub lon: f64,
    /// Time.
    pub at: Timestamp,
    /// Variation, degrees, positive to the east.
    pub variation_deg: f64,
    /// Deviation by compass heading, evenly spaced from 0.
    pub rows: Vec<Row>,
}

/// The true deviation on a heading.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Row {
    /// Compass reading, degrees.
    pub compass_deg: f64,
    /// Deviation, degrees, positive to the east.
    pub deviation_deg: f64,
}

impl Voyage {
    /// Sails a scenario of this package with one ship, whose agent runs on this
    /// machine.
    ///
    /// # Errors
    /// Fails when the simulator cannot be started.
    pub async fn sail(scenario: &str, seed: u64, folder: &Path, pace: Pace) -> Result<Voyage> {
        Voyage::sail_at(Ipv4Addr::LOCALHOST.into(), scenario, seed, folder, pace).await
    }

    /// Sails a scenario with the instruments at an address.
    ///
    /// # Errors
    /// Fails when the simulator cannot be started, or there is no such address.
    pub async fn sail_at(
        instruments: IpAddr,
        scenario: &str,
        seed: u64,
        folder: &Path,
        pace: Pace,
    ) -> Result<Voyage> {
        let file = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("scenarios")
            .join(scenario);
        let truth = folder.join(format!("{scenario}.truth.json"));
        let mut command = program::command("binnacle-simulator")?;
        command.args([
            "voyage",
            "--seed",
            &seed.to_string(),
            "--out",
            "/proc/self/fd/1",
            "--scenario",
        ]);
        command.arg(file).arg("--truth").arg(&truth);
        let log = File::create(folder.join(format!("{scenario}.log")))?;
        let mut simulator = command.stdout(Stdio::piped()).stderr(log).spawn()?;
        let sentences = simulator
            .stdout
            .take()
            .context("standard output was asked for")?;
        let feed = Feed::start_at(instruments, sentences, pace).await?;
        Ok(Voyage {
            feed,
            simulator,
            truth,
        })
    }

    /// Returns the truth, once the voyage has ended.
    ///
    /// # Errors
    /// Fails when the simulator failed.
    pub async fn truth(&mut self) -> Result<Truth> {
        let status = self.simulator.wait().await?;
        ensure!(status.success(), "the simulator: {status}");
        let text = std::fs::read_to_string(&self.truth)?;
        serde_json::from_str(&text).with_context(|| self.truth.display().to_string())
    }
}

impl Place {
    /// Returns the true deviation on a heading, interpolated between rows.
    pub fn deviation_deg(&self, compass_deg: f64) -> f64 {
        let step = 360.0 / self.rows.len() as f64;
        let place = compass_deg.rem_euclid(360.0) / step;
        let row = |index: usize| self.rows[index % self.rows.len()].deviation_deg;
        let (below, part) = (place.floor() as usize, place.fract());
        row(below) * (1.0 - part) + row(below + 1) * part
    }
}
