//! The corrected heading on an NMEA 2000 bus: 127250 and 127258, from an address of its own.
//!
//! 127250 carries the corrected heading itself. Counted from magnetic north its deviation is 0:
//! nothing is left to apply, and a receiver that does not know the field steers by the same heading.
//!
//! Invariants:
//!
//! - While the heading is withheld, 127250 has none.
//! - A heading that was not sent in time is replaced by the next one.
//! - Nothing but the claim is sent before the claim has stood.

mod identity;
mod node;

use crate::config::{N2kHeading, N2kOutputConfig};
use crate::heading::{Heading, Schedule, Trigger};
use binnacle_compass::angle::{MagneticHeading, TrueHeading, Variation};
use binnacle_input::PortEnd;
use binnacle_input::config::AddressOwner;
use binnacle_nmea::n2k::{Address, Message, Name, Reference, VesselHeading, variation_message};
use identity::Identity;
use node::Node;
use std::path::Path;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

/// Seconds between two variations, by the standard.
const VARIATION_INTERVAL_S: f64 = 1.0;

/// Device on a bus that the agent itself is.
#[derive(Clone, Debug)]
pub struct OwnDevice {
    /// Input whose connection it shares.
    pub input: String,
    /// Its NAME.
    pub name: Name,
    /// Its address, while it has one.
    pub address: watch::Receiver<Option<Address>>,
}

/// Heading for a bus.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct BusHeading {
    magnetic: Option<MagneticHeading>,
    true_heading: Option<TrueHeading>,
    variation: Option<Variation>,
    /// Set if the variation is due as well.
    sends_variation: bool,
}

impl BusHeading {
    /// Returns the messages from an address, with the number of their measurement.
    fn messages(&self, config: &N2kOutputConfig, source: Address, sequence: u8) -> Vec<Message> {
        let mut messages = Vec::new();
        let variation_deg_east = self.variation.map(Variation::degrees_east);
        let is_withheld = self.true_heading.is_none();
        if config.heading != N2kHeading::True {
            let heading = VesselHeading {
                deg: self.magnetic.map(MagneticHeading::degrees),
                reference: Reference::Magnetic,
                deviation_deg_east: (!is_withheld).then_some(0.0),
                variation_deg_east: variation_deg_east.filter(|_| !is_withheld),
            };
            messages.push(heading.message(source, sequence));
        }
        if config.heading != N2kHeading::Magnetic {
            let heading = VesselHeading {
                deg: self.true_heading.map(TrueHeading::degrees),
                reference: Reference::True,
                deviation_deg_east: None,
                variation_deg_east: None,
            };
            messages.push(heading.message(source, sequence));
        }
        if self.sends_variation {
            messages.push(variation_message(variation_deg_east, source, sequence));
        }
        messages
    }
}

/// Output to a bus.
#[derive(Debug)]
pub(crate) struct N2kOutput {
    schedule: Schedule,
    variation: Option<Schedule>,
    newest: watch::Sender<BusHeading>,
    own_device: Option<OwnDevice>,
}

impl N2kOutput {
    /// Starts an output that runs until `shutdown`. Returns the input's end of the connection too.
    pub(crate) fn start(
        config: &N2kOutputConfig,
        owner: AddressOwner,
        data_dir: &Path,
        shutdown: &CancellationToken,
    ) -> (N2kOutput, PortEnd<Message>) {
        let input = config.input.get_ref();
        let identity = Identity::load(data_dir, input);
        let (port, end) = binnacle_input::Port::new();
        let (newest, headings) = watch::channel(BusHeading::default());
        let (address, own_address) = watch::channel(None);
        let own_device = (owner == AddressOwner::Agent).then(|| OwnDevice {
            input: input.clone(),
            name: identity.device().name(),
            address: own_address,
        });
        let node = Node {
            config: config.clone(),
            owner,
            identity,
            port,
            headings,
            address,
        };
        let shutdown = shutdown.clone();
        tokio::spawn(async move { shutdown.run_until_cancelled(node.run()).await });
        let output = N2kOutput {
            schedule: Schedule::new(config.interval_s()),
            variation: config
                .variation
                .then(|| Schedule::new(VARIATION_INTERVAL_S.max(config.interval_s()))),
            newest,
            own_device,
        };
        (output, end)
    }

    /// Returns the device that the agent itself is; none where that is the gateway.
    pub(crate) fn own_device(&self) -> Option<&OwnDevice> {
        self.own_device.as_ref()
    }

    /// Returns the time of the next [`Trigger::Timer`].
    pub(crate) fn next_timer(&self, compass_interval: Duration, now: Instant) -> Instant {
        self.schedule.timer(compass_interval).unwrap_or(now)
    }

    /// Sends the heading if it is due.
    pub(crate) fn send(
        &mut self,
        heading: &Heading,
        trigger: Trigger,
        compass_interval: Duration,
        now: Instant,
    ) {
        let is_due =
            |schedule: &mut Schedule| schedule.take_due(heading, trigger, compass_interval, now);
        if !is_due(&mut self.schedule) {
            return;
        }
        let sends_variation = self.variation.as_mut().is_some_and(is_due);
        self.newest.send_replace(BusHeading {
            magnetic: heading.magnetic(),
            true_heading: heading.true_heading,
            variation: heading.variation,
            sends_variation,
        });
    }
}

#[cfg(test)]
mod tests;
