//! Registry of the kinds of messages, notices and live events, put together from those of each
//! capability in the order of the OpenAPI document.

use binnacle_fleet::{alerts, event_kinds as fleet_events};
use binnacle_orders::dispatch;
use binnacle_orders::firms;
use binnacle_orders::{event_kinds as orders_events, work_orders};
use binnacle_planning::notifications::{self, NoticeKinds};
use binnacle_planning::{calendar, event_kinds as planning_events, port_calls, reports};
use binnacle_platform::quotas::QuotaList;
use binnacle_platform::webhooks::{self, MessageKinds};
use binnacle_platform::{events, sign_in_watch, tokens, users};

/// Returns all kinds of messages of the server.
pub fn message_kinds() -> MessageKinds {
    let kinds = alerts::message_kinds::ALL
        .into_iter()
        .chain(work_orders::message_kinds::ALL)
        .chain([notifications::MESSAGE_KIND, reports::MESSAGE_KIND])
        .chain([webhooks::TEST]);
    MessageKinds::new(kinds, work_orders::message_kinds::SUBJECT)
}

/// Returns all kinds of notices of the server.
pub fn notice_kinds() -> NoticeKinds {
    notifications::NOTICE_KINDS
        .into_iter()
        .chain(work_orders::notice_kinds::ALL)
        .chain([alerts::NOTICE_KIND, sign_in_watch::NOTICE_KIND])
        .collect()
}

/// Returns all quotas of the server.
pub fn quotas() -> QuotaList {
    QuotaList::from_iter([
        users::QUOTA,
        tokens::QUOTA,
        webhooks::QUOTA,
        firms::QUOTA,
        calendar::QUOTA,
        port_calls::QUOTA,
        dispatch::MESSAGES_QUOTA,
    ])
}

/// Returns all kinds of live events of the server.
pub fn event_kinds() -> [events::Kind; 8] {
    [
        fleet_events::BATCH,
        fleet_events::MODEL,
        fleet_events::LOGBOOK,
        fleet_events::ALERT,
        orders_events::WORK_ORDER,
        planning_events::PORT_CALL,
        planning_events::SCHEDULE,
        fleet_events::NEED,
    ]
}
