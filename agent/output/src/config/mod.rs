//! `[output]`: destinations of the corrected heading and the alerts, and their sentences.

mod destination;
mod line_load;
mod sentence;
mod shared;

pub use destination::{AddressConfig, MulticastConfig, Selection, SerialOutputConfig, Sfi};
pub use sentence::{Interval, SentenceConfig, SentenceKind};
pub use shared::{Label, N2kHeading, N2kOutputConfig, SignalKOutputConfig};

pub(crate) use line_load::SHORTEST_INTERVAL_SHARE;

use destination::one_or_more;
use sentence::talker;
use serde::Deserialize;
use std::ops::Range;

/// Reason why a configuration cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigProblem {
    /// Bytes of the value in the text.
    pub span: Range<usize>,
    /// Description of the mistake.
    pub problem: String,
}

/// Destinations of the corrected heading.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OutputConfig {
    /// Addresses of TCP servers that send to every client.
    #[serde(deserialize_with = "one_or_more")]
    pub tcp_server: Vec<AddressConfig>,
    /// Destinations of datagrams; may be broadcast addresses.
    #[serde(deserialize_with = "one_or_more")]
    pub udp: Vec<AddressConfig>,
    /// Groups of IEC 61162-450 to send to.
    #[serde(deserialize_with = "one_or_more")]
    pub multicast: Vec<MulticastConfig>,
    /// Serial ports to write to.
    #[serde(deserialize_with = "one_or_more")]
    pub serial: Vec<SerialOutputConfig>,
    /// NMEA 2000 buses to send to.
    #[serde(deserialize_with = "one_or_more")]
    pub n2k: Vec<N2kOutputConfig>,
    /// Signal K servers to send to.
    #[serde(deserialize_with = "one_or_more")]
    pub signalk: Vec<SignalKOutputConfig>,
    /// Seconds between two outputs.
    pub interval_s: Interval,
    /// Talker of all sentences.
    #[serde(deserialize_with = "talker")]
    pub talker: [u8; 2],
    /// Raw heading with deviation and variation.
    pub hdg: SentenceConfig,
    /// True heading with its mode.
    pub ths: SentenceConfig,
    /// True heading without a mode.
    pub hdt: SentenceConfig,
    /// Sends ALR sentences of the agent's own alert as well.
    pub alarm_sentence: bool,
    /// Sends ALF, ALC, ARC and HBT of the agent's alerts, and takes ACN commands to them.
    pub alert_sentences: bool,
}

impl Default for OutputConfig {
    fn default() -> OutputConfig {
        OutputConfig {
            tcp_server: Vec::new(),
            udp: Vec::new(),
            multicast: Vec::new(),
            serial: Vec::new(),
            n2k: Vec::new(),
            signalk: Vec::new(),
            interval_s: Interval(1.0),
            talker: *b"II",
            hdg: SentenceConfig::ON,
            ths: SentenceConfig::ON,
            hdt: SentenceConfig::OFF,
            alarm_sentence: false,
            alert_sentences: false,
        }
    }
}

impl OutputConfig {
    /// Returns talker and sentence of each heading that is sent.
    pub fn headings(&self) -> Vec<([u8; 2], [u8; 3])> {
        let own = [
            (self.hdg, *b"HDG"),
            (self.ths, *b"THS"),
            (self.hdt, *b"HDT"),
        ];
        let sent = own.into_iter().filter(|(config, _)| config.is_on);
        sent.map(|(config, sentence)| (config.talker.unwrap_or(self.talker), sentence))
            .collect()
    }

    /// Returns the seconds between two sentences of a kind.
    pub fn interval_s(&self, sentence: SentenceConfig) -> f64 {
        sentence.interval_s.unwrap_or(self.interval_s).0
    }

    /// Returns whether a sentence is sent at all.
    fn is_sent(&self, kind: SentenceKind) -> bool {
        match kind {
            SentenceKind::Hdg => self.hdg.is_on,
            SentenceKind::Ths => self.ths.is_on,
            SentenceKind::Hdt => self.hdt.is_on,
            SentenceKind::Pbinq => true,
            SentenceKind::Alr => self.alarm_sentence,
            SentenceKind::Alf => self.alert_sentences,
        }
    }

    /// Refuses destinations that select a sentence which is never sent, and serial lines that
    /// cannot carry their sentences.
    ///
    /// # Errors
    /// The value that is wrong, and why.
    pub fn check(&self) -> Result<(), ConfigProblem> {
        for selected in self.selections().flat_map(Selection::named) {
            let kind = *selected.get_ref();
            if !self.is_sent(kind) {
                return Err(ConfigProblem {
                    span: selected.span(),
                    problem: format!("{} is not switched on in [output]", kind.name()),
                });
            }
        }
        self.check_lines()
    }

    fn selections(&self) -> impl Iterator<Item = &Selection> {
        let addresses = self.tcp_server.iter().chain(&self.udp);
        let addresses = addresses.map(|destination| &destination.sentences);
        let groups = self.multicast.iter().map(|group| &group.sentences);
        let lines = self.serial.iter().map(|line| &line.sentences);
        addresses.chain(groups).chain(lines)
    }
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
        assert_eq!((one.udp.len(), one.serial[0].baud()), (1, 4800));
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
    fn a_destination_may_select_its_sentences() {
        let text = r#"
udp = ["10.0.0.1:1", { address = "10.0.0.2:2", sentences = ["HDG", "ALR"] }]
tcp_server = { address = "127.0.0.1:0", sentences = ["PBINQ"] }
"#;
        let output = read(text).unwrap();
        let hdg = |sentences: &Selection| sentences.includes(SentenceKind::Hdg);
        assert!(hdg(&output.udp[0].sentences) && hdg(&output.udp[1].sentences));
        assert!(!output.udp[1].sentences.includes(SentenceKind::Ths));
        assert!(!hdg(&output.tcp_server[0].sentences));
        let unsent = output.check().err().unwrap();
        assert_eq!(unsent.problem, "ALR is not switched on in [output]");
        assert_eq!(&text[unsent.span], "\"ALR\"");
        let none = read("udp = { address = \"10.0.0.2:2\", sentences = [] }");
        assert!(none.unwrap_err().contains("sends nothing"));
        let unknown = read("udp = { address = \"10.0.0.2:2\", sentences = [\"HDM\"] }");
        assert!(unknown.unwrap_err().contains("HDM"));
    }

    #[test]
    fn a_multicast_group_has_a_source_and_perhaps_a_destination() {
        let short = read("multicast = \"239.192.0.4:60004\"").unwrap();
        let group = &short.multicast[0];
        assert_eq!(group.group.port(), 60004);
        assert!(group.sfi.is_none() && group.destination.is_none());
        let long = "multicast = { group = \"239.192.0.4:60004\", interface = \"10.0.0.1\", \
                    sfi = \"HC0012\", destination = \"EI0001\" }";
        let long = read(long).unwrap();
        let group = &long.multicast[0];
        assert_eq!(group.interface.to_string(), "10.0.0.1");
        assert_eq!(group.sfi.unwrap().bytes(), b"HC0012");
        assert_eq!(group.destination.unwrap().bytes(), b"EI0001");
        for (wrong, named) in [
            (
                "\"192.168.1.1:60004\"",
                "192.168.1.1:60004 is not a multicast",
            ),
            (
                "{ group = \"239.192.0.4:60004\", sfi = \"HC1\" }",
                "\"HC1\"",
            ),
            (
                "{ group = \"239.192.0.4:60004\", sfi = \"hc0001\" }",
                "\"hc0001\"",
            ),
            ("5", "one destination"),
        ] {
            let message = read(&format!("multicast = {wrong}")).unwrap_err();
            assert!(message.contains(named), "{wrong}: {message}");
        }
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
