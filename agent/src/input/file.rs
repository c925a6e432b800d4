//! Recorded sentences from a file.

use super::decode::{Decoder, Source};
use super::link::{End, Link};
use super::pump::pump;
use crate::instruments::Observation;
use binnacle_nmea::Tally;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

const CHUNK_BYTES: usize = 64 * 1024;

pub(super) async fn session(path: &Path, link: &Link) -> io::Result<End> {
    let file = tokio::fs::File::open(path).await?;
    link.opened();
    pump(file, Source::Recording, link).await?;
    Ok(End::Finished)
}

/// Reads a whole recording and passes its observations to `each` in the order of its lines. The
/// recording's own times are observations for which [`crate::instruments::is_recorded_time`] holds.
///
/// # Errors
/// Fails when the file cannot be read.
pub(crate) fn replay(path: &Path, mut each: impl FnMut(&[Observation])) -> io::Result<Tally> {
    let mut file = File::open(path)?;
    let mut decoder = Decoder::new("replay".into(), Source::Recording);
    let mut buffer = vec![0; CHUNK_BYTES];
    loop {
        let count = file.read(&mut buffer)?;
        if count == 0 {
            break;
        }
        decoder.chunk(&buffer[..count]);
        each(&decoder.take_observations());
    }
    decoder.finish();
    each(&decoder.take_observations());
    Ok(decoder.take_tally())
}
