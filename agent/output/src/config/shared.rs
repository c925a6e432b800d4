//! Outputs that share the connection of an input: NMEA 2000 buses and Signal K servers.

use super::sentence::Interval;
use serde::Deserialize;
use toml::Spanned;

/// Interval of 127250 by the standard.
const STANDARD_INTERVAL_S: f64 = 0.1;

/// NMEA 2000 bus to send to.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct N2kOutputConfig {
    /// Input whose connection is shared.
    pub input: Spanned<String>,
    /// Norths that the heading is counted from.
    #[serde(default)]
    pub heading: N2kHeading,
    /// Sends the variation as well.
    #[serde(default = "on")]
    pub variation: bool,
    /// Seconds between two headings.
    interval_s: Option<Interval>,
}

impl N2kOutputConfig {
    /// Returns the seconds between two headings.
    pub fn interval_s(&self) -> f64 {
        self.interval_s
            .map_or(STANDARD_INTERVAL_S, Interval::seconds)
    }
}

/// Norths that the heading on a bus is counted from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum N2kHeading {
    /// Magnetic north, with the variation beside it.
    #[default]
    Magnetic,
    /// True north.
    True,
    /// One message of each.
    Both,
}

/// Signal K server to send to.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignalKOutputConfig {
    /// Input whose connection is shared.
    pub input: Spanned<String>,
    /// `$source` of the values.
    #[serde(default)]
    pub label: Label,
    /// Seconds between two deltas, if not those of the output.
    pub interval_s: Option<Interval>,
}

/// Name of a source at a Signal K server.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Label(String);

impl Label {
    /// Returns the text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Default for Label {
    fn default() -> Label {
        Label("binnacle".to_owned())
    }
}

impl TryFrom<String> for Label {
    type Error = String;

    fn try_from(text: String) -> Result<Label, String> {
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
        if !text.is_empty() && text.bytes().all(is_plain) {
            Ok(Label(text))
        } else {
            Err(format!(
                "{text:?} is not a name of letters, digits, - and _, as \"binnacle\""
            ))
        }
    }
}

fn on() -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::super::OutputConfig;
    use super::*;

    fn read(toml: &str) -> Result<OutputConfig, String> {
        toml::from_str(toml).map_err(|error| error.message().to_owned())
    }

    #[test]
    fn an_output_of_an_input_has_a_heading_and_an_interval() {
        let plain = read("n2k = { input = \"bus\" }\nsignalk = { input = \"server\" }").unwrap();
        let bus = &plain.n2k[0];
        assert_eq!((bus.heading, bus.variation), (N2kHeading::Magnetic, true));
        assert!((bus.interval_s() - 0.1).abs() < 1e-9);
        assert_eq!(plain.signalk[0].label.as_str(), "binnacle");
        let own = read(
            "n2k = [{ input = \"a\", heading = \"both\", variation = false, interval_s = 1 },\n\
             { input = \"b\", heading = \"true\" }]",
        );
        let own = own.unwrap().n2k;
        assert_eq!(
            (own[0].heading, own[0].variation),
            (N2kHeading::Both, false)
        );
        assert!((own[0].interval_s() - 1.0).abs() < 1e-9);
        assert_eq!(own[1].heading, N2kHeading::True);
    }

    #[test]
    fn what_cannot_be_sent_is_refused_by_its_value() {
        for (wrong, named) in [
            ("n2k = { heading = \"magnetic\" }", "input"),
            ("n2k = { input = \"a\", heading = \"compass\" }", "compass"),
            ("n2k = { input = \"a\", interval_s = 0 }", "0 is not"),
            ("signalk = { input = \"a\", label = \"a.b\" }", "\"a.b\""),
            ("signalk = { input = \"a\", label = \"\" }", "\"\""),
        ] {
            let message = read(wrong).unwrap_err();
            assert!(message.contains(named), "{wrong}: {message}");
        }
    }
}
