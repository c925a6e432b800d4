//! A change of an order on its way into the database.
//!
//! What always holds: whoever changes an order holds its lock until the transaction
//! ends; the entry, what follows from it and the live event are that one transaction;
//! and the same request under the same key writes one entry.

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

/// A request to change an order.
pub(crate) struct OrderUpdate<'a> {
    pub(crate) app: &'a App,
    pub(crate) request: RequestContext,
    pub(crate) writer: PartyWriter,
    pub(crate) order: OrderId,
    pub(crate) key: Key,
    /// What tells it from another.
    pub(crate) hash: Vec<u8>,
}

/// A change that has begun.
pub(crate) struct Change<'a> {
    app: &'a App,
    pub(crate) tx: Tx,
    pub(crate) stored: StoredOrder,
    pub(crate) author: Author,
    pub(crate) now: Time,
    /// The id of the entry to be written.
    pub(crate) id: Uuid,
    /// The order before.
    before: OrderBefore,
    told: Vec<Event>,
}

impl<'a> OrderUpdate<'a> {
    /// The order as it is, and whether this request has been done already.
    pub(crate) async fn look(&self) -> Result<(StoredOrder, Option<Uuid>)> {
        let tenant = self.writer.tenant;
        let stored = store::find(&self.app.db, tenant, self.order).await?;
        let db = &self.app.db;
        let done = store::find_written(&self.key, db, tenant, &stored.summary, &self.hash).await?;
        Ok((stored, done))
    }

    /// Begins to change it, unless it has gone on since it was looked at; none when this
    /// request has been done meanwhile.
    pub(crate) async fn begin(self, seen: &StoredOrder) -> Result<Option<Change<'a>>> {
        let begun = self.begin_on(seen.summary.vessel_id).await?;
        if let Some(change) = &begun
            && change.stored.summary.last_seq != seen.summary.last_seq
        {
            return Err(Error::WrongState(
                "the order has gone on meanwhile: look at it again".to_owned(),
            ));
        }
        Ok(begun)
    }

    /// Begins to change an order of a vessel's as it is now, without having looked before:
    /// whoever does has to look at what is in the change.
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
            before: OrderBefore::of(&stored),
            stored,
            author,
            now,
            id,
            told: Vec::new(),
        }
    }

    /// A change that nobody asked for.
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
        // The first entry is the one that the request's key stands for.
        let id = std::mem::replace(&mut self.id, Uuid::now_v7());
        let (tx, stored) = (&mut self.tx, &mut self.stored);
        store::append(tx, stored, id, &self.author, self.now, content).await
    }

    /// Tells dashboards of something else that the change brings.
    pub(crate) async fn tell(&mut self, kind: Kind) -> Result<()> {
        let vessel = self.stored.summary.vessel_id;
        let event = events::insert(&mut self.tx, vessel, kind, self.now).await?;
        self.told.push(event);
        Ok(())
    }

    /// Makes it durable, and tells both sides.
    pub(crate) async fn commit(self) -> Result<()> {
        let app = self.app;
        let (tx, told) = self.finish().await?;
        tx.commit().await?;
        for event in told {
            app.publish(event);
        }
        app.work.notify_one();
        Ok(())
    }

    /// Ends it in a transaction that goes on; the events are to be published, and the work
    /// that follows to be woken, once that is committed.
    pub(crate) async fn finish(mut self) -> Result<(Tx, Vec<Event>)> {
        let news = publish::publish_changes(&mut self.tx, &self.stored, &self.before, self.now);
        let news = news.await?;
        self.told.extend(news);
        Ok((self.tx, self.told))
    }
}
