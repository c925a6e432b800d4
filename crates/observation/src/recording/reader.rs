//! Reader of one recording, chunk by chunk.

use super::decoder::{Decoder, Recorded};
use super::open::open;
use super::plan::Plan;
use std::fmt;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

const CHUNK_BYTES: usize = 64 * 1024;

/// Reader of one recording.
pub struct RecordingReader {
    bytes: Box<dyn Read + Send>,
    buffer: Vec<u8>,
    decoder: Decoder,
    is_done: bool,
    problem: Option<String>,
}

/// Chunk of a recording.
#[derive(Debug, Default)]
pub struct Chunk {
    /// Bytes that were read.
    pub bytes: usize,
    /// Observations in the order of the lines.
    pub recorded: Vec<Recorded>,
}

impl RecordingReader {
    /// Opens a recording.
    ///
    /// # Errors
    /// Fails when the file cannot be read.
    pub fn open(path: &Path, input: Arc<str>, plan: Plan) -> io::Result<RecordingReader> {
        Ok(RecordingReader {
            bytes: open(path)?,
            buffer: vec![0; CHUNK_BYTES],
            decoder: Decoder::new(input, plan),
            is_done: false,
            problem: None,
        })
    }

    /// Reads the next chunk; `None` behind the last one. A file that cannot be read to its end, as
    /// a compressed one that was cut short, ends where that is found.
    pub fn next_chunk(&mut self) -> Option<Chunk> {
        if self.is_done {
            return None;
        }
        let bytes = self.bytes.read(&mut self.buffer).unwrap_or_else(|error| {
            self.problem = Some(error.to_string());
            0
        });
        if bytes == 0 {
            self.is_done = true;
            self.decoder.finish();
        } else {
            self.decoder.chunk(&self.buffer[..bytes]);
        }
        Some(Chunk {
            bytes,
            recorded: self.decoder.take_recorded(),
        })
    }

    /// Returns the decoder, for its counts.
    pub fn decoder(&mut self) -> &mut Decoder {
        &mut self.decoder
    }

    /// Returns the reason why the file ended before its end.
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }
}

impl fmt::Debug for RecordingReader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordingReader")
            .field("decoder", &self.decoder)
            .finish_non_exhaustive()
    }
}
