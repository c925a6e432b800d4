//! NMEA 0183 sentences of the simulated instruments.
//!
//! They are written here byte by byte, without the crate that reads them: an
//! error common to writer and reader would stay hidden. Two years of a fleet
//! are written in minutes, so nothing is allocated once the buffer has grown.

use super::calendar::CalendarTime;
use binnacle_compass::position::Position;
use binnacle_compass::time::Timestamp;

/// `$HCHDG`: the raw reading; the instrument has neither deviation nor
/// variation.
pub(crate) fn hchdg(out: &mut Vec<u8>, compass_deg: f64) {
    sentence(out, b"$HCHDG,", |out| {
        heading(out, compass_deg);
        out.extend_from_slice(b",,,,");
    });
}

/// `$HETHS` or `$GPTHS`: a heading of this talker in mode A, or mode V without one.
pub(crate) fn ths(out: &mut Vec<u8>, talker: [u8; 2], heading_deg: Option<f64>) {
    let [first, second] = talker;
    let head = [b'$', first, second, b'T', b'H', b'S', b','];
    sentence(out, &head, |out| {
        if let Some(degrees) = heading_deg {
            heading(out, degrees);
        }
        out.extend_from_slice(if heading_deg.is_some() { b",A" } else { b",V" });
    });
}

/// `$HEROT`: degrees a minute, negative for a turn to port.
pub(crate) fn herot(out: &mut Vec<u8>, rate_deg_min: f64) {
    sentence(out, b"$HEROT,", |out| {
        signed_tenths(out, rate_deg_min);
        out.extend_from_slice(b",A");
    });
}

/// `$IIXDR`: roll.
pub(crate) fn iixdr_roll(out: &mut Vec<u8>, roll_deg: f64) {
    sentence(out, b"$IIXDR,", |out| {
        out.extend_from_slice(b"A,");
        signed_tenths(out, roll_deg);
        out.extend_from_slice(b",D,ROLL");
    });
}

/// `$GPRMC` with status and mode A; the receiver gives no variation.
pub(crate) fn gprmc(
    out: &mut Vec<u8>,
    time: Timestamp,
    position: Position,
    sog_kn: f64,
    cog_deg: f64,
) {
    let at = CalendarTime::from_timestamp(time);
    sentence(out, b"$GPRMC,", |out| {
        clock(out, &at);
        out.extend_from_slice(b",A,");
        coordinate(out, position.lat_deg(), 2, [b'N', b'S']);
        coordinate(out, position.lon_deg(), 3, [b'E', b'W']);
        let tenths = (sog_kn * 10.0).round() as u64;
        digits(out, tenths / 10, 1);
        out.push(b'.');
        digits(out, tenths % 10, 1);
        out.push(b',');
        heading(out, cog_deg);
        out.push(b',');
        digits(out, at.day, 2);
        digits(out, at.month, 2);
        digits(out, at.year % 100, 2);
        out.extend_from_slice(b",,,A");
    });
}

/// `$GPZDA` in UTC.
pub(crate) fn gpzda(out: &mut Vec<u8>, time: Timestamp) {
    let at = CalendarTime::from_timestamp(time);
    sentence(out, b"$GPZDA,", |out| {
        clock(out, &at);
        out.push(b',');
        digits(out, at.day, 2);
        out.push(b',');
        digits(out, at.month, 2);
        out.push(b',');
        digits(out, at.year, 4);
        out.extend_from_slice(b",00,00");
    });
}

/// `hhmmss.ss`
fn clock(out: &mut Vec<u8>, at: &CalendarTime) {
    digits(out, at.hour, 2);
    digits(out, at.minute, 2);
    digits(out, at.centisecond / 100, 2);
    out.push(b'.');
    digits(out, at.centisecond % 100, 2);
}

fn sentence(out: &mut Vec<u8>, head: &[u8], body: impl FnOnce(&mut Vec<u8>)) {
    let start = out.len();
    out.extend_from_slice(head);
    body(out);
    let sum = out[start + 1..].iter().fold(0, |sum, byte| sum ^ byte);
    let hex = |nibble: u8| b"0123456789ABCDEF"[usize::from(nibble)];
    out.extend_from_slice(&[b'*', hex(sum >> 4), hex(sum & 15), b'\r', b'\n']);
}

/// Degrees to a tenth, from 000.0 to 359.9.
fn heading(out: &mut Vec<u8>, degrees: f64) {
    let tenths = ((degrees * 10.0).round() as i64).rem_euclid(3600) as u64;
    digits(out, tenths / 10, 3);
    out.push(b'.');
    digits(out, tenths % 10, 1);
}

fn signed_tenths(out: &mut Vec<u8>, value: f64) {
    let tenths = (value * 10.0).round() as i64;
    if tenths < 0 {
        out.push(b'-');
    }
    let size = tenths.unsigned_abs();
    digits(out, size / 10, 1);
    out.push(b'.');
    digits(out, size % 10, 1);
}

/// `ddmm.mmmm,h,` to a ten-thousandth of a minute.
fn coordinate(out: &mut Vec<u8>, degrees: f64, width: usize, [plus, minus]: [u8; 2]) {
    let parts = (degrees.abs() * 600_000.0).round() as u64;
    digits(out, parts / 600_000, width);
    digits(out, parts / 10_000 % 60, 2);
    out.push(b'.');
    digits(out, parts % 10_000, 4);
    let side = if degrees < 0.0 { minus } else { plus };
    out.extend_from_slice(&[b',', side, b',']);
}

/// A whole number in at least `width` digits.
fn digits(out: &mut Vec<u8>, mut value: u64, width: usize) {
    let mut text = [b'0'; 20];
    let mut first = text.len();
    while value > 0 {
        first -= 1;
        text[first] = b'0' + (value % 10) as u8;
        value /= 10;
    }
    let first = first.min(text.len() - width);
    out.extend_from_slice(&text[first..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(write: impl FnOnce(&mut Vec<u8>)) -> String {
        let mut out = Vec::new();
        write(&mut out);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn headings_have_five_characters_and_never_reach_360() {
        let text = |degrees| written(|out| hchdg(out, degrees));
        assert_eq!(text(5.04), "$HCHDG,005.0,,,,*47\r\n");
        assert!(text(359.96).starts_with("$HCHDG,000.0,"));
        assert!(text(-0.3).starts_with("$HCHDG,359.7,"));
        assert!(text(725.0).starts_with("$HCHDG,005.0,"));
    }

    #[test]
    fn a_lost_satellite_compass_gives_no_heading() {
        let lost = written(|out| ths(out, *b"GP", None));
        assert_eq!(lost, "$GPTHS,,V*0E\r\n");
    }

    #[test]
    fn south_and_west_are_letters_not_signs() {
        let time = Timestamp::parse("2026-02-28T23:59:59.25Z").unwrap();
        let place = Position::new(-33.999_999_9, -18.5).unwrap();
        let text = written(|out| gprmc(out, time, place, 12.34, 90.0));
        let body = "$GPRMC,235959.25,A,3400.0000,S,01830.0000,W,12.3,090.0,280226,,,A*";
        assert!(text.starts_with(body), "{text}");
    }

    #[test]
    fn turning_to_port_is_negative_and_nothing_is_minus_zero() {
        assert!(written(|out| herot(out, -12.34)).starts_with("$HEROT,-12.3,A*"));
        assert!(written(|out| iixdr_roll(out, -0.04)).starts_with("$IIXDR,A,0.0,D,ROLL*"));
    }
}
