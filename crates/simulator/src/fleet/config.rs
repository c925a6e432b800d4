//! What is written for an agent before it runs.

use anyhow::Result;
use binnacle_simulator::scenario::ShipPlan;
use std::fmt::Write;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};

/// The addresses of one ship's agent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ports {
    /// Where her instruments speak.
    pub(super) instruments: SocketAddr,
    /// Where the corrected heading comes out.
    pub(super) output: SocketAddr,
    /// The local page.
    pub(super) page: SocketAddr,
}

impl Ports {
    /// Takes free ports for what the agent opens.
    pub(super) fn choose(instruments: SocketAddr) -> Result<Ports> {
        let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        // Both are held until both are known, so that they differ.
        let (output, page) = (TcpListener::bind(any)?, TcpListener::bind(any)?);
        Ok(Ports {
            instruments,
            output: output.local_addr()?,
            page: page.local_addr()?,
        })
    }
}

/// `agent.toml` for a simulated ship.
pub(super) fn agent_toml(plan: &ShipPlan, ports: Ports) -> String {
    let mut text = String::from("data_dir = \"state\"\n\n[inputs.bridge]\n");
    let mut line = |content: std::fmt::Arguments<'_>| {
        writeln!(text, "{content}").expect("a string takes every write");
    };
    line(format_args!("tcp = \"{}\"\n", ports.instruments));
    line(format_args!("[roles]"));
    let mut role = |name: &str, talker: Option<&str>, sentence: &str| {
        let talker = talker.map_or(String::new(), |talker| format!("talker = \"{talker}\", "));
        line(format_args!(
            "{name} = [{{ input = \"bridge\", {talker}sentence = \"{sentence}\" }}]"
        ));
    };
    role("compass", Some("HC"), "HDG");
    role("gyro", Some("HE"), "THS");
    if plan.satellite.is_some() {
        role("satellite", Some("GP"), "THS");
    }
    role("position", Some("GP"), "RMC");
    role("rate_of_turn", None, "ROT");
    role("roll", None, "XDR");
    line(format_args!(
        "\n[output]\ntcp_server = \"{}\"\ninterval_s = 1",
        ports.output
    ));
    line(format_args!("\n[page]\nlisten = \"{}\"", ports.page));
    // A demonstration lasts minutes: models are asked for every ten seconds.
    line(format_args!(
        "\n[uplink]\npoll_s = 10\nretry_min_s = 1\nretry_max_s = 10"
    ));
    text
}

/// A folder's name for a ship.
pub(super) fn slug(name: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '-'
        }
    };
    name.chars().map(plain).collect()
}
