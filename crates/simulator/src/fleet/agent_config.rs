//! Writes an agent's configuration.

use anyhow::Result;
use binnacle_simulator::scenario::ShipPlan;
use std::fmt::Write;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};

/// The addresses of one ship's agent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ports {
    /// Address of the ship's instruments.
    pub(super) instruments: SocketAddr,
    /// Address of the corrected heading's output.
    pub(super) output: SocketAddr,
    /// Address of the local page.
    pub(super) page: SocketAddr,
}

impl Ports {
    /// Chooses free ports for the agent.
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

/// Returns the `agent.toml` of a simulated ship.
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
    // A demonstration lasts minutes: models are polled every ten seconds.
    line(format_args!(
        "\n[uplink]\npoll_s = 10\nretry_min_s = 1\nretry_max_s = 10"
    ));
    text
}

/// Returns a ship's folder name: its letters and digits, with hyphens between.
pub(super) fn slug(name: &str) -> String {
    let lower = name.to_lowercase();
    let words = lower.split(|c: char| !c.is_alphanumeric());
    words
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join("-")
}

#[cfg(test)]
mod tests {
    use super::slug;

    #[test]
    fn a_ships_folder_has_her_own_letters_and_no_leading_hyphen() {
        assert_eq!(slug("Östersjön"), "östersjön");
        assert_eq!(slug("  M/V Baía de Santos"), "m-v-baía-de-santos");
        assert_ne!(slug("Åland"), slug("Öland"));
    }
}
