//! Reads a stream of bytes to its end; each chunk is one delivery.

use super::decode::Decoder;
use super::link::{End, Link};
use std::io;
use tokio::io::{AsyncRead, AsyncReadExt};

/// Chunk size: about eight hundred sentences.
const CHUNK_BYTES: usize = 64 * 1024;

pub(crate) async fn pump(mut stream: impl AsyncRead + Unpin, link: &Link) -> io::Result<End> {
    let mut decoder = Decoder::new(link.name.clone());
    let mut buffer = vec![0; CHUNK_BYTES];
    loop {
        let count = stream.read(&mut buffer).await?;
        if count == 0 {
            break;
        }
        decoder.chunk(&buffer[..count]);
        link.stats.count_received(count, &decoder.take_tally());
        link.deliver(decoder.take_observations()).await?;
    }
    // The last line of a broken connection is incomplete.
    Ok(End::Closed)
}
