//! Connection of an input that an output shares: what a device takes on the line where it is read.
//!
//! Invariant: nothing waits for a connection that is not open. What was to be sent meanwhile is
//! discarded when it opens.

use tokio::sync::mpsc;

/// Messages that may wait to be sent: less than a second of headings.
const MAX_WAITING: usize = 16;
/// Events that may wait for the output.
const MAX_EVENTS: usize = 64;

/// Event of a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortEvent<T> {
    /// It was opened.
    Opened,
    /// A message that concerns the output.
    Received(T),
    /// It was closed.
    Closed,
}

/// Output's end of a shared connection.
#[derive(Debug)]
pub struct Port<T> {
    /// Events in their order.
    pub events: mpsc::Receiver<PortEvent<T>>,
    outgoing: mpsc::Sender<T>,
}

/// Input's end of a shared connection.
#[derive(Debug)]
pub struct PortEnd<T> {
    events: mpsc::Sender<PortEvent<T>>,
    outgoing: mpsc::Receiver<T>,
}

impl<T> Port<T> {
    /// Creates both ends.
    pub fn new() -> (Port<T>, PortEnd<T>) {
        let (event_tx, events) = mpsc::channel(MAX_EVENTS);
        let (outgoing_tx, outgoing) = mpsc::channel(MAX_WAITING);
        let port = Port {
            events,
            outgoing: outgoing_tx,
        };
        let end = PortEnd {
            events: event_tx,
            outgoing,
        };
        (port, end)
    }

    /// Sends without waiting. Returns whether the connection takes the message.
    pub fn send(&self, message: T) -> bool {
        self.outgoing.try_send(message).is_ok()
    }
}

impl<T> PortEnd<T> {
    /// Discards what waits, and passes on that the connection is open.
    pub(crate) async fn opened(&mut self) {
        while self.outgoing.try_recv().is_ok() {}
        self.pass_on(PortEvent::Opened).await;
    }

    /// Passes on that the connection is closed.
    pub(crate) async fn closed(&self) {
        self.pass_on(PortEvent::Closed).await;
    }

    /// Passes on a message.
    pub(crate) async fn received(&self, message: T) {
        self.pass_on(PortEvent::Received(message)).await;
    }

    async fn pass_on(&self, event: PortEvent<T>) {
        // An output that has ended needs no events.
        self.events.send(event).await.ok();
    }

    /// Waits for a message to send; forever once the output has ended.
    pub(crate) async fn next(&mut self) -> T {
        match self.outgoing.recv().await {
            Some(message) => message,
            None => std::future::pending().await,
        }
    }
}

/// Waits for a message to send; forever where no output shares the connection.
pub(crate) async fn next_outgoing<T>(end: &mut Option<PortEnd<T>>) -> T {
    match end {
        Some(end) => end.next().await,
        None => std::future::pending().await,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn what_waited_for_a_closed_connection_is_not_sent() {
        let (mut port, mut end) = Port::new();
        for number in 0..2 * MAX_WAITING {
            assert_eq!(port.send(number), number < MAX_WAITING);
        }
        end.opened().await;
        assert_eq!(port.events.recv().await, Some(PortEvent::Opened));
        assert!(port.send(99));
        assert_eq!(end.next().await, 99);
    }
}
