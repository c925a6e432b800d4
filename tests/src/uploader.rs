//! An agent without a ship: the test itself makes its batches and sends them.

use crate::server_process::ServerProcess;
use anyhow::{Context, Result};
use binnacle_compass::angle::{CompassHeading, TrueHeading};
use binnacle_compass::position::Position;
use binnacle_compass::sample::Sample;
use binnacle_compass::time::Timestamp;
use binnacle_wire::batch::{Batch, StreamId};
use binnacle_wire::encode;
use binnacle_wire::messages::{EnrolRequest, EnrolResponse};
use reqwest::Method;
use std::collections::BTreeMap;

/// Seconds between two samples.
const EVERY_S: f64 = 600.0;

/// An enrolled agent's identity.
#[derive(Clone, Debug)]
pub struct Uploader {
    /// Id of the vessel.
    pub vessel: String,
    /// The agent's token.
    pub token: String,
    /// Its stream of batches.
    pub stream: StreamId,
}

impl Uploader {
    /// Creates a vessel and enrols an agent for it.
    ///
    /// # Errors
    /// Fails when the server refuses.
    pub async fn enrol(server: &ServerProcess, name: &str) -> Result<Uploader> {
        let (vessel, code) = server.create_vessel(name).await?;
        let request = EnrolRequest {
            code,
            agent_version: "0.0.0".to_owned(),
        };
        let answer = server
            .anonymous(Method::POST, "/agents/enrol")
            .json(&request)
            .send()
            .await?;
        let answer: EnrolResponse = answer.error_for_status()?.json().await?;
        Ok(Uploader {
            vessel,
            token: answer.token,
            stream: answer.stream,
        })
    }
}

/// Returns samples at sea on a slowly turning heading, the first `skipped` of them left out.
///
/// # Errors
/// Fails when a heading is out of range, which is a fault of this function.
pub fn samples(skipped: usize, count: usize) -> Result<Vec<Sample>> {
    let start = Timestamp::parse("2026-11-20T00:00:05Z")?;
    let position = Position::new(48.0, -6.0).context("a position")?;
    let sample = |i: usize| {
        let heading = (31.0 * i as f64).rem_euclid(360.0);
        let compass = CompassHeading::new(heading).context("a heading")?;
        Ok(Sample {
            gyro: TrueHeading::new(heading - 3.0),
            sog_kn: Some(12.0),
            spread_deg: Some(0.3),
            windows: 60,
            ..Sample::new(start.plus_seconds(EVERY_S * i as f64), position, compass)
        })
    };
    (skipped..skipped + count).map(sample).collect()
}

/// Encodes a batch.
///
/// # Errors
/// Fails when the samples cannot be encoded.
pub fn frame(stream: StreamId, seq: u64, samples: Vec<Sample>) -> Result<Vec<u8>> {
    Ok(encode(&Batch {
        stream,
        seq,
        samples,
        tally: BTreeMap::new(),
        alerts: Vec::new(),
        thinned: None,
    })?)
}
