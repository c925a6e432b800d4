//! Lines of text that gateways send and loggers write.
//!
//! | format | example |
//! |---|---|
//! | candump | `can0  09F8027F   [8]  00 FC FF FF 00 00 FF FF`, also with `<0x09f8027f>` |
//! | candump -l | `(1502984866.421964) can0 09F112CC#FF725AFF7FFF7FFD` |
//! | canboat | `2023-06-13T10:39:46.213Z,2,127250,16,255,8,ff,4b,ed,ff,7f,ff,7f,fd`, fast packets whole or by frame |
//! | YDWG RAW | `00:29:58.617 R 09F11213 00 16 3A FF 7F FF 7F FD` |
//! | iKonvert | `!PDGY,127250,2,3,255,481.734,2C20AAAAAAE=` |
//! | PCAN trace | `1)  48.6  Rx  09F11201  8  FF 50 7A FF 7F FF 7F FD` |

use super::frame::{Frame, Header, Message};
use crate::time::{Date, TimeOfDay, unix_micros};

/// Greatest number of bytes in a line: the longest message in hexadecimal with its header.
const MOST_BYTES: usize = 223;

/// Line of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Time at which it was received.
    pub stamp: Stamp,
    /// Content.
    pub content: Content,
}

/// Time of a line, as its format has it, microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stamp {
    /// None.
    None,
    /// Since 1970, UTC.
    Unix(i64),
    /// Since midnight.
    OfDay(i64),
    /// Since the recording began, or the gateway started.
    Elapsed(i64),
}

/// Content of a line.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Frame of the bus.
    Frame(Frame),
    /// Whole message, that the gateway or the logger put together.
    Message(Message),
}

/// Reads a line in any of the formats; `None` for a line of none.
pub fn parse_line(line: &[u8]) -> Option<Line> {
    let line = std::str::from_utf8(line).ok()?.trim();
    if let Some(rest) = line.strip_prefix("!PDGY,") {
        return ikonvert(rest);
    }
    if let Some(rest) = line.strip_prefix('(') {
        return candump_log(rest);
    }
    if line.contains(',') {
        return canboat(line);
    }
    let words: Vec<&str> = line.split_ascii_whitespace().take(MOST_BYTES).collect();
    candump(&words)
        .or_else(|| ydwg(&words))
        .or_else(|| pcan(&words))
}

/// Returns whether a line of YDWG RAW repeats what a program gave the gateway to send.
pub fn is_ydwg_echo(line: &[u8]) -> bool {
    let mut words = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty());
    words.nth(1) == Some(b"T")
}

/// Writes a frame as YDWG RAW takes it.
pub fn write_ydwg(frame: &Frame) -> String {
    use std::fmt::Write as _;
    let mut line = format!("{:08X}", frame.header.identifier());
    for byte in frame.data() {
        // Writing to a string cannot fail.
        let _ = write!(line, " {byte:02X}");
    }
    line.push_str("\r\n");
    line
}

fn candump(words: &[&str]) -> Option<Line> {
    let at = words.iter().position(|word| is_length(word))?;
    let identifier = words.get(at.checked_sub(1)?)?;
    let identifier = identifier.trim_start_matches('<').trim_end_matches('>');
    let identifier = identifier.strip_prefix("0x").unwrap_or(identifier);
    frame(identifier, words.get(at + 1..)?, Stamp::None)
}

/// Returns whether a word is a length in brackets.
fn is_length(word: &str) -> bool {
    let inner = word
        .strip_prefix('[')
        .and_then(|rest| rest.strip_suffix(']'));
    inner.is_some_and(|inner| inner.parse::<u8>().is_ok_and(|length| length <= 8))
}

fn candump_log(rest: &str) -> Option<Line> {
    let (seconds, rest) = rest.split_once(')')?;
    let stamp = Stamp::Unix(micros(seconds)?);
    let (identifier, data) = rest.split_ascii_whitespace().last()?.split_once('#')?;
    let header = header(identifier)?;
    let frame = Frame::new(header, &hex_bytes(data)?)?;
    Some(Line {
        stamp,
        content: Content::Frame(frame),
    })
}

fn ydwg(words: &[&str]) -> Option<Line> {
    let [time, direction, identifier, data @ ..] = words else {
        return None;
    };
    let is_direction = matches!(*direction, "R" | "T");
    let stamp = Stamp::OfDay(of_day(time).filter(|_| is_direction)?);
    frame(identifier, data, stamp)
}

fn pcan(words: &[&str]) -> Option<Line> {
    let [
        number,
        milliseconds,
        "Rx" | "Tx",
        identifier,
        _length,
        data @ ..,
    ] = words
    else {
        return None;
    };
    number.strip_suffix(')')?;
    let stamp = Stamp::Elapsed(micros(milliseconds)? / 1000);
    frame(identifier, data, stamp)
}

fn frame(identifier: &str, data: &[&str], stamp: Stamp) -> Option<Line> {
    let bytes: Option<Vec<u8>> = data.iter().map(|word| byte(word)).collect();
    Some(Line {
        stamp,
        content: Content::Frame(Frame::new(header(identifier)?, &bytes?)?),
    })
}

fn header(identifier: &str) -> Option<Header> {
    // A standard identifier has three digits: no frame of NMEA 2000.
    if identifier.len() != 8 {
        return None;
    }
    let identifier = u32::from_str_radix(identifier, 16).ok()?;
    Some(Header::from_identifier(identifier))
}

fn canboat(line: &str) -> Option<Line> {
    let mut fields = line.split(',');
    let stamp = Stamp::Unix(iso_micros(fields.next()?)?);
    let mut number = || fields.next()?.trim().parse::<u32>().ok();
    let (priority, pgn, source, destination) = (number()?, number()?, number()?, number()?);
    let length = number()? as usize;
    let data: Option<Vec<u8>> = fields
        .take(MOST_BYTES)
        .map(|field| byte(field.trim()))
        .collect();
    let data = data.filter(|data| data.len() == length)?;
    let header = Header {
        priority: u8::try_from(priority).ok().filter(|p| *p <= 7)?,
        // Higher numbers than a bus has are of the gateway itself.
        pgn,
        source: u8::try_from(source).ok()?,
        destination: u8::try_from(destination).ok()?,
    };
    let content = match Frame::new(header, &data) {
        Some(frame) => Content::Frame(frame),
        None => Content::Message(Message { header, data }),
    };
    Some(Line { stamp, content })
}

fn ikonvert(rest: &str) -> Option<Line> {
    let fields: Vec<&str> = rest.split(',').collect();
    let [pgn, priority, source, destination, seconds, data] = fields[..] else {
        return None;
    };
    let data = base64(data)?;
    let header = Header {
        priority: priority.parse().ok()?,
        pgn: pgn.parse().ok()?,
        source: source.parse().ok()?,
        destination: destination.parse().ok()?,
    };
    Some(Line {
        stamp: Stamp::Elapsed(micros(seconds)?),
        content: Content::Message(Message { header, data }),
    })
}

/// Decodes base 64 (RFC 4648, section 4); padding may be missing.
fn base64(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    let (mut bits, mut count) = (0_u32, 0);
    for byte in text.trim_end_matches('=').bytes() {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = (bits << 6) | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    (out.len() <= MOST_BYTES).then_some(out)
}

fn byte(word: &str) -> Option<u8> {
    let is_hex = word.len() == 2 && word.bytes().all(|b| b.is_ascii_hexdigit());
    u8::from_str_radix(word, 16).ok().filter(|_| is_hex)
}

fn hex_bytes(text: &str) -> Option<Vec<u8>> {
    if text.len() > 16 || !text.is_ascii() {
        return None;
    }
    (0..text.len())
        .step_by(2)
        .map(|at| byte(text.get(at..at + 2)?))
        .collect()
}

/// Reads seconds, or milliseconds, with decimals as millionths.
fn micros(text: &str) -> Option<i64> {
    let value: f64 = text.trim().parse().ok()?;
    (0.0..1e12)
        .contains(&value)
        .then(|| (value * 1e6).round() as i64)
}

/// Reads `hh:mm:ss.fff` as microseconds since midnight.
fn of_day(text: &str) -> Option<i64> {
    let time = time_of_day(text)?;
    let seconds = i64::from(time.hour()) * 3600 + i64::from(time.minute()) * 60;
    Some((seconds + i64::from(time.second())) * 1_000_000 + i64::from(time.micro()))
}

fn time_of_day(text: &str) -> Option<TimeOfDay> {
    let (hour, rest) = text.split_once(':')?;
    let (minute, seconds) = rest.split_once(':')?;
    let (second, fraction) = seconds.split_once('.').unwrap_or((seconds, ""));
    if fraction.len() > 9 || !fraction.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let millionths = format!("{:0<6}", &fraction[..fraction.len().min(6)]);
    TimeOfDay::new(
        hour.parse().ok()?,
        minute.parse().ok()?,
        second.parse().ok()?,
        millionths.parse().ok()?,
    )
}

/// Reads `2023-06-13T10:39:46.213Z`, also with a hyphen or a space before the time.
fn iso_micros(text: &str) -> Option<i64> {
    let text = text.strip_suffix('Z').unwrap_or(text);
    let (date, time) = (text.get(..10)?, text.get(11..)?);
    if !matches!(text.as_bytes()[10], b'T' | b'-' | b' ') {
        return None;
    }
    let mut parts = date.split('-');
    let mut number = || parts.next()?.parse::<u16>().ok();
    let (year, month, day) = (number()?, number()?, number()?);
    let date = Date::new(year, u8::try_from(month).ok()?, u8::try_from(day).ok()?)?;
    Some(unix_micros(date, time_of_day(time)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DATA: [u8; 8] = [0xff, 0x4b, 0xed, 0xff, 0x7f, 0xff, 0x7f, 0xfd];

    fn heading_frame() -> Frame {
        Frame::new(Header::from_identifier(0x09f1_12cc), &DATA).unwrap()
    }

    #[test]
    fn one_frame_is_read_in_every_format() {
        let day = Stamp::OfDay((5 * 3600 + 15 * 60 + 49) * 1_000_000 + 768_000);
        let unix = Stamp::Unix(1_708_146_949_768_000);
        for (line, stamp) in [
            (
                "  can0  09F112CC   [8]  FF 4B ED FF 7F FF 7F FD",
                Stamp::None,
            ),
            ("<0x09f112cc> [8] ff 4b ed ff 7f ff 7f fd ", Stamp::None),
            ("(1708146949.768) can0 09F112CC#FF4BEDFF7FFF7FFD\r", unix),
            (
                "2024-02-17T05:15:49.768Z,2,127250,204,255,8,ff,4b,ed,ff,7f,ff,7f,fd",
                unix,
            ),
            (
                "2024-02-17-05:15:49.768,2,127250,204,255,8,ff,4b,ed,ff,7f,ff,7f,fd",
                unix,
            ),
            ("05:15:49.768 R 09F112CC FF 4B ED FF 7F FF 7F FD", day),
            (
                "     1)        48.6  Rx     09F112CC  8  FF 4B ED FF 7F FF 7F FD ",
                Stamp::Elapsed(48_600),
            ),
        ] {
            let content = Content::Frame(heading_frame());
            assert_eq!(
                parse_line(line.as_bytes()),
                Some(Line { stamp, content }),
                "{line}"
            );
        }
    }

    #[test]
    fn messages_put_together_are_read_whole() {
        let line = parse_line(b"!PDGY,127250,2,204,255,481.734,/0vt/3//f/0=").unwrap();
        let message = Message {
            header: heading_frame().header,
            data: DATA.to_vec(),
        };
        assert_eq!(line.stamp, Stamp::Elapsed(481_734_000));
        assert_eq!(line.content, Content::Message(message));
        let whole = "2024-02-17T05:15:49.768Z,3,129029,4,255,10,00,01,02,03,04,05,06,07,08,09";
        let Some(Content::Message(message)) = parse_line(whole.as_bytes()).map(|l| l.content)
        else {
            panic!("no message");
        };
        assert_eq!(message.data, (0..10).collect::<Vec<u8>>());
    }

    #[test]
    fn a_frame_is_written_as_it_is_read() {
        let line = write_ydwg(&heading_frame());
        assert_eq!(line, "09F112CC FF 4B ED FF 7F FF 7F FD\r\n");
        let read = parse_line(format!("00:00:00.000 T {line}").as_bytes()).unwrap();
        assert_eq!(read.content, Content::Frame(heading_frame()));
        assert!(is_ydwg_echo(format!("00:00:00.000 T {line}").as_bytes()));
        assert!(!is_ydwg_echo(format!("00:00:00.000 R {line}").as_bytes()));
    }

    #[test]
    fn other_lines_are_none() {
        for line in [
            "",
            "# candump",
            "(x) can0 09F112CC#FF",
            "(1.0) can0 123#FF",
            "can0 09F112CC [9] FF",
            "can0 09F112CC [8] FF 4B ED FF 7F FF 7F FD 00",
            "2024-02-17T05:15:49.768Z,2,127250,204,255,8,ff",
            "!PDGY,000000,4,,,1.0,",
            "05:15 R 09F112CC FF",
            "$HCHDG,98.3,1.5,W,12.6,E*53",
            "\u{fffd},,",
        ] {
            assert_eq!(parse_line(line.as_bytes()), None, "{line}");
        }
    }
}
