//! `[inputs.NAME]`: one input, of exactly one kind.

use super::baud::baud;
use super::host_port::HostPort;
use super::n2k_input::{ActisenseConfig, YdwgConfig};
use super::signalk::SignalKConfig;
use serde::Deserialize;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4};
use std::path::{Path, PathBuf};

/// One input.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "InputTable")]
pub enum InputConfig {
    /// Reads a serial port.
    Serial(SerialConfig),
    /// Connects to a host and port.
    Tcp(HostPort),
    /// Receives datagrams of plain sentences at this address, broadcast ones too.
    Udp(SocketAddr),
    /// Joins an IEC 61162-450 transmission group.
    Multicast(Group),
    /// Connects to a Signal K server.
    SignalK(SignalKConfig),
    /// Reads a CAN bus of the kernel, as `can0`.
    SocketCan(String),
    /// Reads NMEA 2000 from an Actisense gateway.
    Actisense(ActisenseConfig),
    /// Reads NMEA 2000 from a Yacht Devices gateway.
    Ydwg(YdwgConfig),
    /// Reads a recording to its end.
    File(PathBuf),
}

impl InputConfig {
    /// Makes paths relative to the configuration's directory; what the input called `name` keeps
    /// is in `data_dir`.
    pub fn resolve(&mut self, directory: &Path, data_dir: &Path, name: &str) {
        match self {
            InputConfig::File(path) => *path = directory.join(&path),
            InputConfig::SignalK(server) => server.resolve(directory, data_dir, name),
            _ => {}
        }
    }

    /// Returns the kind by its name in the file.
    pub fn kind(&self) -> &'static str {
        match self {
            InputConfig::Serial(_) => "serial",
            InputConfig::Tcp(_) => "tcp",
            InputConfig::Udp(_) => "udp",
            InputConfig::Multicast(_) => "multicast",
            InputConfig::SignalK(_) => "signalk",
            InputConfig::SocketCan(_) => "socketcan",
            InputConfig::Actisense(_) => "actisense",
            InputConfig::Ydwg(_) => "ydwg",
            InputConfig::File(_) => "file",
        }
    }
}

/// Owner of the address that messages of an output have on an NMEA 2000 bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddressOwner {
    /// The agent claims it.
    Agent,
    /// The gateway has claimed it, and puts it into each message.
    Gateway,
}

impl InputConfig {
    /// Returns whose address the messages of an NMEA 2000 output have.
    ///
    /// # Errors
    /// Fails with the reason when such an output cannot share this input.
    pub fn n2k_address_owner(&self) -> Result<AddressOwner, String> {
        match self {
            InputConfig::Actisense(_) => Ok(AddressOwner::Gateway),
            InputConfig::Ydwg(YdwgConfig::Udp { send_to: None, .. }) => Err(
                "a gateway's datagrams are only received: set send_to to its address".to_owned(),
            ),
            InputConfig::SocketCan(_) | InputConfig::Ydwg(_) => Ok(AddressOwner::Agent),
            _ => Err(format!("{} carries no NMEA 2000", self.kind())),
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct InputTable {
    serial: Option<SerialConfig>,
    tcp: Option<HostPort>,
    udp: Option<SocketAddr>,
    multicast: Option<Group>,
    signalk: Option<SignalKConfig>,
    socketcan: Option<String>,
    actisense: Option<ActisenseConfig>,
    ydwg: Option<YdwgConfig>,
    file: Option<PathBuf>,
}

impl TryFrom<InputTable> for InputConfig {
    type Error = String;

    fn try_from(table: InputTable) -> Result<InputConfig, String> {
        let given: Vec<InputConfig> = [
            table.serial.map(InputConfig::Serial),
            table.tcp.map(InputConfig::Tcp),
            table.udp.map(InputConfig::Udp),
            table.multicast.map(InputConfig::Multicast),
            table.signalk.map(InputConfig::SignalK),
            table.socketcan.map(InputConfig::SocketCan),
            table.actisense.map(InputConfig::Actisense),
            table.ydwg.map(InputConfig::Ydwg),
            table.file.map(InputConfig::File),
        ]
        .into_iter()
        .flatten()
        .collect();
        let kinds: Vec<&str> = given.iter().map(InputConfig::kind).collect();
        let found = match kinds.as_slice() {
            [] => "none".to_owned(),
            kinds => kinds.join(" and "),
        };
        <[InputConfig; 1]>::try_from(given)
            .map(|[input]| input)
            .map_err(|_| {
                format!(
                    "an input has exactly one of serial, tcp, udp, multicast, signalk, socketcan, \
                     actisense, ydwg and file; this one has {found}"
                )
            })
    }
}

/// Serial port to read.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SerialConfig {
    /// Device, as `/dev/ttyUSB0`.
    pub path: String,
    /// Bits per second; IEC 61162-1 has 4800, 61162-2 38400.
    #[serde(default = "standard_baud", deserialize_with = "baud")]
    pub baud: u32,
}

fn standard_baud() -> u32 {
    4800
}

/// A multicast group, and the interface to join it on.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "GroupText")]
pub struct Group {
    /// Address and port; IEC 61162-450 has 239.192.0.1 to 64, ports 60001 to 60009.
    pub address: SocketAddrV4,
    /// Address of the interface; unspecified lets the system choose.
    pub interface: Ipv4Addr,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"239.192.0.4:60004\" or { group = \"239.192.0.4:60004\", interface = \"192.168.1.2\" }"
)]
enum GroupText {
    Short(SocketAddrV4),
    Long(LongGroup),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LongGroup {
    group: SocketAddrV4,
    interface: Ipv4Addr,
}

impl TryFrom<GroupText> for Group {
    type Error = String;

    fn try_from(text: GroupText) -> Result<Group, String> {
        let (address, interface) = match text {
            GroupText::Short(address) => (address, Ipv4Addr::UNSPECIFIED),
            GroupText::Long(long) => (long.group, long.interface),
        };
        if !address.ip().is_multicast() {
            return Err(format!("{address} is not a multicast address"));
        }
        Ok(Group { address, interface })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(toml: &str) -> Result<InputConfig, String> {
        toml::from_str(toml).map_err(|error| error.message().to_owned())
    }

    #[test]
    fn every_kind_is_read() {
        for (text, kind) in [
            (
                "serial = { path = \"/dev/ttyUSB0\", baud = 38400 }",
                "serial",
            ),
            ("serial = { path = \"/dev/ttyUSB0\" }", "serial"),
            ("tcp = \"127.0.0.1:10110\"", "tcp"),
            ("tcp = \"bridge.local:10110\"", "tcp"),
            ("udp = \"0.0.0.0:10110\"", "udp"),
            ("multicast = \"239.192.0.4:60004\"", "multicast"),
            (
                "multicast = { group = \"239.192.0.4:60004\", interface = \"10.0.0.1\" }",
                "multicast",
            ),
            (
                "signalk = \"ws://host:3000/signalk/v1/stream?subscribe=none\"",
                "signalk",
            ),
            ("file = \"log.nmea\"", "file"),
        ] {
            assert_eq!(read(text).unwrap().kind(), kind, "{text}");
        }
    }

    #[test]
    fn an_input_of_no_kind_or_of_two_is_refused() {
        assert!(read("").unwrap_err().ends_with("this one has none"));
        let two = read("tcp = \"h:1\"\nudp = \"0.0.0.0:1\"").unwrap_err();
        assert!(two.ends_with("this one has tcp and udp"), "{two}");
    }

    #[test]
    fn what_cannot_work_is_refused_by_its_value() {
        for (text, named) in [
            ("tpc = \"h:1\"", "tpc"),
            ("tcp = \"h\"", "\"h\""),
            ("tcp = \"h:0\"", "h:0"),
            ("tcp = \":10110\"", ":10110"),
            ("udp = \"10110\"", "socket address"),
            ("multicast = \"192.168.1.1:60004\"", "192.168.1.1:60004"),
            ("multicast = 5", "239.192.0.4:60004"),
            ("signalk = \"http://host:3000/\"", "http://host:3000/"),
            ("signalk = \"https://host:3000/\"", "https://host:3000/"),
            ("signalk = \"ws:\"", "ws:"),
            ("serial = { path = \"/dev/x\", bauds = 1 }", "bauds"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(named), "{text}: {message}");
        }
    }

    #[test]
    fn only_paths_of_files_follow_the_configuration() {
        let mut file = read("file = \"log.nmea\"").unwrap();
        file.resolve(Path::new("/etc/binnacle"), Path::new("/var"), "log");
        assert!(
            matches!(&file, InputConfig::File(path) if path == Path::new("/etc/binnacle/log.nmea"))
        );
    }
}
