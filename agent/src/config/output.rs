//! `[output]`: destinations of the corrected heading.

use super::limits::PositiveSeconds;
use serde::Deserialize;
use std::net::SocketAddr;

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
