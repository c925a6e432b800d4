//! Turns of server and peer on a connection, with their deadlines.
//!
//! Invariant: whatever waits for the peer has a deadline here. Nothing has a timer of its own: the
//! connection asks for the verdict now and then.

use crate::limits::Limits;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::time::Instant;

/// Part of a body for which a peer has the time [`Limits::stall`], bytes: at one minute the peer
/// keeps pace at 137 bytes a second, less than half of what a satellite telephone carries.
pub(crate) const PIECE_BYTES: usize = 8 * 1024;

/// Fate of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It goes on.
    Keep,
    /// It has had no request for too long.
    Idle,
    /// Its peer has left something waiting for too long.
    Stalled,
}

/// Turns of one connection.
#[derive(Debug)]
pub(crate) struct Turns {
    idle: Duration,
    stall: Duration,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    /// Number of the next turn.
    next: u64,
    /// Turns in progress; those of the peer with their deadlines.
    turns: BTreeMap<u64, Option<Instant>>,
    /// Deadline of a write that the system does not take.
    blocked_until: Option<Instant>,
    /// Set once the first request has come.
    has_served: bool,
    /// Deadline of the next request.
    quiet_until: Instant,
}

impl Turns {
    /// Begins to wait for a handshake and the first request.
    pub(crate) fn new(limits: &Limits) -> Arc<Turns> {
        Arc::new(Turns {
            idle: limits.idle,
            stall: limits.stall,
            state: Mutex::new(State {
                next: 0,
                turns: BTreeMap::new(),
                blocked_until: None,
                has_served: false,
                quiet_until: Instant::now() + limits.handshake + limits.head,
            }),
        })
    }

    /// Begins to wait for the first request, now that the handshake is done.
    pub(crate) fn await_request(&self, head: Duration) {
        self.state().quiet_until = Instant::now() + head;
    }

    /// Begins a turn of the server.
    pub(crate) fn begin(self: &Arc<Turns>) -> Turn {
        let mut state = self.state();
        state.has_served = true;
        let id = state.next;
        state.next += 1;
        state.turns.insert(id, None);
        Turn {
            turns: self.clone(),
            id,
            left: self.stall,
        }
    }

    /// Notes that the system takes no more bytes for the peer.
    pub(crate) fn block(&self) {
        let until = Instant::now() + self.stall;
        self.state().blocked_until.get_or_insert(until);
    }

    /// Notes that the system took bytes for the peer.
    pub(crate) fn unblock(&self) {
        let quiet_until = Instant::now() + self.idle;
        let mut state = self.state();
        state.blocked_until = None;
        // Before the first request, bytes of the protocol alone gain no time.
        if state.has_served {
            state.quiet_until = quiet_until;
        }
    }

    /// Judges the connection.
    pub(crate) fn verdict(&self) -> Verdict {
        let now = Instant::now();
        let state = self.state();
        let waits = state.turns.values().flatten().chain(&state.blocked_until);
        if waits.into_iter().any(|deadline| *deadline < now) {
            Verdict::Stalled
        } else if state.turns.is_empty() && state.quiet_until < now {
            Verdict::Idle
        } else {
            Verdict::Keep
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Turn of a request: its handler, or one of its bodies.
#[derive(Debug)]
pub(crate) struct Turn {
    turns: Arc<Turns>,
    id: u64,
    /// Time that the peer has left.
    left: Duration,
}

impl Turn {
    /// Passes the turn to the peer.
    pub(crate) fn wait_for_peer(&mut self) {
        let deadline = Instant::now() + self.left;
        if let Some(turn) = self.turns.state().turns.get_mut(&self.id) {
            turn.get_or_insert(deadline);
        }
    }

    /// Takes the turn back after the peer has sent or taken some bytes, for which it gains time.
    pub(crate) fn take_back(&mut self, bytes: usize) {
        let mut state = self.turns.state();
        let Some(deadline) = state.turns.get_mut(&self.id).and_then(Option::take) else {
            return;
        };
        let pieces = (bytes as f64 / PIECE_BYTES as f64).min(1.0);
        let left = deadline.saturating_duration_since(Instant::now());
        self.left = (left + self.turns.stall.mul_f64(pieces)).min(self.turns.stall);
    }

    /// Begins another turn of the same connection.
    pub(crate) fn another(&self) -> Turn {
        self.turns.begin()
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        let quiet_until = Instant::now() + self.turns.idle;
        let mut state = self.turns.state();
        state.turns.remove(&self.id);
        state.quiet_until = quiet_until;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::tests::generous;
    use tokio::time::advance;

    const SECOND: Duration = Duration::from_secs(1);

    fn turns() -> Arc<Turns> {
        let turns = Turns::new(&Limits {
            handshake: 5 * SECOND,
            head: 10 * SECOND,
            idle: 30 * SECOND,
            stall: 20 * SECOND,
            ..generous()
        });
        turns.await_request(10 * SECOND);
        turns
    }

    async fn after(turns: &Turns, seconds: u32) -> Verdict {
        advance(seconds * SECOND).await;
        turns.verdict()
    }

    #[tokio::test(start_paused = true)]
    async fn bytes_of_the_protocol_do_not_postpone_the_first_request() {
        let turns = turns();
        assert_eq!(after(&turns, 9).await, Verdict::Keep);
        turns.unblock();
        assert_eq!(after(&turns, 2).await, Verdict::Idle);
    }

    #[tokio::test(start_paused = true)]
    async fn the_server_may_take_its_time_and_the_peer_may_not() {
        let turns = turns();
        let mut turn = turns.begin();
        assert_eq!(after(&turns, 3600).await, Verdict::Keep);
        turn.wait_for_peer();
        assert_eq!(after(&turns, 19).await, Verdict::Keep);
        assert_eq!(after(&turns, 2).await, Verdict::Stalled);
    }

    #[tokio::test(start_paused = true)]
    async fn a_trickle_gains_hardly_any_time_and_a_steady_pace_all_of_it() {
        let turns = turns();
        let mut turn = turns.begin();
        for _ in 0..10 {
            turn.wait_for_peer();
            assert_eq!(after(&turns, 19).await, Verdict::Keep);
            turn.take_back(PIECE_BYTES);
        }
        turn.wait_for_peer();
        advance(15 * SECOND).await;
        turn.take_back(1);
        turn.wait_for_peer();
        assert_eq!(after(&turns, 6).await, Verdict::Stalled);
    }

    #[tokio::test(start_paused = true)]
    async fn a_blocked_write_ends_when_the_system_takes_some_of_it() {
        let turns = turns();
        let _turn = turns.begin();
        turns.block();
        assert_eq!(after(&turns, 19).await, Verdict::Keep);
        turns.block();
        assert_eq!(after(&turns, 2).await, Verdict::Stalled);
        turns.unblock();
        assert_eq!(turns.verdict(), Verdict::Keep);
    }

    #[tokio::test(start_paused = true)]
    async fn a_connection_is_idle_from_the_end_of_its_last_request_or_bytes() {
        let turns = turns();
        drop(turns.begin());
        assert_eq!(after(&turns, 29).await, Verdict::Keep);
        turns.unblock();
        assert_eq!(after(&turns, 29).await, Verdict::Keep);
        assert_eq!(after(&turns, 2).await, Verdict::Idle);
    }
}
