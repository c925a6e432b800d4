//! Limits of a listener.

use std::time::Duration;

/// Files that the rest of a program needs open: databases, logs, its own connections.
const RESERVED_FILES: u64 = 256;

/// Limits on the connections of a listener.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Maximum number of connections. More wait in the system's queue.
    pub connections: usize,
    /// Maximum number of connections of one IPv4 address or one IPv6 /56, the smallest network
    /// that a subscriber is given (RIPE-690, section 4.2). Further ones are closed at once. `None`
    /// where the peers are proxies of our own.
    pub connections_per_network: Option<usize>,
    /// Time limit of the handshake, TLS for example.
    pub handshake: Duration,
    /// Time limit of the first request's head.
    pub head: Duration,
    /// Time after which a connection is closed that has no request in progress.
    pub idle: Duration,
    /// Time that a peer has for each 8 KiB of a body, in either direction, and to let the system
    /// send anything at all.
    pub stall: Duration,
    /// Time for requests in progress to finish when the listener stops.
    pub drain: Duration,
}

impl Limits {
    /// Lowers the number of connections to what the process may have open.
    pub fn within_open_files(self, open_files: u64) -> Limits {
        let left = open_files.saturating_sub(RESERVED_FILES).max(1);
        let left = usize::try_from(left).unwrap_or(usize::MAX);
        Limits {
            connections: self.connections.min(left),
            ..self
        }
    }

    /// Time after which connections are looked at again: a quarter of the shortest limit.
    pub(crate) fn period(&self) -> Duration {
        self.head.min(self.idle).min(self.stall) / 4
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Limits so long that a test fails by its own patience first.
    pub(crate) fn generous() -> Limits {
        let long = Duration::from_mins(10);
        Limits {
            connections: 64,
            connections_per_network: None,
            handshake: long,
            head: long,
            idle: long,
            stall: long,
            drain: long,
        }
    }

    #[test]
    fn the_files_that_may_be_open_bound_the_connections() {
        let connections = |files| generous().within_open_files(files).connections;
        assert_eq!(connections(1024), 64);
        assert_eq!(connections(300), 44);
        assert_eq!(connections(20), 1);
    }
}
