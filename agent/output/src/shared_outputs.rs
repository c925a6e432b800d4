//! Outputs over the connections of inputs: to NMEA 2000 buses and Signal K servers.

use crate::config::OutputConfig;
use crate::heading::{Heading, Trigger};
use crate::n2k::{N2kOutput, OwnDevice};
use crate::signalk::SignalKOutput;
use binnacle_input::SharedEnds;
use binnacle_input::config::AddressOwner;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

/// Outputs that share the connections of inputs.
#[derive(Debug, Default)]
pub struct SharedOutputs {
    n2k: Vec<N2kOutput>,
    signalk: Vec<SignalKOutput>,
}

impl SharedOutputs {
    /// Starts the configured outputs, which run until `shutdown`. Returns also the ends of their
    /// connections, for the inputs by name. `owner` says whose address is used on an input's bus.
    pub fn start(
        config: &OutputConfig,
        owner: impl Fn(&str) -> AddressOwner,
        data_dir: &Path,
        shutdown: &CancellationToken,
    ) -> (SharedOutputs, BTreeMap<String, SharedEnds>) {
        let mut outputs = SharedOutputs::default();
        let mut ends: BTreeMap<String, SharedEnds> = BTreeMap::new();
        for bus in &config.n2k {
            let input = bus.input.get_ref();
            let (output, end) = N2kOutput::start(bus, owner(input), data_dir, shutdown);
            outputs.n2k.push(output);
            ends.entry(input.clone()).or_default().bus = Some(end);
        }
        for server in &config.signalk {
            let interval_s = server.interval_s.unwrap_or(config.interval_s).seconds();
            let (output, end) = SignalKOutput::new(server, interval_s);
            outputs.signalk.push(output);
            let input = server.input.get_ref().clone();
            ends.entry(input).or_default().deltas = Some(end);
        }
        (outputs, ends)
    }

    #[cfg(test)]
    pub(crate) fn n2k_outputs(&mut self) -> &mut [N2kOutput] {
        &mut self.n2k
    }

    /// Returns the devices that the agent itself is.
    pub fn own_devices(&self) -> Vec<OwnDevice> {
        self.n2k
            .iter()
            .filter_map(N2kOutput::own_device)
            .cloned()
            .collect()
    }

    /// Returns the `$source` of the values that it sends to servers.
    pub fn own_labels(&self) -> Vec<String> {
        let labels = self.signalk.iter().map(SignalKOutput::label);
        labels.map(str::to_owned).collect()
    }

    /// Returns the time of the next [`Trigger::Timer`], given the compass's own interval; none
    /// without an output.
    pub fn next_timer(&self, compass_interval: Duration, now: Instant) -> Option<Instant> {
        let buses = self.n2k.iter();
        let buses = buses.map(|output| output.next_timer(compass_interval, now));
        let servers = self.signalk.iter();
        let servers = servers.map(|output| output.next_timer(compass_interval, now));
        buses.chain(servers).min()
    }

    /// Sends the heading where it is due, without waiting.
    pub fn send(
        &mut self,
        heading: &Heading,
        trigger: Trigger,
        compass_interval: Duration,
        now: Instant,
    ) {
        for output in &mut self.n2k {
            output.send(heading, trigger, compass_interval, now);
        }
        for output in &mut self.signalk {
            output.send(heading, trigger, compass_interval, now);
        }
    }
}
