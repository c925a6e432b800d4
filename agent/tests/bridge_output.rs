//! Outputs of the real agent as a bridge uses them: withheld headings on every kind of line, alerts
//! and commands to them.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use binnacle_nmea::sentence::{Hdg, Ths, ThsMode};
use binnacle_nmea::{Data, Sentence, datagram, parse, parse_tagged, write};
use common::agent::Agent;
use common::bridge::{self, Bridge};
use common::server::TestServer;
use socket2::{Domain, Socket, Type};
use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader, Lines};
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::net::{TcpListener, TcpStream, UdpSocket};
use tokio::sync::mpsc;
use tokio::time::{interval, timeout};
use tokio_serial::{SerialPort, SerialStream};

const PATIENCE: Duration = Duration::from_mins(2);
const HOUR_S: i64 = 3_600;

/// Receiver of the output over TCP, which sends commands back.
struct Console {
    lines: Lines<BufReader<OwnedReadHalf>>,
    commands: OwnedWriteHalf,
}

impl Console {
    async fn connect(output: SocketAddr) -> Console {
        let (lines, commands) = TcpStream::connect(output).await.unwrap().into_split();
        Console {
            lines: BufReader::new(lines).lines(),
            commands,
        }
    }

    /// Waits for a line with a text.
    async fn hear(&mut self, text: &str) -> String {
        let heard = async {
            loop {
                let line = self.lines.next_line().await.unwrap().unwrap();
                if line.contains(text) {
                    return line;
                }
            }
        };
        let heard = timeout(PATIENCE, heard).await;
        heard.unwrap_or_else(|_| panic!("{text} was not heard"))
    }

    async fn send(&mut self, body: &str) {
        self.commands.write_all(&sentence(body)).await.unwrap();
    }
}

fn sentence(body: &str) -> Vec<u8> {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n").into_bytes()
}

#[tokio::test]
async fn the_bridge_acknowledges_the_agents_alert_and_hears_what_is_refused() {
    let bridge = Bridge::struck(8 * HOUR_S, 5 * HOUR_S + 1200, 25.0).await;
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(bridge.address);
    agent.configure("[output]", "alert_sentences = true");
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    common::status_when(&running, |status| status["link"]["state"] == "up").await;
    let mut console = Console::connect(running.output).await;
    bridge.sail();

    let raised = console.hear("ALF,2,1,").await;
    assert!(raised.contains(",B,W,V,BIN,10001,1,"), "{raised}");
    let description = console.hear("ALF,2,2,").await;
    assert!(description.contains("TAKE AN AZIMUTH"), "{description}");
    console.send("CAACN,,BIN,10001,1,O,C").await;
    assert!(console.hear("ARC,").await.contains(",BIN,10001,1,O*"));
    console.send("CAACN,,BIN,10001,1,A,C").await;
    assert!(
        console
            .hear("ALF,2,1,")
            .await
            .contains(",B,W,A,BIN,10001,1,")
    );
    common::status_when(&running, |status| status["alert"]["acknowledged"] == true).await;
    console.send("CAACN,,BIN,10001,1,A,C").await;
    assert!(console.hear("ARC,").await.contains(",BIN,10001,1,A*"));
    let (_, log) = running.terminate().await;
    assert!(log.contains("the bridge acknowledged an alert"), "{log}");
    let running = agent.run().await;
    let again = common::status_when(&running, |status| !status["alert"].is_null()).await;
    assert_eq!(again["alert"]["acknowledged"], true);
    running.kill().await;
}

/// Sends ten readings a second, with a compass that is 25° off, and what comes in besides.
async fn live_bridge(mut more: mpsc::Receiver<Vec<u8>>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(async move {
        let (mut stream, _) = listener.accept().await.unwrap();
        let mut ticks = interval(Duration::from_millis(100));
        for count in 0.. {
            tokio::select! {
                _ = ticks.tick() => {}
                Some(more) = more.recv() => stream.write_all(&more).await.unwrap(),
            }
            let mut text = Vec::new();
            if count % 10 == 0 {
                // Position and time come once a second.
                let second = bridge::second(count / 10);
                let position = second.split_inclusive(|byte| *byte == b'\n').next();
                text.extend(position.unwrap());
            }
            let mut say = |talker: &[u8; 2], data| {
                let talker = *talker;
                write(&Sentence { talker, data }, &mut text);
            };
            let reading_deg = Some(45.0 - bridge::LEAD_DEG - 25.0);
            say(
                b"HC",
                Data::Hdg(Hdg {
                    reading_deg,
                    ..Hdg::default()
                }),
            );
            say(
                b"HE",
                Data::Ths(Ths {
                    heading_deg_true: Some(45.0),
                    mode: ThsMode::Autonomous,
                }),
            );
            if stream.write_all(&text).await.is_err() {
                return;
            }
        }
    });
    address
}

#[tokio::test]
async fn a_difference_of_headings_is_raised_and_acknowledged_over_an_input() {
    let (instruments, more) = mpsc::channel(1);
    let server = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(live_bridge(more).await);
    agent.configure("[output]", "alert_sentences = true\nhdt = true");
    agent.configure("stale_s = 3", "[alert]\ndifference_s = 1");
    agent.enrol(&server.url).await;
    let running = agent.run().await;
    let mut console = Console::connect(running.output).await;

    let raised = console.hear("BIN,10002,1,").await;
    assert!(raised.contains(",B,W,V,BIN,10002,1,"), "{raised}");
    assert!(raised.contains("HDG DIFFERENCE"), "{raised}");
    // It is an alarm: the heading goes on.
    console.hear("IIHDT,").await;
    let status = common::status_when(&running, |status| {
        status["heading_difference"]["is_open"] == true
    })
    .await;
    let difference = &status["heading_difference"];
    let degrees = difference["difference_deg"].as_f64().unwrap();
    assert!((degrees + 26.0).abs() < 3.0, "{degrees}");
    let said = agent.call(&["status"]).await;
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(
        said.contains("ALERT      corrected heading and gyro differ"),
        "{said}"
    );
    let command = sentence("CAACN,,BIN,10002,1,A,C");
    instruments.send(command).await.unwrap();
    let acknowledged = console.hear(",B,W,A,BIN,10002,1,").await;
    assert!(acknowledged.contains("ALF,2,1,"), "{acknowledged}");
    let acknowledged = common::status_when(&running, |status| {
        status["heading_difference"]["acknowledged"] == true
    })
    .await;
    running.terminate().await;
    let running = agent.run().await;
    let again = common::status_when(&running, |status| !status["heading_difference"].is_null());
    let (before, after) = (&acknowledged["heading_difference"], again.await);
    let after = &after["heading_difference"];
    assert_eq!(after["id"], before["id"]);
    assert_eq!(
        (&after["is_open"], &after["acknowledged"]),
        (&true.into(), &true.into())
    );
    let mut console = Console::connect(running.output).await;
    console.send("CAACN,,BIN,10002,1,Q,C").await;
    console.hear(",B,W,A,BIN,10002,1,").await;
    running.kill().await;
}

/// Asserts that no sentence of a text can be read as a heading. Returns their number.
fn count_withheld<'a>(sentences: impl Iterator<Item = &'a [u8]>) -> usize {
    let mut count = 0;
    for sentence in sentences {
        count += 1;
        match parse(sentence).map(|read| read.data) {
            Ok(Data::Hdg(hdg)) => assert_eq!(hdg.reading_deg, None),
            Ok(Data::Ths(ths)) => {
                assert_eq!((ths.heading_deg_true, ths.mode), (None, ThsMode::NotValid));
            }
            _ => assert!(sentence.starts_with(b"$PBINQ,V,"), "{sentence:?}"),
        }
    }
    count
}

#[tokio::test]
async fn without_a_model_no_line_carries_a_heading() {
    let (_instruments, more) = mpsc::channel(1);
    let agent = Agent::new(live_bridge(more).await);
    let udp = UdpSocket::bind("127.0.0.1:0").await.unwrap();
    let group = Socket::new(Domain::IPV4, Type::DGRAM, None).unwrap();
    let any: SocketAddr = ([0, 0, 0, 0], 0).into();
    group.bind(&any.into()).unwrap();
    group
        .join_multicast_v4(&Ipv4Addr::new(239, 192, 0, 4), &Ipv4Addr::LOCALHOST)
        .unwrap();
    group.set_nonblocking(true).unwrap();
    let group = UdpSocket::from_std(group.into()).unwrap();
    let (serial, port) = SerialStream::pair().unwrap();
    agent.configure(
        "[output]",
        &format!(
            "hdt = true\nudp = \"{}\"\nserial = {{ path = \"{}\", baud = 115200 }}\n\
             multicast = {{ group = \"239.192.0.4:{}\", interface = \"127.0.0.1\", sfi = \"HC0007\" }}",
            udp.local_addr().unwrap(),
            port.name().unwrap(),
            group.local_addr().unwrap().port(),
        ),
    );
    let running = agent.run().await;
    common::status_when(&running, |status| {
        !status["heading"]["compass_deg"].is_null()
    })
    .await;
    let mut buffer = [0; 2048];
    let mut heard = [0; 2];
    while heard.iter().any(|count| *count < 20) {
        let length = udp.recv(&mut buffer).await.unwrap();
        let lines = buffer[..length].split_inclusive(|byte| *byte == b'\n');
        heard[0] += count_withheld(lines);
        let length = group.recv(&mut buffer).await.unwrap();
        let lines = datagram::lines(&buffer[..length]).unwrap();
        let sentences = lines.map(|line| {
            if let Ok(read) = parse_tagged(line) {
                assert_eq!(read.tag.source, Some(&b"HC0007"[..]));
                assert!(read.tag.line_count.is_some());
            }
            let end = line.iter().rposition(|byte| *byte == b'\\').unwrap();
            &line[end + 1..]
        });
        heard[1] += count_withheld(sentences);
    }
    let mut console = Console::connect(running.output).await;
    let mut serial = BufReader::new(serial).lines();
    for _ in 0..20 {
        let line = console.lines.next_line().await.unwrap().unwrap();
        assert_eq!(count_withheld([line.as_bytes()].into_iter()), 1);
        let line = serial.next_line().await.unwrap().unwrap();
        assert_eq!(count_withheld([line.as_bytes()].into_iter()), 1);
    }
    running.kill().await;
}

#[tokio::test]
async fn a_rate_that_the_line_cannot_carry_is_refused_at_start() {
    let bridge = Bridge::new(0).await;
    let agent = Agent::new(bridge.address);
    agent.configure(
        "[output]",
        "serial = { path = \"/dev/binnacle-none\", baud = 4800 }",
    );
    let refused = agent.call(&["run"]).await;
    assert!(!refused.status.success());
    let said = String::from_utf8(refused.stderr).unwrap();
    // The interval of the tests is a twentieth of a second.
    assert!(
        said.contains("agent.toml:12: baud: 4800 baud carry 480"),
        "{said}"
    );
}
