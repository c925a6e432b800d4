//! State of the whole server: that of the platform and of single capabilities.

use crate::kinds::{message_kinds, notice_kinds, quotas};
use axum::extract::FromRef;
use binnacle_fleet::alerts;
use binnacle_orders::berth_session::CorrectorPlanSlots;
use binnacle_planning::notifications::NoticeKinds;
use binnacle_planning::schedule::PlanSlots;
use binnacle_platform::app::App;
use binnacle_platform::db::Workload;
use binnacle_platform::mail::TopicList;
use binnacle_platform::quotas::QuotaList;
use binnacle_platform::webhooks::MessageKinds;

/// State of every route; each handler takes the part it needs by [`FromRef`].
#[derive(Clone)]
pub struct ServerState {
    /// State of the platform.
    pub app: App,
    /// Slots for schedules being solved.
    pub plan_slots: PlanSlots,
    /// Slots for corrector plans being made.
    pub corrector_plan_slots: CorrectorPlanSlots,
    /// Kinds of messages that webhooks may subscribe to.
    pub message_kinds: MessageKinds,
    /// Kinds of notices that users choose a way of delivery for.
    pub notice_kinds: NoticeKinds,
}

impl ServerState {
    /// Creates the state of an idle server.
    pub fn new(app: App) -> ServerState {
        ServerState {
            app,
            plan_slots: PlanSlots::default(),
            corrector_plan_slots: CorrectorPlanSlots::default(),
            message_kinds: message_kinds(),
            notice_kinds: notice_kinds(),
        }
    }

    /// Returns the same state, by the database connections of a workload.
    #[must_use]
    pub fn for_workload(&self, workload: Workload) -> ServerState {
        ServerState {
            app: self.app.for_workload(workload),
            ..self.clone()
        }
    }
}

impl FromRef<ServerState> for App {
    fn from_ref(state: &ServerState) -> App {
        state.app.clone()
    }
}

impl FromRef<ServerState> for PlanSlots {
    fn from_ref(state: &ServerState) -> PlanSlots {
        state.plan_slots.clone()
    }
}

impl FromRef<ServerState> for CorrectorPlanSlots {
    fn from_ref(state: &ServerState) -> CorrectorPlanSlots {
        state.corrector_plan_slots.clone()
    }
}

impl FromRef<ServerState> for MessageKinds {
    fn from_ref(state: &ServerState) -> MessageKinds {
        state.message_kinds.clone()
    }
}

impl FromRef<ServerState> for NoticeKinds {
    fn from_ref(state: &ServerState) -> NoticeKinds {
        state.notice_kinds.clone()
    }
}

impl FromRef<ServerState> for QuotaList {
    fn from_ref(_: &ServerState) -> QuotaList {
        quotas()
    }
}

impl FromRef<ServerState> for TopicList {
    fn from_ref(_: &ServerState) -> TopicList {
        alerts::TOPIC_LIST
    }
}
