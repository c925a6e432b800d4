//! Messages of an NMEA 2000 bus: from the kernel's CAN sockets, or from a gateway.

use super::link::{End, Link, connect};
use crate::config::{ActisenseConfig, YdwgConfig};
use binnacle_nmea::lines::Line;
use binnacle_nmea::n2k::{Frame, Header, actisense, text};
use binnacle_nmea::{Lines, Tally};
use binnacle_observation::Observation;
use binnacle_observation::n2k::N2kReader;
use binnacle_observation::signalk::DeltaCounts;
use socketcan::{CanFrame, CanSocket, EmbeddedFrame, Frame as _, Socket};
use std::io;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt};
use tokio::net::UdpSocket;
use tokio::sync::mpsc;
use tokio_serial::SerialPortBuilderExt;

/// Chunk size: about a second of a full bus.
const CHUNK_BYTES: usize = 64 * 1024;

/// Longest time for which a thread waits for a frame.
const READ_TIMEOUT: Duration = Duration::from_millis(500);
/// Frames that may wait to be decoded.
const FRAMES_AT_ONCE: usize = 64;

/// Decoder of one connection.
struct Decoder {
    form: Form,
    reader: N2kReader,
    counts: DeltaCounts,
    out: Vec<Observation>,
}

/// Form in which a gateway sends messages.
enum Form {
    Actisense(actisense::Decoder),
    Ydwg(Lines),
}

impl Decoder {
    fn new(form: Form, link: &Link) -> Decoder {
        Decoder {
            form,
            reader: N2kReader::new(link.name.clone()),
            counts: DeltaCounts::default(),
            out: Vec::new(),
        }
    }

    fn chunk(&mut self, bytes: &[u8]) {
        let (reader, counts, out) = (&mut self.reader, &mut self.counts, &mut self.out);
        match &mut self.form {
            Form::Actisense(decoder) => decoder.push(bytes, |_, message| {
                reader.message(&message, counts, |seen| out.push(seen));
            }),
            Form::Ydwg(lines) => lines.push(bytes, |line| {
                let Line::Whole(line) = line else {
                    return;
                };
                match text::parse_line(line).map(|line| line.content) {
                    Some(text::Content::Frame(frame)) => {
                        reader.frame(&frame, counts, |seen| out.push(seen));
                    }
                    Some(text::Content::Message(message)) => {
                        reader.message(&message, counts, |seen| out.push(seen));
                    }
                    None => counts.reject("not a frame"),
                }
            }),
        }
    }

    fn frame(&mut self, frame: &Frame) {
        let out = &mut self.out;
        self.reader
            .frame(frame, &mut self.counts, |seen| out.push(seen));
    }

    fn count(&mut self, bytes: usize, link: &Link) {
        link.stats.count_received(bytes, &Tally::default());
        link.stats.count_values(&std::mem::take(&mut self.counts));
    }
}

pub(crate) async fn actisense(config: &ActisenseConfig, link: &Link) -> io::Result<End> {
    let decoder = Decoder::new(Form::Actisense(actisense::Decoder::of_stream()), link);
    match config {
        ActisenseConfig::Serial { path, baud } => {
            let stream = tokio_serial::new(path, *baud).open_native_async()?;
            link.opened();
            pump(stream, decoder, link).await
        }
        ActisenseConfig::Tcp(address) => {
            let stream = connect(address.as_str()).await?;
            link.opened();
            pump(stream, decoder, link).await
        }
    }
}

pub(crate) async fn ydwg(config: &YdwgConfig, link: &Link) -> io::Result<End> {
    let decoder = Decoder::new(Form::Ydwg(Lines::default()), link);
    match config {
        YdwgConfig::Tcp(address) => {
            let stream = connect(address.as_str()).await?;
            link.opened();
            pump(stream, decoder, link).await
        }
        YdwgConfig::Udp(address) => datagrams(*address, decoder, link).await,
    }
}

async fn pump(
    mut stream: impl AsyncRead + Unpin,
    mut decoder: Decoder,
    link: &Link,
) -> io::Result<End> {
    let mut buffer = vec![0; CHUNK_BYTES];
    loop {
        let count = stream.read(&mut buffer).await?;
        if count == 0 {
            return Ok(End::Closed);
        }
        decoder.chunk(&buffer[..count]);
        decoder.count(count, link);
        link.deliver(std::mem::take(&mut decoder.out)).await?;
    }
}

async fn datagrams(address: SocketAddr, mut decoder: Decoder, link: &Link) -> io::Result<End> {
    let socket = UdpSocket::bind(address).await?;
    link.opened();
    let mut buffer = vec![0; CHUNK_BYTES];
    loop {
        let (count, sender) = socket.recv_from(&mut buffer).await?;
        decoder.reader.set_sender(sender.ip());
        decoder.chunk(&buffer[..count]);
        // A datagram ends its last line.
        decoder.chunk(b"\n");
        decoder.count(count, link);
        link.offer(std::mem::take(&mut decoder.out))?;
    }
}

pub(crate) async fn socketcan(interface: &str, link: &Link) -> io::Result<End> {
    let socket = CanSocket::open(interface)?;
    link.opened();
    frames(socket, link).await
}

/// Reads the frames of a socket, on a thread of its own.
async fn frames(socket: CanSocket, link: &Link) -> io::Result<End> {
    // Between frames the thread looks whether it is still needed.
    socket.set_read_timeout(READ_TIMEOUT)?;
    let (tx, mut rx) = mpsc::channel(FRAMES_AT_ONCE);
    tokio::task::spawn_blocking(move || read_frames(&socket, &tx));
    let mut decoder = Decoder::new(Form::Ydwg(Lines::default()), link);
    while let Some(read) = rx.recv().await {
        let frame: CanFrame = read?;
        let CanFrame::Data(data) = frame else {
            continue;
        };
        if !data.is_extended() {
            continue;
        }
        let header = Header::from_identifier(data.raw_id());
        if let Some(frame) = Frame::new(header, data.data()) {
            decoder.frame(&frame);
        }
        decoder.count(data.data().len(), link);
        link.deliver(std::mem::take(&mut decoder.out)).await?;
    }
    Ok(End::Closed)
}

fn read_frames(socket: &CanSocket, tx: &mpsc::Sender<io::Result<CanFrame>>) {
    loop {
        match socket.read_frame() {
            Ok(frame) => {
                if tx.blocking_send(Ok(frame)).is_err() {
                    return;
                }
            }
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
                ) =>
            {
                if tx.is_closed() {
                    return;
                }
            }
            Err(error) => {
                // A receiver that is gone needs no reason.
                tx.blocking_send(Err(error)).ok();
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InputStats;
    use binnacle_nmea::n2k::Address;
    use binnacle_observation::Reading;
    use std::os::fd::OwnedFd;
    use std::os::unix::net::UnixDatagram;
    use std::sync::Arc;

    fn link() -> (Link, mpsc::Receiver<Vec<Observation>>) {
        let (tx, rx) = mpsc::channel(16);
        (
            Link::new("bus".into(), tx, Arc::new(InputStats::default())),
            rx,
        )
    }

    fn is_compass(seen: &[Observation]) -> bool {
        matches!(
            seen,
            [Observation {
                reading: Reading::Compass { .. },
                ..
            }]
        )
    }

    /// A frame as the kernel hands it over, where it has no CAN bus: through a pair of sockets.
    #[tokio::test]
    async fn a_frame_from_a_can_socket_is_an_observation() {
        let (ours, kernels) = UnixDatagram::pair().unwrap();
        let (link, mut rx) = link();
        let reading = async { frames(CanSocket::from(OwnedFd::from(kernels)), &link).await };
        let sending = async {
            for identifier in [0x123_u32, 0x89f1_12cc] {
                let mut frame = identifier.to_ne_bytes().to_vec();
                frame.extend([8, 0, 0, 0]);
                frame.extend([0xff, 0x4b, 0xed, 0xff, 0x7f, 0xff, 0x7f, 0xfd]);
                ours.send(&frame).unwrap();
            }
            rx.recv().await.unwrap()
        };
        let seen = tokio::select! {
            ended = reading => panic!("{ended:?}"),
            seen = sending => seen,
        };
        assert!(is_compass(&seen), "{seen:?}");
        assert_eq!(seen[0].source.n2k_address.map(Address::number), Some(204));
    }

    #[tokio::test]
    async fn a_gateway_s_lines_and_frames_are_observations() {
        for (form, bytes) in [
            (
                Form::Ydwg(Lines::default()),
                b"05:15:49.768 R 09F112CC FF 4B ED FF 7F FF 7F FD\r\nnoise\r\n".to_vec(),
            ),
            (
                Form::Actisense(actisense::Decoder::of_stream()),
                [
                    &[0x10, 0x02, 0x93, 0x13, 0x02, 0x12, 0xf1, 0x01, 0xff, 0xcc][..],
                    &[0xb1, 0x5d, 0x0a, 0x00, 0x08, 0xff, 0x4b, 0xed, 0xff, 0x7f],
                    &[0xff, 0x7f, 0xfd, 0x39, 0x10, 0x03],
                ]
                .concat(),
            ),
        ] {
            let (link, mut rx) = link();
            let decoder = Decoder::new(form, &link);
            let end = pump(&bytes[..], decoder, &link).await.unwrap();
            assert_eq!(end, End::Closed);
            assert!(is_compass(&rx.recv().await.unwrap()));
            assert_eq!(link.stats.status().sentences["PGN 127250"], 1);
        }
    }
}
