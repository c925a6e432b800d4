//! The agent as a device on a bus: it claims an address, meets requests, beats, and sends headings.

use super::BusHeading;
use super::identity::Identity;
use crate::config::N2kOutputConfig;
use binnacle_input::config::AddressOwner;
use binnacle_input::{Port, PortEvent};
use binnacle_nmea::n2k::{
    Address, AddressClaim, CLAIM_TIME, ClaimState, HEARTBEAT_INTERVAL, Message,
};
use tokio::sync::watch;
use tokio::time::{Instant, sleep_until};

/// Device on one bus.
#[derive(Debug)]
pub(super) struct Node {
    pub(super) config: N2kOutputConfig,
    pub(super) owner: AddressOwner,
    pub(super) identity: Identity,
    pub(super) port: Port<Message>,
    pub(super) headings: watch::Receiver<BusHeading>,
    /// Address, for those that must know the device.
    pub(super) address: watch::Sender<Option<Address>>,
}

/// State of the connection.
enum Link {
    Closed,
    /// The gateway has an address; each message gets it there.
    Gateways(Address),
    Own(Box<OwnAddress>),
}

/// Claim, and the time of what follows it: its confirmation, then heartbeats.
struct OwnAddress {
    claim: AddressClaim,
    next: Instant,
}

impl Node {
    /// Runs until the input or the output has ended.
    pub(super) async fn run(mut self) {
        let mut link = Link::Closed;
        let mut sequence = 0_u8;
        loop {
            let next = match &link {
                Link::Own(own) => Some(own.next),
                Link::Closed | Link::Gateways(_) => None,
            };
            tokio::select! {
                event = self.port.events.recv() => {
                    let Some(event) = event else { return };
                    self.observe(event, &mut link);
                }
                () = until(next) => {
                    if let Link::Own(own) = &mut link {
                        self.continue_claim(own);
                    }
                }
                changed = self.headings.changed() => {
                    if changed.is_err() {
                        return;
                    }
                    let heading = *self.headings.borrow_and_update();
                    let source = match &link {
                        Link::Closed => None,
                        Link::Gateways(address) => Some(*address),
                        Link::Own(own) => own.claim.address(),
                    };
                    if let Some(source) = source {
                        self.send(heading.messages(&self.config, source, sequence));
                        sequence = (sequence + 1) % 253;
                    }
                }
            }
        }
    }

    fn observe(&mut self, event: PortEvent<Message>, link: &mut Link) {
        match event {
            PortEvent::Opened => *link = self.open(),
            PortEvent::Closed => {
                *link = Link::Closed;
                self.address.send_replace(None);
            }
            PortEvent::Received(message) => {
                let Link::Own(own) = link else { return };
                let before = own.claim.state();
                let responses = own.claim.observe(&message);
                if own.claim.state() != before {
                    self.address.send_replace(own.claim.address());
                    own.next = Instant::now() + CLAIM_TIME;
                    if own.claim.state() == ClaimState::Lost {
                        let input = self.config.input.get_ref();
                        tracing::warn!(input, "no address is free on the bus");
                    }
                }
                self.send(responses);
            }
        }
    }

    fn open(&mut self) -> Link {
        let Some(address) = self.identity.address() else {
            return Link::Closed;
        };
        if self.owner == AddressOwner::Gateway {
            return Link::Gateways(address);
        }
        let (claim, messages) = AddressClaim::begin(self.identity.device(), address);
        self.send(messages);
        let next = Instant::now() + CLAIM_TIME;
        Link::Own(Box::new(OwnAddress { claim, next }))
    }

    /// Confirms a claim that has stood, or sends the heartbeat.
    fn continue_claim(&mut self, own: &mut OwnAddress) {
        if own.claim.state() == ClaimState::Claiming {
            own.claim.confirm();
            if let Some(address) = own.claim.address() {
                self.identity.keep(address);
                self.address.send_replace(Some(address));
                let input = self.config.input.get_ref();
                tracing::info!(input, %address, "the agent has an address on the bus");
            }
        }
        self.send(own.claim.next_heartbeat());
        own.next = Instant::now() + HEARTBEAT_INTERVAL;
    }

    fn send(&self, messages: impl IntoIterator<Item = Message>) {
        for message in messages {
            let pgn = message.header.pgn;
            if !self.port.send(message) {
                tracing::debug!(pgn, "the bus takes no message");
            }
        }
    }
}

async fn until(time: Option<Instant>) {
    match time {
        Some(time) => sleep_until(time).await,
        None => std::future::pending().await,
    }
}
