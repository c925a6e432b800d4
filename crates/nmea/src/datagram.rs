//! IEC 61162-450 datagrams: a header, then lines of TAG blocks and sentences.

use crate::rejected::Rejected;

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
    fn other_headers_are_refused() {
        for datagram in [&b"RaUdP\0$HEHDT"[..], b"UdPbC", b"$GPHDT,274.07,T*03", b""] {
            assert_eq!(lines(datagram).err(), Some(Rejected::BadDatagram));
        }
    }
}
