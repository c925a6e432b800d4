//! One connection, from its handshake to its end.

use crate::admission::Place;
use crate::body::{RequestBody, ResponseBody};
use crate::limits::Limits;
use crate::stream::Stream;
use crate::turns::{Turns, Verdict};
use axum::Router;
use axum::body::Body;
use axum::extract::ConnectInfo;
use hyper::service::service_fn;
use hyper::{Request, body::Incoming};
use hyper_util::rt::{TokioExecutor, TokioIo};
use hyper_util::server::conn::auto::Builder;
use std::io;
use std::net::SocketAddr;
use std::pin::pin;
use std::sync::Arc;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio::time::{Instant, MissedTickBehavior, interval_at, timeout};
use tokio_util::sync::CancellationToken;
use tower::ServiceExt;
use tracing::debug;

/// Size limit of a request's head, and of what is sent ahead of a slow reader, bytes.
const BUFFER_BYTES: usize = 64 * 1024;

/// Parts that all connections of a listener share.
#[derive(Clone, Debug)]
pub(crate) struct Shared<H> {
    pub(crate) limits: Arc<Limits>,
    pub(crate) router: Router,
    pub(crate) handshake: H,
    pub(crate) stopping: CancellationToken,
}

/// Serves a connection until its end.
pub(crate) async fn serve_connection<H, F, Io>(
    stream: TcpStream,
    peer: SocketAddr,
    place: Place,
    shared: Shared<H>,
) where
    H: FnOnce(Stream) -> F,
    F: Future<Output = io::Result<Io>>,
    Io: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let limits = &shared.limits;
    let turns = Turns::new(limits);
    let stream = Stream::new(stream, turns.clone());
    match timeout(limits.handshake, (shared.handshake)(stream)).await {
        Ok(Ok(io)) => {
            serve_requests(io, peer, limits, &turns, &shared.router, &shared.stopping).await;
        }
        Ok(Err(error)) => debug!(%peer, %error, "the handshake failed"),
        Err(_) => debug!(%peer, "the handshake took too long"),
    }
    drop(place);
}

async fn serve_requests<Io>(
    io: Io,
    peer: SocketAddr,
    limits: &Limits,
    turns: &Arc<Turns>,
    router: &Router,
    stopping: &CancellationToken,
) where
    Io: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let service = service_fn(|request: Request<Incoming>| {
        let turn = turns.begin();
        let mut request = request.map(|body| Body::new(RequestBody::new(body, turn.another())));
        request.extensions_mut().insert(ConnectInfo(peer));
        let router = router.clone();
        async move {
            let response = router.oneshot(request).await?;
            Ok::<_, std::convert::Infallible>(response.map(|body| ResponseBody::new(body, turn)))
        }
    });
    let mut builder = Builder::new(TokioExecutor::new());
    builder.http1().max_buf_size(BUFFER_BYTES);
    builder.http2().max_send_buf_size(BUFFER_BYTES);
    let mut connection = pin!(builder.serve_connection(TokioIo::new(io), service));
    turns.await_request(limits.head);
    let period = limits.period();
    let mut look = interval_at(Instant::now() + period, period);
    look.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut is_ending = false;
    loop {
        tokio::select! {
            served = connection.as_mut() => {
                if let Err(error) = served {
                    debug!(%peer, error, "a connection failed");
                }
                return;
            }
            () = stopping.cancelled(), if !is_ending => {
                connection.as_mut().graceful_shutdown();
                is_ending = true;
            }
            _ = look.tick() => match turns.verdict() {
                Verdict::Keep => {}
                // A request that is on its way is still served.
                Verdict::Idle if !is_ending => {
                    connection.as_mut().graceful_shutdown();
                    is_ending = true;
                }
                Verdict::Idle => return,
                Verdict::Stalled => {
                    debug!(%peer, "a connection whose peer does not go on is closed");
                    return;
                }
            }
        }
    }
}
