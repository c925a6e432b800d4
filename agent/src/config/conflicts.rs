//! Settings that contradict each other: one place that two of them use, one source in two places,
//! and keys of a source that its input never names.

use super::error::Problem;
use super::{Config, RolesConfig};
use binnacle_input::InputConfig;
use binnacle_input::config::{ActisenseConfig, YdwgConfig};
use binnacle_instruments::config::SourceConfig;
use binnacle_output::config::OutputConfig;
use std::collections::BTreeSet;
use std::fmt;
use std::net::SocketAddr;
use toml::Spanned;

/// Fails when settings contradict each other.
pub(super) fn check(config: &Config) -> Result<(), Problem> {
    if config.data_dir.as_os_str().is_empty() {
        return Err(Problem::of_field(
            &["data_dir"],
            "\"\" names no directory".into(),
        ));
    }
    let inputs = config.inputs.iter();
    let mut uses: Vec<Use> = inputs.map(|(name, input)| input_use(name, input)).collect();
    uses.extend(output_uses(&config.output));
    if let Some(page) = &config.page {
        uses.push(Use::new(&["page", "listen"], Place::TcpPort(page.listen)));
    }
    for (count, one) in uses.iter().enumerate() {
        one.check()?;
        if let Some(other) = uses[..count]
            .iter()
            .find(|other| other.place.is(&one.place))
        {
            let problem = format!("{} is used by {} as well", one.place, other.setting());
            return Err(one.problem(problem));
        }
    }
    check_shared_inputs(config)?;
    check_sources(config)
}

/// Setting and the place that it uses.
struct Use {
    keys: Vec<String>,
    place: Place,
}

/// Place in the computer or the network that one setting alone can use.
#[derive(PartialEq)]
enum Place {
    /// Port that is listened on.
    TcpPort(SocketAddr),
    /// Port that datagrams are received at.
    UdpPort(SocketAddr),
    /// Serial port, which is opened for one user.
    Serial(String),
    /// Anything else that is read: twice, each reading would count twice.
    Source(String),
    /// Address that datagrams are sent to: twice, each would arrive twice.
    Receiver(SocketAddr, String),
}

impl Place {
    fn is(&self, other: &Place) -> bool {
        match (self, other) {
            (Place::TcpPort(one), Place::TcpPort(other))
            | (Place::UdpPort(one), Place::UdpPort(other)) => {
                let is_any = one.ip().is_unspecified() || other.ip().is_unspecified();
                // Port 0 is another free one each time.
                one.port() != 0 && one.port() == other.port() && (is_any || one.ip() == other.ip())
            }
            _ => self == other,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::TcpPort(address) | Place::UdpPort(address) => write!(f, "{address}"),
            Place::Serial(name) | Place::Source(name) | Place::Receiver(_, name) => {
                f.write_str(name)
            }
        }
    }
}

impl Use {
    fn new(keys: &[&str], place: Place) -> Use {
        Use {
            keys: keys.iter().map(|key| (*key).to_owned()).collect(),
            place,
        }
    }

    /// Fails when there can be no such place.
    fn check(&self) -> Result<(), Problem> {
        match &self.place {
            Place::UdpPort(address) if address.port() == 0 => {
                Err(self.problem("nothing is received at port 0".to_owned()))
            }
            Place::Receiver(address, _) if address.port() == 0 => {
                Err(self.problem("nothing can be sent to port 0".to_owned()))
            }
            Place::Serial(name) | Place::Source(name) if name.is_empty() => {
                Err(self.problem("\"\" names nothing to read or write".to_owned()))
            }
            _ => Ok(()),
        }
    }

    fn problem(&self, problem: String) -> Problem {
        let keys: Vec<&str> = self.keys.iter().map(String::as_str).collect();
        Problem::of_field(&keys, problem)
    }

    /// Returns the name of the setting, as `inputs.bridge.udp`.
    fn setting(&self) -> String {
        let is_name = |key: &&String| key.parse::<usize>().is_err();
        let names = self.keys.iter().filter(is_name).map(String::as_str);
        names.collect::<Vec<_>>().join(".")
    }
}

fn input_use(name: &str, input: &InputConfig) -> Use {
    let kind = input.kind();
    let of_key = |key, place| Use::new(&["inputs", name, kind, key], place);
    let of_kind = |place| Use::new(&["inputs", name, kind], place);
    match input {
        InputConfig::Serial(port) => of_key("path", Place::Serial(port.path.clone())),
        InputConfig::Tcp(server) => of_kind(Place::Source(server.as_str().to_owned())),
        InputConfig::Udp(address) => of_kind(Place::UdpPort(*address)),
        InputConfig::Multicast(group) => {
            // Two networks for one group are two sources.
            let name = format!("{} on {}", group.address, group.interface);
            of_kind(Place::Source(name))
        }
        InputConfig::SignalK(server) => of_kind(Place::Source(server.url.uri().to_string())),
        InputConfig::SocketCan(bus) => of_kind(Place::Source(bus.clone())),
        InputConfig::Actisense(ActisenseConfig::Serial { path, .. }) => {
            of_key("serial", Place::Serial(path.clone()))
        }
        InputConfig::Actisense(ActisenseConfig::Tcp(server))
        | InputConfig::Ydwg(YdwgConfig::Tcp(server)) => {
            of_key("tcp", Place::Source(server.as_str().to_owned()))
        }
        InputConfig::Ydwg(YdwgConfig::Udp { address, .. }) => {
            of_key("udp", Place::UdpPort(*address))
        }
        InputConfig::File(path) => of_kind(Place::Source(path.display().to_string())),
    }
}

fn output_uses(output: &OutputConfig) -> Vec<Use> {
    let of =
        |kind: &str, index: usize, place| Use::new(&["output", kind, &index.to_string()], place);
    let mut uses = Vec::new();
    for (index, server) in output.tcp_server.iter().enumerate() {
        uses.push(of("tcp_server", index, Place::TcpPort(server.address)));
    }
    for (index, receiver) in output.udp.iter().enumerate() {
        let address = receiver.address;
        let place = Place::Receiver(address, address.to_string());
        uses.push(of("udp", index, place));
    }
    for (index, group) in output.multicast.iter().enumerate() {
        let name = format!("{} on {}", group.group, group.interface);
        let place = Place::Receiver(group.group.into(), name);
        uses.push(of("multicast", index, place));
    }
    for (index, port) in output.serial.iter().enumerate() {
        uses.push(of("serial", index, Place::Serial(port.path().to_owned())));
    }
    uses
}

/// Fails when a role has one source twice, when gyro and satellite compass share one, or when a
/// source has a key that its input never names.
fn check_sources(config: &Config) -> Result<(), Problem> {
    let mut headings: Vec<(&str, String)> = Vec::new();
    for (role, sources) in config.roles.by_role() {
        let mut names: Vec<String> = Vec::new();
        for (index, source) in sources.iter().enumerate() {
            check_keys(config, role, index, source)?;
            let name = source.name();
            let index = index.to_string();
            let repeated = |problem| Problem::of_field(&["roles", role, &index], problem);
            if names.contains(&name) {
                return Err(repeated("this source stands here twice".to_owned()));
            }
            if let Some((other, _)) = headings.iter().find(|(_, known)| *known == name) {
                let problem = format!("this source is that of {other} as well");
                return Err(repeated(problem));
            }
            names.push(name);
        }
        if RolesConfig::TRUE_HEADINGS.contains(&role) {
            headings.extend(names.into_iter().map(|name| (role, name)));
        }
    }
    Ok(())
}

fn check_keys(
    config: &Config,
    role: &str,
    index: usize,
    source: &SourceConfig,
) -> Result<(), Problem> {
    let named = source.input.as_ref().map(Spanned::get_ref);
    let Some((name, input)) = named.and_then(|name| config.inputs.get_key_value(name)) else {
        return Ok(());
    };
    let is_sentences = matches!(
        input,
        InputConfig::Serial(_)
            | InputConfig::Tcp(_)
            | InputConfig::Udp(_)
            | InputConfig::Multicast(_)
    );
    let is_datagrams = matches!(
        input,
        InputConfig::Udp(_) | InputConfig::Multicast(_) | InputConfig::Ydwg(YdwgConfig::Udp { .. })
    );
    let is_signalk = matches!(input, InputConfig::SignalK(_) | InputConfig::File(_));
    let wrong = [
        ("source", source.source.is_some() && !is_signalk),
        ("sender", source.sender.is_some() && !is_datagrams),
        ("n2k_address", source.n2k_address.is_some() && is_sentences),
        ("n2k_name", source.n2k_name.is_some() && is_sentences),
    ];
    let Some((key, _)) = wrong.into_iter().find(|(_, is_wrong)| *is_wrong) else {
        return Ok(());
    };
    let (kind, index) = (input.kind(), index.to_string());
    let problem = format!("{name:?} is an input of kind {kind}, which never names a {key}");
    Err(Problem::of_field(&["roles", role, &index, key], problem))
}

/// Refuses outputs over an input that cannot carry them, and two over one.
fn check_shared_inputs(config: &Config) -> Result<(), Problem> {
    let buses = config.output.n2k.iter().map(|bus| &bus.input);
    let servers = config.output.signalk.iter().map(|server| &server.input);
    let mut shared = BTreeSet::new();
    for (input, is_bus) in buses
        .map(|input| (input, true))
        .chain(servers.map(|input| (input, false)))
    {
        let name = input.get_ref();
        let wrong = |problem: String| Problem::at(input.span(), problem);
        let found = config.inputs.get(name);
        let found = found.ok_or_else(|| wrong(format!("there is no input named {name:?}")))?;
        if is_bus {
            found.n2k_address_owner().map_err(wrong)?;
        } else if !matches!(found, InputConfig::SignalK(_)) {
            return Err(wrong(format!("{} is no Signal K server", found.kind())));
        }
        if !shared.insert(name) {
            return Err(wrong(format!("two outputs share the input {name:?}")));
        }
    }
    Ok(())
}
