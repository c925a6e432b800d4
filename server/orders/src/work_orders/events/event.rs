//! Duties of every event: state change, words, webhook and audience.

use crate::work_orders::message_kinds;
use crate::work_orders::offers::OfferState;
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::Exchange;
use crate::work_orders::payload::port_call::CallChange;
use crate::work_orders::summary::Summary;
use binnacle_platform::ids::FirmId;
use binnacle_platform::notices;
use binnacle_platform::outbox;

/// Event of a work order.
pub(crate) trait Event {
    /// Changes the state of the order.
    fn apply(&self, state: &mut OrderState);

    /// Changes the line of the order in lists, beyond what follows from its state.
    fn update_summary(&self, _summary: &mut Summary) {}

    /// Exchange with one firm, if the event is one.
    fn exchange(&self) -> Option<&Exchange> {
        None
    }

    /// Change of the port call, if the event is one.
    fn call_change(&self) -> Option<&CallChange> {
        None
    }

    /// Readers of the event.
    fn audience(&self) -> Audience {
        let exchange = self.exchange();
        exchange.map_or(Audience::Parties, |exchange| {
            Audience::Firm(exchange.firm.firm_id)
        })
    }

    /// Kind of the webhook message; `None` where none is sent.
    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::UPDATED)
    }

    /// Headline for the operator's people; `None` where they are not notified.
    fn operator_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        None
    }

    /// Headline for the firm's people; `None` where they are not notified.
    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        None
    }

    /// Author's own words, below the headline, with hours in the time of the order's port.
    fn quote(&self, port: &str) -> Option<String> {
        self.exchange().and_then(|exchange| exchange.quote(port))
    }

    /// Returns whether offers may change by it.
    fn changes_offers(&self) -> bool {
        false
    }

    /// Returns whether the log has one such entry for each firm: the operator is notified of
    /// the first alone.
    fn is_repeated_per_firm(&self) -> bool {
        false
    }
}

/// Readers of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Audience {
    /// The operator alone.
    Operator,
    /// The operator and one firm.
    Firm(FirmId),
    /// The operator and the firm that has the order.
    Parties,
}

impl Audience {
    /// Returns whether a firm that sees the order may see the event.
    pub(crate) fn includes(self, firm: FirmId) -> bool {
        match self {
            Audience::Operator => false,
            Audience::Firm(addressee) => addressee == firm,
            Audience::Parties => true,
        }
    }
}

/// Circumstances that decide the words of a notification.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circumstances {
    /// True if a member of a firm wrote the entry.
    pub by_firm: bool,
    /// State of the offer to the firm before the event.
    pub offer_before: Option<OfferState>,
}

/// Headline of a notification.
#[derive(Clone, Debug)]
pub(crate) struct Headline {
    /// Kind, by which people subscribe.
    pub kind: notices::DeclaredKind,
    /// Words between the vessel's name and the port.
    pub words: String,
}

impl Headline {
    /// A headline in these words.
    pub(crate) fn new(kind: notices::DeclaredKind, words: impl Into<String>) -> Headline {
        Headline {
            kind,
            words: words.into(),
        }
    }
}
