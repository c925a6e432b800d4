//! Decoding of bytes to observations: split into lines, parsed, counted.

use binnacle_nmea::lines::Line;
use binnacle_nmea::{Lines, Rejected, Tally, datagram};
use binnacle_observation::{Observation, Source};
use binnacle_observation::{readings, timestamp};
use std::net::IpAddr;
use std::sync::Arc;

/// Decoder of one connection's bytes; a new connection needs a new one.
#[derive(Debug)]
pub(crate) struct Decoder {
    lines: Lines,
    reader: Reader,
}

#[derive(Debug)]
struct Reader {
    input: Arc<str>,
    tally: Tally,
    /// Sender of the present datagram.
    sender: Option<IpAddr>,
    /// Last system function, which many lines share.
    sfi: Option<Arc<str>>,
    out: Vec<Observation>,
}

impl Decoder {
    pub(crate) fn new(input: Arc<str>) -> Decoder {
        Decoder {
            lines: Lines::default(),
            reader: Reader {
                input,
                tally: Tally::default(),
                sender: None,
                sfi: None,
                out: Vec::new(),
            },
        }
    }

    /// Decodes the lines that a chunk completes.
    pub(crate) fn chunk(&mut self, chunk: &[u8]) {
        let reader = &mut self.reader;
        self.lines.push(chunk, |line| reader.line(line));
    }

    /// Decodes the last line, whose end may be missing.
    pub(crate) fn finish(&mut self) {
        let reader = &mut self.reader;
        self.lines.finish(|line| reader.line(line));
    }

    /// Sets the sender of the datagram that follows.
    pub(crate) fn set_sender(&mut self, sender: IpAddr) {
        self.reader.sender = Some(sender);
    }

    /// Decodes a datagram of plain sentences.
    pub(crate) fn plain_datagram(&mut self, bytes: &[u8]) {
        self.chunk(bytes);
        self.finish();
    }

    /// Decodes an IEC 61162-450 datagram.
    pub(crate) fn tagged_datagram(&mut self, bytes: &[u8]) {
        match datagram::lines(bytes) {
            Ok(lines) => lines.for_each(|line| self.reader.line(Line::Whole(line))),
            Err(rejected) => self.reader.tally.reject(rejected),
        }
    }

    /// Takes the observations so far.
    pub(crate) fn take_observations(&mut self) -> Vec<Observation> {
        let room = Vec::with_capacity(self.reader.out.len());
        std::mem::replace(&mut self.reader.out, room)
    }

    /// Takes the counts so far.
    pub(crate) fn take_tally(&mut self) -> Tally {
        std::mem::take(&mut self.reader.tally)
    }
}

impl Reader {
    fn line(&mut self, line: Line<'_>) {
        let Line::Whole(line) = line else {
            self.tally.reject(Rejected::TooLong);
            return;
        };
        let Some(tagged) = self.tally.read(line) else {
            return;
        };
        // The clock in a TAG block is some device's own, and states when the sentence was measured.
        let stated = tagged.tag.unix_micros.and_then(timestamp);
        self.sfi = tagged.tag.source.and_then(|text| self.shared_sfi(text));
        let sentence = tagged.sentence;
        let source = Source {
            sfi: self.sfi.clone(),
            sender: self.sender,
            ..Source::of_sentence(
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_compass::time::Timestamp;

    const HEADING: &str = "$GPHDT,274.07,T*03";

    fn decode(text: &str) -> (Vec<Observation>, Tally) {
        let mut decoder = Decoder::new("log".into());
        decoder.chunk(text.as_bytes());
        decoder.finish();
        (decoder.take_observations(), decoder.take_tally())
    }

    #[test]
    fn the_clock_of_a_tag_block_states_when_a_sentence_was_measured() {
        let (seen, _) = decode(&format!("\\c:1767355200*5F\\{HEADING}\n"));
        assert_eq!(seen.len(), 1);
        let stated = Timestamp::parse("2026-01-02T12:00:00Z").ok();
        assert_eq!(seen[0].stated, stated);
    }

    #[test]
    fn observations_carry_their_source() {
        let (seen, _) = decode("$HCHDG,98.3,0.0,E,12.6,W*57\r\n");
        let plain = Source::of_sentence("log".into(), *b"HC", *b"HDG");
        assert_eq!((&seen[0].source, seen[0].stated), (&plain, None));
        let mut decoder = Decoder::new("log".into());
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
        let (seen, tally) = decode(text);
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
        let mut decoder = Decoder::new("log".into());
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
