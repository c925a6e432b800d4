//! Change of the order's port call, announced to one firm.

use crate::work_orders::events::event::{Circumstances, Event, Headline};
use crate::work_orders::order_state::OrderState;
use crate::work_orders::payload::exchange::{Exchange, NamedFirm};
use crate::work_orders::payload::hours::Hours;
use crate::work_orders::payload::port_call::{CallChange, CallFit, in_both_zones, zone_of};
use crate::work_orders::{message_kinds, notice_kinds};
use binnacle_platform::outbox;
use serde::{Deserialize, Serialize};

/// Change of the order's port call, as one firm is informed of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CallMoved {
    /// Firm and text.
    #[serde(flatten)]
    pub exchange: Exchange,
    /// The change.
    pub call: CallChange,
}

impl Event for CallMoved {
    fn apply(&self, state: &mut OrderState) {
        state.port.get_or_insert_with(|| self.call.was.port.clone());
        state.call_change = Some(self.call.clone());
    }

    fn exchange(&self) -> Option<&Exchange> {
        Some(&self.exchange)
    }

    fn call_change(&self) -> Option<&CallChange> {
        Some(&self.call)
    }

    fn webhook(&self) -> Option<outbox::Kind> {
        Some(message_kinds::CALL_MOVED)
    }

    fn operator_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(self.headline())
    }

    fn firm_headline(&self, _circumstances: Circumstances) -> Option<Headline> {
        Some(self.headline())
    }

    fn is_repeated_per_firm(&self) -> bool {
        true
    }
}

impl CallMoved {
    /// An announcement to one firm of a call's change, for a job planned in these hours.
    pub(crate) fn new(firm: NamedFirm, call: CallChange, hours: Hours) -> CallMoved {
        let exchange = Exchange {
            text: Some(describe(&call, hours)),
            ..Exchange::with(firm)
        };
        CallMoved { exchange, call }
    }

    /// Headline for both sides.
    fn headline(&self) -> Headline {
        let words = match (&self.call.is, self.call.fit) {
            (None, _) => "the port call is withdrawn",
            (_, CallFit::Fits) => "the port call has moved",
            (_, CallFit::OtherHour) => "the port call has moved, another hour is needed",
            (_, CallFit::NeedsNewDay) => "the port call has moved, a new day is needed",
            (_, CallFit::NoCall) => "the port call is now at another port",
        };
        Headline::new(notice_kinds::CALL_MOVED, words)
    }
}

/// Describes a call's change, and what to agree on, in sentences.
fn describe(call: &CallChange, hours: Hours) -> String {
    let became = match &call.is {
        None => format!(
            "The port call at {}, {}, is withdrawn.",
            call.was.port,
            call.was.describe()
        ),
        Some(is) if is.port != call.was.port => format!(
            "The port call at {}, {}, is now at {}, {}.",
            call.was.port,
            call.was.describe(),
            is.port,
            is.describe()
        ),
        Some(is) if *is == call.was => {
            format!(
                "The port call at {} is planned again, {}.",
                is.port,
                is.describe()
            )
        }
        Some(is) => format!(
            "The port call at {} has moved: it was {}, and is {}.",
            is.port,
            call.was.describe(),
            is.describe()
        ),
    };
    let agreed = in_both_zones(hours.from, zone_of(&call.was.port));
    let what = match call.fit {
        CallFit::Fits => format!("The job's time, {agreed}, still lies in it."),
        CallFit::OtherHour => {
            format!("The job's day still lies in it, but not its hour, {agreed}: agree on another.")
        }
        CallFit::NeedsNewDay => {
            format!("The job's time, {agreed}, no longer lies in it: agree on a new day.")
        }
        CallFit::NoCall => {
            format!("The job's time, {agreed}, has no call: agree on another or cancel.")
        }
    };
    format!("{became} {what}")
}
