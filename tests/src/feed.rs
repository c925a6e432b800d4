//! A ship's bridge: sends sentences over TCP at the agent's pace.
//!
//! Time passes on the bridge with or without an agent. Sentences under way to
//! an agent that died are lost, and the next one continues from there.

use anyhow::{Context, Result, bail};
use binnacle_compass::time::Timestamp;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncRead, AsyncWriteExt, BufReader};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::task::JoinHandle;
use tokio::time::{MissedTickBehavior, interval, timeout};

/// Approximate size of the pieces sent, in bytes.
const PIECE: usize = 32 * 1024;
/// Real time of a ship's second in live mode.
const LIVE_SECOND: Duration = Duration::from_millis(20);

/// Pace of time on the bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// As fast as the agent reads, up to an instant; then the ship waits.
    FastUntil(Timestamp),
    /// At fifty times real time, to the end.
    Live,
}

impl Pace {
    /// True if time may pass beyond an instant.
    fn allows(&self, time: Timestamp) -> bool {
        match self {
            Pace::FastUntil(end) => time < *end,
            Pace::Live => true,
        }
    }
}

/// Progress of the bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// Nothing was sent yet.
    Waiting,
    /// Time of the last fix sent.
    At(Timestamp),
    /// Everything was sent.
    Ended,
}

impl Progress {
    /// Returns the time of the last fix sent.
    pub fn time(&self) -> Option<Timestamp> {
        match self {
            Progress::At(time) => Some(*time),
            Progress::Waiting | Progress::Ended => None,
        }
    }
}

/// State of the bridge's satellite receiver.
#[derive(Clone, Copy, Debug, Default)]
struct Receiver {
    /// Error of its clock, seconds.
    clock_off_s: f64,
    /// True while its position is false.
    is_spoofed: bool,
}

/// A bridge that sends its sentences to one agent.
#[derive(Debug)]
pub struct Feed {
    address: SocketAddr,
    pace: watch::Sender<Pace>,
    receiver: watch::Sender<Receiver>,
    progress: watch::Receiver<Progress>,
    task: JoinHandle<Result<()>>,
}

impl Feed {
    /// Listens on a free port for an agent on this machine.
    ///
    /// # Errors
    /// Fails when there is no port.
    pub async fn start(
        source: impl AsyncRead + Send + Unpin + 'static,
        pace: Pace,
    ) -> Result<Feed> {
        Feed::start_at(IpAddr::V4(Ipv4Addr::LOCALHOST), source, pace).await
    }

    /// Listens at an address.
    ///
    /// # Errors
    /// Fails when there is no such address, or no port.
    pub async fn start_at(
        address: IpAddr,
        source: impl AsyncRead + Send + Unpin + 'static,
        pace: Pace,
    ) -> Result<Feed> {
        let listener = TcpListener::bind((address, 0)).await?;
        let address = listener.local_addr()?;
        let (pace, paces) = watch::channel(pace);
        let (receiver, receivers) = watch::channel(Receiver::default());
        let (sender, progress) = watch::channel(Progress::Waiting);
        let bridge = Bridge {
            listener,
            agent: None,
            source: BufReader::with_capacity(PIECE, source),
            piece: Vec::with_capacity(2 * PIECE),
            paces,
            receivers,
            sender,
        };
        let task = tokio::spawn(bridge.run());
        Ok(Feed {
            address,
            pace,
            receiver,
            progress,
            task,
        })
    }

    /// The address of the sentences.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Changes the pace.
    ///
    /// # Errors
    /// Fails when the feed has failed.
    pub fn set_pace(&self, pace: Pace) -> Result<()> {
        self.pace.send(pace).context("the feed has ended")
    }

    /// Sets the error of the receiver's clock; pace and progress use the right
    /// time.
    ///
    /// # Errors
    /// Fails when the feed has failed.
    pub fn set_clock(&self, off_s: f64) -> Result<()> {
        let mut receiver = *self.receiver.borrow();
        receiver.clock_off_s = off_s;
        self.receiver.send(receiver).context("the feed has ended")
    }

    /// Moves the receiver's position in circles off Portugal, or ends that; pace and progress use
    /// the right time.
    ///
    /// # Errors
    /// Fails when the feed has failed.
    pub fn set_spoofed(&self, is_spoofed: bool) -> Result<()> {
        let mut receiver = *self.receiver.borrow();
        receiver.is_spoofed = is_spoofed;
        self.receiver.send(receiver).context("the feed has ended")
    }

    /// Waits until the bridge's progress is `enough`.
    ///
    /// # Errors
    /// Fails when it is not `within` the time, or the feed failed.
    pub async fn reached(
        &mut self,
        within: Duration,
        enough: impl FnMut(&Progress) -> bool,
    ) -> Result<Progress> {
        let seen = self.progress.clone();
        match timeout(within, self.progress.wait_for(enough)).await {
            Ok(progress) => Ok(*progress.context("the feed has failed")?),
            Err(_) => bail!("the ship only came to {:?}", *seen.borrow()),
        }
    }
}

impl Drop for Feed {
    fn drop(&mut self) {
        self.task.abort();
    }
}

struct Bridge<S> {
    listener: TcpListener,
    agent: Option<TcpStream>,
    source: BufReader<S>,
    piece: Vec<u8>,
    paces: watch::Receiver<Pace>,
    receivers: watch::Receiver<Receiver>,
    sender: watch::Sender<Progress>,
}

impl<S: AsyncRead + Unpin> Bridge<S> {
    async fn run(mut self) -> Result<()> {
        let mut ticks = interval(LIVE_SECOND);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            let start = self.piece.len();
            if self.source.read_until(b'\n', &mut self.piece).await? == 0 {
                break;
            }
            let fix = time_of_fix(&self.piece[start..]);
            let receiver = *self.receivers.borrow();
            if receiver.clock_off_s != 0.0 {
                self.change(start, |line| with_time_shifted(line, receiver.clock_off_s));
            }
            if receiver.is_spoofed {
                self.change(start, with_false_position);
            }
            if let Some(time) = fix {
                self.sender.send_replace(Progress::At(time));
                let pace = *self.paces.borrow();
                match pace {
                    Pace::Live => {
                        self.send().await?;
                        ticks.tick().await;
                    }
                    Pace::FastUntil(end) if time >= end => {
                        self.send().await?;
                        self.paces.wait_for(|pace| pace.allows(time)).await?;
                    }
                    Pace::FastUntil(_) => {}
                }
            }
            if self.piece.len() >= PIECE {
                self.send().await?;
            }
        }
        self.send().await?;
        self.sender.send_replace(Progress::Ended);
        // The instruments fall silent; the connection stays open.
        std::future::pending().await
    }

    /// Puts another sentence in place of the last one, if there is one to put.
    fn change(&mut self, start: usize, change: impl FnOnce(&[u8]) -> Option<Vec<u8>>) {
        if let Some(changed) = change(&self.piece[start..]) {
            self.piece.truncate(start);
            self.piece.extend(changed);
        }
    }

    /// Sends the piece to the connected agent, or waits for one.
    async fn send(&mut self) -> Result<()> {
        while !self.piece.is_empty() {
            let agent = match &mut self.agent {
                Some(agent) => agent,
                None => self.agent.insert(self.listener.accept().await?.0),
            };
            if agent.write_all(&self.piece).await.is_err() {
                self.agent = None;
            }
            // Read or lost: the bridge does not repeat it.
            self.piece.clear();
        }
        Ok(())
    }
}

/// Returns the time of the fix in an RMC sentence. A sentence with a wrong
/// checksum, as on a poor line, is ignored.
fn time_of_fix(line: &[u8]) -> Option<Timestamp> {
    if line.get(3..7)? != b"RMC," {
        return None;
    }
    let (body, sum) = std::str::from_utf8(&line[1..])
        .ok()?
        .trim_end()
        .split_once('*')?;
    let computed = body.bytes().fold(0, |sum, byte| sum ^ byte);
    if sum != format!("{computed:02X}") {
        return None;
    }
    let mut fields = body.split(',').skip(1);
    let (clock, day) = (fields.next()?, fields.nth(7)?);
    let (dd, mm, yy) = (day.get(0..2)?, day.get(2..4)?, day.get(4..6)?);
    let (hour, minute, second) = (clock.get(0..2)?, clock.get(2..4)?, clock.get(4..6)?);
    Timestamp::parse(&format!("20{yy}-{mm}-{dd}T{hour}:{minute}:{second}Z")).ok()
}

/// Returns an RMC or ZDA sentence with its time shifted.
fn with_time_shifted(line: &[u8], off_s: f64) -> Option<Vec<u8>> {
    let mut fields = fields_of(line)?;
    let is_zda = fields[0].ends_with("ZDA");
    let date = if is_zda {
        format!("{}-{}-{}", fields[4], fields[3], fields[2])
    } else if fields[0].ends_with("RMC") {
        let ddmmyy = fields[9].clone();
        let part = |from: usize| ddmmyy.get(from..from + 2);
        format!("20{}-{}-{}", part(4)?, part(2)?, part(0)?)
    } else {
        return None;
    };
    let clock = fields[1].clone();
    let part = |from: usize| clock.get(from..from + 2);
    let time = format!("{date}T{}:{}:{}Z", part(0)?, part(2)?, clock.get(4..)?);
    let wrong = Timestamp::parse(&time)
        .ok()?
        .plus_seconds(off_s)
        .to_string();
    // YYYY-MM-DDTHH:MM:SS
    let part = |from: usize, to: usize| wrong.get(from..to);
    fields[1] = format!("{}{}{}.00", part(11, 13)?, part(14, 16)?, part(17, 19)?);
    let (year, month, day) = (part(0, 4)?, part(5, 7)?, part(8, 10)?);
    if is_zda {
        [fields[4], fields[3], fields[2]] = [year, month, day].map(str::to_owned);
    } else {
        fields[9] = format!("{day}{month}{}", part(2, 4)?);
    }
    Some(sentence_of(&fields))
}

/// Returns an RMC sentence with a position that goes in circles of a mile off Portugal, six minutes
/// each.
fn with_false_position(line: &[u8]) -> Option<Vec<u8>> {
    let seconds = time_of_fix(line)?.micros() / 1_000_000;
    let mut fields = fields_of(line)?;
    let (north, east) = (seconds as f64).to_radians().sin_cos();
    let minutes = |of: f64| format!("{:07.4}", 30.0 + of);
    let place = [
        format!("40{}", minutes(north)),
        "N".to_owned(),
        format!("010{}", minutes(-east)),
        "W".to_owned(),
    ];
    fields.get_mut(3..7)?.clone_from_slice(&place);
    Some(sentence_of(&fields))
}

/// Returns the fields of a sentence, the first one with talker and name.
fn fields_of(line: &[u8]) -> Option<Vec<String>> {
    let text = std::str::from_utf8(line).ok()?;
    let (body, _) = text.strip_prefix('$')?.trim_end().split_once('*')?;
    Some(body.split(',').map(str::to_owned).collect())
}

fn sentence_of(fields: &[String]) -> Vec<u8> {
    let body = fields.join(",");
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n").into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_with_its_time_shifted_has_a_right_checksum() {
        let fix = b"$GPRMC,073015.00,A,4321.10,N,00301.50,W,12.4,085.0,211126,,,A*73\r\n";
        let day_later = with_time_shifted(fix, 86_400.0).unwrap();
        let time = Timestamp::parse("2026-11-22T07:30:15Z").unwrap();
        assert_eq!(time_of_fix(&day_later), Some(time));
        let zda = with_time_shifted(b"$GPZDA,073015.00,21,11,2026,,*00\r\n", -86_400.0).unwrap();
        assert!(zda.starts_with(b"$GPZDA,073015.00,20,11,2026,,*"));
        assert_eq!(with_time_shifted(b"$HCHDG,010.0,,,,*00\r\n", 1.0), None);
    }

    #[test]
    fn a_false_position_keeps_its_time_and_circles() {
        let fix = b"$GPRMC,073015.00,A,4321.10,N,00301.50,W,12.4,085.0,211126,,,A*73\r\n";
        let moved = with_false_position(fix).unwrap();
        assert_eq!(time_of_fix(&moved), time_of_fix(fix));
        let fields = fields_of(&moved).unwrap();
        assert!(fields[3].starts_with("40") && fields[5].starts_with("010"));
        assert_eq!(with_false_position(b"$HCHDG,010.0,,,,*00\r\n"), None);
    }

    #[test]
    fn only_a_fix_has_a_time() {
        let fix = b"$GPRMC,073015.00,A,4321.10,N,00301.50,W,12.4,085.0,211126,,,A*73\r\n";
        let time = Timestamp::parse("2026-11-21T07:30:15Z").unwrap();
        assert_eq!(time_of_fix(fix), Some(time));
        let damaged = fix.map(|byte| if byte == b'6' { b'5' } else { byte });
        assert_eq!(time_of_fix(&damaged), None);
        assert_eq!(time_of_fix(b"$HCHDG,010.0,,,,*00\r\n"), None);
        assert_eq!(time_of_fix(b"$GPRMC,,V,,,,,,,,,,N*00\r\n"), None);
        assert_eq!(time_of_fix(b"\xff\r\n"), None);
    }
}
