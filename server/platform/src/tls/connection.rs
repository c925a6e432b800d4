//! TLS connections that use few packets: each packet costs forty bytes or more of headers
//! over the satellite link.
//!
//! Invariants: data that a peer waits for is never held back. A peer that is still connected
//! receives everything that was written.

use binnacle_listener::Stream;
use socket2::SockRef;
use std::io::{self, IoSlice};
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio_rustls::server::TlsStream;

/// First byte of an encrypted TLS record (RFC 8446, section 5.1).
const ENCRYPTED: u8 = 23;

/// TCP connection below TLS. Nobody waits for the session ticket, so it is sent with the
/// first response instead of in a packet of its own.
#[derive(Debug)]
pub(super) struct Tcp {
    stream: Stream,
    /// Data held back for the next write.
    held_back: Vec<u8>,
    handshake_done: bool,
    /// True once data that the peer waits for has joined the data held back.
    joined: bool,
}

impl Tcp {
    /// Wraps a connection that was just accepted.
    pub(super) fn new(stream: Stream) -> Tcp {
        let tcp = Tcp {
            stream,
            held_back: Vec::new(),
            handshake_done: false,
            joined: false,
        };
        tcp.acknowledge_with_response();
        tcp
    }

    /// Holds back no further data. Data held back so far is sent with the next write.
    fn finish_handshake(&mut self) {
        self.handshake_done = true;
        self.acknowledge_with_response();
    }

    /// Lets the acknowledgement of a hello or a request be sent with the response to it. The
    /// system resets this option now and then; it only saves bytes.
    fn acknowledge_with_response(&self) {
        #[cfg(target_os = "linux")]
        SockRef::from(&self.stream).set_tcp_quickack(false).ok();
    }

    fn poll_send_held_back(&mut self, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        while !self.held_back.is_empty() {
            let sent = ready!(Pin::new(&mut self.stream).poll_write(cx, &self.held_back))?;
            if sent == 0 {
                return Poll::Ready(Err(io::ErrorKind::WriteZero.into()));
            }
            self.held_back.drain(..sent);
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
        if read.is_pending() && !self.handshake_done {
            // It was not a ticket: the peer may be waiting for it.
            ready!(self.poll_send_held_back(cx))?;
        }
        read
    }
}

impl AsyncWrite for Tcp {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        if !self.handshake_done && bytes.first() == Some(&ENCRYPTED) {
            self.held_back.extend_from_slice(bytes);
            return Poll::Ready(Ok(bytes.len()));
        }
        if self.joined || self.held_back.is_empty() {
            ready!(self.poll_send_held_back(cx))?;
            return Pin::new(&mut self.stream).poll_write(cx, bytes);
        }
        // In one packet, if it fits.
        self.joined = true;
        self.held_back.extend_from_slice(bytes);
        if let Poll::Ready(Err(error)) = self.poll_send_held_back(cx) {
            return Poll::Ready(Err(error));
        }
        Poll::Ready(Ok(bytes.len()))
    }

    // A server hello and the records after it are several slices, but one packet.
    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        slices: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let first = slices.iter().find(|slice| !slice.is_empty());
        let starts_clear = first.is_some_and(|slice| slice[0] != ENCRYPTED);
        if self.held_back.is_empty() && (self.handshake_done || starts_clear) {
            return Pin::new(&mut self.stream).poll_write_vectored(cx, slices);
        }
        let bytes: Vec<u8> = slices
            .iter()
            .flat_map(|slice| slice.iter().copied())
            .collect();
        self.poll_write(cx, &bytes)
    }

    fn is_write_vectored(&self) -> bool {
        true
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        if self.joined {
            ready!(self.poll_send_held_back(cx))?;
        }
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(self.poll_send_held_back(cx))?;
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

/// TLS connection that ends with one packet instead of five after the peer has closed it.
#[derive(Debug)]
pub struct TlsConnection {
    stream: TlsStream<Tcp>,
    /// True once the peer has closed its end, so it has received what it wanted.
    peer_closed: bool,
}

impl TlsConnection {
    /// Wraps a connection whose handshake is done.
    pub(super) fn new(mut stream: TlsStream<Tcp>) -> TlsConnection {
        stream.get_mut().0.finish_handshake();
        TlsConnection {
            stream,
            peer_closed: false,
        }
    }
}

impl AsyncRead for TlsConnection {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        ready!(Pin::new(&mut self.stream).poll_read(cx, buffer))?;
        if buffer.remaining() > 0 && buffer.filled().len() == before {
            self.peer_closed = true;
        }
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for TlsConnection {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write(cx, bytes)
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
        if self.peer_closed {
            // Resets the connection when it is dropped: the peer has closed its end as well.
            let tcp = SockRef::from(&self.stream.get_ref().0.stream);
            return Poll::Ready(tcp.set_linger(Some(Duration::ZERO)));
        }
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
