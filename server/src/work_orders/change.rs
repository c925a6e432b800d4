//! A change of an order on its way into the database.
//!
//! What always holds: whoever changes an order holds its lock until the transaction
//! ends; the entry, what follows from it and the live event are that one transaction;
//! and the same request under the same key writes one entry.

use super::entry::{Author, Content};
use super::order::State;
use super::store::{self, Whole};
use crate::access::Writer;
use crate::app::App;
use crate::db::Tx;
use crate::error::{Error, Result};
use crate::events::{self, Event, Kind};
use crate::idempotency::Key;
use crate::ids::OrderId;
use crate::session;
use crate::time::Time;
use uuid::Uuid;

/// A request to change an order.
pub(super) struct Request<'a> {
    pub(super) app: &'a App,
    pub(super) writer: Writer,
    pub(super) order: OrderId,
    pub(super) key: Key,
    /// What tells it from another.
    pub(super) hash: Vec<u8>,
}

/// A change that has begun.
pub(super) struct Change<'a> {
    app: &'a App,
    pub(super) tx: Tx,
    pub(super) whole: Whole,
    pub(super) author: Author,
    pub(super) now: Time,
    /// The id of the entry to be written.
    pub(super) id: Uuid,
    told: Vec<Event>,
}

impl<'a> Request<'a> {
    /// The order as it is, and whether this request has been done already.
    pub(super) async fn look(&self) -> Result<(Whole, Option<Uuid>)> {
        let whole = store::whole(&self.app.db, self.writer.operator, self.order).await?;
        let done = self
            .key
            .find(&self.app.db, self.writer.operator, &self.hash)
            .await?;
        Ok((whole, done))
    }

    /// Begins to change it, unless it has gone on since it was looked at; none when this
    /// request has been done meanwhile.
    pub(super) async fn begin(self, seen: &Whole) -> Result<Option<Change<'a>>> {
        let now = self.app.clock.now().into();
        let mut tx = self.app.db.begin().await?;
        let whole = store::lock(&mut tx, seen.summary.vessel_id, self.order).await?;
        let wanted = Uuid::now_v7();
        let operator = self.writer.operator;
        let made = self
            .key
            .once(&mut tx, operator, &self.hash, wanted, now)
            .await?;
        if made != wanted {
            return Ok(None);
        }
        if whole.summary.last_seq != seen.summary.last_seq {
            return Err(Error::WrongState(
                "the order has gone on meanwhile: look at it again".to_owned(),
            ));
        }
        let author = Author {
            id: Some(self.writer.user.0),
            name: session::name_of(&mut tx, self.writer.user).await?,
        };
        Ok(Some(Change {
            app: self.app,
            tx,
            whole,
            author,
            now,
            id: wanted,
            told: Vec::new(),
        }))
    }
}

impl Change<'_> {
    /// Writes the entry.
    pub(super) async fn append(&mut self, content: Content) -> Result<()> {
        let (id, now) = (self.id, self.now);
        store::append(
            &mut self.tx,
            &mut self.whole,
            id,
            &self.author,
            now,
            content,
        )
        .await
    }

    /// Tells dashboards of something else that the change brings.
    pub(super) async fn tell(&mut self, kind: Kind) -> Result<()> {
        let vessel = self.whole.summary.vessel_id;
        let event = events::insert(&mut self.tx, vessel, kind, self.now).await?;
        self.told.push(event);
        Ok(())
    }

    /// Makes it durable, and tells the dashboards.
    pub(super) async fn commit(mut self) -> Result<()> {
        self.tell(Kind::WorkOrder).await?;
        self.tx.commit().await?;
        for event in self.told {
            self.app.publish(event);
        }
        self.app.work.notify_one();
        Ok(())
    }
}

impl Whole {
    /// Refuses what cannot be done to an order in its state.
    pub(super) fn must_be(&self, allowed: &[State], what: &str) -> Result<()> {
        if allowed.contains(&self.summary.state) {
            return Ok(());
        }
        let state = serde_json::to_value(self.summary.state)?;
        let state = state.as_str().unwrap_or_default().to_owned();
        Err(Error::WrongState(format!("the order is {state}: {what}")))
    }
}
