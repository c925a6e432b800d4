//! Announcement of committed events to the other processes on the same database.
//!
//! Invariants: events are announced after their commit, several in one notification. PostgreSQL
//! lets only one transaction with a notification commit at a time; no transaction that stores
//! anything waits for that.

use super::{CHANNEL, Event};
use crate::db::{Db, Pools, Result};
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, PoisonError};
use tokio::sync::Notify;
use uuid::Uuid;

/// Number of events in a notification: PostgreSQL's limit is 8,000 bytes, and an event has up
/// to 330.
const EVENTS_OF_NOTICE: usize = 20;

/// Committed events of this process that are not announced yet.
#[derive(Debug)]
pub struct Announcer {
    /// Id of this process, by which it knows its own notifications.
    process: Uuid,
    pending: Mutex<Vec<Event>>,
    wake: Notify,
}

/// Notification of PostgreSQL with events.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Notice {
    process: Uuid,
    events: Vec<Event>,
}

impl Default for Announcer {
    fn default() -> Announcer {
        Announcer {
            process: Uuid::new_v4(),
            pending: Mutex::default(),
            wake: Notify::new(),
        }
    }
}

impl Announcer {
    /// Adds a committed event. It takes the place of a pending one about the same.
    pub(crate) fn push(&self, event: Event) {
        let mut pending = self.pending.lock().unwrap_or_else(PoisonError::into_inner);
        pending.retain(|known| !known.is_about_the_same(&event));
        pending.push(event);
        self.wake.notify_one();
    }

    /// Waits for events that are pending.
    pub(crate) async fn wait(&self) {
        self.wake.notified().await;
    }

    /// Announces the pending events; they stay pending if that fails.
    ///
    /// # Errors
    /// Fails when the database does.
    pub async fn announce_pending(&self, db: &Db) -> Result<()> {
        let events = {
            let mut pending = self.pending.lock().unwrap_or_else(PoisonError::into_inner);
            std::mem::take(&mut *pending)
        };
        let announced = announce(db, self.process, &events).await;
        if announced.is_err() {
            for event in events {
                self.push(event);
            }
        }
        announced
    }

    /// Returns the events of a notification from another process.
    pub(crate) fn read(&self, text: &str) -> serde_json::Result<Vec<Event>> {
        let notice: Notice = serde_json::from_str(text)?;
        if notice.process == self.process {
            return Ok(Vec::new());
        }
        Ok(notice.events)
    }
}

/// Announces committed events of a command.
///
/// # Errors
/// Fails when the database does.
pub async fn announce_all(db: &Db, events: &[Event]) -> Result<()> {
    announce(db, Uuid::new_v4(), events).await
}

async fn announce(db: &Db, process: Uuid, events: &[Event]) -> Result<()> {
    let Pools::Postgres(pool) = db.pools() else {
        return Ok(());
    };
    for events in events.chunks(EVENTS_OF_NOTICE) {
        let notice = Notice {
            process,
            events: events.to_vec(),
        };
        let text = serde_json::to_string(&notice).expect("ids and words are JSON");
        sqlx::query("SELECT pg_notify($1, $2)")
            .bind(CHANNEL)
            .bind(text)
            .execute(pool)
            .await?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::events::Kind;
    use crate::ids::{EventId, OperatorId, VesselId};

    fn event(vessel: Uuid, kind: &'static str) -> Event {
        Event {
            id: EventId::new(),
            operator_id: OperatorId(Uuid::nil()),
            firm_id: None,
            about: None,
            vessel_id: VesselId(vessel),
            kind: Kind::new(kind),
        }
    }

    fn pending(announcer: &Announcer) -> Vec<Event> {
        announcer.pending.lock().unwrap().clone()
    }

    #[test]
    fn an_event_takes_the_place_of_a_pending_one_about_the_same() {
        let announcer = Announcer::default();
        let [one, other] = [Uuid::from_u128(1), Uuid::from_u128(2)];
        announcer.push(event(one, "batch"));
        announcer.push(event(other, "batch"));
        announcer.push(event(one, "model"));
        let last = event(one, "batch");
        announcer.push(last.clone());
        let pending = pending(&announcer);
        assert_eq!(pending.len(), 3);
        assert_eq!(pending[2], last);
    }

    #[test]
    fn a_process_ignores_its_own_notifications() {
        let announcer = Announcer::default();
        let notice = |process| {
            let events = vec![event(Uuid::from_u128(1), "batch")];
            serde_json::to_string(&Notice { process, events }).unwrap()
        };
        let own = notice(announcer.process);
        assert_eq!(announcer.read(&own).unwrap(), []);
        let foreign = notice(Uuid::new_v4());
        assert_eq!(announcer.read(&foreign).unwrap().len(), 1);
        assert!(announcer.read("{}").is_err());
    }

    #[test]
    fn a_full_notification_is_within_the_limit_of_postgresql() {
        let mut longest = event(Uuid::max(), "a_kind_with_quite_a_long_name_for_a_kind");
        longest.firm_id = Some(crate::ids::FirmId(Uuid::max()));
        longest.about = Some(Uuid::max());
        let notice = Notice {
            process: Uuid::max(),
            events: vec![longest; EVENTS_OF_NOTICE],
        };
        let bytes = serde_json::to_string(&notice).unwrap().len();
        assert!(bytes < 8000, "{bytes}");
    }
}
