//! Lines that sentences go out on.
//!
//! A TCP line serves one client at a time. In a hurry it waits for one and goes
//! at its pace; live it waits for nobody, and what a client does not take in
//! time is lost to it, as on a real bridge.

use anyhow::{Context, Result};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::AsyncWriteExt;
use tokio::net::{TcpListener, TcpSocket, TcpStream, UdpSocket};

/// What may be under way to a client that dies: some minutes of a voyage.
const SEND_BUFFER_BYTES: u32 = 64 * 1024;
/// A live client that takes nothing for so long is given up.
const LIVE_PATIENCE: Duration = Duration::from_secs(5);
/// Fits every Ethernet.
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

    /// Waits for a client and sends. What was on its way to a client that went
    /// away is lost.
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

    /// Sends to the client if there is one, and to nobody otherwise.
    pub(crate) async fn send_live(&mut self, bytes: &[u8]) {
        let arrived = tokio::time::timeout(Duration::ZERO, self.listener.accept()).await;
        if let Ok(Ok((newest, _))) = arrived {
            self.client = Some(newest);
        }
        let Some(client) = &mut self.client else {
            return;
        };
        let sent = tokio::time::timeout(LIVE_PATIENCE, client.write_all(bytes)).await;
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
        // An absent listener shows as an error of the datagram before: on a ship
        // nobody minds.
        let _ = socket.send_to(&bytes[..end], to).await;
        bytes = &bytes[end..];
    }
    Ok(())
}
