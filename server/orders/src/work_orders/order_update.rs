//! Change of an order, on its way into the database.
//!
//! Invariants: a change holds the order's lock until the transaction ends. The entry, its
//! consequences and the live events are that one transaction. The same request under the same key
//! writes one entry.

use crate::work_orders::events::OrderEvent;
use crate::work_orders::log::entry::Author;
use crate::work_orders::publish::OrderBefore;
use crate::work_orders::store::StoredOrder;
use crate::work_orders::{publish, store};
use binnacle_platform::access::PartyWriter;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::db::Tx;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::events::{self, Event, Kind};
use binnacle_platform::idempotency::Key;
use binnacle_platform::ids::{OrderId, VesselId};
use binnacle_platform::session;
use binnacle_platform::time::Time;
use uuid::Uuid;

/// Request to change an order.
pub(crate) struct OrderUpdate<'a> {
    pub(crate) app: &'a App,
    pub(crate) request: RequestContext,
    pub(crate) writer: PartyWriter,
    pub(crate) order: OrderId,
    pub(crate) key: Key,
    /// Hash that distinguishes the request from others.
    pub(crate) hash: Vec<u8>,
}

/// Change in an open transaction.
pub(crate) struct Change<'a> {
    app: &'a App,
    pub(crate) tx: Tx,
    pub(crate) stored: StoredOrder,
    pub(crate) author: Author,
    pub(crate) now: Time,
    /// Id of the next entry.
    pub(crate) id: Uuid,
    /// The order before the change.
    before: OrderBefore,
    live_events: Vec<Event>,
}

impl<'a> OrderUpdate<'a> {
    /// Loads the order, and the entry of this request if it was processed before.
    pub(crate) async fn load(&self) -> Result<(StoredOrder, Option<Uuid>)> {
        let tenant = self.writer.tenant;
        let stored = store::find(&self.app.db, tenant, self.order).await?;
        let db = &self.app.db;
        let done = store::find_written(&self.key, db, tenant, &stored.summary, &self.hash).await?;
        Ok((stored, done))
    }

    /// Begins the change, unless the order has changed since `seen`. `None` if this request was
    /// processed meanwhile.
    pub(crate) async fn begin(self, seen: &StoredOrder) -> Result<Option<Change<'a>>> {
        let begun = self.begin_on(seen.summary.vessel_id).await?;
        if let Some(change) = &begun
            && change.stored.summary.last_seq != seen.summary.last_seq
        {
            return Err(Error::WrongState(
                "the order has changed meanwhile: load it again".to_owned(),
            ));
        }
        Ok(begun)
    }

    /// Begins the change of an order of this vessel in its present state, which the caller must
    /// check. `None` if this request was processed before.
    pub(crate) async fn begin_on(self, vessel: VesselId) -> Result<Option<Change<'a>>> {
        let now = self.app.clock.now().into();
        let mut tx = self.request.begin().await?;
        let stored = store::lock(&mut tx, vessel, self.order).await?;
        let wanted = Uuid::now_v7();
        let tenant = self.writer.tenant;
        let (key, order) = (&self.key, &stored.summary);
        let written = store::write_once(key, &mut tx, tenant, order, &self.hash, wanted).await?;
        if written != wanted {
            return Ok(None);
        }
        let author = Author {
            id: Some(self.writer.user.0),
            name: session::name_of(&mut tx, self.writer.user).await?,
            firm_id: tenant.firm(),
        };
        Ok(Some(Change::new(self.app, tx, stored, author, now, wanted)))
    }
}

impl<'a> Change<'a> {
    pub(crate) fn new(
        app: &'a App,
        tx: Tx,
        stored: StoredOrder,
        author: Author,
        now: Time,
        id: Uuid,
    ) -> Change<'a> {
        Change {
            app,
            tx,
            before: OrderBefore::from_order(&stored),
            stored,
            author,
            now,
            id,
            live_events: Vec::new(),
        }
    }

    /// Begins a change by the server itself.
    pub(crate) async fn by_server(
        app: &'a App,
        vessel: VesselId,
        order: OrderId,
    ) -> Result<Change<'a>> {
        let now = app.clock.now().into();
        let mut tx = app.db.begin().await?;
        let stored = store::lock(&mut tx, vessel, order).await?;
        let author = Author::server();
        Ok(Change::new(app, tx, stored, author, now, Uuid::now_v7()))
    }

    /// Writes the next entry.
    pub(crate) async fn append(&mut self, content: OrderEvent) -> Result<()> {
        // The request's key stands for the first entry.
        let id = std::mem::replace(&mut self.id, Uuid::now_v7());
        let (tx, stored) = (&mut self.tx, &mut self.stored);
        store::append(tx, stored, id, &self.author, self.now, content).await
    }

    /// Adds a live event for something else that the change brings.
    pub(crate) async fn add_live_event(&mut self, kind: Kind) -> Result<()> {
        let vessel = self.stored.summary.vessel_id;
        let event = events::insert(&mut self.tx, vessel, kind, self.now).await?;
        self.live_events.push(event);
        Ok(())
    }

    /// Commits the change, and publishes its events.
    pub(crate) async fn commit(self) -> Result<()> {
        let app = self.app;
        let (tx, live_events) = self.finish().await?;
        tx.commit().await?;
        for event in live_events {
            app.publish(event);
        }
        app.work.notify_one();
        Ok(())
    }

    /// Ends the change in a transaction that goes on. After its commit the caller publishes the
    /// events and wakes the worker.
    pub(crate) async fn finish(mut self) -> Result<(Tx, Vec<Event>)> {
        let changes = publish::publish_changes(&mut self.tx, &self.stored, &self.before, self.now);
        let changes = changes.await?;
        self.live_events.extend(changes);
        Ok((self.tx, self.live_events))
    }
}
