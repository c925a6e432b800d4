//! Subscriptions: one table of the handlers of events, in the order in which they run, and of
//! questions.

use binnacle_fleet::vessels;
use binnacle_orders::work_orders;
use binnacle_planning::{calendar, notifications, port_calls, schedule};
use binnacle_platform::db::Subscribers;

/// Returns the handlers of every event and every question of the server.
pub fn subscribers() -> Subscribers {
    Subscribers::default()
        .on(work_orders::refuse_leave_of_service)
        .on(work_orders::refuse_amended_binnacle)
        .on(schedule::on_service_change)
        .on(schedule::on_particulars_change)
        .on(schedule::on_terms_change)
        .on(schedule::on_vessel_event)
        .on(calendar::delete_feeds)
        .on(calendar::delete_made)
        .on(notifications::create_notifications)
        .on(port_calls::note_berth_heading)
        .answer(vessels::find_owner)
        .answer(calendar::list_made)
}
