//! Commands that receivers send back on an output: ACN, to the agent's alerts. Anything else is
//! ignored.

use binnacle_nmea::lines::Line;
use binnacle_nmea::sentence::Acn;
use binnacle_nmea::{Data, Lines, parse_tagged};
use std::convert::Infallible;
use tokio::io::{AsyncRead, AsyncReadExt};
use tokio::sync::mpsc;

/// Chunk size: a few sentences.
const CHUNK_BYTES: usize = 1024;

/// Reads commands for as long as a receiver can be written to: one that sends nothing more may
/// still listen.
pub(crate) async fn read_commands(
    mut receiver: impl AsyncRead + Unpin,
    commands: &mpsc::Sender<Acn>,
) -> Infallible {
    let mut lines = Lines::default();
    let mut buffer = [0; CHUNK_BYTES];
    while let Ok(count @ 1..) = receiver.read(&mut buffer).await {
        let mut read = Vec::new();
        lines.push(&buffer[..count], |line| read.extend(command(line)));
        for command in read {
            if commands.send(command).await.is_err() {
                break;
            }
        }
    }
    std::future::pending().await
}

fn command(line: Line<'_>) -> Option<Acn> {
    let Line::Whole(line) = line else { return None };
    match parse_tagged(line).ok()?.sentence.data {
        Data::Acn(command) => Some(command),
        _ => None,
    }
}
