//! Gateways to an NMEA 2000 bus.

use super::baud::some_baud;
use super::host_port::HostPort;
use serde::Deserialize;
use std::net::SocketAddr;

/// Actisense NGT-1, or what speaks as it does.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "ActisenseTable")]
pub enum ActisenseConfig {
    /// At a serial port.
    Serial {
        /// Device, as `/dev/ttyUSB0`.
        path: String,
        /// Bits per second.
        baud: u32,
    },
    /// Behind a serial server.
    Tcp(HostPort),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ActisenseTable {
    serial: Option<String>,
    #[serde(default, deserialize_with = "some_baud")]
    baud: Option<u32>,
    tcp: Option<HostPort>,
}

/// Bits per second of an NGT-1.
const NGT_BAUD: u32 = 115_200;

impl TryFrom<ActisenseTable> for ActisenseConfig {
    type Error = String;

    fn try_from(table: ActisenseTable) -> Result<ActisenseConfig, String> {
        match (table.serial, table.tcp, table.baud) {
            (Some(path), None, baud) => Ok(ActisenseConfig::Serial {
                path,
                baud: baud.unwrap_or(NGT_BAUD),
            }),
            (None, Some(address), None) => Ok(ActisenseConfig::Tcp(address)),
            (None, Some(_), Some(_)) => Err("baud is of a serial port, not of tcp".to_owned()),
            _ => Err("a gateway of Actisense has exactly one of serial and tcp".to_owned()),
        }
    }
}

/// Yacht Devices gateway, or what speaks its RAW protocol.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "YdwgTable")]
pub enum YdwgConfig {
    /// Connects to the gateway.
    Tcp(HostPort),
    /// Receives its datagrams.
    Udp {
        /// Address to receive at.
        address: SocketAddr,
        /// Address of the gateway, for an output that shares the input.
        send_to: Option<SocketAddr>,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct YdwgTable {
    tcp: Option<HostPort>,
    udp: Option<SocketAddr>,
    send_to: Option<SocketAddr>,
}

impl TryFrom<YdwgTable> for YdwgConfig {
    type Error = String;

    fn try_from(table: YdwgTable) -> Result<YdwgConfig, String> {
        match (table.tcp, table.udp, table.send_to) {
            (Some(address), None, None) => Ok(YdwgConfig::Tcp(address)),
            (None, Some(address), send_to) => Ok(YdwgConfig::Udp { address, send_to }),
            (Some(_), None, Some(_)) => Err("send_to is of udp, not of tcp".to_owned()),
            _ => Err("a gateway of Yacht Devices has exactly one of tcp and udp".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gateway_has_one_line() {
        let actisense = |text: &str| toml::from_str::<ActisenseConfig>(text);
        let serial = actisense("serial = \"/dev/ttyUSB0\"").unwrap();
        assert!(matches!(
            serial,
            ActisenseConfig::Serial { baud: 115_200, .. }
        ));
        assert!(actisense("tcp = \"10.0.0.5:2000\"").is_ok());
        for wrong in [
            "",
            "serial = \"/dev/ttyUSB0\"\ntcp = \"10.0.0.5:2000\"",
            "tcp = \"10.0.0.5:2000\"\nbaud = 115200",
            "udp = \"0.0.0.0:1457\"",
        ] {
            assert!(actisense(wrong).is_err(), "{wrong}");
        }
        let ydwg = |text: &str| toml::from_str::<YdwgConfig>(text);
        assert!(ydwg("udp = \"0.0.0.0:1457\"").is_ok() && ydwg("").is_err());
        let send_to = "send_to = \"10.0.0.5:1457\"";
        assert!(ydwg(&format!("udp = \"0.0.0.0:1457\"\n{send_to}")).is_ok());
        assert!(ydwg(&format!("tcp = \"10.0.0.5:1457\"\n{send_to}")).is_err());
    }
}
