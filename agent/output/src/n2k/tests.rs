//! The output on a bus, through a gateway's connection over loopback.

use super::*;
use crate::SharedOutputs;
use crate::config::OutputConfig;
use binnacle_input::{InputConfig, InputStats};
use binnacle_nmea::n2k::{Assembler, Data, Frame, Header, actisense, text};
use std::sync::Arc;
use tempfile::TempDir;
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::net::{TcpListener, TcpStream, UdpSocket};
use tokio::sync::mpsc;
use tokio::time::timeout;

/// Timeout; only a failing test reaches it.
const PATIENCE: Duration = Duration::from_secs(30);
/// Address that the agent claims first.
const FIRST: u8 = 35;

/// An output over the input `bus`.
struct Ship {
    outputs: SharedOutputs,
    folder: TempDir,
    shutdown: CancellationToken,
}

impl Ship {
    fn start(input: &str, output: &str) -> Ship {
        Ship::start_in(tempfile::tempdir().unwrap(), input, output)
    }

    fn start_in(folder: TempDir, input: &str, output: &str) -> Ship {
        let config: OutputConfig = toml::from_str(output).unwrap();
        let input: InputConfig = toml::from_str(input).unwrap();
        let owner = input.n2k_address_owner().unwrap();
        let shutdown = CancellationToken::new();
        let (outputs, mut ends) =
            SharedOutputs::start(&config, |_| owner, folder.path(), &shutdown);
        let end = ends.remove("bus").unwrap();
        let (tx, mut observations) = mpsc::channel(8);
        let stats = Arc::new(InputStats::default());
        binnacle_input::spawn("bus".into(), input, end, tx, stats, shutdown.clone());
        tokio::spawn(async move { while observations.recv().await.is_some() {} });
        Ship {
            outputs,
            folder,
            shutdown,
        }
    }

    /// Sends a heading, whatever the interval.
    fn send(&mut self, heading: &Heading) {
        let later = Instant::now() + Duration::from_hours(1);
        let no_interval = Duration::ZERO;
        let output = &mut self.outputs.n2k_outputs()[0];
        output.schedule.reset();
        output.variation.iter_mut().for_each(Schedule::reset);
        self.outputs
            .send(heading, Trigger::Reading, no_interval, later);
    }

    async fn has_address(&mut self, number: u8) {
        let mut address = self.outputs.own_devices()[0].address.clone();
        let is_ours = |address: &Option<Address>| address.map(Address::number) == Some(number);
        let claimed = timeout(PATIENCE, address.wait_for(is_ours)).await;
        claimed.expect("the address is claimed").unwrap();
    }
}

/// Gateway that speaks YDWG RAW.
struct Gateway {
    lines: BufReader<TcpStream>,
    assembler: Assembler,
}

impl Gateway {
    async fn accept(listener: &TcpListener) -> Gateway {
        Gateway {
            lines: BufReader::new(listener.accept().await.unwrap().0),
            assembler: Assembler::default(),
        }
    }

    /// Returns the next message of the agent.
    async fn next(&mut self) -> Message {
        loop {
            let mut line = String::new();
            let read = timeout(PATIENCE, self.lines.read_line(&mut line)).await;
            read.expect("the agent sends something").unwrap();
            // With a time and a direction it is a line as a gateway sends it.
            let line = format!("00:00:00.000 R {line}");
            let read = text::parse_line(line.as_bytes()).unwrap();
            let text::Content::Frame(frame) = read.content else {
                panic!("{line}");
            };
            if let Some(message) = self.assembler.add(&frame) {
                return message;
            }
        }
    }

    async fn next_of(&mut self, pgn: u32) -> Message {
        loop {
            let message = self.next().await;
            if message.header.pgn == pgn {
                return message;
            }
        }
    }

    async fn say(&mut self, identifier: u32, data: &[u8]) {
        let frame = Frame::new(Header::from_identifier(identifier), data).unwrap();
        let line = format!("00:00:00.000 R {}", text::write_ydwg(&frame));
        self.lines.write_all(line.as_bytes()).await.unwrap();
    }

    async fn claim(&mut self, address: u8, name: u64) {
        let identifier = 0x18ee_ff00 | u32::from(address);
        self.say(identifier, &name.to_le_bytes()).await;
    }
}

async fn over_ydwg(output: &str) -> (Ship, Gateway, TcpListener) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let ship = Ship::start(&format!("ydwg = {{ tcp = \"{address}\" }}"), output);
    let gateway = Gateway::accept(&listener).await;
    (ship, gateway, listener)
}

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 0.003
}

#[tokio::test]
async fn the_corrected_heading_is_sent_once_the_address_is_claimed() {
    let (mut ship, mut gateway, _listener) =
        over_ydwg("n2k = { input = \"bus\", heading = \"both\" }").await;
    // Before the claim has stood, nothing else is sent.
    ship.send(&Heading::from_degrees(90.0, -2.0, 5.0));
    let claim = gateway.next().await;
    assert_eq!((claim.header.pgn, claim.header.source), (60_928, FIRST));
    let request = gateway.next().await;
    assert_eq!((request.header.pgn, request.header.source), (59_904, 254));
    let beat = gateway.next().await;
    assert_eq!((beat.header.pgn, beat.header.source), (126_993, FIRST));
    ship.has_address(FIRST).await;
    for (compass, deviation, variation, magnetic, of_true) in [
        (90.0, -2.0, 5.0, 88.0, 93.0),
        (1.0, -2.0, -5.0, 359.0, 354.0),
        (359.0, 2.0, 5.0, 1.0, 6.0),
    ] {
        ship.send(&Heading::from_degrees(compass, deviation, variation));
        let message = gateway.next_of(127_250).await;
        assert_eq!((message.header.source, message.header.priority), (FIRST, 2));
        let Some(Data::Heading {
            deg,
            reference: Reference::Magnetic,
            deviation_deg_east: Some(left),
            variation_deg_east: Some(given),
        }) = Data::parse(&message)
        else {
            panic!("{message:?}");
        };
        assert!(near(deg, magnetic) && near(left, 0.0) && near(given, variation));
        let message = gateway.next_of(127_250).await;
        let Some(Data::Heading {
            deg,
            reference: Reference::True,
            ..
        }) = Data::parse(&message)
        else {
            panic!("{message:?}");
        };
        assert!(near(deg, of_true));
    }
    ship.shutdown.cancel();
}

#[tokio::test]
async fn a_withheld_heading_is_not_available_at_once_and_the_variation_goes_on() {
    let (mut ship, mut gateway, _listener) =
        over_ydwg("n2k = { input = \"bus\", heading = \"both\" }").await;
    ship.has_address(FIRST).await;
    let given = Heading::from_degrees(90.0, -2.0, 5.0);
    ship.send(&given);
    gateway.next_of(127_258).await;
    let withheld = Heading {
        true_heading: None,
        ..given
    };
    // Out of turn: the interval has not passed.
    let now = Instant::now() - Duration::from_mins(1);
    ship.outputs
        .send(&withheld, Trigger::Timer, Duration::ZERO, now);
    for reference in [0xfd, 0xfc] {
        let message = gateway.next_of(127_250).await;
        assert_eq!(Data::parse(&message), None);
        let nothing = [0xff, 0xff, 0xff, 0x7f, 0xff, 0x7f, reference];
        assert_eq!(message.data[1..], nothing);
    }
    ship.send(&withheld);
    let message = gateway.next_of(127_258).await;
    let Some(Data::Variation { deg_east }) = Data::parse(&message) else {
        panic!("{message:?}");
    };
    assert!(near(deg_east, 5.0));
    ship.shutdown.cancel();
}

#[tokio::test]
async fn an_address_that_is_lost_is_left_and_remembered_over_a_restart() {
    let (mut ship, mut gateway, listener) = over_ydwg("n2k = { input = \"bus\" }").await;
    ship.has_address(FIRST).await;
    gateway.claim(FIRST + 1, 1).await;
    gateway.claim(FIRST, 2).await;
    ship.has_address(FIRST + 2).await;
    ship.send(&Heading::from_degrees(90.0, 0.0, 0.0));
    let message = gateway.next_of(127_250).await;
    assert_eq!(message.header.source, FIRST + 2);
    // One with a greater NAME does not get it.
    gateway.claim(FIRST + 2, u64::MAX).await;
    let name = ship.outputs.own_devices()[0].name;
    loop {
        let claim = gateway.next_of(60_928).await;
        assert_eq!(Data::parse(&claim), Some(Data::AddressClaim { name }));
        if claim.header.source == FIRST + 2 {
            break;
        }
    }
    ship.shutdown.cancel();
    let folder = ship.folder;
    let address = listener.local_addr().unwrap();
    let input = format!("ydwg = {{ tcp = \"{address}\" }}");
    let ship = Ship::start_in(folder, &input, "n2k = { input = \"bus\" }");
    let mut gateway = Gateway::accept(&listener).await;
    let claim = gateway.next().await;
    assert_eq!(claim.header.source, FIRST + 2);
    assert_eq!(Data::parse(&claim), Some(Data::AddressClaim { name }));
    ship.shutdown.cancel();
}

#[tokio::test]
async fn a_device_without_an_address_says_so_and_sends_nothing() {
    let (mut ship, mut gateway, _listener) = over_ydwg("n2k = { input = \"bus\" }").await;
    ship.has_address(FIRST).await;
    for address in (0..=251).filter(|address| *address != FIRST) {
        gateway.claim(address, u64::from(address)).await;
    }
    gateway.claim(FIRST, 0).await;
    while gateway.next_of(60_928).await.header.source != 254 {}
    ship.send(&Heading::from_degrees(90.0, 0.0, 0.0));
    // A request for its claim is answered; the heading before it was not sent.
    gateway.say(0x18ea_ff04, &[0x00, 0xee, 0x00]).await;
    let message = gateway.next().await;
    assert_eq!((message.header.pgn, message.header.source), (60_928, 254));
    ship.shutdown.cancel();
}

#[tokio::test]
async fn requests_of_other_devices_are_met() {
    let (mut ship, mut gateway, _listener) = over_ydwg("n2k = { input = \"bus\" }").await;
    ship.has_address(FIRST).await;
    gateway.say(0x18ea_2304, &[0x14, 0xf0, 0x01]).await;
    let product = gateway.next_of(126_996).await;
    assert_eq!(product.data.len(), 134);
    assert_eq!(&product.data[4..26], b"Binnacle compass agent");
    gateway.say(0x18ea_2304, &[0x16, 0xf0, 0x01]).await;
    let refusal = gateway.next_of(59_392).await;
    assert_eq!((refusal.header.destination, refusal.data[0]), (4, 1));
    ship.shutdown.cancel();
}

#[tokio::test]
async fn a_connection_that_breaks_off_is_claimed_on_again_and_gets_no_old_heading() {
    let (mut ship, gateway, listener) = over_ydwg("n2k = { input = \"bus\" }").await;
    ship.has_address(FIRST).await;
    drop(gateway);
    let mut address = ship.outputs.own_devices()[0].address.clone();
    address.wait_for(Option::is_none).await.unwrap();
    for _ in 0..40 {
        ship.send(&Heading::from_degrees(10.0, 0.0, 0.0));
    }
    let mut gateway = Gateway::accept(&listener).await;
    ship.has_address(FIRST).await;
    ship.send(&Heading::from_degrees(20.0, 0.0, 0.0));
    let message = gateway.next_of(127_250).await;
    let Some(Data::Heading { deg, .. }) = Data::parse(&message) else {
        panic!("{message:?}");
    };
    assert!(near(deg, 20.0), "{deg}");
    ship.shutdown.cancel();
}

#[tokio::test]
async fn a_gateway_is_sent_datagrams_at_its_address() {
    let gateway = UdpSocket::bind("127.0.0.1:0").await.unwrap();
    let address = gateway.local_addr().unwrap();
    let input = format!("ydwg = {{ udp = \"127.0.0.1:0\", send_to = \"{address}\" }}");
    let ship = Ship::start(&input, "n2k = { input = \"bus\" }");
    let mut buffer = [0; 256];
    let count = gateway.recv(&mut buffer).await.unwrap();
    let line = [b"00:00:00.000 R ", &buffer[..count]].concat();
    let Some(text::Content::Frame(frame)) = text::parse_line(&line).map(|line| line.content) else {
        panic!("{}", line.escape_ascii());
    };
    assert_eq!((frame.header.pgn, frame.header.source), (60_928, FIRST));
    ship.shutdown.cancel();
}

#[tokio::test]
async fn a_gateway_with_an_address_of_its_own_is_sent_headings_alone() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let input = format!("actisense = {{ tcp = \"{address}\" }}");
    let mut ship = Ship::start(&input, "n2k = { input = \"bus\" }");
    let (mut gateway, _) = listener.accept().await.unwrap();
    assert!(ship.outputs.own_devices().is_empty());
    let mut bytes = vec![0; 64];
    let read = gateway.read(&mut bytes);
    tokio::pin!(read);
    let count = loop {
        ship.send(&Heading::from_degrees(90.0, -2.0, 5.0));
        tokio::select! {
            count = &mut read => break count.unwrap(),
            () = tokio::task::yield_now() => {}
        }
    };
    let message = VesselHeading {
        deg: Some(88.0),
        reference: Reference::Magnetic,
        deviation_deg_east: Some(0.0),
        variation_deg_east: Some(5.0),
    };
    let first = actisense::write(&message.message(Address::new(0).unwrap(), 0));
    // The sequence number and the sum differ.
    assert_eq!(bytes[..10], first[..10], "{:02x?}", &bytes[..count]);
    assert_eq!(bytes[11..18], first[11..18]);
    ship.shutdown.cancel();
}
