//! Serial ports of the output.
//!
//! No old heading is written. The port is given no more than the line carries, so that nothing
//! waits in the kernel. What waits here is replaced by what is newer, and thrown away while the
//! port is gone.

use crate::bridge_commands::read_commands;
use crate::config::SerialOutputConfig;
use crate::line::Line;
use binnacle_nmea::sentence::Acn;
use std::collections::VecDeque;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncWrite, AsyncWriteExt};
use tokio::sync::broadcast::error::{RecvError, TryRecvError};
use tokio::sync::{broadcast, mpsc};
use tokio::time::{sleep, timeout};
use tokio_serial::{ClearBuffer, SerialPort, SerialPortBuilderExt, SerialStream};
use tokio_util::sync::CancellationToken;

/// Pause before a failed serial port is opened again.
const RETRY: Duration = Duration::from_secs(5);
/// Time beyond its own within which a port must take a line.
const WRITE_TIMEOUT: Duration = Duration::from_secs(1);
/// Bits of a byte on the line.
const BITS_PER_BYTE: f64 = 10.0;
/// Sentences of alerts that wait for a slow line.
const MAX_WAITING_ALERTS: usize = 32;

/// Writes to a port until `shutdown`, and reads its commands.
pub(crate) async fn write_serial(
    config: SerialOutputConfig,
    mut lines: broadcast::Receiver<Arc<[Line]>>,
    commands: mpsc::Sender<Acn>,
    shutdown: CancellationToken,
) {
    let path = config.path();
    let mut reported = false;
    loop {
        let session = run_session(&config, &mut lines, &commands);
        let Some(Err(error)) = shutdown.run_until_cancelled(session).await else {
            return;
        };
        if !reported {
            tracing::warn!(path, %error, "the serial output failed, retrying");
            reported = true;
        }
        if shutdown.run_until_cancelled(sleep(RETRY)).await.is_none() {
            return;
        }
    }
}

async fn run_session(
    config: &SerialOutputConfig,
    lines: &mut broadcast::Receiver<Arc<[Line]>>,
    commands: &mpsc::Sender<Acn>,
) -> io::Result<()> {
    let port = tokio_serial::new(config.path(), config.baud()).open_native_async()?;
    // What was sent while the port was gone is no heading of now.
    *lines = lines.resubscribe();
    let (port, ended) = use_port(port, lines, commands, config.baud()).await;
    // Closing would wait for a line that takes nothing.
    port.clear(ClearBuffer::Output).ok();
    ended
}

async fn use_port(
    port: SerialStream,
    lines: &mut broadcast::Receiver<Arc<[Line]>>,
    commands: &mpsc::Sender<Acn>,
    baud: u32,
) -> (SerialStream, io::Result<()>) {
    let (mut received, mut sent) = tokio::io::split(port);
    let ended = tokio::select! {
        ended = write_lines(&mut sent, lines, baud) => ended,
        never = read_commands(&mut received, commands) => match never {},
    };
    (received.unsplit(sent), ended)
}

async fn write_lines<P: AsyncWrite + Unpin>(
    port: &mut P,
    lines: &mut broadcast::Receiver<Arc<[Line]>>,
    baud: u32,
) -> io::Result<()> {
    let mut queue = Queue::default();
    loop {
        if queue.is_empty() {
            match lines.recv().await {
                Ok(lines) => queue.push(&lines),
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => return Ok(()),
            }
        }
        loop {
            match lines.try_recv() {
                Ok(lines) => queue.push(&lines),
                Err(TryRecvError::Lagged(_)) => {}
                Err(_) => break,
            }
        }
        let text = queue.take();
        let on_line = Duration::from_secs_f64(text.len() as f64 * BITS_PER_BYTE / f64::from(baud));
        timeout(on_line + WRITE_TIMEOUT, port.write_all(&text))
            .await
            .map_err(|_| io::Error::new(io::ErrorKind::TimedOut, "the port takes nothing"))??;
        sleep(on_line).await;
    }
}

/// Lines that wait for the port.
#[derive(Debug, Default)]
struct Queue {
    /// Newest of each kind.
    headings: Vec<Line>,
    alerts: VecDeque<Line>,
}

impl Queue {
    fn is_empty(&self) -> bool {
        self.headings.is_empty() && self.alerts.is_empty()
    }

    fn push(&mut self, lines: &[Line]) {
        for line in lines {
            if line.is_heading() {
                self.headings.retain(|waiting| waiting.kind != line.kind);
                self.headings.push(line.clone());
                continue;
            }
            if self.alerts.len() >= MAX_WAITING_ALERTS {
                self.alerts.pop_front();
            }
            self.alerts.push_back(line.clone());
        }
    }

    /// Takes all headings and one sentence of the alerts, so that these delay no heading.
    fn take(&mut self) -> Vec<u8> {
        let alert = self.alerts.pop_front();
        let lines = self.headings.drain(..).chain(alert);
        lines.flat_map(|line| line.text).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::SentenceKind;
    use tokio::io::AsyncReadExt;

    fn line(kind: SentenceKind, text: &str) -> Line {
        Line::single(kind, format!("{text}\r\n").into_bytes())
    }

    fn lines(kind: SentenceKind, text: &str) -> Arc<[Line]> {
        [line(kind, text)].into()
    }

    #[test]
    fn a_newer_heading_replaces_one_that_waits_and_alerts_wait_in_order() {
        let mut queue = Queue::default();
        queue.push(&[
            line(SentenceKind::Hdt, "old"),
            line(SentenceKind::Ths, "ths"),
            line(SentenceKind::Alf, "first"),
        ]);
        queue.push(&[
            line(SentenceKind::Alf, "second"),
            line(SentenceKind::Hdt, "new"),
        ]);
        assert_eq!(queue.take(), b"ths\r\nnew\r\nfirst\r\n");
        assert_eq!(queue.take(), b"second\r\n");
        assert!(queue.is_empty());
        for _ in 0..100 {
            queue.push(&[line(SentenceKind::Alf, "alert")]);
        }
        assert_eq!(queue.alerts.len(), MAX_WAITING_ALERTS);
    }

    #[tokio::test]
    async fn a_port_that_was_gone_gets_no_old_heading() {
        let (mut instrument, port) = SerialStream::pair().unwrap();
        let path = port.name().expect("a pseudo-terminal has a name");
        let config: SerialOutputConfig =
            toml::from_str(&format!("path = \"{path}\"\nbaud = 38400")).unwrap();
        let (sender, mut receiver) = broadcast::channel(4);
        for text in ["1", "2", "3", "4", "5", "6"] {
            sender.send(lines(SentenceKind::Hdt, text)).unwrap();
        }
        let (commands, mut taken) = mpsc::channel(1);
        let session = run_session(&config, &mut receiver, &commands);
        let instrument = async {
            // Once its command has come through, the port is open.
            let acknowledge = b"$CAACN,,BIN,10001,1,A,C*08\r\n";
            instrument.write_all(acknowledge).await.unwrap();
            assert_eq!(taken.recv().await.unwrap().alert.number, 10_001);
            sender.send(lines(SentenceKind::Hdt, "now")).unwrap();
            let mut read = [0; 5];
            instrument.read_exact(&mut read).await.unwrap();
            assert_eq!(&read, b"now\r\n");
            drop(sender);
        };
        let (ended, ()) = tokio::join!(session, instrument);
        ended.unwrap();
    }

    #[tokio::test]
    async fn a_slow_line_gets_the_newest_heading_and_no_queue_of_old_ones() {
        for waiting in [3, 10] {
            let (mut port, mut instrument) = tokio::io::duplex(4096);
            let (sender, mut receiver) = broadcast::channel(4);
            for count in 1..=waiting {
                let text = count.to_string();
                sender.send(lines(SentenceKind::Hdt, &text)).unwrap();
            }
            drop(sender);
            write_lines(&mut port, &mut receiver, 1_000_000)
                .await
                .unwrap();
            drop(port);
            let mut read = String::new();
            instrument.read_to_string(&mut read).await.unwrap();
            assert_eq!(read, format!("{waiting}\r\n"));
        }
    }
}
