//! Host and port of a server.

use serde::Deserialize;
use std::net::SocketAddr;

/// Host name or address, colon and port; resolved at each connection.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct HostPort(String);

impl HostPort {
    /// Returns the text as written.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl TryFrom<String> for HostPort {
    type Error = String;

    fn try_from(text: String) -> Result<HostPort, String> {
        let is_named = text.rsplit_once(':').is_some_and(|(host, port)| {
            is_name(host) && port.parse::<u16>().is_ok_and(|port| port > 0)
        });
        let is_address = text.parse::<SocketAddr>().is_ok_and(|at| at.port() > 0);
        let good = is_named || is_address;
        if good {
            Ok(HostPort(text))
        } else {
            Err(format!(
                "{text:?} is not a host and a port, as \"10.0.0.5:10110\""
            ))
        }
    }
}

/// Returns whether a text may be the name of a host, without a scheme or a path.
fn is_name(text: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || "-._".contains(c);
    !text.is_empty() && text.chars().all(is_part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_host_is_a_name_or_an_address_without_a_scheme() {
        for good in ["10.0.0.5:10110", "gyro-1.local:80", "[::1]:10110"] {
            assert!(HostPort::try_from(good.to_owned()).is_ok(), "{good}");
        }
        for wrong in [
            "tcp://10.0.0.5:10110",
            "10.0.0.5/24:10110",
            "10.0.0.5 :10110",
            "::1:10110",
            "[bridge]:10110",
            ":10110",
            "10.0.0.5:0",
        ] {
            assert!(HostPort::try_from(wrong.to_owned()).is_err(), "{wrong}");
        }
    }
}
