//! A bridge that sends rubbish: the agent counts it and continues.

#![allow(clippy::unwrap_used, reason = "these are tests, helpers included")]

use binnacle_tests::{Feed, Pace, Ship};
use std::io::Cursor;
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::net::TcpStream;
use tokio::time::timeout;

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

/// Sentences of a ship on a steady heading, second by second.
fn watch(seconds: u32) -> String {
    (0..seconds).fold(String::new(), |mut text, second| {
        let (minute, second) = (second / 60, second % 60);
        let clock = format!("12{minute:02}{second:02}.00");
        let fix = format!("GPRMC,{clock},A,4321.10,N,00301.50,W,12.4,085.0,201126,,,A");
        for line in [&fix, "HCHDG,087.3,,,,", "HETHS,085.1,A"] {
            text += &sentence(line);
        }
        text
    })
}

fn noise(count: usize) -> impl Iterator<Item = u8> {
    let mut state = 7_u64;
    (0..count).map(move |_| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 56) as u8
    })
}

#[tokio::test]
async fn noise_and_a_line_of_ten_megabytes_do_not_stop_an_agent() {
    let folder = tempfile::tempdir().unwrap();
    let mut rubbish: Vec<u8> = noise(1_000_000).collect();
    rubbish.extend(std::iter::repeat_n(b'$', 10_000_000));
    rubbish.extend(b"\r\n");
    rubbish.extend(watch(3000).as_bytes());
    let feed = Feed::start(Cursor::new(rubbish), Pace::Live).await.unwrap();
    let mut ship = Ship::new("rubbish", folder.path(), feed.address()).unwrap();
    ship.start().unwrap();
    let output = ship.ready().await.unwrap();
    let output = TcpStream::connect(output).await.unwrap();
    let mut lines = BufReader::new(output).lines();
    let heard = timeout(Duration::from_mins(1), async {
        loop {
            let line = lines.next_line().await.unwrap().expect("the agent hung up");
            // No model yet, and so no heading: the variation at the place heard after the rubbish.
            let variation = line.strip_prefix("$IIHDG,,,,");
            if variation.is_some_and(|rest| rest.starts_with(|first: char| first.is_ascii_digit()))
            {
                return;
            }
        }
    });
    heard.await.expect("the place after the rubbish");
    ship.assert_running().unwrap();
    let peak = ship.peak_memory_kb().unwrap();
    assert!(peak < 200_000, "{peak} kB for an unreadable line");
    ship.kill().await.unwrap();
}
