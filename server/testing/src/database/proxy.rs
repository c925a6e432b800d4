//! A TCP proxy that can be cut, as a cable can.

use std::net::SocketAddr;
use tokio::io::copy_bidirectional;
use tokio::net::{TcpListener, TcpStream};
use tokio::task::{JoinHandle, JoinSet};

/// A proxy on the local host.
pub struct Proxy {
    address: SocketAddr,
    target: SocketAddr,
    running: Option<JoinHandle<()>>,
}

impl Proxy {
    /// Starts a proxy to an address.
    pub async fn start(target: SocketAddr) -> Proxy {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        Proxy {
            address: listener.local_addr().unwrap(),
            target,
            running: Some(tokio::spawn(forward(listener, target))),
        }
    }

    /// Returns the port to connect to.
    pub fn port(&self) -> u16 {
        self.address.port()
    }

    /// Ends every connection, and refuses further ones.
    pub async fn cut(&mut self) {
        let running = self.running.take().expect("it is not cut yet");
        running.abort();
        assert!(running.await.unwrap_err().is_cancelled());
    }

    /// Accepts connections again.
    pub async fn mend(&mut self) {
        let listener = TcpListener::bind(self.address).await.unwrap();
        self.running = Some(tokio::spawn(forward(listener, self.target)));
    }
}

async fn forward(listener: TcpListener, target: SocketAddr) {
    let mut connections = JoinSet::new();
    loop {
        let (mut near, _) = listener.accept().await.unwrap();
        connections.spawn(async move {
            let mut far = TcpStream::connect(target).await.unwrap();
            // Either end may break off.
            let _ = copy_bidirectional(&mut near, &mut far).await;
        });
    }
}
