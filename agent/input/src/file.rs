//! Recorded lines from a file.

use super::link::{End, Link};
use binnacle_observation::Observation;
use binnacle_observation::recording::{RecordingReader, Survey};
use std::io;
use std::path::Path;

pub(crate) async fn session(path: &Path, link: &Link) -> io::Result<End> {
    let (path, input) = (path.to_owned(), link.name.clone());
    let opened = tokio::task::spawn_blocking(move || {
        let plan = Survey::of(&path, None)?.plan();
        RecordingReader::open(&path, input, plan)
    });
    let mut reader = opened.await.map_err(io::Error::other)??;
    link.opened();
    loop {
        let read = tokio::task::spawn_blocking(move || (reader.next_chunk(), reader));
        let (chunk, returned) = read.await.map_err(io::Error::other)?;
        reader = returned;
        let Some(chunk) = chunk else {
            break;
        };
        let decoder = reader.decoder();
        link.stats
            .count_received(chunk.bytes, &decoder.take_tally());
        link.stats.count_values(&decoder.take_values());
        let observations: Vec<Observation> = chunk
            .recorded
            .into_iter()
            .map(|recorded| recorded.seen)
            .collect();
        link.deliver(observations).await?;
    }
    Ok(End::Finished)
}
