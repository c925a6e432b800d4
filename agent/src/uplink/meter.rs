//! Counter of the bytes that the uplink's connections cost, counted at their sockets beneath TLS.
//!
//! Invariants:
//!
//! - Everything counts that a socket takes or gives: proxy, TLS handshake with its certificates,
//!   heads and bodies, whether the request succeeds or not.
//! - The packets are estimated, since a socket does not show them: full segments, and an
//!   acknowledgement for every two (RFC 9293, 3.8.6.3). Repetitions of lost packets are not seen.

use rustix::net::sockopt;
use socket2::SockRef;
use std::io;
use std::pin::Pin;
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;

/// Bytes of the headers of IPv4 (RFC 791, 3.1) and TCP (RFC 9293, 3.1), and of IPv6 (RFC 8200, 3) and
/// TCP.
const IPV4_TCP_BYTES: u64 = 20 + 20;
const IPV6_TCP_BYTES: u64 = 40 + 20;
/// Bytes of the time stamps in each header (RFC 7323, 3.2 and appendix A), where both hosts send them.
const TIMESTAMP_BYTES: u64 = 12;
/// Bytes of further options in the first segment of each side: segment size, window, selective
/// acknowledgements.
const SYN_OPTIONS: u64 = 8;
/// Packets that open a connection and packets that close it.
const OPENING_PACKETS: u64 = 3;
const CLOSING_PACKETS: u64 = 4;
/// Segment size where the socket does not say it: an Ethernet's.
const SEGMENT_BYTES: u64 = 1_448;
/// First segments of an attempt that nobody answers.
const UNANSWERED_PACKETS: u64 = 3;

/// Counter of all connections of one client.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meter(Arc<Mutex<Counts>>);

#[derive(Debug, Default)]
struct Counts {
    /// Bytes of packets since the last call of [`Meter::take`].
    bytes: u64,
    /// Bytes of the last connection until it could carry a request.
    connection_bytes: Option<u64>,
    /// Connections that are open now.
    open: u32,
}

/// Traffic of the uplink in a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Traffic {
    /// Bytes of packets, both ways.
    pub(crate) bytes: u64,
    /// Bytes of the last connection that was opened meanwhile, without its requests.
    pub(crate) connection_bytes: Option<u64>,
}

impl Meter {
    /// Returns the traffic since the last call.
    pub(crate) fn take(&self) -> Traffic {
        self.update(|counts| Traffic {
            bytes: std::mem::take(&mut counts.bytes),
            connection_bytes: counts.connection_bytes.take(),
        })
    }

    /// Returns whether a connection is open.
    pub(crate) fn is_connected(&self) -> bool {
        self.update(|counts| counts.open > 0)
    }

    /// Counts an attempt to connect that failed.
    pub(super) fn count_failed_attempt(&self) {
        let packet = IPV4_TCP_BYTES + TIMESTAMP_BYTES + SYN_OPTIONS;
        self.update(|counts| counts.bytes += UNANSWERED_PACKETS * packet);
    }

    /// Returns the bytes so far, as the start of a connection.
    pub(super) fn mark(&self) -> u64 {
        self.update(|counts| counts.bytes)
    }

    /// Records that a connection which began at `mark` can carry requests.
    pub(super) fn record_connection(&self, mark: u64) {
        self.update(|counts| counts.connection_bytes = Some(counts.bytes.saturating_sub(mark)));
    }

    fn update<T>(&self, change: impl FnOnce(&mut Counts) -> T) -> T {
        let mut counts = self.0.lock().expect("nothing panics while it counts");
        change(&mut counts)
    }
}

/// TCP connection whose bytes are counted.
#[derive(Debug)]
pub(super) struct MeteredStream {
    tcp: TcpStream,
    meter: Meter,
    header_bytes: u64,
    segment_bytes: u64,
}

impl MeteredStream {
    /// Counts an open connection from its first packet on. The packets that will close it are
    /// counted at once, since nobody waits for them.
    pub(super) fn new(tcp: TcpStream, meter: Meter) -> MeteredStream {
        let segment_bytes = SockRef::from(&tcp)
            .tcp_mss()
            .map_or(SEGMENT_BYTES, u64::from);
        let header_bytes = header_bytes(&tcp, segment_bytes);
        meter.update(|counts| {
            counts.open += 1;
            counts.bytes += (OPENING_PACKETS + CLOSING_PACKETS) * header_bytes + 2 * SYN_OPTIONS;
        });
        MeteredStream {
            tcp,
            meter,
            header_bytes,
            segment_bytes: segment_bytes.max(1),
        }
    }

    fn count(&self, bytes: usize) {
        let bytes = bytes as u64;
        let segments = bytes.div_ceil(self.segment_bytes);
        let packets = segments + segments.div_ceil(2);
        self.meter
            .update(|counts| counts.bytes += bytes + packets * self.header_bytes);
    }
}

/// Returns the bytes of a packet's headers. The largest packet less its data shows whether they have
/// time stamps, unless the other side takes smaller segments than the way: then they count.
fn header_bytes(tcp: &TcpStream, segment_bytes: u64) -> u64 {
    let is_v6 = tcp.peer_addr().is_ok_and(|address| address.is_ipv6());
    let (bare, largest) = if is_v6 {
        (IPV6_TCP_BYTES, sockopt::ipv6_mtu(tcp))
    } else {
        (IPV4_TCP_BYTES, sockopt::ip_mtu(tcp))
    };
    match largest {
        Ok(largest) if u64::from(largest) == bare + segment_bytes => bare,
        _ => bare + TIMESTAMP_BYTES,
    }
}

impl Drop for MeteredStream {
    fn drop(&mut self) {
        self.meter.update(|counts| counts.open -= 1);
    }
}

impl AsyncRead for MeteredStream {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        let done = Pin::new(&mut self.tcp).poll_read(context, buffer);
        self.count(buffer.filled().len() - before);
        done
    }
}

impl AsyncWrite for MeteredStream {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let done = Pin::new(&mut self.tcp).poll_write(context, bytes);
        if let Poll::Ready(Ok(written)) = done {
            self.count(written);
        }
        done
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        slices: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let done = Pin::new(&mut self.tcp).poll_write_vectored(context, slices);
        if let Poll::Ready(Ok(written)) = done {
            self.count(written);
        }
        done
    }

    fn is_write_vectored(&self) -> bool {
        self.tcp.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.tcp).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.tcp).poll_shutdown(context)
    }
}
