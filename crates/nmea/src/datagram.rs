//! IEC 61162-450 datagrams: a header, then lines of TAG blocks and sentences.

use crate::rejected::Rejected;
use crate::tag::{Tag, write_tag};

/// The header of a datagram that carries sentences.
pub const HEADER: &[u8; 6] = b"UdPbC\0";

/// The lines of a datagram, without their ends; empty ones are left out.
///
/// # Errors
/// [`Rejected::BadDatagram`] when it does not carry sentences: files and
/// NMEA 2000 messages travel under other headers.
pub fn lines(datagram: &[u8]) -> Result<impl Iterator<Item = &[u8]>, Rejected> {
    let text = datagram.strip_prefix(HEADER).ok_or(Rejected::BadDatagram)?;
    Ok(text
        .split(|&byte| byte == b'\n' || byte == b'\r')
        .filter(|line| !line.is_empty()))
}

/// Appends a line to a datagram, which begins with its header: a TAG block and a sentence with its
/// line end.
pub fn write_line(tag: &Tag<'_>, sentence: &[u8], datagram: &mut Vec<u8>) {
    if datagram.is_empty() {
        datagram.extend_from_slice(HEADER);
    }
    write_tag(tag, datagram);
    datagram.extend_from_slice(sentence);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tag::parse_tagged;

    #[test]
    fn a_datagram_gives_its_sentences_with_their_sources() {
        let datagram =
            b"UdPbC\0\\s:HE0001,n:1*0C\\$GPHDT,274.07,T*03\r\n\\s:HE0001,n:2*0F\\$HEROT,-1.5,A*02\r\n";
        let lines: Vec<_> = lines(datagram).unwrap().collect();
        assert_eq!(lines.len(), 2);
        for line in lines {
            let tagged = parse_tagged(line).unwrap();
            assert_eq!(tagged.tag.source, Some(&b"HE0001"[..]));
        }
    }

    #[test]
    fn a_written_datagram_has_one_header_and_a_tag_block_a_line() {
        let mut datagram = Vec::new();
        for (count, sentence) in [(1, "$GPHDT,274.07,T*03\r\n"), (2, "$HEROT,-1.5,A*02\r\n")] {
            let tag = Tag {
                source: Some(b"HE0001"),
                line_count: Some(count),
                ..Tag::default()
            };
            write_line(&tag, sentence.as_bytes(), &mut datagram);
        }
        let expected: &[u8] =
            b"UdPbC\0\\s:HE0001,n:1*0C\\$GPHDT,274.07,T*03\r\n\\s:HE0001,n:2*0F\\$HEROT,-1.5,A*02\r\n";
        assert_eq!(datagram, expected, "{}", datagram.escape_ascii());
    }

    #[test]
    fn other_headers_are_refused() {
        for datagram in [&b"RaUdP\0$HEHDT"[..], b"UdPbC", b"$GPHDT,274.07,T*03", b""] {
            assert_eq!(lines(datagram).err(), Some(Rejected::BadDatagram));
        }
    }
}
