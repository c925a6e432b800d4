//! Destinations of the corrected heading and of the alerts: TCP servers, datagrams, serial ports.
//!
//! No receiver can block the agent, and none gets an old heading after a new one.

use crate::config::{OutputConfig, Selection};
use crate::datagrams::Datagrams;
use crate::line::{Line, select};
use crate::open_error::OpenError;
use crate::serial_line::write_serial;
use crate::tcp_clients::{TcpClients, accept, write_timeout};
use binnacle_nmea::sentence::Acn;
use std::net::SocketAddr;
use std::sync::Arc;
use tokio::net::TcpListener;
use tokio::sync::{broadcast, mpsc};
use tokio_util::sync::CancellationToken;

/// Outputs that a receiver may lag behind: a client is dropped then, a serial port misses some.
const MAX_LAG: usize = 16;

/// Open outputs.
#[derive(Debug)]
pub struct Outputs {
    streams: Vec<Stream>,
    datagrams: Vec<Datagrams>,
    /// Address of the first TCP server.
    pub tcp_address: Option<SocketAddr>,
}

/// TCP server or serial port.
#[derive(Debug)]
struct Stream {
    selection: Selection,
    lines: broadcast::Sender<Arc<[Line]>>,
}

impl Outputs {
    /// Opens the configured outputs, which run until `shutdown`, and passes on the commands that
    /// their receivers send.
    ///
    /// # Errors
    /// An address that cannot be listened on, or sent to.
    pub async fn open(
        config: &OutputConfig,
        commands: &mpsc::Sender<Acn>,
        shutdown: &CancellationToken,
    ) -> Result<Outputs, OpenError> {
        let mut outputs = Outputs {
            streams: Vec::new(),
            datagrams: Vec::new(),
            tcp_address: None,
        };
        for server in &config.tcp_server {
            let address = server.address;
            let refused = |source| OpenError {
                field: "tcp_server",
                address,
                source,
            };
            let listener = TcpListener::bind(address).await.map_err(refused)?;
            let bound = listener.local_addr().map_err(refused)?;
            outputs.tcp_address.get_or_insert(bound);
            let clients = TcpClients {
                lines: outputs.add_stream(&server.sentences),
                commands: commands.clone(),
                write_timeout: write_timeout(config.interval_s.seconds()),
            };
            tokio::spawn(accept(listener, clients, shutdown.clone()));
        }
        for port in &config.serial {
            let lines = outputs.add_stream(&port.sentences).subscribe();
            let (commands, shutdown) = (commands.clone(), shutdown.clone());
            tokio::spawn(write_serial(port.clone(), lines, commands, shutdown));
        }
        for target in &config.udp {
            outputs.datagrams.push(Datagrams::plain(target)?);
        }
        for group in &config.multicast {
            let group = Datagrams::tagged(group, config.talker)?;
            outputs.datagrams.push(group);
        }
        Ok(outputs)
    }

    fn add_stream(&mut self, selection: &Selection) -> broadcast::Sender<Arc<[Line]>> {
        let (lines, _) = broadcast::channel(MAX_LAG);
        self.streams.push(Stream {
            selection: selection.clone(),
            lines: lines.clone(),
        });
        lines
    }

    /// Sends to all receivers without waiting.
    pub fn send(&mut self, lines: &[Line]) {
        for output in &mut self.datagrams {
            output.send(lines);
        }
        for stream in &self.streams {
            let selected: Arc<[Line]> = select(lines, &stream.selection).cloned().collect();
            if !selected.is_empty() {
                // An error only means that no client is connected.
                stream.lines.send(selected).ok();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::SentenceKind;
    use std::io;
    use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
    use tokio::net::{TcpStream, UdpSocket};

    struct Opened {
        outputs: Outputs,
        commands: mpsc::Receiver<Acn>,
        _shutdown: CancellationToken,
    }

    async fn open(toml: &str) -> Result<Opened, OpenError> {
        let config: OutputConfig = toml::from_str(toml).unwrap();
        let (commands, taken) = mpsc::channel(1);
        let shutdown = CancellationToken::new();
        Ok(Opened {
            outputs: Outputs::open(&config, &commands, &shutdown).await?,
            commands: taken,
            _shutdown: shutdown,
        })
    }

    async fn server() -> (Opened, SocketAddr) {
        let opened = open("tcp_server = \"127.0.0.1:0\"").await.unwrap();
        let address = opened.outputs.tcp_address.unwrap();
        (opened, address)
    }

    fn heading(text: &str) -> [Line; 1] {
        [Line::single(
            SentenceKind::Hdt,
            format!("{text}\r\n").into_bytes(),
        )]
    }

    /// Waits until the given number of clients is connected.
    async fn connected(opened: &Opened, clients: usize) {
        while opened.outputs.streams[0].lines.receiver_count() < clients {
            tokio::task::yield_now().await;
        }
    }

    #[tokio::test]
    async fn every_client_hears_every_line() {
        let (mut opened, address) = server().await;
        let first = TcpStream::connect(address).await.unwrap();
        let second = TcpStream::connect(address).await.unwrap();
        connected(&opened, 2).await;
        for text in ["one", "two"] {
            opened.outputs.send(&heading(text));
        }
        for client in [first, second] {
            let mut lines = BufReader::new(client).lines();
            assert_eq!(lines.next_line().await.unwrap().unwrap(), "one");
            assert_eq!(lines.next_line().await.unwrap().unwrap(), "two");
        }
    }

    #[tokio::test]
    async fn a_client_that_does_not_keep_up_is_dropped_and_the_others_are_not() {
        let (mut opened, address) = server().await;
        let mut slow = TcpStream::connect(address).await.unwrap();
        connected(&opened, 1).await;
        // Without a pause for the client's task, it falls behind at once.
        for _ in 0..4 * MAX_LAG {
            opened.outputs.send(&heading("line"));
        }
        let mut rest = Vec::new();
        let cut = slow.read_to_end(&mut rest).await.unwrap_err();
        assert_eq!(cut.kind(), io::ErrorKind::ConnectionReset);
        let mut quick = BufReader::new(TcpStream::connect(address).await.unwrap()).lines();
        connected(&opened, 1).await;
        opened.outputs.send(&heading("after"));
        assert_eq!(quick.next_line().await.unwrap().unwrap(), "after");
    }

    #[tokio::test]
    async fn commands_of_a_client_are_passed_on_and_what_is_none_is_not() {
        let (mut opened, address) = server().await;
        let mut client = TcpStream::connect(address).await.unwrap();
        connected(&opened, 1).await;
        let sent = b"GET / HTTP/1.1\r\n\r\n$GPHDT,274.07,T*03\r\n$CAACN,,BIN,10001,1,A,C*00\r\n\
                     $CAACN,,BIN,10002,1,S,C*19\r\n$CAACN,,BIN,10001,1,A,C*08\r\n";
        client.write_all(sent).await.unwrap();
        // The side that it does not write to any more still gets the heading.
        client.shutdown().await.unwrap();
        let first = opened.commands.recv().await.unwrap();
        assert_eq!(first.alert.number, 10_002);
        let second = opened.commands.recv().await.unwrap();
        assert_eq!(second.alert.number, 10_001);
        opened.outputs.send(&heading("still"));
        let mut lines = BufReader::new(client).lines();
        assert_eq!(lines.next_line().await.unwrap().unwrap(), "still");
    }

    #[tokio::test]
    async fn datagrams_reach_all_their_addresses_with_the_sentences_of_each() {
        let all = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let alerts = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let mut opened = open(&format!(
            "alarm_sentence = true\nudp = [\"{}\", {{ address = \"{}\", sentences = [\"ALR\"] }}]",
            all.local_addr().unwrap(),
            alerts.local_addr().unwrap()
        ))
        .await
        .unwrap();
        let [line] = heading("heading");
        let alarm = Line::single(SentenceKind::Alr, b"alarm\r\n".to_vec());
        opened.outputs.send(&[line, alarm]);
        let mut buffer = [0; 64];
        let length = all.recv(&mut buffer).await.unwrap();
        assert_eq!(&buffer[..length], b"heading\r\nalarm\r\n");
        let length = alerts.recv(&mut buffer).await.unwrap();
        assert_eq!(&buffer[..length], b"alarm\r\n");
    }

    #[tokio::test]
    async fn an_address_in_use_is_named() {
        let (_opened, address) = server().await;
        let error = open(&format!("tcp_server = \"{address}\"")).await;
        assert!(
            error
                .err()
                .unwrap()
                .to_string()
                .contains(&address.to_string())
        );
    }
}
