//! Compares the server's models with the truth.
//!
//! A model holds when its 95 % band at the ship's own place contains the true
//! deviation on nine headings of ten. The truth is that of the compass's user:
//! true heading less variation less compass reading, with the lubber line and
//! without noise.

use super::agent::Vessel;
use super::run::Run;
use super::server_api::{Predicted, ServerApi, Uploads};
use super::simulated_ship::SimulatedShip;
use anyhow::{Result, bail};
use binnacle_compass::angle::wrap_180;
use binnacle_compass::time::Timestamp;
use binnacle_simulator::truth::Place;
use serde::Serialize;
use std::fmt::Write as _;
use std::io::Write as _;
use std::time::{Duration, Instant};

const MIN_HEADINGS_IN_BAND: f64 = 0.9;
const POLL_INTERVAL: Duration = Duration::from_secs(1);
/// Time for the server to catch up after the last change.
const TIMEOUT: Duration = Duration::from_mins(3);
/// After this long without change, a model of older data is final.
const QUIET_TIME: Duration = Duration::from_secs(30);
/// Sentences are sent once a minute in port.
const READ_TOLERANCE_S: f64 = 150.0;

/// The comparison of all vessels.
#[derive(Debug, Serialize)]
pub(super) struct Comparison {
    scenario: String,
    seed: u64,
    from: Timestamp,
    until: Timestamp,
    holds: bool,
    vessels: Vec<VesselComparison>,
}

/// The comparison of one vessel.
#[derive(Debug, Serialize)]
struct VesselComparison {
    name: String,
    vessel_id: String,
    batches: u64,
    samples: u64,
    model_version: Option<u64>,
    lat: f64,
    lon: f64,
    at: Timestamp,
    headings: usize,
    in_band: usize,
    holds: bool,
    worst_error_deg: Option<f64>,
    mean_band_deg: Option<f64>,
    rows: Vec<HeadingComparison>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct HeadingComparison {
    compass_deg: f64,
    true_deviation_deg: f64,
    deviation_deg: f64,
    band95_deg: Option<f64>,
    in_band: bool,
}

/// Waits for the server and compares every vessel.
pub(super) async fn compare_fleet(
    run: &Run<'_>,
    api: &ServerApi,
    vessels: &[Vessel],
    fleet: &[SimulatedShip],
) -> Result<Comparison> {
    let mut compared = Vec::new();
    for vessel in vessels {
        wait_for(api, vessel, run.until).await?;
    }
    for (vessel, ship) in vessels.iter().zip(fleet) {
        compared.push(compare(api, vessel, &ship.place()).await?);
    }
    Ok(Comparison {
        scenario: run.scenario.name.clone(),
        seed: run.seed,
        from: run.from,
        until: run.until,
        holds: compared.iter().all(|vessel| vessel.holds),
        vessels: compared,
    })
}

/// Waits until the agent has sent its sealed batches and the model includes
/// them.
async fn wait_for(api: &ServerApi, vessel: &Vessel, until: Timestamp) -> Result<()> {
    writeln!(
        std::io::stderr(),
        "waiting for the model of {}",
        vessel.name
    )?;
    let mut last = None;
    let mut moved = Instant::now();
    loop {
        let state = read_state(api, vessel, until).await?;
        if state.settled {
            return Ok(());
        }
        if last.as_ref() != Some(&state) {
            moved = Instant::now();
        }
        if state.sent && moved.elapsed() > QUIET_TIME {
            return Ok(());
        }
        if moved.elapsed() > TIMEOUT {
            bail!(
                "{}: no progress for {} s: {state:?}",
                vessel.name,
                TIMEOUT.as_secs()
            );
        }
        last = Some(state);
        tokio::time::sleep(POLL_INTERVAL).await;
    }
}

/// The progress of a vessel's data.
#[derive(Debug, PartialEq, Eq)]
struct DataState {
    ship_time: Option<Timestamp>,
    waiting_batches: Option<u64>,
    uploads: Uploads,
    model: Option<(u64, Timestamp)>,
    /// Every sealed batch is on the server.
    sent: bool,
    /// Everything is sent, and the model includes it.
    settled: bool,
}

async fn read_state(api: &ServerApi, vessel: &Vessel, until: Timestamp) -> Result<DataState> {
    // The agent may be restarting.
    let status = api.agent_status(vessel.page).await.unwrap_or_default();
    let ship_time = status["ship_time"]
        .as_str()
        .and_then(|time| Timestamp::parse(time).ok());
    let waiting_batches = status["spool"]["waiting_batches"].as_u64();
    if let Some(parked) = status["spool"]["parked_batches"]
        .as_u64()
        .filter(|&parked| parked > 0)
    {
        let because = status["spool"]["parked_because"]
            .as_str()
            .unwrap_or("no reason given");
        bail!(
            "{}: the server refused {parked} batches: {because}",
            vessel.name
        );
    }
    let vessel_state = api.vessel(&vessel.id).await?;
    let uploads = api.uploads(&vessel.id).await?;
    let model = vessel_state
        .model
        .map(|model| (model.version, model.data_until));
    let read_all = ship_time.is_some_and(|time| until.seconds_since(time) < READ_TOLERANCE_S);
    let sent = read_all && waiting_batches == Some(0);
    let newest = vessel_state.last_position.map(|position| position.at);
    let knows_all = match (&model, newest) {
        (Some((_, data_until)), Some(newest)) => *data_until >= newest,
        _ => false,
    };
    Ok(DataState {
        ship_time,
        waiting_batches,
        uploads,
        model,
        sent,
        settled: sent && knows_all,
    })
}

async fn compare(api: &ServerApi, vessel: &Vessel, truth: &Place) -> Result<VesselComparison> {
    let rows = api.deviation(&vessel.id, truth).await?.unwrap_or_default();
    let uploads = api.uploads(&vessel.id).await?;
    let version = api
        .vessel(&vessel.id)
        .await?
        .model
        .map(|model| model.version);
    let compared: Vec<HeadingComparison> = truth
        .rows
        .iter()
        .filter_map(|truth| {
            let predicted = rows
                .iter()
                .find(|row| wrap_180(row.compass_deg - truth.compass_deg).abs() < 0.01)?;
            Some(compare_row(predicted, truth.deviation_deg))
        })
        .collect();
    let errors = compared
        .iter()
        .map(|row| row.deviation_deg - row.true_deviation_deg);
    let worst = errors.map(|error| wrap_180(error).abs()).reduce(f64::max);
    let bands: Vec<f64> = compared.iter().filter_map(|row| row.band95_deg).collect();
    let mean = bands.iter().sum::<f64>() / bands.len() as f64;
    let in_band = compared.iter().filter(|row| row.in_band).count();
    let headings = truth.rows.len();
    Ok(VesselComparison {
        name: vessel.name.clone(),
        vessel_id: vessel.id.clone(),
        batches: uploads.batches,
        samples: uploads.samples,
        model_version: version,
        lat: truth.lat,
        lon: truth.lon,
        at: truth.at,
        headings,
        in_band,
        holds: in_band as f64 >= MIN_HEADINGS_IN_BAND * headings as f64,
        worst_error_deg: worst,
        mean_band_deg: (!bands.is_empty()).then_some(mean),
        rows: compared,
    })
}

fn compare_row(predicted: &Predicted, true_deviation_deg: f64) -> HeadingComparison {
    let error = wrap_180(predicted.deviation_deg - true_deviation_deg).abs();
    HeadingComparison {
        compass_deg: predicted.compass_deg,
        true_deviation_deg,
        deviation_deg: predicted.deviation_deg,
        band95_deg: predicted.band95_deg,
        in_band: predicted.band95_deg.is_some_and(|band| error <= band),
    }
}

impl Comparison {
    pub(super) fn holds(&self) -> bool {
        self.holds
    }

    /// Returns a table for people.
    pub(super) fn table(&self) -> String {
        let mut text = String::new();
        self.write_table(&mut text)
            .expect("a string takes every write");
        text
    }

    fn write_table(&self, out: &mut String) -> std::fmt::Result {
        let degrees = |value: Option<f64>| value.map_or("–".to_owned(), |v| format!("{v:.2}°"));
        writeln!(
            out,
            "\n{:<22} {:>8} {:>8} {:>12} {:>12} {:>10}",
            "vessel", "samples", "uploads", "in the band", "worst error", "mean band"
        )?;
        for vessel in &self.vessels {
            writeln!(
                out,
                "{:<22} {:>8} {:>8} {:>12} {:>12} {:>10}{}",
                vessel.name,
                vessel.samples,
                vessel.batches,
                format!("{} of {}", vessel.in_band, vessel.headings),
                degrees(vessel.worst_error_deg),
                degrees(vessel.mean_band_deg),
                match (vessel.model_version, vessel.holds) {
                    (None, _) => "  no model",
                    (_, false) => "  FAILS",
                    (_, true) => "",
                },
            )?;
        }
        let good = self.vessels.iter().filter(|vessel| vessel.holds).count();
        let all = self.vessels.len();
        let word = if self.holds { "holds" } else { "DOES NOT HOLD" };
        writeln!(
            out,
            "\nThe 95 % band {word}: it contains the truth on at least 90 % of headings for \
             {good} of {all} vessels, each at its own place.\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_truth_outside_the_band_or_without_one_is_not_held() {
        let predicted = |band95_deg| Predicted {
            compass_deg: 90.0,
            deviation_deg: 2.0,
            band95_deg,
        };
        assert!(compare_row(&predicted(Some(0.5)), 2.4).in_band);
        assert!(!compare_row(&predicted(Some(0.5)), 2.6).in_band);
        assert!(!compare_row(&predicted(None), 2.0).in_band);
    }
}
