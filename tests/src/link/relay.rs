//! Passes TCP connections on to an address that can be changed, as the virtual address of a
//! database cluster does.

use anyhow::Result;
use std::net::SocketAddr;
use tokio::io::copy_bidirectional;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::task::JoinHandle;

/// A running relay.
#[derive(Debug)]
pub struct Relay {
    /// Its own address.
    pub address: SocketAddr,
    target: watch::Sender<SocketAddr>,
    task: JoinHandle<()>,
}

impl Relay {
    /// Opens a relay to a target.
    ///
    /// # Errors
    /// Fails when there is no port.
    pub async fn open(target: SocketAddr) -> Result<Relay> {
        let listener = TcpListener::bind("127.0.0.1:0").await?;
        let address = listener.local_addr()?;
        let (target, current) = watch::channel(target);
        let task = tokio::spawn(async move {
            while let Ok((mut client, _)) = listener.accept().await {
                let mut current = current.clone();
                let to = *current.borrow_and_update();
                tokio::spawn(async move {
                    let pass = async {
                        let mut server = TcpStream::connect(to).await?;
                        copy_bidirectional(&mut client, &mut server).await
                    };
                    // A change ends open connections.
                    tokio::select! {
                        _ = pass => {}
                        _ = current.changed() => {}
                    }
                });
            }
        });
        Ok(Relay {
            address,
            target,
            task,
        })
    }

    /// Ends all connections; new ones go to another target.
    pub fn redirect(&self, target: SocketAddr) {
        self.target.send_replace(target);
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        self.task.abort();
    }
}
