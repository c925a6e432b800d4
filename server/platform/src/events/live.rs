//! Channel from the publishers of events to the dashboards of one process.

use super::Event;
use tokio::sync::broadcast::{Receiver, Sender};

/// Events that a slow dashboard may lag behind before it must read them again.
const BUFFERED: usize = 256;

/// Live event channel of this process.
#[derive(Clone, Debug)]
pub struct Live(Sender<Event>);

impl Live {
    /// Creates a channel without subscribers.
    pub fn new() -> Live {
        Live(Sender::new(BUFFERED))
    }

    /// Subscribes to the events from now on.
    pub fn subscribe(&self) -> Receiver<Event> {
        self.0.subscribe()
    }

    /// Sends an event to all subscribers of this process.
    pub fn send(&self, event: Event) {
        // A channel without subscribers is not an error.
        let _ = self.0.send(event);
    }
}

impl Default for Live {
    fn default() -> Live {
        Live::new()
    }
}
