//! Datagrams of the output: plain sentences, or those of an IEC 61162-450 network with a header and
//! a TAG block before each sentence.

use crate::config::{AddressConfig, MulticastConfig, Selection, Sfi};
use crate::line::{Line, Part, select};
use crate::open_error::OpenError;
use binnacle_nmea::datagram;
use binnacle_nmea::tag::{Group, Tag};
use socket2::{Domain, Protocol, Socket, Type};
use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};

/// Longest datagram of IEC 61162-450: one Ethernet frame.
const MAX_DATAGRAM_BYTES: usize = 1472;
/// Highest count of lines; 1 follows.
const MAX_LINE_COUNT: u16 = 999;
/// Highest code of a group of sentences; 1 follows.
const MAX_GROUP_CODE: u16 = 99;

/// Destination of datagrams. It never blocks: what the kernel does not take is lost.
#[derive(Debug)]
pub(crate) struct Datagrams {
    socket: UdpSocket,
    target: SocketAddr,
    selection: Selection,
    /// TAG blocks; none for plain sentences.
    tags: Option<LineTags>,
}

/// Source, destination and count of the lines that a group gets.
#[derive(Debug)]
struct LineTags {
    sfi: Sfi,
    destination: Option<Sfi>,
    line_count: u16,
    /// Code of the latest message of several sentences.
    group_code: u16,
}

impl Datagrams {
    /// Opens a destination of plain sentences.
    pub(crate) fn plain(config: &AddressConfig) -> Result<Datagrams, OpenError> {
        let target = config.address;
        let any: SocketAddr = if target.is_ipv4() {
            (Ipv4Addr::UNSPECIFIED, 0).into()
        } else {
            (std::net::Ipv6Addr::UNSPECIFIED, 0).into()
        };
        let socket = plain_socket(any).map_err(|source| OpenError {
            field: "udp",
            address: target,
            source,
        })?;
        Ok(Datagrams {
            socket,
            target,
            selection: config.sentences.clone(),
            tags: None,
        })
    }

    /// Opens a transmission group, as the first system function of `talker` if no other is set.
    pub(crate) fn tagged(
        config: &MulticastConfig,
        talker: [u8; 2],
    ) -> Result<Datagrams, OpenError> {
        let target = config.group.into();
        let socket = multicast_socket(config.interface).map_err(|source| OpenError {
            field: "multicast",
            address: target,
            source,
        })?;
        Ok(Datagrams {
            socket,
            target,
            selection: config.sentences.clone(),
            tags: Some(LineTags {
                sfi: config.sfi.unwrap_or(Sfi::first_of(talker)),
                destination: config.destination,
                line_count: 0,
                group_code: 0,
            }),
        })
    }

    /// Sends the selected lines.
    pub(crate) fn send(&mut self, lines: &[Line]) {
        let selected = select(lines, &self.selection);
        let datagrams = match &mut self.tags {
            Some(tags) => tags.datagrams(selected),
            None => vec![selected.flat_map(|line| &line.text).copied().collect()],
        };
        for datagram in datagrams.iter().filter(|datagram| !datagram.is_empty()) {
            if let Err(error) = self.socket.send_to(datagram, self.target) {
                tracing::debug!(%error, target = %self.target, "a datagram was not sent");
            }
        }
    }
}

fn plain_socket(any: SocketAddr) -> io::Result<UdpSocket> {
    let socket = UdpSocket::bind(any)?;
    socket.set_broadcast(true)?;
    socket.set_nonblocking(true)?;
    Ok(socket)
}

fn multicast_socket(interface: Ipv4Addr) -> io::Result<UdpSocket> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    socket.bind(&SocketAddr::V4(SocketAddrV4::new(interface, 0)).into())?;
    if !interface.is_unspecified() {
        socket.set_multicast_if_v4(&interface)?;
    }
    // The network ends at its own switch.
    socket.set_multicast_ttl_v4(1)?;
    socket.set_nonblocking(true)?;
    Ok(socket.into())
}

impl LineTags {
    /// Returns the group of a sentence; the first one begins another.
    fn group(&mut self, part: Part) -> Group {
        if part.number == 1 {
            self.group_code = self.group_code % MAX_GROUP_CODE + 1;
        }
        Group {
            sentence: part.number,
            sentences: part.total,
            code: self.group_code,
        }
    }

    /// Puts lines into as few datagrams as carry them.
    fn datagrams<'a>(&mut self, lines: impl Iterator<Item = &'a Line>) -> Vec<Vec<u8>> {
        let mut datagrams = vec![Vec::new()];
        for line in lines {
            self.line_count = self.line_count % MAX_LINE_COUNT + 1;
            let group = line.part.map(|part| self.group(part));
            let tag = Tag {
                source: Some(self.sfi.bytes()),
                destination: self.destination.as_ref().map(Sfi::bytes),
                unix_micros: None,
                line_count: Some(self.line_count),
                group,
            };
            let mut whole = datagrams.pop().unwrap_or_default();
            let before = whole.len();
            datagram::write_line(&tag, &line.text, &mut whole);
            if whole.len() <= MAX_DATAGRAM_BYTES || before == 0 {
                datagrams.push(whole);
                continue;
            }
            whole.truncate(before);
            let mut next = Vec::new();
            datagram::write_line(&tag, &line.text, &mut next);
            datagrams.extend([whole, next]);
        }
        datagrams
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::SentenceKind;
    use binnacle_nmea::parse_tagged;

    const HDT: &[u8] = b"$GPHDT,274.07,T*03\r\n";

    fn lines(count: usize) -> Vec<Line> {
        let line = Line::single(SentenceKind::Hdt, HDT.to_vec());
        vec![line; count]
    }

    fn tags(destination: Option<&str>) -> LineTags {
        let sfi = |text: &str| Sfi::try_from(text.to_owned()).unwrap();
        LineTags {
            sfi: sfi("HE0001"),
            destination: destination.map(sfi),
            line_count: 0,
            group_code: 0,
        }
    }

    #[test]
    fn a_datagram_has_its_header_and_each_line_its_source_and_count() {
        let mut tags = tags(None);
        let expected = [b"UdPbC\0\\s:HE0001,n:1*0C\\", HDT].concat();
        assert_eq!(tags.datagrams(lines(1).iter()), [expected]);
        let second = &tags.datagrams(lines(2).iter())[0];
        let counts = datagram::lines(second).unwrap().map(|line| {
            let tag = parse_tagged(line).unwrap().tag;
            (tag.source, tag.line_count)
        });
        let source = Some(&b"HE0001"[..]);
        assert_eq!(
            counts.collect::<Vec<_>>(),
            [(source, Some(2)), (source, Some(3))]
        );
    }

    #[test]
    fn the_sentences_of_a_message_are_one_group() {
        let mut tags = tags(None);
        let alert = [HDT, HDT].concat();
        let message = || Line::of_message(SentenceKind::Alf, &alert);
        let sent = [lines(1), message(), lines(1), message()].concat();
        let datagrams = tags.datagrams(sent.iter());
        let groups = datagram::lines(&datagrams[0]).unwrap().map(|line| {
            let group = parse_tagged(line).unwrap().tag.group;
            group.map(|group| (group.sentence, group.sentences, group.code))
        });
        assert_eq!(
            groups.collect::<Vec<_>>(),
            [
                None,
                Some((1, 2, 1)),
                Some((2, 2, 1)),
                None,
                Some((1, 2, 2)),
                Some((2, 2, 2)),
            ]
        );
        // A message of one sentence is none.
        assert_eq!(Line::of_message(SentenceKind::Alf, HDT)[0].part, None);
        let codes = (0..99).map(|_| {
            tags.group(Part {
                number: 1,
                total: 2,
            })
            .code
        });
        assert_eq!(codes.last(), Some(2));
    }

    #[test]
    fn a_destination_stands_in_each_tag_block() {
        let mut tags = tags(Some("EI0002"));
        let datagram = &tags.datagrams(lines(1).iter())[0];
        let line = datagram::lines(datagram).unwrap().next().unwrap();
        let tag = parse_tagged(line).unwrap().tag;
        assert_eq!(tag.destination, Some(&b"EI0002"[..]));
    }

    #[test]
    fn many_lines_take_several_datagrams_and_the_count_begins_again_at_one() {
        let mut tags = tags(None);
        let datagrams = tags.datagrams(lines(1_000).iter());
        let mut counts = Vec::new();
        for datagram in &datagrams {
            assert!(datagram.len() <= MAX_DATAGRAM_BYTES);
            for line in datagram::lines(datagram).unwrap() {
                counts.extend(parse_tagged(line).unwrap().tag.line_count);
            }
        }
        assert!(datagrams.len() > 10);
        let expected: Vec<u16> = (1..=999).chain([1]).collect();
        assert_eq!(counts, expected);
    }

    #[test]
    fn a_group_gets_the_selected_lines_alone() {
        let receiver = Socket::new(Domain::IPV4, Type::DGRAM, None).unwrap();
        receiver
            .bind(&SocketAddr::from(([0, 0, 0, 0], 0)).into())
            .unwrap();
        let port = receiver.local_addr().unwrap().as_socket().unwrap().port();
        let group = Ipv4Addr::new(239, 192, 0, 4);
        receiver
            .join_multicast_v4(&group, &Ipv4Addr::LOCALHOST)
            .unwrap();
        let receiver: UdpSocket = receiver.into();
        let config: MulticastConfig = toml::from_str(&format!(
            "group = \"{group}:{port}\"\ninterface = \"127.0.0.1\"\nsentences = [\"HDT\"]"
        ))
        .unwrap();
        let mut output = Datagrams::tagged(&config, *b"II").unwrap();
        let mut sent = lines(1);
        sent.insert(
            0,
            Line::single(SentenceKind::Ths, b"$IITHS,,V*19\r\n".to_vec()),
        );
        output.send(&sent[..1]);
        output.send(&sent);
        let mut buffer = [0; 256];
        let length = receiver.recv(&mut buffer).unwrap();
        let mut lines = datagram::lines(&buffer[..length]).unwrap();
        let tagged = parse_tagged(lines.next().unwrap()).unwrap();
        assert_eq!(tagged.tag.source, Some(&b"II0001"[..]));
        assert_eq!(tagged.tag.line_count, Some(1));
        assert_eq!(tagged.sentence.data.kind().name(), "HDT");
        assert!(lines.next().is_none());
    }
}
