//! The real agent as a device on an NMEA 2000 bus, behind a gateway that speaks YDWG RAW. The bus
//! brings back all that the agent sends, as a second gateway would.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic too")]

mod common;

use binnacle_nmea::n2k::text::{Content, parse_line, write_ydwg};
use binnacle_nmea::n2k::{Data, Frame, Header, Message, Reference};
use common::agent::Agent;
use common::server::TestServer;
use common::signalk::fix;
use serde_json::Value;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{mpsc, watch};
use tokio::time::{interval, timeout};

const PATIENCE: Duration = Duration::from_mins(1);
/// 127250 of a sensor at address 204: 2 rad from magnetic north, no deviation, no variation.
const COMPASS: u32 = 0x09f1_12cc;
const READING: [u8; 8] = [0xff, 0x20, 0x4e, 0xff, 0x7f, 0xff, 0x7f, 0xfd];
const READING_RAD: f64 = 2.0;
/// Deviation of the model that the agent has.
const DEVIATION_DEG: f64 = 2.5;

/// Bus with a compass, which gives each message of the agent back.
struct Bus {
    compass: watch::Sender<bool>,
    messages: mpsc::UnboundedReceiver<Message>,
}

impl Bus {
    async fn next_heading(&mut self, reference: u8) -> Message {
        let next = async {
            loop {
                let message = self.messages.recv().await.unwrap();
                if message.header.pgn == 127_250 && message.data[7] & 0x03 == reference {
                    return message;
                }
            }
        };
        timeout(PATIENCE, next)
            .await
            .expect("the agent sends a heading")
    }

    /// Waits for a heading that can be read, or for one that cannot.
    async fn heading(&mut self, reference: u8, is_valid: bool) -> Option<f64> {
        loop {
            let message = self.next_heading(reference).await;
            let deg = match Data::parse(&message) {
                Some(Data::Heading { deg, .. }) => Some(deg),
                _ => None,
            };
            if deg.is_some() == is_valid {
                return deg;
            }
        }
    }
}

async fn serve(
    gateway: TcpStream,
    compass: watch::Receiver<bool>,
    sent: mpsc::UnboundedSender<Message>,
) {
    let (lines, mut gateway) = gateway.into_split();
    let mut lines = BufReader::new(lines).lines();
    let mut ticks = interval(Duration::from_millis(100));
    loop {
        let line = tokio::select! {
            _ = ticks.tick() => {
                if !*compass.borrow() {
                    continue;
                }
                let header = Header::from_identifier(COMPASS);
                write_ydwg(&Frame::new(header, &READING).unwrap())
            }
            line = lines.next_line() => match line {
                Ok(Some(line)) => line + "\r\n",
                _ => return,
            },
        };
        let line = format!("00:00:00.000 R {line}");
        let Some(Content::Frame(frame)) = parse_line(line.as_bytes()).map(|line| line.content)
        else {
            panic!("{line}");
        };
        if gateway.write_all(line.as_bytes()).await.is_err() {
            return;
        }
        let (header, data) = (frame.header, frame.data().to_vec());
        if header.source != 204 {
            sent.send(Message { header, data }).ok();
        }
    }
}

/// Starts a bus, and a receiver of satellites. Returns their addresses too.
async fn instruments() -> (Bus, String, String) {
    let gateway = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let receiver = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let addresses = [&gateway, &receiver].map(|one| one.local_addr().unwrap().to_string());
    let (compass, is_on) = watch::channel(true);
    let (sent, messages) = mpsc::unbounded_channel();
    tokio::spawn(async move {
        let (stream, _) = gateway.accept().await.unwrap();
        serve(stream, is_on, sent).await;
    });
    tokio::spawn(async move {
        let (mut stream, _) = receiver.accept().await.unwrap();
        let mut ticks = interval(Duration::from_millis(500));
        while stream.write_all(fix().as_bytes()).await.is_ok() {
            ticks.tick().await;
        }
    });
    let [gateway, receiver] = addresses;
    (Bus { compass, messages }, gateway, receiver)
}

#[tokio::test]
async fn the_agent_steers_a_bus_and_takes_nothing_of_its_own_for_an_instrument() {
    let (mut bus, gateway, receiver) = instruments().await;
    let shore = TestServer::start(Some(common::model()), None).await;
    let agent = Agent::new(receiver.parse().unwrap());
    // Any heading of the bus would do, the agent's own too.
    let config = format!(
        "data_dir = \"state\"\n[inputs.bus]\nydwg = {{ tcp = \"{gateway}\" }}\n\
         [inputs.gps]\ntcp = \"{receiver}\"\n[roles]\n\
         compass = [{{ input = \"bus\", sentence = \"HDG\" }}]\n\
         gyro = [{{ input = \"bus\", sentence = \"HDT\" }}]\n\
         position = [{{ input = \"gps\" }}]\n[output]\ntcp_server = \"127.0.0.1:0\"\n\
         n2k = {{ input = \"bus\", heading = \"both\" }}\n[page]\nlisten = \"127.0.0.1:0\"\n\
         [uplink]\npoll_s = 1\nretry_min_s = 0.02\nretry_max_s = 0.1\n"
    );
    std::fs::write(agent.config(), config).unwrap();
    agent.enrol(&shore.url).await;
    let running = agent.run().await;

    let expected = READING_RAD.to_degrees() + DEVIATION_DEG;
    let magnetic = bus.heading(1, true).await.unwrap();
    assert!((magnetic - expected).abs() < 0.01, "{magnetic}");
    let message = bus.next_heading(0).await;
    let Some(Data::Heading {
        deg,
        reference: Reference::True,
        ..
    }) = Data::parse(&message)
    else {
        panic!("{message:?}");
    };
    // The variation off Bilbao is less than a degree in these years.
    assert!((deg - expected).abs() < 3.0, "{deg}");
    let status = common::status_when(&running, |status| {
        let sources = status["sources"].as_array().unwrap();
        let own = |sentence: &str| {
            sources
                .iter()
                .any(|source| source["sentence"] == sentence && source["own_output"] == true)
        };
        own("HDG") && own("HDT")
    })
    .await;
    assert_eq!(status["gyro_deg"], Value::Null, "{status}");
    let problems = status["source_problems"].to_string();
    assert!(!problems.contains("two sensors"), "{problems}");
    let sources = status["sources"].as_array().unwrap();
    for own in sources.iter().filter(|source| source["own_output"] == true) {
        assert_eq!(own["serves"], serde_json::json!([]), "{own}");
        assert_eq!(own["n2k_address"], 35, "{own}");
    }

    // What comes back does not keep a dead compass alive.
    bus.compass.send_replace(false);
    assert_eq!(bus.heading(1, false).await, None);
    assert_eq!(bus.heading(0, false).await, None);
    for _ in 0..10 {
        assert_eq!(Data::parse(&bus.next_heading(1).await), None);
    }
    running.kill().await;
}
