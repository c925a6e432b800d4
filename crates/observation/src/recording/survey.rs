//! Survey of a recording before it is read: the order of its dates, and the error of its logger's
//! clock.
//!
//! A logger may keep the time of a zone, or none that is right. The receivers in the recording know
//! better, and their difference is the same for all lines.

use super::decoder::Recorded;
use super::plan::{Plan, ROLL_OVER_MICROS};
use super::reader::RecordingReader;
use crate::{Reading, is_recorded_time};
use binnacle_compass::time::Timestamp;
use binnacle_nmea::recording::DateOrder;
use binnacle_nmea::{Rejected, Tally};
use std::io;
use std::path::Path;

/// Bytes of a recording that are surveyed: some minutes of a busy bridge.
const SURVEYED_BYTES: usize = 512 * 1024;
/// Bytes within which a time is looked for.
const SEARCHED_BYTES: usize = 64 * 1024 * 1024;
/// Differences between logger and receiver that are compared.
const MAX_DIFFERENCES: usize = 1_000;
/// Difference from which a logger's clock is wrong, rather than late by its own delay.
const LOGGER_TOLERANCE_MICROS: i64 = 60_000_000;
const MICROS_A_DAY: u64 = 86_400_000_000;

/// Clock of a logger against the receivers that it recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoggerClock {
    /// The recording has no receiver, or no times of a logger.
    Unknown,
    /// They agree.
    Agrees,
    /// Time by which the logger is ahead, microseconds.
    Ahead(i64),
}

/// Instruments of a recording, in the order in which readings of one time belong: a reference is
/// compared with the compass's reading of its own time, at the position of that time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Instruments {
    /// Position, perhaps among others.
    Position,
    /// Compass without a position.
    Compass,
    /// Others alone.
    #[default]
    Others,
}

/// Findings about a recording.
#[derive(Clone, Copy, Debug)]
pub struct Survey {
    /// Order of day and month; `None` when both are as good.
    pub order: Option<DateOrder>,
    /// Clock of the logger.
    pub clock: LoggerClock,
    /// Set if the logger gives lines their times.
    pub is_stamped: bool,
    /// First time, as the logger or else the receiver gives it.
    pub first: Option<Timestamp>,
    /// Instruments that were recorded.
    pub instruments: Instruments,
    /// Set if no sentence has a checksum, as of receivers before NMEA 0183 required one.
    pub without_checksums: bool,
}

/// Reading of the beginning of a recording with one order of dates.
#[derive(Debug, Default)]
struct Pass {
    stamps: u64,
    logger: Option<Timestamp>,
    first: Option<Timestamp>,
    instruments: Instruments,
    differences: Vec<i64>,
    without_checksums: bool,
}

impl Survey {
    /// Surveys the beginning of a recording that lies near a time, if one is known.
    ///
    /// # Errors
    /// Fails when the file cannot be read.
    pub fn of(path: &Path, near: Option<Timestamp>) -> io::Result<Survey> {
        let month_first = Pass::read(path, DateOrder::MonthFirst, near)?;
        let day_first = Pass::read(path, DateOrder::DayFirst, near)?;
        let quality = |pass: &Pass| (pass.stamps, std::cmp::Reverse(pass.days_apart()));
        let order = match quality(&month_first).cmp(&quality(&day_first)) {
            std::cmp::Ordering::Greater => Some(DateOrder::MonthFirst),
            std::cmp::Ordering::Less => Some(DateOrder::DayFirst),
            std::cmp::Ordering::Equal => None,
        };
        let pass = match order {
            Some(DateOrder::DayFirst) => day_first,
            Some(DateOrder::MonthFirst) | None => month_first,
        };
        Ok(Survey {
            order,
            clock: pass.logger_clock(),
            is_stamped: pass.stamps > 0,
            first: pass.first,
            instruments: pass.instruments,
            without_checksums: pass.without_checksums,
        })
    }

    /// Returns the settings for this recording alone.
    pub fn plan(&self) -> Plan {
        Plan {
            order: self.order.unwrap_or_default(),
            logger_ahead_micros: match self.clock {
                LoggerClock::Ahead(micros) => micros,
                LoggerClock::Unknown | LoggerClock::Agrees => 0,
            },
            roll_overs: 0,
            without_checksums: self.without_checksums,
            near: self.first,
        }
    }
}

impl Pass {
    fn read(path: &Path, order: DateOrder, near: Option<Timestamp>) -> io::Result<Pass> {
        let plan = Plan {
            order,
            near,
            ..Plan::default()
        };
        let (pass, tally) = Pass::read_with(path, plan)?;
        let no_checksum = Rejected::NoChecksum.reason();
        let lacks = tally.rejected().any(|(reason, _)| reason == no_checksum);
        if tally.total_read() > 0 || !lacks {
            return Ok(pass);
        }
        let without_checksums = true;
        let plan = Plan {
            without_checksums,
            ..plan
        };
        let (pass, tally) = Pass::read_with(path, plan)?;
        Ok(Pass {
            without_checksums: tally.total_read() > 0,
            ..pass
        })
    }

    fn read_with(path: &Path, plan: Plan) -> io::Result<(Pass, Tally)> {
        let mut reader = RecordingReader::open(path, "survey".into(), plan)?;
        let mut pass = Pass::default();
        let mut bytes = 0;
        while let Some(chunk) = reader.next_chunk() {
            bytes += chunk.bytes;
            chunk
                .recorded
                .iter()
                .for_each(|recorded| pass.add(recorded));
            let enough = if pass.first.is_some() {
                SURVEYED_BYTES
            } else {
                SEARCHED_BYTES
            };
            if bytes >= enough {
                break;
            }
        }
        Ok((pass, reader.decoder().take_tally()))
    }

    fn add(&mut self, recorded: &Recorded) {
        let instruments = match recorded.seen.reading {
            Reading::Fix { .. } => Instruments::Position,
            Reading::Compass { .. } | Reading::Magnetic { .. } => Instruments::Compass,
            _ => Instruments::Others,
        };
        self.instruments = self.instruments.min(instruments);
        let (Reading::Time(at) | Reading::Fix { time: Some(at), .. }) = recorded.seen.reading
        else {
            return;
        };
        self.first = self.first.or(Some(at));
        if is_recorded_time(&recorded.seen) {
            self.stamps += 1;
            self.logger = Some(at);
            return;
        }
        if let Some(logger) = self.logger
            && self.differences.len() < MAX_DIFFERENCES
        {
            self.differences.push(logger.micros() - at.micros());
        }
    }

    /// Returns the middle of the differences between logger and receiver.
    fn difference(&self) -> Option<i64> {
        let mut sorted = self.differences.clone();
        sorted.sort_unstable();
        sorted.get(sorted.len() / 2).copied()
    }

    /// Returns the days between logger and receiver.
    fn days_apart(&self) -> u64 {
        self.difference().unwrap_or_default().unsigned_abs() / MICROS_A_DAY
    }

    fn logger_clock(&self) -> LoggerClock {
        match self.difference() {
            None => LoggerClock::Unknown,
            Some(ahead) if ahead.abs() < LOGGER_TOLERANCE_MICROS => LoggerClock::Agrees,
            // No clock of a logger is wrong by decades: the receiver is.
            Some(ahead) if ahead.abs() > ROLL_OVER_MICROS / 2 => LoggerClock::Unknown,
            Some(ahead) => LoggerClock::Ahead(ahead),
        }
    }
}
