//! The live status, for the page and `status`.

use super::Agent;
use crate::alert::{AlertRecord, HeadingDifference};
use crate::status::{InputReport, Status, offline_status};
use binnacle_instruments::Latest;
use tokio::time::Instant;

impl Agent {
    /// Builds the live status.
    pub(super) async fn build_status(&mut self) -> Status {
        let now = Instant::now();
        let stale = self.silence.stale_s.duration();
        let (heading, card) = self.correct();
        let readings = &self.acquisition.readings;
        let mut status = offline_status(&self.spool).await.unwrap_or_default();
        status.running = true;
        status.built_at = Some(now);
        status.ship_time = self.acquisition.time();
        status.heading = heading;
        status.card = card;
        status.alert = self.alert_monitor.record().map(AlertRecord::status);
        let difference = self.difference_monitor.last();
        status.heading_difference = difference.map(HeadingDifference::status);
        status.position = Latest::within(readings.position, stale, now);
        status.gyro_deg = Latest::within(readings.gyro, stale, now);
        status.satellite_deg = Latest::within(readings.satellite, stale, now);
        status.sog_kn = Latest::within(readings.sog_kn, stale, now);
        status.rate_of_turn_deg_min = Latest::within(readings.rate_of_turn_deg_min, stale, now);
        status.roll_deg = Latest::within(readings.roll_deg, stale, now);
        status.model = self.model_status();
        status.exclusion = *self.exclusion.borrow();
        status.windows = self.windows.by_name();
        let inputs = self.inputs.iter();
        status.inputs = inputs
            .map(|(name, stats)| InputReport::new(name, stats.status()))
            .collect();
        status.link = self.uplink_handle.link.borrow().clone();
        status.raw_log = self.raw_log.status();
        status.sources = self.acquisition.sources(now);
        status.source_problems = self.acquisition.source_problems(now);
        status.gnss_interference = self.interference_monitor.status();
        status.clock_problem = self.acquisition.clock_problem();
        status.storage_problem = self.unstored.problem.as_ref().map(|problem| {
            let waiting = self.unstored.samples.len();
            format!("samples cannot be stored: {problem}; {waiting} wait in memory")
        });
        status
    }
}
