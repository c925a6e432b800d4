//! Network outputs of sentences.
//!
//! A TCP output serves one client at a time. In fast mode it waits for a client
//! and follows its pace. In live mode it never waits, and a slow client
//! loses sentences, as on a real bridge.

use anyhow::{Context, Result};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::net::{TcpListener, TcpSocket, TcpStream, UdpSocket};

/// The most bytes under way to a client that disappears: some minutes of a
/// voyage.
const SEND_BUFFER_BYTES: u32 = 64 * 1024;
/// Time after which a live client that reads nothing is dropped.
const LIVE_TIMEOUT: Duration = Duration::from_secs(5);
/// The largest datagram, which fits every Ethernet.
const DATAGRAM_BYTES: usize = 1400;

/// A TCP server for one client at a time.
#[derive(Debug)]
pub(crate) struct TcpLine {
    listener: TcpListener,
    client: Option<TcpStream>,
}

impl TcpLine {
    pub(crate) fn listen(address: SocketAddr) -> Result<TcpLine> {
        let listen = || {
            let socket = if address.is_ipv4() {
                TcpSocket::new_v4()
            } else {
                TcpSocket::new_v6()
            }?;
            socket.set_reuseaddr(true)?;
            socket.set_send_buffer_size(SEND_BUFFER_BYTES)?;
            socket.bind(address)?;
            socket.listen(16)
        };
        let listener = listen().with_context(|| format!("cannot listen at {address}"))?;
        Ok(TcpLine {
            listener,
            client: None,
        })
    }

    pub(crate) fn address(&self) -> Result<SocketAddr> {
        Ok(self.listener.local_addr()?)
    }

    /// Waits for a client and sends. Bytes under way to a client that
    /// disconnected are lost.
    pub(crate) async fn send(&mut self, bytes: &[u8]) -> Result<()> {
        if self.client.is_none() {
            self.client = Some(self.listener.accept().await?.0);
        }
        if let Some(client) = &mut self.client
            && client.write_all(bytes).await.is_err()
        {
            self.client = None;
        }
        Ok(())
    }

    /// Sends to the client, if there is one.
    pub(crate) async fn send_live(&mut self, bytes: &[u8]) {
        let arrived = tokio::time::timeout(Duration::ZERO, self.listener.accept()).await;
        if let Ok(Ok((newest, _))) = arrived {
            self.client = Some(newest);
        }
        let Some(client) = &mut self.client else {
            return;
        };
        let sent = tokio::time::timeout(LIVE_TIMEOUT, client.write_all(bytes)).await;
        if !matches!(sent, Ok(Ok(()))) {
            self.client = None;
        }
    }
}

/// Sends lines in datagrams, several whole lines in each.
pub(crate) async fn send_datagrams(
    socket: &UdpSocket,
    to: SocketAddr,
    mut bytes: &[u8],
) -> Result<()> {
    while !bytes.is_empty() {
        let most = &bytes[..bytes.len().min(DATAGRAM_BYTES)];
        let end = most
            .iter()
            .rposition(|&byte| byte == b'\n')
            .map_or(most.len(), |at| at + 1);
        // A missing listener shows as an error of the previous datagram, and is
        // ignored, as on a ship.
        let _ = socket.send_to(&bytes[..end], to).await;
        bytes = &bytes[end..];
    }
    Ok(())
}
