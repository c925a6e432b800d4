//! `agent.toml`: inputs, roles of the sources, and destinations.
//!
//! Anything unknown, missing or impossible is refused with file, line and field, so a configuration
//! that loads can run. Paths in the file are relative to the file.

mod alert;
mod conflicts;
mod document;
mod error;
mod limits;
mod pin;
mod profile;
mod uplink;

pub(crate) use alert::AlertConfig;
#[cfg(test)]
pub(crate) use alert::GyroError;
pub(crate) use error::ConfigError;
pub(crate) use pin::Pin;
#[cfg(test)]
pub(crate) use profile::max_burst_batch_bytes;
pub(crate) use profile::{ConnectionPolicy, Profile, UploadPlan};
pub(crate) use uplink::{ModemConfig, UplinkConfig};

use binnacle_input::InputConfig;
#[cfg(test)]
use binnacle_instruments::config::PositiveSeconds;
use binnacle_instruments::config::{RolesConfig, SilenceConfig};
use binnacle_output::config::OutputConfig;
use error::{Place, Problem};
use limits::{RawLogLimit, SpoolLimit};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

/// Contents of `agent.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Config {
    /// Directory of the spool.
    pub(crate) data_dir: PathBuf,
    /// Disk limit of the spool.
    #[serde(default)]
    pub(crate) spool_mb: SpoolLimit,
    /// Disk limit of the raw log; 0 keeps nothing.
    #[serde(default, rename = "ring_mb")]
    pub(crate) raw_log_mb: RawLogLimit,
    /// Inputs, by the names that roles refer to.
    #[serde(default)]
    pub(crate) inputs: BTreeMap<String, InputConfig>,
    /// Sources of each instrument.
    #[serde(default = "RolesConfig::usual")]
    pub(crate) roles: RolesConfig,
    /// Destinations of the corrected heading.
    #[serde(default)]
    pub(crate) output: OutputConfig,
    /// The local page; none when absent.
    pub(crate) page: Option<PageConfig>,
    /// Connection to the server.
    #[serde(default)]
    pub(crate) uplink: UplinkConfig,
    /// Modem for short-burst messages.
    pub(crate) modem: Option<ModemConfig>,
    /// Thresholds of the agent's own alert.
    #[serde(default)]
    pub(crate) alert: AlertConfig,
    /// Age up to which readings serve.
    #[serde(default)]
    pub(crate) silence: SilenceConfig,
}

/// The local page.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PageConfig {
    /// Address and port; port 0 takes a free one.
    pub(crate) listen: SocketAddr,
    /// PIN that changes need; without one they are accepted on the agent's own computer alone.
    pub(crate) pin: Option<Pin>,
}

impl Config {
    /// Reads and checks a file.
    pub(crate) fn load(path: &Path) -> Result<Config, ConfigError> {
        let bytes = fs::read(path).map_err(|source| ConfigError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        let text = String::from_utf8(bytes).map_err(|error| ConfigError::not_text(path, &error))?;
        let mut config = parse(&text).map_err(|wrong| wrong.in_file(path, &text))?;
        let directory = path.parent().unwrap_or(Path::new("."));
        config.data_dir = directory.join(&config.data_dir);
        if let Some(ca) = &mut config.uplink.pinned_ca {
            *ca = directory.join(&ca);
        }
        if let Some(modem) = &mut config.modem {
            modem.resolve(directory);
        }
        for (name, input) in &mut config.inputs {
            input.resolve(directory, &config.data_dir, name);
        }
        Ok(config)
    }
}

fn parse(text: &str) -> Result<Config, Problem> {
    let config: Config = toml::from_str(text).map_err(|e| Problem {
        place: Place::Bytes(e.span()),
        problem: e.message().replace('\n', "; "),
    })?;
    for source in config.roles.sources() {
        let Some(input) = &source.input else { continue };
        if !config.inputs.contains_key(input.get_ref()) {
            return Err(Problem::at(
                input.span(),
                format!("there is no input named {:?}", input.get_ref()),
            ));
        }
    }
    config.uplink.check(config.modem.as_ref())?;
    let output = config.output.check();
    output.map_err(|wrong| Problem::at(wrong.span, wrong.problem))?;
    conflicts::check(&config)?;
    Ok(config)
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
        assert!((config.output.interval_s.seconds() - 1.0).abs() < 1e-9);
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
        assert_eq!(example.silence.steering_s, bare.silence.steering_s);
        assert_eq!(example.output.interval_s, bare.output.interval_s);
        assert_eq!(example.output.alarm_sentence, bare.output.alarm_sentence);
        assert_eq!(example.output.alert_sentences, bare.output.alert_sentences);
        assert_eq!(example.output.talker, bare.output.talker);
        assert_eq!(example.output.hdg, bare.output.hdg);
        assert_eq!(example.output.ths, bare.output.ths);
        assert_eq!(example.output.hdt, bare.output.hdt);
        assert_eq!(example.alert.gyro_error_deg, bare.alert.gyro_error_deg);
        assert_eq!(example.alert.settled_s, bare.alert.settled_s);
        assert_eq!(example.alert.difference_deg, bare.alert.difference_deg);
        assert_eq!(example.alert.difference_s, bare.alert.difference_s);
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
            "agent.toml:14: interval_s: -1 is not from 0.01 to 3600 seconds"
        );
        let wrong = WHOLE.replace("poll_s = 21600", "pol_s = 21600");
        assert!(message(&wrong).starts_with("agent.toml:19: pol_s: unknown field `pol_s`"));
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
        let wrong = WHOLE.trim_start().replace("data_dir = \"state\"\n", "");
        assert_eq!(message(&wrong), "agent.toml:1: missing field `data_dir`");
    }

    #[test]
    fn a_file_in_another_encoding_is_named_with_the_line() {
        let folder = tempfile::TempDir::new().unwrap();
        let path = folder.path().join("agent.toml");
        fs::write(&path, b"data_dir = \"d\"\n# caf\xe9\n").unwrap();
        let wrong = Config::load(&path).unwrap_err().to_string();
        assert!(
            wrong.contains("agent.toml:2: this is not text in UTF-8"),
            "{wrong}"
        );
    }

    #[test]
    fn a_rate_that_a_serial_line_cannot_carry_is_named_where_it_is_written() {
        let line = "interval_s = 0.1\nserial = { path = \"/dev/a\", baud = 4800 }";
        let wrong = message(&WHOLE.replace("interval_s = 1", line));
        assert!(
            wrong.starts_with("agent.toml:15: baud: 4800 baud carry 480 bytes a second, but HDG,"),
            "{wrong}"
        );
        let standard = "interval_s = 0.1\nserial = [{ path = \"/dev/a\" }]";
        let wrong = message(&WHOLE.replace("interval_s = 1", standard));
        assert!(
            wrong.starts_with("agent.toml:15: path: 4800 baud carry"),
            "{wrong}"
        );
    }

    #[test]
    fn an_output_over_an_input_that_cannot_carry_it_is_refused_where_it_is_written() {
        let with = |inputs: &str, output: &str| {
            let inputs = format!("[inputs.bus]\n{inputs}\n[inputs.bridge]");
            let text = WHOLE.replace("[inputs.bridge]", &inputs);
            text.replace("interval_s = 1", output)
        };
        let can = "socketcan = \"can0\"";
        assert!(parse(&with(can, "n2k = { input = \"bus\" }")).is_ok());
        let udp = "ydwg = { udp = \"0.0.0.0:1457\" }";
        for (input, output, problem) in [
            (
                can,
                "n2k = { input = \"b\" }",
                "there is no input named \"b\"",
            ),
            (
                can,
                "n2k = { input = \"bridge\" }",
                "tcp carries no NMEA 2000",
            ),
            (
                udp,
                "n2k = { input = \"bus\" }",
                "a gateway's datagrams are only received: set send_to to its address",
            ),
            (
                can,
                "signalk = { input = \"bus\" }",
                "socketcan is no Signal K server",
            ),
            (
                can,
                "n2k = [{ input = \"bus\" }, { input = \"bus\" }]",
                "two outputs share the input \"bus\"",
            ),
        ] {
            let wrong = message(&with(input, output));
            assert_eq!(wrong, format!("agent.toml:16: input: {problem}"));
        }
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
