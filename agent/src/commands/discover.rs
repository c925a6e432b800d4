//! The command `discover`: what is heard, and roles for it.

use crate::acquisition::Acquisition;
use crate::config::Config;
use crate::discovery::Discovery;
use binnacle_input::{InputConfig, InputStats, SharedEnds};
use binnacle_wire::messages::Settings;
use std::io::Write;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::{Instant, timeout_at};
use tokio_util::sync::CancellationToken;

/// Deliveries of observations that may wait.
const CHANNEL_CAPACITY: usize = 8;

pub(super) async fn discover(config: Config, listen: Duration, json: bool) -> anyhow::Result<()> {
    let mut acquisition =
        Acquisition::new(&config.roles, &config.silence, Settings::default(), None);
    let is_recorded = |input: &InputConfig| matches!(input, InputConfig::File(_));
    if !config.inputs.is_empty() && config.inputs.values().all(is_recorded) {
        acquisition.set_recorded();
    }
    let shutdown = CancellationToken::new();
    let (tx, mut observations) = mpsc::channel(CHANNEL_CAPACITY);
    let mut inputs = Vec::new();
    for (name, input) in config.inputs {
        let stats = Arc::new(InputStats::default());
        inputs.push((name.clone(), Arc::clone(&stats)));
        let shared = SharedEnds::default();
        binnacle_input::spawn(
            name.into(),
            input,
            shared,
            tx.clone(),
            stats,
            shutdown.clone(),
        );
    }
    // Recordings end; other inputs do not.
    drop(tx);
    let end = Instant::now() + listen;
    while let Ok(Some(more)) = timeout_at(end, observations.recv()).await {
        let heard = Instant::now();
        for seen in &more {
            acquisition.observe(seen, heard);
        }
        // Nothing is sampled here.
        acquisition.sampler.take_samples();
        acquisition.sampler.take_settled();
    }
    let closed = inputs.iter().filter_map(|(name, stats)| {
        let status = stats.status();
        let problem = status.problem.filter(|_| status.bytes == 0)?;
        Some(format!("{name}: {problem}"))
    });
    let closed: Vec<String> = closed.collect();
    shutdown.cancel();
    let discovery = Discovery::of(&acquisition, closed, Instant::now());
    let text = if json {
        serde_json::to_string_pretty(&discovery)? + "\n"
    } else {
        discovery.text()
    };
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(())
}
