//! Deltas from a Signal K server over a WebSocket.

use super::link::{CONNECT_TIMEOUT, End, Link, connect};
use crate::config::SignalKUrl;
use binnacle_nmea::Tally;
use binnacle_observation::signalk::{DeltaCounts, DeltaReader, PATHS};
use futures_util::{SinkExt, StreamExt};
use serde_json::json;
use std::io;
use tokio_tungstenite::client_async_with_config;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;

/// Size limit of a message: deltas are some hundred bytes.
const MAX_MESSAGE_BYTES: usize = 1024 * 1024;

pub(super) async fn session(url: &SignalKUrl, link: &Link) -> io::Result<End> {
    let stream = connect(&url.host_port()).await?;
    let limits = WebSocketConfig::default()
        .max_message_size(Some(MAX_MESSAGE_BYTES))
        .max_frame_size(Some(MAX_MESSAGE_BYTES));
    let handshake = client_async_with_config(url.uri(), stream, Some(limits));
    let (mut socket, _) = tokio::time::timeout(CONNECT_TIMEOUT, handshake)
        .await
        .map_err(|_| io::Error::new(io::ErrorKind::TimedOut, "the handshake timed out"))?
        .map_err(io::Error::other)?;
    socket
        .send(Message::text(subscription()))
        .await
        .map_err(io::Error::other)?;
    link.opened();
    let mut deltas = DeltaReader::new(link.name.clone());
    while let Some(message) = socket.next().await {
        let message = message.map_err(io::Error::other)?;
        link.stats.count_received(message.len(), &Tally::default());
        match message {
            Message::Text(text) => {
                let mut counts = DeltaCounts::default();
                let observations = deltas.read(&text, &mut counts);
                link.stats.count_values(&counts);
                link.deliver(observations).await?;
            }
            Message::Binary(_) => link.stats.reject("bad delta"),
            Message::Close(_) => return Ok(End::Closed),
            Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
        }
    }
    Ok(End::Closed)
}

/// Returns the request for the paths in use, sent as soon as they change.
fn subscription() -> String {
    let paths: Vec<_> = PATHS
        .iter()
        .map(|path| json!({"path": path, "policy": "instant"}))
        .collect();
    json!({"context": "vessels.self", "subscribe": paths}).to_string()
}
