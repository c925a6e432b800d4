//! Messages of an NMEA 2000 bus: from the kernel's CAN sockets, or from a gateway. An output may
//! share the connection: it gets the claims and requests of the bus, and sends its own messages.

use super::can::CanBus;
use super::link::{End, Link, connect};
use crate::config::{ActisenseConfig, YdwgConfig};
use crate::port::{PortEnd, next_outgoing};
use binnacle_nmea::lines::Line;
use binnacle_nmea::n2k::{Frame, Message, actisense, is_network_management, split, text};
use binnacle_nmea::{Lines, Tally};
use binnacle_observation::Observation;
use binnacle_observation::n2k::N2kReader;
use binnacle_observation::signalk::DeltaCounts;
use socketcan::{CanSocket, Socket};
use std::io;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::net::UdpSocket;
use tokio::time::timeout;
use tokio_serial::SerialPortBuilderExt;

/// Output's share of a connection, if there is one.
pub(crate) type BusEnd = Option<PortEnd<Message>>;

/// Chunk size: about a second of a full bus.
const CHUNK_BYTES: usize = 64 * 1024;
/// Time within which a gateway must take a message: an older heading is not for steering.
const WRITE_TIMEOUT: Duration = Duration::from_secs(1);

/// Decoder and encoder of one connection.
struct Codec {
    form: Form,
    reader: N2kReader,
    counts: DeltaCounts,
    out: Vec<Observation>,
    /// Claims and requests for the output that shares the connection.
    management: Vec<Message>,
    is_shared: bool,
    /// Number of the next fast packet.
    sequence: u8,
}

/// Form in which a gateway takes and sends messages.
enum Form {
    Actisense(actisense::Decoder),
    Ydwg(Lines),
}

impl Codec {
    fn new(form: Form, link: &Link, end: &BusEnd) -> Codec {
        Codec {
            form,
            reader: N2kReader::new(link.name.clone()),
            counts: DeltaCounts::default(),
            out: Vec::new(),
            management: Vec::new(),
            is_shared: end.is_some(),
            sequence: 0,
        }
    }

    fn chunk(&mut self, bytes: &[u8]) {
        let mut read = Vec::new();
        match &mut self.form {
            Form::Actisense(decoder) => decoder.push(bytes, |_, message| {
                read.push(Some(text::Content::Message(message)));
            }),
            Form::Ydwg(lines) => lines.push(bytes, |line| {
                let Line::Whole(line) = line else {
                    return;
                };
                // What the output gave the gateway is not read as a device's.
                if !(self.is_shared && text::is_ydwg_echo(line)) {
                    read.push(text::parse_line(line).map(|line| line.content));
                }
            }),
        }
        for content in read {
            match content {
                Some(text::Content::Frame(frame)) => self.frame(&frame),
                Some(text::Content::Message(message)) => self.message(message),
                None => self.counts.reject("not a frame"),
            }
        }
    }

    fn frame(&mut self, frame: &Frame) {
        let out = &mut self.out;
        self.reader
            .frame(frame, &mut self.counts, |seen| out.push(seen));
        // These are never fast packets.
        if is_network_management(frame.header.pgn) {
            self.management.push(Message {
                header: frame.header,
                data: frame.data().to_vec(),
            });
        }
    }

    fn message(&mut self, message: Message) {
        let out = &mut self.out;
        self.reader
            .message(&message, &mut self.counts, |seen| out.push(seen));
        if is_network_management(message.header.pgn) {
            self.management.push(message);
        }
    }

    /// Passes on what an output needs, and returns the observations.
    async fn take(&mut self, bytes: usize, end: &BusEnd, link: &Link) -> Vec<Observation> {
        link.stats.count_received(bytes, &Tally::default());
        link.stats.count_values(&std::mem::take(&mut self.counts));
        let management = std::mem::take(&mut self.management);
        if let Some(end) = end {
            for message in management {
                end.received(message).await;
            }
        }
        std::mem::take(&mut self.out)
    }

    fn frames(&mut self, message: &Message) -> Vec<Frame> {
        self.sequence = self.sequence.wrapping_add(1);
        split(message, self.sequence)
    }

    fn encode(&mut self, message: &Message) -> Vec<u8> {
        match self.form {
            Form::Actisense(_) => actisense::write(message),
            Form::Ydwg(_) => {
                let frames = self.frames(message).into_iter();
                frames
                    .flat_map(|frame| text::write_ydwg(&frame).into_bytes())
                    .collect()
            }
        }
    }
}

pub(crate) async fn actisense(
    config: &ActisenseConfig,
    end: &mut BusEnd,
    link: &Link,
) -> io::Result<End> {
    let form = Form::Actisense(actisense::Decoder::of_stream());
    let codec = Codec::new(form, link, end);
    match config {
        ActisenseConfig::Serial { path, baud } => {
            let stream = tokio_serial::new(path, *baud).open_native_async()?;
            opened(end, link).await;
            pump(stream, codec, end, link).await
        }
        ActisenseConfig::Tcp(address) => {
            let stream = connect(address.as_str()).await?;
            stream.set_nodelay(true)?;
            opened(end, link).await;
            pump(stream, codec, end, link).await
        }
    }
}

pub(crate) async fn ydwg(config: &YdwgConfig, end: &mut BusEnd, link: &Link) -> io::Result<End> {
    let codec = Codec::new(Form::Ydwg(Lines::default()), link, end);
    match config {
        YdwgConfig::Tcp(address) => {
            let stream = connect(address.as_str()).await?;
            stream.set_nodelay(true)?;
            opened(end, link).await;
            pump(stream, codec, end, link).await
        }
        YdwgConfig::Udp { address, send_to } => {
            datagrams(*address, *send_to, codec, end, link).await
        }
    }
}

async fn opened(end: &mut BusEnd, link: &Link) {
    link.opened();
    if let Some(end) = end {
        end.opened().await;
    }
}

async fn pump(
    mut stream: impl AsyncRead + AsyncWrite + Unpin,
    mut codec: Codec,
    end: &mut BusEnd,
    link: &Link,
) -> io::Result<End> {
    let mut buffer = vec![0; CHUNK_BYTES];
    loop {
        tokio::select! {
            count = stream.read(&mut buffer) => {
                let count = count?;
                if count == 0 {
                    return Ok(End::Closed);
                }
                codec.chunk(&buffer[..count]);
                let seen = codec.take(count, end, link).await;
                link.deliver(seen).await?;
            }
            message = next_outgoing(end) => {
                let bytes = codec.encode(&message);
                timeout(WRITE_TIMEOUT, stream.write_all(&bytes)).await.map_err(|_| {
                    io::Error::new(io::ErrorKind::TimedOut, "the gateway takes no messages")
                })??;
            }
        }
    }
}

async fn datagrams(
    address: SocketAddr,
    send_to: Option<SocketAddr>,
    mut codec: Codec,
    end: &mut BusEnd,
    link: &Link,
) -> io::Result<End> {
    let socket = UdpSocket::bind(address).await?;
    socket.set_broadcast(true)?;
    opened(end, link).await;
    let mut buffer = vec![0; CHUNK_BYTES];
    loop {
        tokio::select! {
            received = socket.recv_from(&mut buffer) => {
                let (count, sender) = received?;
                codec.reader.set_sender(sender.ip());
                codec.chunk(&buffer[..count]);
                // A datagram ends its last line.
                codec.chunk(b"\n");
                let seen = codec.take(count, end, link).await;
                link.offer(seen)?;
            }
            message = next_outgoing(end) => {
                let Some(gateway) = send_to else { continue };
                let bytes = codec.encode(&message);
                if let Err(error) = socket.send_to(&bytes, gateway).await {
                    tracing::debug!(%error, %gateway, "a message was not sent");
                }
            }
        }
    }
}

pub(crate) async fn socketcan(interface: &str, end: &mut BusEnd, link: &Link) -> io::Result<End> {
    let socket = CanSocket::open(interface)?;
    can_frames(socket, end, link).await
}

/// Reads and writes the frames of a CAN socket.
async fn can_frames(socket: CanSocket, end: &mut BusEnd, link: &Link) -> io::Result<End> {
    let mut bus = CanBus::start(socket)?;
    let mut codec = Codec::new(Form::Ydwg(Lines::default()), link, end);
    opened(end, link).await;
    loop {
        tokio::select! {
            frame = bus.next() => {
                let Some(frame) = frame else { return Ok(End::Closed) };
                let Some(frame) = frame? else { continue };
                codec.frame(&frame);
                let seen = codec.take(frame.data().len(), end, link).await;
                link.deliver(seen).await?;
            }
            message = next_outgoing(end) => {
                for frame in codec.frames(&message) {
                    // A bus that takes nothing has no use for this frame later.
                    if let Err(error) = bus.write(&frame) {
                        tracing::debug!(%error, input = %link.name, "a frame was not sent");
                        break;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{InputStats, Port, PortEvent};
    use binnacle_nmea::n2k::{Address, Header};
    use binnacle_observation::Reading;
    use std::os::fd::OwnedFd;
    use std::os::unix::net::UnixDatagram;
    use std::sync::Arc;
    use tokio::sync::mpsc;

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
        let reading = async {
            let socket = CanSocket::from(OwnedFd::from(kernels));
            can_frames(socket, &mut None, &link).await
        };
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

    /// Frames as the kernel takes them: identifier with its flags, length, data.
    #[tokio::test]
    async fn a_message_of_an_output_is_frames_on_the_can_socket() {
        let (ours, kernels) = UnixDatagram::pair().unwrap();
        let (link, _rx) = link();
        let (mut port, end) = Port::new();
        let sharing = async {
            let socket = CanSocket::from(OwnedFd::from(kernels));
            can_frames(socket, &mut Some(end), &link).await
        };
        let header = Header::from_identifier(0x09f1_1223);
        let product = Header::from_identifier(0x19f0_1423);
        let using = async {
            assert_eq!(port.events.recv().await, Some(PortEvent::Opened));
            let data = vec![5, 0x39, 0x30, 0, 0, 0x4c, 0xfe, 0xfd];
            assert!(port.send(Message { header, data }));
            let data = vec![7; 134];
            assert!(port.send(Message {
                header: product,
                data
            }));
            // A request of another device is passed on.
            let mut frame = (0x18ea_ff04_u32 | 0x8000_0000).to_ne_bytes().to_vec();
            frame.extend([3, 0, 0, 0, 0x00, 0xee, 0x00, 0, 0, 0, 0, 0]);
            ours.send(&frame).unwrap();
            while port.events.recv().await.is_some_and(|event| {
                !matches!(event, PortEvent::Received(message) if message.header.pgn == 59_904)
            }) {}
        };
        tokio::select! {
            ended = sharing => panic!("{ended:?}"),
            () = using => {}
        }
        let mut frame = [0; 16];
        assert_eq!(ours.recv(&mut frame).unwrap(), 16);
        let identifier = u32::from_ne_bytes(frame[..4].try_into().unwrap());
        assert_eq!((identifier, frame[4]), (0x89f1_1223, 8));
        assert_eq!(frame[8..], [5, 0x39, 0x30, 0, 0, 0x4c, 0xfe, 0xfd]);
        // Product information is a fast packet of twenty frames.
        for number in 0..20 {
            ours.recv(&mut frame).unwrap();
            assert_eq!(frame[8] & 0x1f, number);
        }
    }

    #[tokio::test]
    async fn what_a_gateway_sent_for_the_output_is_no_observation() {
        let line = b"05:15:49.768 T 09F112CC FF 4B ED FF 7F FF 7F FD\r\n";
        for is_shared in [false, true] {
            let (link, mut rx) = link();
            let (_port, end) = Port::new();
            let mut end = is_shared.then_some(end);
            let codec = Codec::new(Form::Ydwg(Lines::default()), &link, &end);
            let both = tokio::io::join(&line[..], tokio::io::sink());
            pump(both, codec, &mut end, &link).await.unwrap();
            drop(link);
            assert_eq!(rx.recv().await.is_some(), !is_shared);
        }
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
            let codec = Codec::new(form, &link, &None);
            let line = tokio::io::join(&bytes[..], tokio::io::sink());
            let end = pump(line, codec, &mut None, &link).await.unwrap();
            assert_eq!(end, End::Closed);
            assert!(is_compass(&rx.recv().await.unwrap()));
            assert_eq!(link.stats.status().sentences["PGN 127250"], 1);
        }
    }
}
