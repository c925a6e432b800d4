//! Decoding of a recording's lines to observations, each with the time of its line.

use super::file_clock::FileClock;
use super::lines::NumberedLines;
use super::not_understood::NotUnderstood;
use super::plan::{Plan, ROLL_OVER_MICROS};
use crate::n2k::N2kReader;
use crate::readings::{readings, timestamp};
use crate::signalk::{DeltaCounts, DeltaReader};
use crate::{Observation, RECORDED_TIME, Reading, Source};
use binnacle_compass::time::Timestamp;
use binnacle_nmea::lines::Line;
use binnacle_nmea::n2k::{self, actisense};
use binnacle_nmea::recording::{LineFormat, Stamp, split};
use binnacle_nmea::with_checksum;
use binnacle_nmea::{Rejected, Tally};
use std::borrow::Cow;
use std::sync::Arc;

const MICROS_A_DAY: i64 = 86_400_000_000;
/// Difference between logger and receiver within which their dates agree but for a roll-over.
const SAME_DATE_MICROS: i64 = 2 * MICROS_A_DAY;
/// Age beyond which a value of a delta is a server's cached one.
const CACHED_AFTER_S: f64 = 10.0;

/// Observation of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Time of its line, once the recording has given one.
    pub at: Option<Timestamp>,
    /// Observation.
    pub seen: Observation,
}

/// Roll-over of the weeks of GPS that was corrected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollOver {
    /// First date as the receiver gave it.
    pub stated: Timestamp,
    /// Corrected date.
    pub corrected: Timestamp,
}

/// Decoder of one recording.
#[derive(Debug)]
pub struct Decoder {
    /// First bytes, until there are enough to tell what kind of recording it is.
    first: Option<Vec<u8>>,
    /// Decoder of a recording without lines; none for one with lines.
    binary: Option<actisense::Decoder>,
    lines: NumberedLines,
    reader: LineReader,
}

/// Reader of lines, and all that they share.
#[derive(Debug)]
struct LineReader {
    input: Arc<str>,
    plan: Plan,
    deltas: DeltaReader,
    n2k: N2kReader,
    /// System function of the last TAG block, which many lines share.
    sfi: Option<Arc<str>>,
    clock: FileClock,
    /// Last time that the logger gave, corrected.
    recorded_at: Option<Timestamp>,
    /// Set once the logger has given a line its time. Times within deltas then do not count.
    is_stamped: bool,
    /// Last known time, near which a time of day is looked for.
    near: Option<Timestamp>,
    roll_over: Option<RollOver>,
    tally: Tally,
    values: DeltaCounts,
    not_understood: NotUnderstood,
    out: Vec<Recorded>,
}

impl Decoder {
    /// Creates a decoder of a recording that a survey has planned.
    pub fn new(input: Arc<str>, plan: Plan) -> Decoder {
        Decoder {
            first: Some(Vec::new()),
            binary: None,
            lines: NumberedLines::default(),
            reader: LineReader {
                deltas: DeltaReader::of_recording(Arc::clone(&input)),
                n2k: N2kReader::new(Arc::clone(&input)),
                input,
                near: plan.near,
                plan,
                sfi: None,
                clock: FileClock::default(),
                recorded_at: None,
                is_stamped: false,
                roll_over: None,
                tally: Tally::default(),
                values: DeltaCounts::default(),
                not_understood: NotUnderstood::default(),
                out: Vec::new(),
            },
        }
    }

    /// Decodes the lines that a chunk completes.
    pub fn chunk(&mut self, chunk: &[u8]) {
        let Some(first) = &mut self.first else {
            return self.decode(chunk);
        };
        first.extend_from_slice(chunk);
        if first.len() >= actisense::SEARCHED_BYTES {
            self.begin();
        }
    }

    /// Decodes the first bytes.
    fn begin(&mut self) {
        if let Some(first) = self.first.take() {
            self.binary = actisense::Decoder::of_recording(&first);
            self.decode(&first);
        }
    }

    fn decode(&mut self, chunk: &[u8]) {
        let reader = &mut self.reader;
        match &mut self.binary {
            Some(binary) => binary.push(chunk, |stamp, message| {
                reader.n2k(&n2k::text::Line {
                    stamp,
                    content: n2k::text::Content::Message(message),
                });
            }),
            None => self
                .lines
                .push(chunk, |number, line| reader.line(number, line)),
        }
    }

    /// Decodes the last line, whose end may be missing.
    pub fn finish(&mut self) {
        self.begin();
        let reader = &mut self.reader;
        self.lines.finish(|number, line| reader.line(number, line));
    }

    /// Takes the observations so far.
    pub fn take_recorded(&mut self) -> Vec<Recorded> {
        let room = Vec::with_capacity(self.reader.out.len());
        std::mem::replace(&mut self.reader.out, room)
    }

    /// Takes the counts of sentences so far.
    pub fn take_tally(&mut self) -> Tally {
        std::mem::take(&mut self.reader.tally)
    }

    /// Takes the counts of Signal K values so far.
    pub fn take_values(&mut self) -> DeltaCounts {
        std::mem::take(&mut self.reader.values)
    }

    /// Takes the lines so far that were not understood.
    pub fn take_not_understood(&mut self) -> NotUnderstood {
        std::mem::take(&mut self.reader.not_understood)
    }

    /// Returns the roll-over that was corrected, if there was one.
    pub fn roll_over(&self) -> Option<RollOver> {
        self.reader.roll_over
    }
}

impl LineReader {
    fn line(&mut self, number: u64, line: Line<'_>) {
        let Line::Whole(line) = line else {
            self.tally.reject(Rejected::TooLong);
            let reason = Rejected::TooLong.reason();
            self.not_understood.add(reason, number, b"");
            return;
        };
        if let Some(line) = n2k::text::parse_line(line) {
            self.n2k(&line);
            return;
        }
        let mut rest = line;
        while let Some(part) = split(rest, self.plan.order) {
            if let Some(at) = part.stamp.and_then(|stamp| self.time_of(stamp)) {
                self.is_stamped = true;
                self.record_time(at);
            }
            match part.format {
                LineFormat::Sentence => self.sentence(number, part.content),
                LineFormat::Delta => self.delta(number, part.content),
            }
            rest = part.rest;
        }
        if rest.len() == line.len() && !is_comment(line) {
            self.tally.reject(Rejected::NotASentence);
            let reason = Rejected::NotASentence.reason();
            self.not_understood.add(reason, number, line);
        }
    }

    /// Decodes a frame or message of NMEA 2000.
    fn n2k(&mut self, line: &n2k::text::Line) {
        let stamp = match line.stamp {
            n2k::text::Stamp::Unix(micros) => Some(Stamp::Instant(micros)),
            n2k::text::Stamp::OfDay(micros) => Some(Stamp::TimeOfDay(micros)),
            n2k::text::Stamp::None | n2k::text::Stamp::Elapsed(_) => None,
        };
        if let Some(at) = stamp.and_then(|stamp| self.time_of(stamp)) {
            self.is_stamped = true;
            self.record_time(at);
        }
        let mut seen = Vec::new();
        let keep = |observation| seen.push(observation);
        match &line.content {
            n2k::text::Content::Frame(frame) => self.n2k.frame(frame, &mut self.values, keep),
            n2k::text::Content::Message(message) => {
                self.n2k.message(message, &mut self.values, keep);
            }
        }
        for seen in seen {
            let reading = self.corrected(seen.reading);
            self.push(Observation { reading, ..seen });
        }
    }

    fn sentence(&mut self, number: u64, content: &[u8]) {
        let is_bare = self.plan.without_checksums && !content.contains(&b'*');
        let whole = is_bare.then(|| with_checksum(content.trim_ascii_end()));
        let content = whole.as_deref().unwrap_or(content);
        let lines = &mut self.not_understood;
        let note = |rejected: Rejected| lines.add(rejected.reason(), number, content);
        let Some(tagged) = self.tally.read_noting(content, note) else {
            return;
        };
        if let Some(at) = tagged.tag.unix_micros.and_then(timestamp) {
            self.record_time(self.logger_time(at));
        }
        self.sfi = tagged.tag.source.and_then(|text| self.shared_sfi(text));
        let sentence = tagged.sentence;
        let source = Source {
            sfi: self.sfi.clone(),
            ..Source::of_sentence(
                Arc::clone(&self.input),
                sentence.talker,
                sentence.data.kind().code(),
            )
        };
        readings(&sentence.data, |reading| {
            let reading = self.corrected(reading);
            self.push(Observation::now(source.clone(), reading));
        });
    }

    /// Decodes a delta, which a table quotes by doubling its quotes.
    fn delta(&mut self, number: u64, content: &[u8]) {
        let text = String::from_utf8_lossy(content);
        let text = if text.starts_with("{\"\"") {
            Cow::Owned(text.replace("\"\"", "\""))
        } else {
            text
        };
        let mut counts = DeltaCounts::default();
        for seen in self.deltas.read(&text, &mut counts) {
            self.delta_value(number, content, seen);
        }
        for reason in counts.rejected.keys() {
            self.not_understood.add(reason, number, content);
        }
        self.values.add(&counts);
    }

    fn delta_value(&mut self, number: u64, content: &[u8], seen: Observation) {
        let stated = seen.stated.map(|at| self.logger_time(at));
        if let Some(at) = stated.filter(|_| !self.is_stamped) {
            self.record_time(at);
            let now = self.clock.now().unwrap_or(at);
            if now.seconds_since(at) > CACHED_AFTER_S {
                self.not_understood.add("old value", number, content);
                return;
            }
        }
        if matches!(seen.reading, Reading::Greeting(_)) {
            return;
        }
        let reading = self.corrected(seen.reading);
        self.push(Observation::now(seen.source, reading));
    }

    fn push(&mut self, seen: Observation) {
        let at = self.clock.now();
        self.out.push(Recorded { at, seen });
    }

    /// Returns the time that a logger's stamp means.
    fn time_of(&self, stamp: Stamp) -> Option<Timestamp> {
        let at = match stamp {
            Stamp::Instant(micros) => timestamp(micros)?,
            Stamp::TimeOfDay(micros) => nearest(micros, self.near?)?,
        };
        Some(self.logger_time(at))
    }

    /// Corrects a logger's time by its clock's error.
    fn logger_time(&self, at: Timestamp) -> Timestamp {
        let micros = at.micros() - self.plan.logger_ahead_micros;
        timestamp(micros).unwrap_or(at)
    }

    /// Applies a time that the logger gave.
    fn record_time(&mut self, at: Timestamp) {
        if self.recorded_at.replace(at) == Some(at) {
            return;
        }
        self.near = Some(at);
        self.clock.observe(at);
        let (talker, sentence) = RECORDED_TIME;
        let source = Source::of_sentence(Arc::clone(&self.input), talker, sentence);
        self.push(Observation::now(source, Reading::Time(at)));
    }

    /// Corrects a receiver's date after a roll-over, and applies its time where the logger gives
    /// none.
    fn corrected(&mut self, mut reading: Reading) -> Reading {
        let (Reading::Time(time)
        | Reading::Fix {
            time: Some(time), ..
        }) = &mut reading
        else {
            return reading;
        };
        let stated = *time;
        let asked = timestamp(stated.micros() + self.plan.roll_overs * ROLL_OVER_MICROS);
        let behind = self.cycles_behind(asked.unwrap_or(stated));
        let cycles = self.plan.roll_overs + behind;
        if let Some(corrected) = timestamp(stated.micros() + cycles * ROLL_OVER_MICROS)
            && cycles > 0
        {
            *time = corrected;
            let found = RollOver { stated, corrected };
            self.roll_over.get_or_insert(found);
        }
        let time = *time;
        if self.recorded_at.is_none() {
            self.clock.observe(time);
            self.near = Some(time);
        }
        reading
    }

    /// Returns the roll-overs by which a receiver's date is behind the logger's, or without one
    /// behind the last date.
    fn cycles_behind(&self, time: Timestamp) -> i64 {
        let Some(before) = self.recorded_at.or(self.near) else {
            return 0;
        };
        let behind = before.micros() - time.micros();
        let cycles = (behind + ROLL_OVER_MICROS / 2).div_euclid(ROLL_OVER_MICROS);
        let remainder = behind - cycles * ROLL_OVER_MICROS;
        if cycles < 1 || remainder.abs() > SAME_DATE_MICROS {
            return 0;
        }
        cycles
    }

    /// Returns the text of a system function, which is that of the last line in most cases.
    fn shared_sfi(&self, text: &[u8]) -> Option<Arc<str>> {
        let text = std::str::from_utf8(text).ok()?;
        let known = self.sfi.clone().filter(|known| **known == *text);
        Some(known.unwrap_or_else(|| text.into()))
    }
}

/// Returns the instant with a time of day that lies nearest to another.
fn nearest(time_of_day_micros: i64, near: Timestamp) -> Option<Timestamp> {
    let midnight = near.micros().div_euclid(MICROS_A_DAY) * MICROS_A_DAY;
    let days = -1..=1;
    let candidates = days.map(|day| midnight + day * MICROS_A_DAY + time_of_day_micros);
    let nearest = candidates.min_by_key(|candidate| candidate.abs_diff(near.micros()))?;
    timestamp(nearest)
}

/// Returns whether a line is a remark, as headers of recordings are.
fn is_comment(line: &[u8]) -> bool {
    let text = line
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(line)
        .trim_ascii_start();
    text.is_empty() || matches!(text[0], b'#' | b';' | b'%') || text.starts_with(b"//")
}
