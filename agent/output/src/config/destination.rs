//! Destinations of `[output]`: TCP servers, datagrams, multicast groups and serial ports.
//!
//! Each is one value or a list of them. An address alone takes all sentences; a table may select
//! some with `sentences`.

use super::sentence::SentenceKind;
use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{DeserializeOwned, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::marker::PhantomData;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4};
use toml::Spanned;

/// Baud rate of IEC 61162-1; IEC 61162-2 has 38400.
const STANDARD_BAUD: u32 = 4800;

/// Address to listen on or to send to.
#[derive(Clone, Debug, Deserialize)]
#[serde(from = "TextOrTable<SocketAddr, AddressTable>")]
pub struct AddressConfig {
    /// Address and port.
    pub address: SocketAddr,
    /// Sentences that it takes.
    pub sentences: Selection,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AddressTable {
    address: SocketAddr,
    #[serde(default)]
    sentences: Selection,
}

impl From<SocketAddr> for AddressConfig {
    fn from(address: SocketAddr) -> AddressConfig {
        AddressConfig {
            address,
            sentences: Selection::default(),
        }
    }
}

impl From<TextOrTable<SocketAddr, AddressTable>> for AddressConfig {
    fn from(form: TextOrTable<SocketAddr, AddressTable>) -> AddressConfig {
        match form {
            TextOrTable::Text(address) => address.into(),
            TextOrTable::Table(table) => AddressConfig {
                address: table.address,
                sentences: table.sentences,
            },
        }
    }
}

/// Transmission group of IEC 61162-450.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "TextOrTable<SocketAddrV4, MulticastTable>")]
pub struct MulticastConfig {
    /// Address and port; IEC 61162-450 has 239.192.0.1 to 64, ports 60001 to 60009.
    pub group: SocketAddrV4,
    /// Address of the interface; unspecified lets the system choose.
    pub interface: Ipv4Addr,
    /// System function that the agent sends as; the talker and 0001 if it is not set.
    pub sfi: Option<Sfi>,
    /// System function that the sentences are for.
    pub destination: Option<Sfi>,
    /// Sentences that it takes.
    pub sentences: Selection,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MulticastTable {
    group: SocketAddrV4,
    interface: Option<Ipv4Addr>,
    sfi: Option<Sfi>,
    destination: Option<Sfi>,
    #[serde(default)]
    sentences: Selection,
}

impl TryFrom<TextOrTable<SocketAddrV4, MulticastTable>> for MulticastConfig {
    type Error = String;

    fn try_from(form: TextOrTable<SocketAddrV4, MulticastTable>) -> Result<Self, String> {
        let table = match form {
            TextOrTable::Table(table) => table,
            TextOrTable::Text(group) => MulticastTable {
                group,
                interface: None,
                sfi: None,
                destination: None,
                sentences: Selection::default(),
            },
        };
        let group = table.group;
        if !group.ip().is_multicast() {
            return Err(format!("{group} is not a multicast address"));
        }
        Ok(MulticastConfig {
            group,
            interface: table.interface.unwrap_or(Ipv4Addr::UNSPECIFIED),
            sfi: table.sfi,
            destination: table.destination,
            sentences: table.sentences,
        })
    }
}

/// System function identifier: two letters or digits, and four digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Sfi([u8; 6]);

impl Sfi {
    /// Returns the first system function of a talker.
    pub fn first_of([first, second]: [u8; 2]) -> Sfi {
        Sfi([first, second, b'0', b'0', b'0', b'1'])
    }

    /// Returns the text.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }
}

impl TryFrom<String> for Sfi {
    type Error = String;

    fn try_from(text: String) -> Result<Sfi, String> {
        let wrong = || format!("{text:?} is not a system function as \"HE0001\"");
        let bytes: [u8; 6] = text.as_bytes().try_into().map_err(|_| wrong())?;
        let (talker, number) = bytes.split_at(2);
        let is_talker = |byte: &u8| byte.is_ascii_uppercase() || byte.is_ascii_digit();
        if talker.iter().all(is_talker) && number.iter().all(u8::is_ascii_digit) {
            Ok(Sfi(bytes))
        } else {
            Err(wrong())
        }
    }
}

/// Serial port to write to.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SerialOutputConfig {
    /// Device, as `/dev/ttyUSB0`.
    pub(super) path: Spanned<String>,
    pub(super) baud: Option<Spanned<u32>>,
    /// Sentences that it takes.
    #[serde(default)]
    pub sentences: Selection,
}

impl SerialOutputConfig {
    /// Returns the device.
    pub fn path(&self) -> &str {
        self.path.get_ref()
    }

    /// Returns the bits per second.
    pub fn baud(&self) -> u32 {
        self.baud
            .as_ref()
            .map_or(STANDARD_BAUD, |baud| *baud.get_ref())
    }
}

/// Sentences that a destination takes: all that are sent unless some are named.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(try_from = "Vec<Spanned<SentenceKind>>")]
pub struct Selection(Option<Vec<Spanned<SentenceKind>>>);

impl Selection {
    /// Returns whether the destination takes a sentence.
    pub fn includes(&self, kind: SentenceKind) -> bool {
        let named = self.0.as_ref();
        named.is_none_or(|named| named.iter().any(|one| *one.get_ref() == kind))
    }

    /// Returns the sentences that are named.
    pub(super) fn named(&self) -> &[Spanned<SentenceKind>] {
        self.0.as_deref().unwrap_or_default()
    }
}

impl TryFrom<Vec<Spanned<SentenceKind>>> for Selection {
    type Error = &'static str;

    fn try_from(named: Vec<Spanned<SentenceKind>>) -> Result<Selection, &'static str> {
        if named.is_empty() {
            return Err("an empty list sends nothing; leave it out to send all");
        }
        Ok(Selection(Some(named)))
    }
}

/// A value as text alone, or a table.
///
/// An untagged enum would do, but it loses the line of a mistake.
enum TextOrTable<S, T> {
    Text(S),
    Table(T),
}

impl<'de, S: DeserializeOwned, T: DeserializeOwned> Deserialize<'de> for TextOrTable<S, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TextOrTableVisitor(PhantomData))
    }
}

struct TextOrTableVisitor<S, T>(PhantomData<(S, T)>);

impl<'de, S: DeserializeOwned, T: DeserializeOwned> Visitor<'de> for TextOrTableVisitor<S, T> {
    type Value = TextOrTable<S, T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an address and port, or a table")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
        S::deserialize(StrDeserializer::new(text)).map(TextOrTable::Text)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(TextOrTable::Table)
    }
}

/// Reads one value, or a list of them.
pub(super) fn one_or_more<'de, D, T>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    D: Deserializer<'de>,
    T: DeserializeOwned,
{
    deserializer.deserialize_any(OneOrMoreVisitor(PhantomData))
}

struct OneOrMoreVisitor<T>(PhantomData<T>);

impl<'de, T: DeserializeOwned> Visitor<'de> for OneOrMoreVisitor<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("one destination, or a list of them")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Vec<T>, E> {
        Ok(vec![T::deserialize(StrDeserializer::new(text))?])
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Vec<T>, A::Error> {
        Ok(vec![T::deserialize(MapAccessDeserializer::new(map))?])
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = list.next_element()? {
            values.push(value);
        }
        Ok(values)
    }
}
