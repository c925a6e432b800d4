//! Instruments of a vessel that steers four courses in turn, an hour each, and whose compass reads
//! 3° less than the gyro.

use binnacle_nmea::sentence::{Hdg, Position, Rmc, Rot, Ths, ThsMode, Xdr};
use binnacle_nmea::time::from_unix_micros;
use binnacle_nmea::{Data, Sentence, write};
use std::net::SocketAddr;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpListener;
use tokio::sync::watch;

/// 2026-09-01T00:00:00Z.
pub(crate) const START_S: i64 = 1_788_220_800;
/// Difference by which the compass reads less than the gyro.
pub(crate) const LEAD_DEG: f64 = 3.0;
/// Difference by which the course over ground is more than the heading.
pub(crate) const DRIFT_DEG: f64 = 2.0;
/// Speed over the ground.
const SPEED_KN: f64 = 12.0;
/// Noise of the compass, part of which lasts for twenty seconds.
const NOISE_DEG: f64 = 0.2;
/// Mean of the roll, its standard deviation, and the temperature of the air.
pub(crate) const LIST_DEG: f64 = -0.6;
pub(crate) const ROLL_DEG: f64 = 1.5;
pub(crate) const AIR_C: f64 = 18.0;

/// All sentences of one second.
pub(crate) fn second(offset_s: i64) -> Vec<u8> {
    second_with(offset_s, LEAD_DEG)
}

/// All sentences of one second, with a compass that reads `lead_deg` less than the gyro.
fn second_with(offset_s: i64, lead_deg: f64) -> Vec<u8> {
    let mut out = Vec::with_capacity(256);
    let heading = heading_deg(offset_s);
    let (date, time) = from_unix_micros((START_S + offset_s) * 1_000_000).unwrap();
    let mut say = |talker: &[u8; 2], data: Data| {
        let talker = *talker;
        write(&Sentence { talker, data }, &mut out);
    };
    say(
        b"GP",
        Data::Rmc(Some(Rmc {
            time: Some(time),
            date: Some(date),
            position: Some(place(offset_s)),
            sog_kn: Some(SPEED_KN),
            cog_deg_true: Some(heading + DRIFT_DEG),
            ..Rmc::default()
        })),
    );
    say(
        b"HC",
        Data::Hdg(Hdg {
            reading_deg: Some(
                (heading + yaw_deg(offset_s) - lead_deg + noise_deg(offset_s)).rem_euclid(360.0),
            ),
            ..Hdg::default()
        }),
    );
    say(
        b"HE",
        Data::Ths(Ths {
            heading_deg_true: Some(heading + yaw_deg(offset_s)),
            mode: ThsMode::Autonomous,
        }),
    );
    let roll = if offset_s % 2 == 0 { 1.0 } else { -1.0 };
    say(
        b"II",
        Data::Xdr(Xdr {
            roll_deg_starboard_down: Some(LIST_DEG + ROLL_DEG * roll),
            air_temperature_c: Some(AIR_C),
            ..Xdr::default()
        }),
    );
    say(
        b"TI",
        Data::Rot(Rot {
            rate_deg_min_starboard: Some(0.0),
        }),
    );
    out
}

/// Frames the text between `$` and `*` as a sentence.
pub(crate) fn sentence(body: &str) -> Vec<u8> {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n").into_bytes()
}

/// Sentences of one second, without some and with others.
pub(crate) fn changed(offset_s: i64, without: &[&str], with: &[String]) -> Vec<u8> {
    let second = String::from_utf8(second(offset_s)).unwrap();
    let kept = second
        .lines()
        .filter(|line| !without.iter().any(|start| line.starts_with(start)));
    let kept = kept.flat_map(|line| format!("{line}\r\n").into_bytes());
    let more = with.iter().flat_map(|body| sentence(body));
    kept.chain(more).collect()
}

/// Yaw about the course, which cancels out in ten seconds.
fn yaw_deg(offset_s: i64) -> f64 {
    0.8 * (std::f64::consts::TAU * offset_s as f64 / 10.0).sin()
}

/// Noise of the compass: the gyro has none of it.
fn noise_deg(offset_s: i64) -> f64 {
    let slow = share(offset_s / 20) - 0.5;
    let sign = if offset_s % 2 == 0 { 1.0 } else { -1.0 };
    NOISE_DEG * (slow + sign * share(offset_s / 2))
}

/// A share of one that looks random.
fn share(number: i64) -> f64 {
    let hash = number
        .unsigned_abs()
        .wrapping_add(1)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((hash ^ (hash >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f64 / (1_u64 << 24) as f64
}

/// Heading at a time; it changes at once at the full hour.
pub(crate) fn heading_deg(offset_s: i64) -> f64 {
    45.0 + 90.0 * (offset_s / 3600 % 4) as f64
}

/// Place at a time: the four courses lead back to where they began.
pub(crate) fn place(offset_s: i64) -> Position {
    let (mut north_nm, mut east_nm) = (0.0, 0.0);
    let round = offset_s.rem_euclid(4 * 3600);
    for leg in 0..4 {
        let seconds = (round - leg * 3600).clamp(0, 3600);
        let miles = SPEED_KN * seconds as f64 / 3600.0;
        let (sin, cos) = (heading_deg(leg * 3600) + DRIFT_DEG).to_radians().sin_cos();
        north_nm += miles * cos;
        east_nm += miles * sin;
    }
    Position {
        lat_deg_north: 43.5 + north_nm / 60.0,
        lon_deg_east: -3.0 + east_nm / 60.0 / 43.5_f64.to_radians().cos(),
    }
}

/// A TCP server that plays the voyage as fast as it is read. A new connection continues where the
/// last one ended. It begins with [`Bridge::sail`].
pub(crate) struct Bridge {
    pub(crate) address: SocketAddr,
    begin: watch::Sender<bool>,
}

impl Bridge {
    /// Lets the voyage begin.
    pub(crate) fn sail(&self) {
        self.begin.send_replace(true);
    }

    /// Creates a bridge that plays `seconds` and is silent then without closing the connection.
    pub(crate) async fn new(seconds: i64) -> Bridge {
        Bridge::struck(seconds, seconds, 0.0).await
    }

    /// Creates a bridge whose compass is struck by lightning after `struck_s`: from then on it
    /// reads `off_deg` less than before.
    pub(crate) async fn struck(seconds: i64, struck_s: i64, off_deg: f64) -> Bridge {
        Bridge::playing(seconds, move |offset_s| {
            let off_deg = if offset_s < struck_s { 0.0 } else { off_deg };
            second_with(offset_s, LEAD_DEG + off_deg)
        })
        .await
    }

    /// Creates a bridge that plays the given sentences of each second.
    pub(crate) async fn playing(
        seconds: i64,
        say: impl Fn(i64) -> Vec<u8> + Send + 'static,
    ) -> Bridge {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let begin = watch::Sender::new(false);
        let mut begun = begin.subscribe();
        let mut next = 0;
        tokio::spawn(async move {
            loop {
                let (mut stream, _) = listener.accept().await.unwrap();
                begun.wait_for(|begun| *begun).await.unwrap();
                loop {
                    if next >= seconds {
                        std::future::pending::<()>().await;
                    }
                    let until = seconds.min(next + 60);
                    let minute: Vec<u8> = (next..until).flat_map(&say).collect();
                    if stream.write_all(&minute).await.is_err() {
                        break;
                    }
                    next = until;
                }
            }
        });
        Bridge { address, begin }
    }
}
