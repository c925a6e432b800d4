//! `[output]`: destinations of the corrected heading.

use super::limits::PositiveSeconds;
use serde::Deserialize;
use std::net::SocketAddr;

/// Destinations of the corrected heading.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct OutputConfig {
    /// Address of a TCP server that sends to every client.
    pub(crate) tcp_server: Option<SocketAddr>,
    /// Destination of datagrams; may be a broadcast address.
    pub(crate) udp: Option<SocketAddr>,
    /// Serial port to write to.
    pub(crate) serial: Option<SerialConfig>,
    /// Seconds between two outputs.
    pub(crate) interval_s: PositiveSeconds,
    /// Sends ALR sentences of the agent's own alert as well.
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
