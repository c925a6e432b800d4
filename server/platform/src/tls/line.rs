//! Connections that use few packets: each packet costs a ship forty bytes or more besides
//! its content.
//!
//! Invariants: nothing that a peer waits for is kept back, and a peer that is
//! still there gets all that was written.

use socket2::SockRef;
use std::io::{self, IoSlice};
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio_rustls::server::TlsStream;

/// The first byte of an encrypted TLS record (RFC 8446, 5.1).
const ENCRYPTED: u8 = 23;

/// TCP below TLS. The ticket for a next session, which nobody waits for, goes with the
/// first answer instead of in a packet of its own.
#[derive(Debug)]
pub(super) struct Tcp {
    stream: TcpStream,
    /// Data held back for the next write.
    kept: Vec<u8>,
    hands_shaken: bool,
    /// True once data that the peer waits for has joined the data held back.
    joined: bool,
}

impl Tcp {
    /// A connection just taken.
    pub(super) fn new(stream: TcpStream) -> Tcp {
        let tcp = Tcp {
            stream,
            kept: Vec::new(),
            hands_shaken: false,
            joined: false,
        };
        tcp.acknowledge_with_answers();
        tcp
    }

    /// Keeps back nothing more, but what is kept goes with what is written next.
    fn shaken(&mut self) {
        self.hands_shaken = true;
        self.acknowledge_with_answers();
    }

    /// Lets the acknowledgement of a hello or a request go with the answer to it. The system
    /// resets this now and then; it only saves bytes.
    fn acknowledge_with_answers(&self) {
        #[cfg(target_os = "linux")]
        SockRef::from(&self.stream).set_tcp_quickack(false).ok();
    }

    fn poll_send_kept(&mut self, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        while !self.kept.is_empty() {
            let sent = ready!(Pin::new(&mut self.stream).poll_write(cx, &self.kept))?;
            if sent == 0 {
                return Poll::Ready(Err(io::ErrorKind::WriteZero.into()));
            }
            self.kept.drain(..sent);
        }
        Poll::Ready(Ok(()))
    }
}

impl AsyncRead for Tcp {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let read = Pin::new(&mut self.stream).poll_read(cx, buffer);
        if read.is_pending() && !self.hands_shaken {
            // It was no ticket: the peer may be waiting for it.
            ready!(self.poll_send_kept(cx))?;
        }
        read
    }
}

impl AsyncWrite for Tcp {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        octets: &[u8],
    ) -> Poll<io::Result<usize>> {
        if !self.hands_shaken && octets.first() == Some(&ENCRYPTED) {
            self.kept.extend_from_slice(octets);
            return Poll::Ready(Ok(octets.len()));
        }
        if self.joined || self.kept.is_empty() {
            ready!(self.poll_send_kept(cx))?;
            return Pin::new(&mut self.stream).poll_write(cx, octets);
        }
        // In one packet, where it has room.
        self.joined = true;
        self.kept.extend_from_slice(octets);
        if let Poll::Ready(Err(error)) = self.poll_send_kept(cx) {
            return Poll::Ready(Err(error));
        }
        Poll::Ready(Ok(octets.len()))
    }

    // A hello and what follows it are several slices, and one packet.
    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        slices: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let first = slices.iter().find(|slice| !slice.is_empty());
        let starts_clear = first.is_some_and(|slice| slice[0] != ENCRYPTED);
        if self.kept.is_empty() && (self.hands_shaken || starts_clear) {
            return Pin::new(&mut self.stream).poll_write_vectored(cx, slices);
        }
        let octets: Vec<u8> = slices
            .iter()
            .flat_map(|slice| slice.iter().copied())
            .collect();
        self.poll_write(cx, &octets)
    }

    fn is_write_vectored(&self) -> bool {
        true
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        if self.joined {
            ready!(self.poll_send_kept(cx))?;
        }
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(self.poll_send_kept(cx))?;
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

/// A TLS connection that, after the peer has closed it, ends with one packet instead of five.
#[derive(Debug)]
pub struct Line {
    stream: TlsStream<Tcp>,
    /// The peer has closed, so that it has had what it wanted.
    peer_left: bool,
}

impl Line {
    /// A connection with hands shaken.
    pub(super) fn new(mut stream: TlsStream<Tcp>) -> Line {
        stream.get_mut().0.shaken();
        Line {
            stream,
            peer_left: false,
        }
    }
}

impl AsyncRead for Line {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        ready!(Pin::new(&mut self.stream).poll_read(cx, buffer))?;
        if buffer.remaining() > 0 && buffer.filled().len() == before {
            self.peer_left = true;
        }
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for Line {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        octets: &[u8],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write(cx, octets)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        slices: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write_vectored(cx, slices)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        if self.peer_left {
            // A reset, when it is dropped: the peer has closed its end as well.
            let tcp = SockRef::from(&self.stream.get_ref().0.stream);
            return Poll::Ready(tcp.set_linger(Some(Duration::ZERO)));
        }
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
