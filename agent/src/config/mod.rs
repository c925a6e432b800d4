//! `agent.toml`: what is connected, what each source is for, and where results go.
//!
//! Anything unknown, missing or impossible is refused with the file, the line
//! and the field; a configuration that loads is one that can run. Paths in the
//! file are relative to the file.

mod alert;
mod input;
mod profile;
mod roles;
mod uplink;

pub(crate) use alert::AlertConfig;
#[cfg(test)]
pub(crate) use alert::GyroError;
pub(crate) use input::{Group, HostPort, InputConfig, SignalKUrl};
#[cfg(test)]
pub(crate) use profile::max_burst_batch_bytes;
pub(crate) use profile::{ConnectionPolicy, Profile, UploadPlan};
pub(crate) use roles::{RolesConfig, SourceConfig};
pub(crate) use uplink::{ModemConfig, UplinkConfig};

use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::net::SocketAddr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// All of `agent.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Config {
    /// Where the spool is kept.
    pub(crate) data_dir: PathBuf,
    /// How much of the disk the spool may take.
    #[serde(default)]
    pub(crate) spool_mb: SpoolLimit,
    /// How much of the disk what was heard in each second may take; 0 keeps nothing.
    #[serde(default, rename = "ring_mb")]
    pub(crate) raw_log_mb: RawLogLimit,
    /// What is listened to, by the name that roles refer to.
    #[serde(default)]
    pub(crate) inputs: BTreeMap<String, InputConfig>,
    /// Which source is which instrument.
    #[serde(default = "RolesConfig::usual")]
    pub(crate) roles: RolesConfig,
    /// Where the corrected heading goes.
    #[serde(default)]
    pub(crate) output: OutputConfig,
    /// The local page; none when absent.
    pub(crate) page: Option<PageConfig>,
    /// How the shore is spoken to.
    #[serde(default)]
    pub(crate) uplink: UplinkConfig,
    /// What carries short-burst messages.
    pub(crate) modem: Option<ModemConfig>,
    /// When the agent raises its own alert.
    #[serde(default)]
    pub(crate) alert: AlertConfig,
    /// When a source counts as silent.
    #[serde(default)]
    pub(crate) silence: SilenceConfig,
}

/// Where the corrected heading goes.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct OutputConfig {
    /// Listens here and sends to everyone who connects.
    pub(crate) tcp_server: Option<SocketAddr>,
    /// Sends datagrams here; a broadcast address will do.
    pub(crate) udp: Option<SocketAddr>,
    /// Writes to this port.
    pub(crate) serial: Option<SerialConfig>,
    /// Seconds between two outputs.
    pub(crate) interval_s: PositiveSeconds,
    /// Whether to send ALR sentences of the agent's own alert too.
    pub(crate) alarm_sentence: bool,
}

impl Default for OutputConfig {
    fn default() -> OutputConfig {
        OutputConfig {
            tcp_server: None,
            udp: None,
            serial: None,
            interval_s: PositiveSeconds(1.0),
            alarm_sentence: false,
        }
    }
}

/// A serial port to write to.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SerialConfig {
    /// As `/dev/ttyUSB0`.
    pub(crate) path: String,
    /// Bits a second; IEC 61162-1 has 4800, 61162-2 38400.
    #[serde(default = "standard_baud")]
    pub(crate) baud: u32,
}

fn standard_baud() -> u32 {
    4800
}

/// The local page.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PageConfig {
    /// Address and port; port 0 takes a free one.
    pub(crate) listen: SocketAddr,
}

/// When a source counts as silent.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SilenceConfig {
    /// Seconds of ship time.
    pub(crate) stale_s: PositiveSeconds,
}

impl Default for SilenceConfig {
    fn default() -> SilenceConfig {
        SilenceConfig {
            stale_s: PositiveSeconds(15.0),
        }
    }
}

/// Megabytes (of a million bytes), from 4 to 100 000.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct SpoolLimit(f64);

impl SpoolLimit {
    /// In bytes.
    pub(crate) fn bytes(self) -> u64 {
        (self.0 * 1e6) as u64
    }
}

impl Default for SpoolLimit {
    fn default() -> SpoolLimit {
        SpoolLimit(64.0)
    }
}

impl TryFrom<f64> for SpoolLimit {
    type Error = String;
    fn try_from(megabytes: f64) -> Result<SpoolLimit, String> {
        if (4.0..=100_000.0).contains(&megabytes) {
            Ok(SpoolLimit(megabytes))
        } else {
            Err(format!("{megabytes} is not from 4 to 100000 megabytes"))
        }
    }
}

/// Megabytes (of a million bytes), from 1 to 10 000, or 0 for none.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct RawLogLimit(f64);

impl RawLogLimit {
    /// In bytes.
    pub(crate) fn bytes(self) -> u64 {
        (self.0 * 1e6) as u64
    }
}

impl Default for RawLogLimit {
    fn default() -> RawLogLimit {
        RawLogLimit(64.0)
    }
}

impl TryFrom<f64> for RawLogLimit {
    type Error = String;
    fn try_from(megabytes: f64) -> Result<RawLogLimit, String> {
        if megabytes == 0.0 || (1.0..=10_000.0).contains(&megabytes) {
            Ok(RawLogLimit(megabytes))
        } else {
            Err(format!(
                "{megabytes} is neither 0 nor from 1 to 10000 megabytes"
            ))
        }
    }
}

/// Seconds, from a hundredth to a year.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Deserialize)]
#[serde(try_from = "f64")]
pub(crate) struct PositiveSeconds(pub(crate) f64);

impl PositiveSeconds {
    /// As the standard library has it.
    pub(crate) fn duration(self) -> Duration {
        Duration::from_secs_f64(self.0)
    }
}

impl TryFrom<f64> for PositiveSeconds {
    type Error = String;
    fn try_from(seconds: f64) -> Result<PositiveSeconds, String> {
        if (0.01..=31_557_600.0).contains(&seconds) {
            Ok(PositiveSeconds(seconds))
        } else {
            Err(format!("{seconds} is not from 0.01 to 31557600 seconds"))
        }
    }
}

/// Why a configuration cannot be used: one line for the one who wrote it.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ConfigError {
    /// There is no such file, or it cannot be read.
    #[error("{}: {source}", path.display())]
    Unreadable {
        /// The configuration file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Something in it is wrong.
    #[error("{}:{line}: {field}{problem}", path.display())]
    Wrong {
        /// The configuration file.
        path: PathBuf,
        /// Counts from 1.
        line: usize,
        /// The key before the value, with a colon; empty when there is none.
        field: String,
        /// What is wrong.
        problem: String,
    },
}

impl Config {
    /// Reads and checks a file.
    pub(crate) fn load(path: &Path) -> Result<Config, ConfigError> {
        let text = fs::read_to_string(path).map_err(|source| ConfigError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        let mut config = parse(&text).map_err(|wrong| wrong.in_file(path, &text))?;
        let directory = path.parent().unwrap_or(Path::new("."));
        config.data_dir = directory.join(&config.data_dir);
        if let Some(ca) = &mut config.uplink.pinned_ca {
            *ca = directory.join(&ca);
        }
        if let Some(modem) = &mut config.modem {
            modem.resolve(directory);
        }
        for input in config.inputs.values_mut() {
            input.resolve(directory);
        }
        Ok(config)
    }
}

/// A problem and where in the text it is.
struct Wrong {
    span: Option<Range<usize>>,
    problem: String,
}

fn parse(text: &str) -> Result<Config, Wrong> {
    let config: Config = toml::from_str(text).map_err(|e| Wrong {
        span: e.span(),
        problem: e.message().replace('\n', "; "),
    })?;
    for source in config.roles.sources() {
        let Some(input) = &source.input else { continue };
        if !config.inputs.contains_key(input.get_ref()) {
            return Err(Wrong {
                span: Some(input.span()),
                problem: format!("there is no input named {:?}", input.get_ref()),
            });
        }
    }
    config.uplink.check(config.modem.as_ref())?;
    Ok(config)
}

impl Wrong {
    fn in_file(self, path: &Path, text: &str) -> ConfigError {
        let at = self.span.map_or(0, |span| span.start.min(text.len()));
        let before = text.get(..at).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        ConfigError::Wrong {
            path: path.to_owned(),
            line: before.matches('\n').count() + 1,
            field: key_before(&text[line_start..at]),
            problem: self.problem,
        }
    }
}

/// `interval_s = ` gives `interval_s: `, `{ input = "a", talker = ` gives `talker: `.
fn key_before(text: &str) -> String {
    let Some((left, _)) = text.rsplit_once('=') else {
        return String::new();
    };
    let key = left
        .trim_end()
        .rsplit(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-'))
        .next();
    match key {
        Some(key) if !key.is_empty() => format!("{key}: "),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn message(text: &str) -> String {
        parse(text)
            .expect_err("this configuration is wrong")
            .in_file(Path::new("agent.toml"), text)
            .to_string()
    }

    pub(super) const WHOLE: &str = r#"
data_dir = "state"
[inputs.bridge]
tcp = "127.0.0.1:10110"
[roles]
compass  = [{ input = "bridge", talker = "HC", sentence = "HDG" }]
gyro     = [{ input = "bridge", talker = "HE", sentence = "THS" }]
satellite= [{ input = "bridge", talker = "GP", sentence = "THS" }]
position = [{ input = "bridge", talker = "GP", sentence = "RMC" }]
rate_of_turn = [{ input = "bridge", sentence = "ROT" }]
roll     = [{ input = "bridge", sentence = "XDR" }]
[output]
tcp_server = "127.0.0.1:10111"
interval_s = 1
[page]
listen = "127.0.0.1:8090"
[uplink]
pinned_ca = "ca.pem"
poll_s = 21600
retry_min_s = 30
retry_max_s = 3600
[silence]
stale_s = 15
"#;

    #[test]
    fn a_whole_configuration_loads() {
        let config = parse(WHOLE).map_err(|w| w.problem).unwrap();
        assert_eq!(config.roles.compass.len(), 1);
        assert_eq!(config.output.interval_s, PositiveSeconds(1.0));
        assert_eq!(config.page.unwrap().listen.port(), 8090);
    }

    #[test]
    fn the_example_loads_and_shows_the_defaults() {
        let example = parse(include_str!("../../agent.example.toml"));
        let example = example.map_err(|w| w.problem).unwrap();
        let bare = parse("data_dir = \"d\"").map_err(|w| w.problem).unwrap();
        assert_eq!(example.spool_mb, bare.spool_mb);
        assert_eq!(example.raw_log_mb, bare.raw_log_mb);
        assert_eq!(example.uplink.profile, bare.uplink.profile);
        assert_eq!(example.uplink.poll(), bare.uplink.poll());
        assert_eq!(example.uplink.retry_min_s, bare.uplink.retry_min_s);
        assert_eq!(example.uplink.retry_max_s, bare.uplink.retry_max_s);
        assert_eq!(example.silence.stale_s, bare.silence.stale_s);
        assert_eq!(example.output.interval_s, bare.output.interval_s);
        assert_eq!(example.output.alarm_sentence, bare.output.alarm_sentence);
        assert_eq!(example.alert.gyro_error_deg, bare.alert.gyro_error_deg);
        assert_eq!(example.alert.settled_s, bare.alert.settled_s);
    }

    #[test]
    fn only_the_data_directory_is_needed() {
        let config = parse("data_dir = \"d\"").map_err(|w| w.problem).unwrap();
        assert!(config.roles.compass[0].matches_talker(*b"HC"));
        assert_eq!(config.silence.stale_s, PositiveSeconds(15.0));
    }

    #[test]
    fn mistakes_are_named_by_line_and_field() {
        let wrong = WHOLE.replace("interval_s = 1", "interval_s = -1");
        assert_eq!(
            message(&wrong),
            "agent.toml:14: interval_s: -1 is not from 0.01 to 31557600 seconds"
        );
        let wrong = WHOLE.replace("poll_s = 21600", "pol_s = 21600");
        assert!(message(&wrong).starts_with("agent.toml:19: unknown field `pol_s`"));
        let wrong = WHOLE.replace("\"127.0.0.1:8090\"", "\"localhost\"");
        assert!(message(&wrong).starts_with("agent.toml:16: listen: "));
        let wrong = WHOLE.replace(
            "\"bridge\", talker = \"GP\", sentence = \"RMC\"",
            "\"brdge\"",
        );
        assert_eq!(
            message(&wrong),
            "agent.toml:9: input: there is no input named \"brdge\""
        );
        let wrong = WHOLE.replace("[silence]", "[alert]\ngyro_error_deg = 0\n[silence]");
        assert_eq!(
            message(&wrong),
            "agent.toml:23: gyro_error_deg: 0 is not from 0.5 to 30 degrees"
        );
        let wrong = WHOLE.replace("talker = \"HC\"", "talker = \"COMPASS\"");
        assert!(message(&wrong).starts_with("agent.toml:6: talker: "));
        let wrong = WHOLE.replace("\"state\"", "\"state\"\nring_mb = 0.5");
        assert_eq!(
            message(&wrong),
            "agent.toml:3: ring_mb: 0.5 is neither 0 nor from 1 to 10000 megabytes"
        );
        assert!(message("").contains("data_dir"));
    }

    #[test]
    fn retries_the_wrong_way_round_are_named_where_they_are_written() {
        let wrong = WHOLE.replace("poll_s = 21600", "# retry_min_s, retry_max_s: see below");
        let both = wrong.replace("retry_min_s = 30", "retry_min_s = 7200");
        assert_eq!(
            message(&both),
            "agent.toml:20: retry_min_s: 7200 is more than retry_max_s, 3600"
        );
        let one = wrong
            .replace("retry_min_s = 30\n", "\n")
            .replace("retry_max_s = 3600", "retry_max_s = 10");
        assert_eq!(
            message(&one),
            "agent.toml:21: retry_max_s: 10 is less than retry_min_s, 30"
        );
        let zero = WHOLE.replace("retry_min_s = 30", "retry_min_s = 0");
        assert!(message(&zero).starts_with("agent.toml:20: retry_min_s: 0 is not"));
    }

    #[test]
    fn a_magnetic_heading_is_a_compass_only_when_it_is_said_to_be_raw() {
        let hdm = WHOLE.replace("sentence = \"HDG\"", "sentence = \"HDM\"");
        assert!(message(&hdm).contains("raw = true"), "{}", message(&hdm));
        let raw = WHOLE.replace("sentence = \"HDG\"", "sentence = \"HDM\", raw = true");
        assert!(parse(&raw).is_ok());
    }

    #[test]
    fn a_sentence_that_cannot_serve_the_role_is_refused() {
        let wrong = WHOLE.replace("sentence = \"ROT\"", "sentence = \"HDG\"");
        assert!(message(&wrong).starts_with("agent.toml:10: rate_of_turn"));
    }

    #[test]
    fn no_file_is_one_line_with_its_name() {
        let error = Config::load(Path::new("no/such.toml")).unwrap_err();
        assert!(error.to_string().starts_with("no/such.toml: "));
    }
}
