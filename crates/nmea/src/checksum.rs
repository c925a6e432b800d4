//! The checksum of sentences and TAG blocks: all bytes between the delimiters,
//! exclusive-or'ed, as two hexadecimal digits.

use crate::rejected::Rejected;

/// Splits `body*hh` and returns the body when its checksum is right.
///
/// `body` starts after `$`, `!` or `\`.
pub(crate) fn checked(bytes: &[u8]) -> Result<&[u8], Rejected> {
    let mut printable = true;
    let mut sum = 0_u8;
    for &byte in bytes {
        // One comparison for "from space to tilde".
        printable &= byte.wrapping_sub(b' ') <= b'~' - b' ';
        sum ^= byte;
    }
    if !printable {
        return Err(Rejected::NotAscii);
    }
    let Some((body, [b'*', high, low])) = bytes.split_last_chunk::<3>() else {
        return Err(Rejected::NoChecksum);
    };
    let (Some(high_value), Some(low_value)) = (hex_value(*high), hex_value(*low)) else {
        return Err(Rejected::WrongChecksum);
    };
    // The sum was taken over `*hh` as well.
    let of_body = sum ^ b'*' ^ high ^ low;
    if of_body != high_value << 4 | low_value {
        return Err(Rejected::WrongChecksum);
    }
    Ok(body)
}

/// Computes the checksum of `body`.
pub(crate) fn compute(body: &[u8]) -> u8 {
    body.iter().fold(0, |sum, byte| sum ^ byte)
}

/// Returns a sentence, which begins with `$`, with the checksum that it lacks.
pub fn with_checksum(sentence: &[u8]) -> Vec<u8> {
    let mut whole = sentence.to_vec();
    let body = sentence.strip_prefix(b"$").unwrap_or(sentence);
    append(compute(body), &mut whole);
    whole
}

/// Appends `*hh`.
pub(crate) fn append(sum: u8, out: &mut Vec<u8>) {
    const DIGITS: &[u8; 16] = b"0123456789ABCDEF";
    out.extend_from_slice(&[
        b'*',
        DIGITS[usize::from(sum >> 4)],
        DIGITS[usize::from(sum & 15)],
    ]);
}

fn hex_value(digit: u8) -> Option<u8> {
    match digit {
        b'0'..=b'9' => Some(digit - b'0'),
        b'A'..=b'F' => Some(digit - b'A' + 10),
        b'a'..=b'f' => Some(digit - b'a' + 10),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checksum_is_read_in_either_case_and_checked() {
        assert_eq!(checked(b"HEHDT,274.07,T*13"), Err(Rejected::WrongChecksum));
        let mut line = b"HEHDT,274.07,T".to_vec();
        append(compute(&line), &mut line);
        assert_eq!(checked(&line), Ok(&b"HEHDT,274.07,T"[..]));
        let at = line.len() - 2;
        line[at..].make_ascii_lowercase();
        assert_eq!(checked(&line), Ok(&b"HEHDT,274.07,T"[..]));
    }

    #[test]
    fn a_checksum_must_be_there() {
        for line in [
            &b""[..],
            b"*",
            b"*0",
            b"HEHDT,1,T",
            b"HEHDT,1,T*",
            b"HEHDT,1,T*1",
        ] {
            assert_eq!(checked(line), Err(Rejected::NoChecksum));
        }
        assert_eq!(checked(b"HEHDT,1,T*ZZ"), Err(Rejected::WrongChecksum));
        assert_eq!(checked(b"HEHDT,\xff,T*00"), Err(Rejected::NotAscii));
    }
}
