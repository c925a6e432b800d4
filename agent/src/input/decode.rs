//! Decoding of bytes to observations: split into lines, parsed, counted.

use super::readings::{readings, timestamp};
use crate::instruments::{Observation, RECORDED_TIME, Reading, Source as Origin};
use binnacle_compass::time::Timestamp;
use binnacle_nmea::lines::Line;
use binnacle_nmea::{Lines, Rejected, Tally, datagram};
use std::net::IpAddr;
use std::sync::Arc;

/// Kind of input, which decides what may precede a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// Live instruments. A clock in a TAG block is some device's own, and states when the sentence
    /// was measured.
    Live,
    /// Recording: an RFC 3339 time and a space or tab, or the clock in a TAG block, gives the time
    /// at which a line was received.
    Recording,
}

/// Decoder of one connection's bytes; a new connection needs a new one.
#[derive(Debug)]
pub(super) struct Decoder {
    lines: Lines,
    reader: Reader,
}

#[derive(Debug)]
struct Reader {
    input: Arc<str>,
    source: Source,
    tally: Tally,
    /// Sender of the present datagram.
    sender: Option<IpAddr>,
    /// Last system function, which many lines share.
    sfi: Option<Arc<str>>,
    recorded_at: Option<Timestamp>,
    /// Text of the last time, which many lines share.
    time_text: Vec<u8>,
    out: Vec<Observation>,
}

impl Decoder {
    pub(super) fn new(input: Arc<str>, source: Source) -> Decoder {
        Decoder {
            lines: Lines::default(),
            reader: Reader {
                input,
                source,
                tally: Tally::default(),
                sender: None,
                sfi: None,
                recorded_at: None,
                time_text: Vec::new(),
                out: Vec::new(),
            },
        }
    }

    /// Decodes the lines that a chunk completes.
    pub(super) fn chunk(&mut self, chunk: &[u8]) {
        let reader = &mut self.reader;
        self.lines.push(chunk, |line| reader.line(line));
    }

    /// Decodes the last line, whose end may be missing.
    pub(super) fn finish(&mut self) {
        let reader = &mut self.reader;
        self.lines.finish(|line| reader.line(line));
    }

    /// Sets the sender of the datagram that follows.
    pub(super) fn set_sender(&mut self, sender: IpAddr) {
        self.reader.sender = Some(sender);
    }

    /// Decodes a datagram of plain sentences.
    pub(super) fn plain_datagram(&mut self, bytes: &[u8]) {
        self.chunk(bytes);
        self.finish();
    }

    /// Decodes an IEC 61162-450 datagram.
    pub(super) fn tagged_datagram(&mut self, bytes: &[u8]) {
        match datagram::lines(bytes) {
            Ok(lines) => lines.for_each(|line| self.reader.line(Line::Whole(line))),
            Err(rejected) => self.reader.tally.reject(rejected),
        }
    }

    /// Takes the observations so far.
    pub(super) fn take_observations(&mut self) -> Vec<Observation> {
        let room = Vec::with_capacity(self.reader.out.len());
        std::mem::replace(&mut self.reader.out, room)
    }

    /// Takes the counts so far.
    pub(super) fn take_tally(&mut self) -> Tally {
        std::mem::take(&mut self.reader.tally)
    }
}

impl Reader {
    fn line(&mut self, line: Line<'_>) {
        let Line::Whole(mut line) = line else {
            self.tally.reject(Rejected::TooLong);
            return;
        };
        if self.source == Source::Recording {
            let Some(rest) = self.after_time(line) else {
                self.tally.reject(Rejected::NotASentence);
                return;
            };
            line = rest;
        }
        let Some(tagged) = self.tally.read(line) else {
            return;
        };
        let clock = tagged.tag.unix_micros.and_then(timestamp);
        let stated = match self.source {
            Source::Live => clock,
            Source::Recording => {
                if let Some(at) = clock {
                    self.recorded(at);
                }
                None
            }
        };
        self.sfi = tagged.tag.source.and_then(|text| self.shared_sfi(text));
        let sentence = tagged.sentence;
        let source = Origin {
            sfi: self.sfi.clone(),
            sender: self.sender,
            ..Origin::of_sentence(
                Arc::clone(&self.input),
                sentence.talker,
                sentence.data.kind().code(),
            )
        };
        readings(&sentence.data, |reading| {
            self.out.push(Observation {
                source: source.clone(),
                stated,
                reading,
            });
        });
    }

    /// Returns the text of a system function, which is that of the last line in most cases.
    fn shared_sfi(&self, text: &[u8]) -> Option<Arc<str>> {
        let text = std::str::from_utf8(text).ok()?;
        let known = self.sfi.clone().filter(|known| **known == *text);
        Some(known.unwrap_or_else(|| text.into()))
    }

    /// Returns the rest of a line after its time; `None` when something in place of a time is none.
    fn after_time<'a>(&mut self, line: &'a [u8]) -> Option<&'a [u8]> {
        if !line.first().is_some_and(u8::is_ascii_digit) {
            return Some(line);
        }
        let end = line.iter().position(|byte| matches!(byte, b' ' | b'\t'))?;
        let (text, rest) = (&line[..end], line[end..].trim_ascii_start());
        if text != self.time_text {
            let at = Timestamp::parse(std::str::from_utf8(text).ok()?).ok()?;
            self.time_text.clear();
            self.time_text.extend_from_slice(text);
            self.recorded(at);
        }
        Some(rest)
    }

    fn recorded(&mut self, at: Timestamp) {
        if self.recorded_at.replace(at) == Some(at) {
            return;
        }
        let (talker, sentence) = RECORDED_TIME;
        let source = Origin::of_sentence(Arc::clone(&self.input), talker, sentence);
        let seen = Observation::now(source, Reading::Time(at));
        self.out.push(seen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::is_recorded_time;

    const HEADING: &str = "$GPHDT,274.07,T*03";

    fn decode(source: Source, text: &str) -> (Vec<Observation>, Tally) {
        let mut decoder = Decoder::new("log".into(), source);
        decoder.chunk(text.as_bytes());
        decoder.finish();
        (decoder.take_observations(), decoder.take_tally())
    }

    fn times(seen: &[Observation]) -> Vec<String> {
        let times = seen.iter().filter(|seen| is_recorded_time(seen));
        times
            .map(|seen| match seen.reading {
                Reading::Time(at) => at.to_string(),
                _ => panic!("{seen:?}"),
            })
            .collect()
    }

    #[test]
    fn a_recording_gives_its_times_before_its_sentences() {
        let text = format!(
            "2026-01-02T12:00:00Z {HEADING}\n2026-01-02T12:00:00Z\t{HEADING}\r\n\
             2026-01-02T13:00:01.25+01:00  {HEADING}\n{HEADING}"
        );
        let (seen, tally) = decode(Source::Recording, &text);
        assert_eq!(
            times(&seen),
            ["2026-01-02T12:00:00Z", "2026-01-02T12:00:01.250Z"]
        );
        assert_eq!((seen.len(), tally.total_read()), (6, 4));
        assert!(is_recorded_time(&seen[0]) && is_recorded_time(&seen[3]));
    }

    #[test]
    fn the_clock_of_a_tag_block_is_a_time_in_recordings_alone() {
        let text = format!("\\c:1767355200*5F\\{HEADING}\n");
        let (seen, tally) = decode(Source::Recording, &text);
        assert_eq!(tally.total_rejected(), 0, "{tally:?}");
        assert_eq!(times(&seen), ["2026-01-02T12:00:00Z"]);
        assert_eq!(seen[1].stated, None);
        let (seen, _) = decode(Source::Live, &text);
        assert_eq!((seen.len(), times(&seen).len()), (1, 0));
        let stated = Timestamp::parse("2026-01-02T12:00:00Z").ok();
        assert_eq!(seen[0].stated, stated);
    }

    #[test]
    fn a_line_whose_time_is_no_time_is_counted_and_not_used() {
        for time in ["2026-13-02T12:00:00Z", "12", "2026-01-02"] {
            let (seen, tally) = decode(Source::Recording, &format!("{time} {HEADING}\n"));
            assert_eq!(seen, []);
            assert_eq!(
                tally.rejected().collect::<Vec<_>>(),
                [("not a sentence", 1)]
            );
        }
    }

    #[test]
    fn observations_carry_their_source() {
        let (seen, _) = decode(Source::Live, "$HCHDG,98.3,0.0,E,12.6,W*57\r\n");
        let plain = Origin::of_sentence("log".into(), *b"HC", *b"HDG");
        assert_eq!((&seen[0].source, seen[0].stated), (&plain, None));
        let mut decoder = Decoder::new("log".into(), Source::Live);
        decoder.set_sender(IpAddr::from([10, 0, 0, 2]));
        let datagram = format!("UdPbC\0\\s:HE0001,n:1*0C\\{HEADING}");
        decoder.tagged_datagram(datagram.as_bytes());
        let source = decoder.take_observations().remove(0).source;
        assert_eq!(source.sfi.as_deref(), Some("HE0001"));
        assert_eq!(source.sender, Some(IpAddr::from([10, 0, 0, 2])));
    }

    #[test]
    fn nothing_of_noise_or_of_spoilt_sentences_is_used() {
        let text = "\u{0}\u{1}\u{fffd}\n$HCHDG,98.4,0.0,E,12.6,W*57\n$HCHDG,98.3,0.0,E,12.6,W\n";
        let (seen, tally) = decode(Source::Live, text);
        assert_eq!(seen, []);
        let reasons = [
            ("not a sentence", 1),
            ("no checksum", 1),
            ("wrong checksum", 1),
        ];
        assert_eq!(tally.rejected().collect::<Vec<_>>(), reasons);
    }

    #[test]
    fn datagrams_may_lack_the_last_line_end() {
        let mut decoder = Decoder::new("log".into(), Source::Live);
        for _ in 0..2 {
            decoder.plain_datagram(HEADING.as_bytes());
            decoder.tagged_datagram(format!("UdPbC\0{HEADING}").as_bytes());
            decoder.tagged_datagram(HEADING.as_bytes());
        }
        assert_eq!(decoder.take_observations().len(), 4);
        let tally = decoder.take_tally();
        assert_eq!(
            tally.rejected().collect::<Vec<_>>(),
            [("not a datagram of sentences", 2)]
        );
    }
}
