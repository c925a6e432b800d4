//! Host and port of a server.

use serde::Deserialize;

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
        let good = text.rsplit_once(':').is_some_and(|(host, port)| {
            !host.is_empty() && port.parse::<u16>().is_ok_and(|port| port > 0)
        });
        if good {
            Ok(HostPort(text))
        } else {
            Err(format!(
                "{text:?} is not a host and a port, as \"10.0.0.5:10110\""
            ))
        }
    }
}
