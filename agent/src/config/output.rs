//! `[output]`: destinations of the corrected heading, and its sentences.

use super::limits::PositiveSeconds;
use super::roles::two_capitals;
use serde::{Deserialize, Deserializer};
use std::net::SocketAddr;

/// Destinations of the corrected heading.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct OutputConfig {
    /// Addresses of TCP servers that send to every client.
    #[serde(deserialize_with = "one_or_more")]
    pub(crate) tcp_server: Vec<SocketAddr>,
    /// Destinations of datagrams; may be broadcast addresses.
    #[serde(deserialize_with = "one_or_more")]
    pub(crate) udp: Vec<SocketAddr>,
    /// Serial ports to write to.
    #[serde(deserialize_with = "one_or_more")]
    pub(crate) serial: Vec<SerialConfig>,
    /// Seconds between two outputs.
    pub(crate) interval_s: PositiveSeconds,
    /// Talker of all sentences.
    #[serde(deserialize_with = "two_capitals")]
    pub(crate) talker: [u8; 2],
    /// Raw heading with deviation and variation.
    pub(crate) hdg: SentenceConfig,
    /// True heading with its mode.
    pub(crate) ths: SentenceConfig,
    /// True heading without a mode.
    pub(crate) hdt: SentenceConfig,
    /// Sends ALR sentences of the agent's own alert as well.
    pub(crate) alarm_sentence: bool,
}

impl Default for OutputConfig {
    fn default() -> OutputConfig {
        OutputConfig {
            tcp_server: Vec::new(),
            udp: Vec::new(),
            serial: Vec::new(),
            interval_s: PositiveSeconds(1.0),
            talker: *b"II",
            hdg: SentenceConfig::ON,
            ths: SentenceConfig::ON,
            hdt: SentenceConfig::OFF,
            alarm_sentence: false,
        }
    }
}

impl OutputConfig {
    /// Returns talker and sentence of each heading that is sent.
    pub(crate) fn headings(&self) -> Vec<([u8; 2], [u8; 3])> {
        let own = [
            (self.hdg, *b"HDG"),
            (self.ths, *b"THS"),
            (self.hdt, *b"HDT"),
        ];
        let sent = own.into_iter().filter(|(config, _)| config.is_on);
        sent.map(|(config, sentence)| (config.talker.unwrap_or(self.talker), sentence))
            .collect()
    }
}

/// One sentence: off, on, or with its own talker and interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(from = "SentenceForm")]
pub(crate) struct SentenceConfig {
    pub(crate) is_on: bool,
    pub(crate) talker: Option<[u8; 2]>,
    pub(crate) interval_s: Option<PositiveSeconds>,
}

impl SentenceConfig {
    const OFF: SentenceConfig = SentenceConfig {
        is_on: false,
        talker: None,
        interval_s: None,
    };
    const ON: SentenceConfig = SentenceConfig {
        is_on: true,
        ..SentenceConfig::OFF
    };
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected true, false or { talker = \"HC\", interval_s = 0.2 }"
)]
enum SentenceForm {
    Switch(bool),
    Table(SentenceTable),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SentenceTable {
    #[serde(default, deserialize_with = "some_two_capitals")]
    talker: Option<[u8; 2]>,
    interval_s: Option<PositiveSeconds>,
}

impl From<SentenceForm> for SentenceConfig {
    fn from(form: SentenceForm) -> SentenceConfig {
        match form {
            SentenceForm::Switch(is_on) => SentenceConfig {
                is_on,
                ..SentenceConfig::OFF
            },
            SentenceForm::Table(table) => SentenceConfig {
                is_on: true,
                talker: table.talker,
                interval_s: table.interval_s,
            },
        }
    }
}

fn some_two_capitals<'de, D: Deserializer<'de>>(d: D) -> Result<Option<[u8; 2]>, D::Error> {
    two_capitals(d).map(Some)
}

/// Serial port to write to.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SerialConfig {
    /// Device, as `/dev/ttyUSB0`.
    pub(crate) path: String,
    /// Bits per second; IEC 61162-1 has 4800, 61162-2 38400.
    #[serde(default = "standard_baud")]
    pub(crate) baud: u32,
}

fn standard_baud() -> u32 {
    4800
}

/// Reads one value, or a list of them.
fn one_or_more<'de, D, T>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    D: Deserializer<'de>,
    T: serde::de::DeserializeOwned,
{
    let value = toml::Value::deserialize(deserializer)?;
    let values = match value {
        toml::Value::Array(values) => values,
        one => vec![one],
    };
    let read = values.into_iter().map(|value| {
        T::deserialize(value).map_err(|error| serde::de::Error::custom(error.message()))
    });
    read.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(toml: &str) -> Result<OutputConfig, String> {
        toml::from_str(toml).map_err(|error| error.message().to_owned())
    }

    #[test]
    fn a_destination_is_one_or_several() {
        let one = read("udp = \"10.0.0.255:10110\"\nserial = { path = \"/dev/a\" }").unwrap();
        assert_eq!((one.udp.len(), one.serial[0].baud), (1, 4800));
        let more = read("udp = [\"10.0.0.1:1\", \"10.0.0.2:2\"]\ntcp_server = []").unwrap();
        assert_eq!((more.udp.len(), more.tcp_server.len()), (2, 0));
        assert!(
            read("udp = \"10110\"")
                .unwrap_err()
                .contains("socket address")
        );
        assert!(
            read("serial = { bauds = 1 }")
                .unwrap_err()
                .contains("bauds")
        );
    }

    #[test]
    fn each_sentence_has_a_switch_a_talker_and_an_interval() {
        let plain = read("").unwrap();
        assert_eq!(
            (plain.hdg.is_on, plain.ths.is_on, plain.hdt.is_on),
            (true, true, false)
        );
        let own = read("hdg = false\nhdt = { talker = \"HE\", interval_s = 0.2 }").unwrap();
        assert_eq!((own.hdg.is_on, own.hdt.is_on), (false, true));
        assert_eq!(own.hdt.talker, Some(*b"HE"));
        assert!(read("hdt = 5").unwrap_err().contains("true, false or"));
        assert!(read("talker = \"COMPASS\"").is_err());
    }
}
