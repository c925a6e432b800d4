//! Readings of each second, in a file of its own with a size limit: for download in port, never
//! sent.
//!
//! Invariants:
//!
//! - The file never grows beyond its limit; the oldest blocks are overwritten.
//! - Only intact blocks are read: each has checksums. A power failure costs the block being written
//!   and the seconds that were not in one yet.
//! - The spool comes first: when the disk is full for either, the raw log deletes everything and
//!   begins again an hour later at the earliest.
//! - No fault of the raw log stops the agent or keeps a sample from the spool.

mod block;
mod export;
mod second;

pub(crate) use export::{Span, export};
pub(crate) use second::Second;

use binnacle_compass::time::Timestamp;
use block::{BLOCK_BYTES, RECORDS, number_at};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use tokio::time::Instant;

/// Pause after the disk was full.
const PAUSE_AFTER_FULL: Duration = Duration::from_hours(1);

/// Size of the raw log, for the page and `status`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct RawLogStatus {
    #[serde(rename = "octets")]
    pub(crate) bytes: u64,
    #[serde(rename = "limit_octets")]
    pub(crate) limit_bytes: u64,
    /// Reason why nothing is recorded for now.
    pub(crate) problem: Option<String>,
}

/// Raw log of a running agent.
#[derive(Debug)]
pub(crate) struct RawLog {
    path: PathBuf,
    /// Blocks that the file may have; 0 disables the raw log.
    slots: u64,
    file: Option<File>,
    problem: Option<String>,
    /// End of a pause.
    paused_until: Option<Instant>,
    /// Slot and number of the next block.
    slot: u64,
    number: u64,
    seconds: Vec<Second>,
    /// Last recorded second, since 1970.
    last_s: Option<i64>,
}

/// Returns the path of the raw log in a data directory.
pub(crate) fn path(data_dir: &Path) -> PathBuf {
    data_dir.join("ring.bin")
}

impl RawLog {
    /// Opens the raw log and continues after its last block. A log that cannot be used records
    /// nothing.
    pub(crate) fn open(data_dir: &Path, limit_bytes: u64) -> RawLog {
        let mut raw_log = RawLog {
            path: path(data_dir),
            slots: limit_bytes / BLOCK_BYTES,
            file: None,
            problem: None,
            paused_until: None,
            slot: 0,
            number: 1,
            seconds: Vec::with_capacity(RECORDS),
            last_s: None,
        };
        if raw_log.slots == 0 {
            // A log of an earlier configuration is the owner's; it is not removed.
            return raw_log;
        }
        if let Err(error) = raw_log.seek_end() {
            raw_log.release_disk(&error.to_string(), Instant::now());
        }
        raw_log
    }

    fn seek_end(&mut self) -> io::Result<()> {
        let mut file = open_private(&self.path)?;
        let blocks = file.metadata()?.len() / BLOCK_BYTES;
        if blocks > self.slots {
            file.set_len(self.slots * BLOCK_BYTES)?;
        }
        for slot in 0..blocks.min(self.slots) {
            if let Some(number) = number_at(&mut file, slot)?
                && number >= self.number
            {
                (self.slot, self.number) = ((slot + 1) % self.slots, number + 1);
            }
        }
        self.file = Some(file);
        Ok(())
    }

    /// Records a second, unless it is recorded already, and writes the block once it is full.
    pub(crate) fn record(
        &mut self,
        time: Timestamp,
        second: impl FnOnce() -> Second,
        now: Instant,
    ) {
        let second_s = time.micros().div_euclid(1_000_000);
        if self.slots == 0 || self.last_s.replace(second_s) == Some(second_s) {
            return;
        }
        self.seconds.push(second());
        if self.seconds.len() >= RECORDS {
            self.flush(now);
        }
    }

    /// Writes the recorded seconds as a block, as at the end.
    pub(crate) fn flush(&mut self, now: Instant) {
        if self.paused_until.is_some_and(|until| now < until) {
            self.seconds.clear();
        }
        if self.seconds.is_empty() {
            return;
        }
        let written = self.write_block();
        self.seconds.clear();
        match written {
            Ok(()) => {
                self.problem = None;
                self.paused_until = None;
            }
            Err(error) => self.release_disk(&error.to_string(), now),
        }
    }

    fn write_block(&mut self) -> io::Result<()> {
        if self.file.is_none() {
            self.file = Some(open_private(&self.path)?);
        }
        let Some(file) = &mut self.file else {
            return Ok(());
        };
        let block = block::write(self.number, &self.seconds);
        file.seek(SeekFrom::Start(self.slot * BLOCK_BYTES))?;
        file.write_all(&block)?;
        self.slot = (self.slot + 1) % self.slots;
        self.number += 1;
        Ok(())
    }

    /// Deletes everything in favour of the spool.
    pub(crate) fn release_disk(&mut self, problem: &str, now: Instant) {
        if self.slots == 0 {
            return;
        }
        if self.problem.is_none() {
            tracing::warn!(
                problem,
                "the raw log was deleted to free the disk, it restarts in an hour"
            );
        }
        let emptied = self.file.take().map(|file| file.set_len(0));
        if let Some(Err(error)) = emptied {
            tracing::warn!(%error, "the raw log cannot be emptied");
        }
        self.problem = Some(problem.to_owned());
        self.paused_until = Some(now + PAUSE_AFTER_FULL);
        self.slot = 0;
        self.seconds.clear();
    }

    /// Returns the status, `None` when the raw log is disabled.
    pub(crate) fn status(&self) -> Option<RawLogStatus> {
        let length = |file: &File| file.metadata().map_or(0, |found| found.len());
        (self.slots > 0).then(|| RawLogStatus {
            bytes: self.file.as_ref().map_or(0, length),
            limit_bytes: self.slots * BLOCK_BYTES,
            problem: self.problem.clone(),
        })
    }
}

fn open_private(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.mode(0o600);
    }
    options.open(path)
}

#[cfg(test)]
mod tests;
