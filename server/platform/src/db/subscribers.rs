//! Domain events and questions, handled in the transaction that publishes or asks them.
//!
//! A capability publishes its events without knowing the subscribers, which are registered
//! when the server is put together. A handler that fails rolls back the publisher's
//! transaction, so a subscriber may also reject an event. A question is answered by one
//! capability, which the asking one does not know either.

use super::Tx;
use crate::db;
use crate::error::Result;
use futures_util::future::BoxFuture;
use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::fmt;

/// Event that happens in a transaction.
pub trait DomainEvent: Any + Send + Sync {}

/// Function that handles an event in the publisher's transaction.
pub type Handler<E> = for<'a> fn(&'a mut Tx, &'a E) -> BoxFuture<'a, Result<()>>;

/// Question about data that another capability owns.
pub trait Question: Any + Send + Sync {
    /// Answer to the question.
    type Answer;
}

/// Function that answers a question in the transaction that asks it.
pub type Answerer<Q> =
    for<'a> fn(&'a mut Tx, &'a Q) -> BoxFuture<'a, db::Result<<Q as Question>::Answer>>;

/// Handlers of each type of event, in the order in which they run, and of each question.
#[derive(Default)]
pub struct Subscribers {
    /// Handlers by event type, each a `Handler` of that type.
    handlers: HashMap<TypeId, Vec<Box<dyn Any + Send + Sync>>>,
    /// Handlers by question type, each an `Answerer` of that type.
    answerers: HashMap<TypeId, Box<dyn Any + Send + Sync>>,
}

impl Subscribers {
    /// Adds a handler of an event.
    #[must_use]
    pub fn on<E: DomainEvent>(mut self, handler: Handler<E>) -> Subscribers {
        let handlers = self.handlers.entry(TypeId::of::<E>()).or_default();
        handlers.push(Box::new(handler));
        self
    }

    /// Sets the handler of a question.
    #[must_use]
    pub fn answer<Q: Question>(mut self, answerer: Answerer<Q>) -> Subscribers {
        self.answerers.insert(TypeId::of::<Q>(), Box::new(answerer));
        self
    }

    /// Returns the handlers of an event.
    pub(super) fn of<E: DomainEvent>(&self) -> impl Iterator<Item = Handler<E>> {
        let handlers = self.handlers.get(&TypeId::of::<E>());
        let handlers = handlers.into_iter().flatten();
        handlers.filter_map(|handler| handler.downcast_ref::<Handler<E>>().copied())
    }

    /// Returns the handler of a question, if there is one.
    pub(super) fn to<Q: Question>(&self) -> Option<Answerer<Q>> {
        let answerer = self.answerers.get(&TypeId::of::<Q>())?;
        answerer.downcast_ref::<Answerer<Q>>().copied()
    }
}

impl fmt::Debug for Subscribers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (events, questions) = (self.handlers.len(), self.answerers.len());
        write!(f, "handlers of {events} events and {questions} questions")
    }
}
