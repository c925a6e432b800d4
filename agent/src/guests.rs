//! Connections to the page: so many at once, and none that says nothing for long. What
//! the uplink and the instruments need of the computer is not the page's to use up.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, Sleep, sleep};

/// More than a bridge has screens.
const MOST: usize = 64;
/// The page asks once a second.
const PATIENCE: Duration = Duration::from_secs(10);

/// A listener with room for so many.
#[derive(Debug)]
pub(crate) struct Guests {
    listener: TcpListener,
    room: Arc<Semaphore>,
    patience: Duration,
}

impl Guests {
    /// Takes over a listener.
    pub(crate) fn of(listener: TcpListener) -> Guests {
        Guests::at_most(MOST, PATIENCE, listener)
    }

    fn at_most(most: usize, patience: Duration, listener: TcpListener) -> Guests {
        Guests {
            listener,
            room: Arc::new(Semaphore::new(most)),
            patience,
        }
    }
}

impl axum::serve::Listener for Guests {
    type Io = Guest;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Guest, SocketAddr) {
        let room = self.room.clone().acquire_owned().await;
        let room = room.expect("the semaphore is never closed");
        let (stream, address) = axum::serve::Listener::accept(&mut self.listener).await;
        let guest = Guest {
            stream,
            patience: self.patience,
            silent: Box::pin(sleep(self.patience)),
            _room: room,
        };
        (guest, address)
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }
}

/// A connection that ends when nothing comes and nothing can be told for too long.
#[derive(Debug)]
pub(crate) struct Guest {
    stream: TcpStream,
    patience: Duration,
    silent: Pin<Box<Sleep>>,
    _room: OwnedSemaphorePermit,
}

impl Guest {
    /// Begins to wait anew when there was something, and gives up when there is nothing.
    fn heed<T>(
        &mut self,
        cx: &mut Context<'_>,
        happened: Poll<io::Result<T>>,
    ) -> Poll<io::Result<T>> {
        if happened.is_ready() {
            self.silent.as_mut().reset(Instant::now() + self.patience);
            return happened;
        }
        ready!(self.silent.as_mut().poll(cx));
        Poll::Ready(Err(io::ErrorKind::TimedOut.into()))
    }
}

impl AsyncRead for Guest {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let read = Pin::new(&mut self.stream).poll_read(cx, buffer);
        self.heed(cx, read)
    }
}

impl AsyncWrite for Guest {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        octets: &[u8],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(cx, octets);
        self.heed(cx, written)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::Router;
    use axum::routing::get;
    use tokio::io::{AsyncReadExt, AsyncWriteExt};

    #[tokio::test]
    async fn those_who_say_nothing_make_room_for_those_who_do() {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let guests = Guests::at_most(3, Duration::from_millis(200), listener);
        let router = Router::new().route("/", get(|| async { "here" }));
        tokio::spawn(async move { axum::serve(guests, router).await });
        let mut silent = Vec::new();
        for _ in 0..9 {
            let mut guest = TcpStream::connect(address).await.unwrap();
            guest.write_all(b"GET / HTTP/1.1\r\nHo").await.unwrap();
            silent.push(guest);
        }
        let mut guest = TcpStream::connect(address).await.unwrap();
        let request = b"GET / HTTP/1.1\r\nhost: a\r\nconnection: close\r\n\r\n";
        guest.write_all(request).await.unwrap();
        let mut answer = String::new();
        guest.read_to_string(&mut answer).await.unwrap();
        assert!(answer.ends_with("here"), "{answer}");
        // The first was shown out.
        let mut rest = Vec::new();
        let read = silent[0].read_to_end(&mut rest).await;
        assert!(!rest.starts_with(b"HTTP/1.1 200"), "{read:?}");
    }
}
