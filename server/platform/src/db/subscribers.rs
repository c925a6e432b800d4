//! Domain events, handled in the transaction that publishes them.
//!
//! A capability publishes its events without knowing the subscribers, which are registered
//! when the server is put together. A handler that fails rolls back the publisher's
//! transaction, so a subscriber may also reject an event.

use super::Tx;
use crate::error::Result;
use futures_util::future::BoxFuture;
use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::fmt;

/// Event that happens in a transaction.
pub trait DomainEvent: Any + Send + Sync {}

/// Function that handles an event in the publisher's transaction.
pub type Handler<E> = for<'a> fn(&'a mut Tx, &'a E) -> BoxFuture<'a, Result<()>>;

/// Handlers of each type of event, in the order in which they run.
#[derive(Default)]
pub struct Subscribers {
    /// Handlers by event type, each a `Handler` of that type.
    handlers: HashMap<TypeId, Vec<Box<dyn Any + Send + Sync>>>,
}

impl Subscribers {
    /// Adds a handler of an event.
    #[must_use]
    pub fn on<E: DomainEvent>(mut self, handler: Handler<E>) -> Subscribers {
        let handlers = self.handlers.entry(TypeId::of::<E>()).or_default();
        handlers.push(Box::new(handler));
        self
    }

    /// Returns the handlers of an event.
    pub(super) fn of<E: DomainEvent>(&self) -> impl Iterator<Item = Handler<E>> {
        let handlers = self.handlers.get(&TypeId::of::<E>());
        let handlers = handlers.into_iter().flatten();
        handlers.filter_map(|handler| handler.downcast_ref::<Handler<E>>().copied())
    }
}

impl fmt::Debug for Subscribers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "handlers of {} events", self.handlers.len())
    }
}
