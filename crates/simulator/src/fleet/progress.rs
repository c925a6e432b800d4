//! Shows the progress of the fleet.

use super::server_api::{ServerApi, Uploads};
use binnacle_compass::time::Timestamp;
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{Duration, Instant};

const INTERVAL: Duration = Duration::from_secs(2);
/// A log needs fewer lines than a terminal.
const LOG_INTERVAL: Duration = Duration::from_secs(10);

/// The time of each ship.
#[derive(Debug)]
pub(super) struct Progress {
    from: Timestamp,
    until: Timestamp,
    began: Instant,
    times: Vec<AtomicI64>,
}

impl Progress {
    pub(super) fn new(ships: usize, from: Timestamp, until: Timestamp) -> Progress {
        let times = (0..ships).map(|_| AtomicI64::new(from.micros())).collect();
        Progress {
            from,
            until,
            began: Instant::now(),
            times,
        }
    }

    pub(super) fn set_time(&self, ship: usize, time: Timestamp) {
        self.times[ship].store(time.micros(), Ordering::Relaxed);
    }

    /// Prints a line at intervals, forever.
    pub(super) async fn show(&self, api: &ServerApi, vessels: &[String]) {
        let terminal = std::io::stderr().is_terminal();
        let mut ticks = tokio::time::interval(if terminal { INTERVAL } else { LOG_INTERVAL });
        loop {
            ticks.tick().await;
            let mut uploads = Uploads::default();
            for vessel in vessels {
                let found = api.uploads(vessel).await.unwrap_or_default();
                uploads.batches += found.batches;
                uploads.samples += found.samples;
            }
            print(terminal, &self.line(uploads));
        }
    }

    pub(super) fn finish(&self) {
        let took = self.began.elapsed().as_secs_f64();
        let days = self.until.seconds_since(self.from) / 86_400.0;
        let ships = self.times.len();
        let line = format!("{ships} ships have sailed {days:.1} days each in {took:.0} s");
        print(std::io::stderr().is_terminal(), &line);
        if std::io::stderr().is_terminal() {
            writeln!(std::io::stderr()).ok();
        }
    }

    fn line(&self, uploads: Uploads) -> String {
        let times = self.times.iter().map(|time| time.load(Ordering::Relaxed));
        let sailed_s = times
            .map(|time| (time - self.from.micros()) as f64 * 1e-6)
            .sum::<f64>();
        let mean_s = sailed_s / self.times.len() as f64;
        let whole_s = self.until.seconds_since(self.from);
        let speed = mean_s / self.began.elapsed().as_secs_f64().max(0.1);
        let date: String = self
            .from
            .plus_seconds(mean_s)
            .to_string()
            .chars()
            .take(10)
            .collect();
        format!(
            "{:3.0} %  {date}  {} samples in {} uploads  {speed:.0} times real time",
            100.0 * mean_s / whole_s,
            uploads.samples,
            uploads.batches,
        )
    }
}

fn print(terminal: bool, line: &str) {
    let mut out = std::io::stderr().lock();
    // A closed standard error is no reason to stop.
    if terminal {
        write!(out, "\r{line}\x1b[K").ok();
    } else {
        writeln!(out, "{line}").ok();
    }
    out.flush().ok();
}
