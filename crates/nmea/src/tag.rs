//! TAG blocks: parameters before a sentence, between backslashes and with a
//! checksum of their own, for example `\s:GP0001,c:1700000000*hh\`.

use crate::checksum;
use crate::parse::parse;
use crate::print;
use crate::rejected::Rejected;
use crate::sentence::Sentence;

/// TAG blocks longer than this are refused; the standard says 80.
const MAX_TAG_BYTES: usize = 256;
/// The first `c:` number read as milliseconds; smaller ones are seconds. As
/// milliseconds it lies in 1973, as seconds in the year 5138.
const FIRST_MILLISECONDS: i64 = 100_000_000_000;

/// The contents of the TAG blocks before a sentence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tag<'a> {
    /// `s:`, the sender (IEC 61162-450 system function, `HE0001`).
    pub source: Option<&'a [u8]>,
    /// `d:`, the system function that the sentence is for.
    pub destination: Option<&'a [u8]>,
    /// `c:`, the sender's clock, in microseconds since 1970 UTC.
    pub unix_micros: Option<i64>,
    /// `n:`, the sender's count of lines, 1 to 999.
    pub line_count: Option<u16>,
    /// `g:`, the message that the sentence is a part of.
    pub group: Option<Group>,
}

/// The place of a sentence in a message of several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// Number of the sentence, counted from 1.
    pub sentence: u8,
    /// Number of sentences in the message.
    pub sentences: u8,
    /// Code of the message, the same in all its sentences.
    pub code: u16,
}

/// A sentence and the TAG blocks before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tagged<'a> {
    /// All `None` without a TAG block.
    pub tag: Tag<'a>,
    /// The sentence behind them.
    pub sentence: Sentence,
}

/// Reads a sentence and any TAG blocks before it.
///
/// # Errors
/// The reason why the line is not used. A bad TAG block spoils its whole line:
/// bytes were lost on the way.
pub fn parse_tagged(line: &[u8]) -> Result<Tagged<'_>, Rejected> {
    let mut tag = Tag::default();
    let mut rest = line;
    while let [b'\\', block @ ..] = rest {
        let end = block
            .iter()
            .take(MAX_TAG_BYTES)
            .position(|&byte| byte == b'\\')
            .ok_or(Rejected::BadTagBlock)?;
        read_block(&block[..end], &mut tag)?;
        rest = &block[end + 1..];
    }
    Ok(Tagged {
        tag,
        sentence: parse(rest)?,
    })
}

/// Appends a TAG block, checksum included, for a sentence to follow. Clocks are
/// written to the millisecond; clocks before 1970 become 0.
pub fn write_tag(tag: &Tag<'_>, out: &mut Vec<u8>) {
    out.push(b'\\');
    let start = out.len();
    let parameter = |name: u8, out: &mut Vec<u8>| {
        if out.len() > start {
            out.push(b',');
        }
        out.extend_from_slice(&[name, b':']);
    };
    if let Some(source) = tag.source {
        parameter(b's', out);
        out.extend_from_slice(source);
    }
    if let Some(destination) = tag.destination {
        parameter(b'd', out);
        out.extend_from_slice(destination);
    }
    if let Some(micros) = tag.unix_micros {
        parameter(b'c', out);
        print::digits(out, clock(micros.max(0)), 1);
    }
    if let Some(count) = tag.line_count {
        parameter(b'n', out);
        print::digits(out, u64::from(count), 1);
    }
    if let Some(group) = tag.group {
        parameter(b'g', out);
        print::digits(out, u64::from(group.sentence), 1);
        out.push(b'-');
        print::digits(out, u64::from(group.sentences), 1);
        out.push(b'-');
        print::digits(out, u64::from(group.code), 1);
    }
    let sum = checksum::compute(&out[start..]);
    checksum::append(sum, out);
    out.push(b'\\');
}

/// Whole seconds, which every reader knows; otherwise milliseconds, unless they
/// could be read as seconds.
fn clock(micros: i64) -> u64 {
    let millis = micros / 1000;
    let number = if millis % 1000 == 0 || millis < FIRST_MILLISECONDS {
        millis / 1000
    } else {
        millis
    };
    number.unsigned_abs()
}

fn read_block<'a>(block: &'a [u8], tag: &mut Tag<'a>) -> Result<(), Rejected> {
    let body = checksum::checked(block).map_err(|_| Rejected::BadTagBlock)?;
    for parameter in body.split(|&byte| byte == b',') {
        match parameter {
            [b's', b':', source @ ..] => tag.source = Some(source),
            [b'd', b':', destination @ ..] => tag.destination = Some(destination),
            [b'n', b':', count @ ..] => tag.line_count = line_count(count),
            [b'c', b':', clock @ ..] => {
                tag.unix_micros = Some(unix_micros(clock).ok_or(Rejected::BadTagBlock)?);
            }
            [b'g', b':', group @ ..] => tag.group = read_group(group),
            // Texts are not needed here.
            _ => {}
        }
    }
    Ok(())
}

/// Up to three digits; `None` where they are not understood: no reading depends on them.
fn line_count(text: &[u8]) -> Option<u16> {
    let text = std::str::from_utf8(text).ok()?;
    text.parse().ok().filter(|count| *count <= 999)
}

/// Three numbers with hyphens; `None` where they are not understood: no reading depends on them.
fn read_group(text: &[u8]) -> Option<Group> {
    let mut parts = std::str::from_utf8(text).ok()?.split('-');
    let group = Group {
        sentence: parts.next()?.parse().ok()?,
        sentences: parts.next()?.parse().ok()?,
        code: parts.next()?.parse().ok()?,
    };
    let is_part = (1..=group.sentences).contains(&group.sentence);
    (is_part && parts.next().is_none()).then_some(group)
}

/// Whole seconds or milliseconds since 1970.
fn unix_micros(text: &[u8]) -> Option<i64> {
    if text.is_empty() || text.len() > 15 {
        return None;
    }
    let mut value = 0_i64;
    for byte in text {
        if !byte.is_ascii_digit() {
            return None;
        }
        value = value * 10 + i64::from(byte - b'0');
    }
    Some(if value >= FIRST_MILLISECONDS {
        value * 1000
    } else {
        value * 1_000_000
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tagged(tag: &str) -> Vec<u8> {
        let mut line = format!("\\{tag}*{:02X}\\", checksum::compute(tag.as_bytes())).into_bytes();
        line.extend_from_slice(b"$GPHDT,274.07,T*03");
        line
    }

    #[test]
    fn seconds_and_milliseconds_are_distinguished() {
        for (clock, micros) in [
            ("c:1700000000", 1_700_000_000_000_000),
            ("c:1700000000123", 1_700_000_000_123_000),
        ] {
            let line = tagged(clock);
            let read = parse_tagged(&line).unwrap();
            assert_eq!(read.tag.unix_micros, Some(micros));
        }
    }

    #[test]
    fn source_and_clock_come_through_among_other_parameters() {
        let line = tagged("g:1-2-1234,s:HE0001,d:EI0001,n:17,c:1700000000");
        let tag = parse_tagged(&line).unwrap().tag;
        assert_eq!(tag.destination, Some(&b"EI0001"[..]));
        assert_eq!(tag.line_count, Some(17));
        assert_eq!(tag.source, Some(&b"HE0001"[..]));
        assert_eq!(tag.unix_micros, Some(1_700_000_000_000_000));
        let group = Group {
            sentence: 1,
            sentences: 2,
            code: 1234,
        };
        assert_eq!(tag.group, Some(group));
        for wrong in ["g:", "g:1-2", "g:3-2-1", "g:0-2-1", "g:1-2-3-4", "g:a-b-c"] {
            let line = tagged(wrong);
            assert_eq!(parse_tagged(&line).unwrap().tag.group, None, "{wrong}");
        }
    }

    #[test]
    fn a_bad_tag_block_spoils_its_line() {
        let good = tagged("s:HE0001");
        for at in 1..10 {
            let mut line = good.clone();
            line[at] ^= 1;
            assert_eq!(parse_tagged(&line), Err(Rejected::BadTagBlock), "{at}");
        }
        for clock in ["c:", "c:-1", "c:17e8", "c:1234567890123456"] {
            assert_eq!(parse_tagged(&tagged(clock)), Err(Rejected::BadTagBlock));
        }
        assert_eq!(parse_tagged(b"\\s:HE0001"), Err(Rejected::BadTagBlock));
    }

    #[test]
    fn a_written_tag_block_is_read_back() {
        for tag in [
            Tag::default(),
            Tag {
                source: Some(b"GP0001"),
                unix_micros: Some(1_700_000_000_000_000),
                ..Tag::default()
            },
            Tag {
                unix_micros: Some(1_700_000_000_250_000),
                ..Tag::default()
            },
            Tag {
                source: Some(b"II0001"),
                destination: Some(b"EI0002"),
                unix_micros: None,
                line_count: Some(999),
                group: Some(Group {
                    sentence: 2,
                    sentences: 2,
                    code: 99,
                }),
            },
        ] {
            let mut line = Vec::new();
            write_tag(&tag, &mut line);
            line.extend_from_slice(b"$GPHDT,274.07,T*03\r\n");
            assert_eq!(parse_tagged(&line).unwrap().tag, tag);
        }
    }
}
