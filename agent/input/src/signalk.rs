//! Deltas from a Signal K server over a WebSocket, and those of an output that shares it.

use super::link::{CONNECT_TIMEOUT, End, Link, connect};
use super::signalk_access::{Answer, Permission, Registration, tls};
use crate::config::SignalKConfig;
use crate::port::{PortEnd, next_outgoing};
use binnacle_nmea::Tally;
use binnacle_observation::signalk::{DeltaCounts, DeltaReader, PATHS};
use futures_util::{SinkExt, StreamExt};
use rustls::pki_types::ServerName;
use serde_json::json;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::time::{Instant, sleep_until, timeout};
use tokio_rustls::TlsConnector;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::http::header::AUTHORIZATION;
use tokio_tungstenite::tungstenite::http::{HeaderValue, StatusCode};
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{WebSocketStream, client_async_with_config};

/// Silence after which a server is asked whether it wants a token.
const SILENCE: Duration = Duration::from_millis(if cfg!(test) { 100 } else { 5_000 });
/// Time within which a server must take a message.
const WRITE_TIMEOUT: Duration = Duration::from_secs(2);
/// Size limit of a message: deltas are some hundred bytes.
const MAX_MESSAGE_BYTES: usize = 1024 * 1024;

/// Stream of a plain or an encrypted connection.
trait Connection: AsyncRead + AsyncWrite + Unpin + Send {}

impl<T: AsyncRead + AsyncWrite + Unpin + Send> Connection for T {}

pub(crate) async fn session(
    config: &SignalKConfig,
    end: &mut Option<PortEnd<String>>,
    link: &Link,
) -> io::Result<End> {
    let mut registration = Registration::load(config);
    let needed = match end {
        Some(_) => Permission::ReadWrite,
        None => Permission::ReadOnly,
    };
    let token = registration.token(config);
    let mut socket = match open(config, token).await? {
        Opened::Socket(socket) => *socket,
        Opened::Refused => {
            registration.obtain_token(config, needed, link).await?;
            return Ok(End::Closed);
        }
    };
    send(&mut socket, subscription()).await?;
    link.opened();
    if let Some(end) = end {
        end.opened().await;
    }
    let mut deltas = DeltaReader::new(link.name.clone());
    let mut is_admitted = registration.token(config).is_some();
    let silent = sleep_until(Instant::now() + SILENCE);
    tokio::pin!(silent);
    let permission = obtain_permission(registration.clone(), config, needed);
    tokio::pin!(permission);
    loop {
        let message = tokio::select! {
            message = socket.next() => message,
            delta = next_outgoing(end) => {
                send(&mut socket, delta).await?;
                continue;
            }
            // A server with security greets strangers, and sends them nothing.
            () = &mut silent, if !is_admitted => {
                if registration.needs_token(config).await? {
                    registration.obtain_token(config, needed, link).await?;
                    return Ok(End::Closed);
                }
                is_admitted = true;
                continue;
            }
            () = &mut permission, if is_admitted => return Ok(End::Closed),
        };
        let Some(message) = message else {
            return Ok(End::Closed);
        };
        let message = message.map_err(io::Error::other)?;
        link.stats.count_received(message.len(), &Tally::default());
        match message {
            Message::Text(text) => {
                let mut counts = DeltaCounts::default();
                let observations = deltas.read(&text, &mut counts);
                link.stats.count_values(&counts);
                is_admitted |= !counts.values.is_empty();
                if !is_admitted {
                    silent.as_mut().reset(Instant::now() + SILENCE);
                }
                link.deliver(observations).await?;
            }
            Message::Binary(_) => link.stats.reject("bad delta"),
            Message::Close(_) => return Ok(End::Closed),
            Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
        }
    }
}

/// Ends when there is a new token with the permission that is needed. While its request waits, the
/// server is read as before; one without security needs none.
async fn obtain_permission(
    mut registration: Registration,
    config: &SignalKConfig,
    needed: Permission,
) {
    if registration.has_token_for(config, needed) || needed == Permission::ReadOnly {
        return std::future::pending().await;
    }
    let waiting = || {
        tracing::warn!(
            url = %config.url.uri(),
            "the Signal K server takes no deltas before it is approved: accept \"Binnacle compass \
             agent\" on its page, Security, Access Requests"
        );
    };
    match registration.request_token(config, needed, waiting).await {
        Ok(Answer::Approved) => return,
        Ok(Answer::NotTaken(StatusCode::NOT_FOUND)) => {}
        Ok(Answer::NotTaken(status)) => {
            tracing::warn!(%status, "the Signal K server takes no access request");
        }
        Ok(Answer::Denied) => {
            tracing::warn!("the Signal K server's administrator denied sending deltas");
        }
        Err(error) => tracing::warn!(%error, "the Signal K server cannot be asked for access"),
    }
    // The next connection asks again.
    std::future::pending::<()>().await;
}

/// Sends a message, which the server must take in time: an older heading is not for steering.
async fn send(socket: &mut WebSocketStream<Box<dyn Connection>>, text: String) -> io::Result<()> {
    match timeout(WRITE_TIMEOUT, socket.send(Message::text(text))).await {
        Ok(sent) => sent.map_err(io::Error::other),
        Err(_) => Err(io::Error::new(
            io::ErrorKind::TimedOut,
            "the server takes no deltas",
        )),
    }
}

/// Result of a handshake.
enum Opened {
    Socket(Box<WebSocketStream<Box<dyn Connection>>>),
    /// The server wants another token, or one at all.
    Refused,
}

async fn open(config: &SignalKConfig, token: Option<&str>) -> io::Result<Opened> {
    let stream = connect(&config.url.host_port()).await?;
    let stream: Box<dyn Connection> = if config.url.is_secure() {
        let host = ServerName::try_from(config.url.host().to_owned()).map_err(io::Error::other)?;
        let connector = TlsConnector::from(Arc::new(tls(config)?));
        Box::new(connector.connect(host, stream).await?)
    } else {
        Box::new(stream)
    };
    let mut request = config
        .url
        .uri()
        .into_client_request()
        .map_err(io::Error::other)?;
    if let Some(token) = token {
        let value = HeaderValue::try_from(format!("Bearer {token}")).map_err(io::Error::other)?;
        request.headers_mut().insert(AUTHORIZATION, value);
    }
    let limits = WebSocketConfig::default()
        .max_message_size(Some(MAX_MESSAGE_BYTES))
        .max_frame_size(Some(MAX_MESSAGE_BYTES));
    let handshake = client_async_with_config(request, stream, Some(limits));
    let opened = timeout(CONNECT_TIMEOUT, handshake)
        .await
        .map_err(|_| io::Error::new(io::ErrorKind::TimedOut, "the handshake timed out"))?;
    match opened {
        Ok((socket, _)) => Ok(Opened::Socket(Box::new(socket))),
        Err(Error::Http(response)) if is_refusal(response.status()) => Ok(Opened::Refused),
        Err(error) => Err(io::Error::other(error)),
    }
}

fn is_refusal(status: StatusCode) -> bool {
    matches!(status, StatusCode::UNAUTHORIZED | StatusCode::FORBIDDEN)
}

/// Returns the request for the paths in use, sent as soon as they change.
fn subscription() -> String {
    let paths: Vec<_> = PATHS
        .iter()
        .map(|path| json!({"path": path, "policy": "instant"}))
        .collect();
    json!({"context": "vessels.self", "subscribe": paths}).to_string()
}
