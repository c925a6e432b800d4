//! Signal K server: its address, and how the agent is admitted.

use rustls::RootCertStore;
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::{fmt, io};
use tokio_tungstenite::tungstenite::http::Uri;

/// Signal K server to read.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "SignalKForm")]
pub struct SignalKConfig {
    /// Address of its stream.
    pub url: SignalKUrl,
    /// Token; without one the agent asks for access where the server wants that.
    pub token: Option<String>,
    /// PEM file with the authority, or the certificate itself, of a server that signs its own.
    pub ca: Option<PathBuf>,
    /// File with the agent's registration at the server.
    pub registration: Option<PathBuf>,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"ws://10.0.0.5:3000/signalk/v1/stream\" or { url = \"wss://…\", token = \"…\", ca = \"server.pem\" }"
)]
enum SignalKForm {
    Short(String),
    Long(SignalKTable),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SignalKTable {
    url: String,
    token: Option<String>,
    ca: Option<PathBuf>,
}

impl TryFrom<SignalKForm> for SignalKConfig {
    type Error = String;

    fn try_from(form: SignalKForm) -> Result<SignalKConfig, String> {
        let (url, token, ca) = match form {
            SignalKForm::Short(url) => (url, None, None),
            SignalKForm::Long(table) => (table.url, table.token, table.ca),
        };
        let url = SignalKUrl::parse(&url)?;
        if ca.is_some() && !url.is_secure() {
            return Err("ca is of wss, and this address is ws".to_owned());
        }
        Ok(SignalKConfig {
            url,
            token,
            ca,
            registration: None,
        })
    }
}

impl SignalKConfig {
    /// Loads the authorities of `ca`, if it is set.
    ///
    /// # Errors
    /// The file, and why it cannot be read or is no PEM file of certificates.
    pub fn load_authorities(&self) -> io::Result<Option<RootCertStore>> {
        let Some(path) = &self.ca else {
            return Ok(None);
        };
        let wrong =
            |error: &dyn fmt::Display| io::Error::other(format!("{}: {error}", path.display()));
        let mut roots = RootCertStore::empty();
        for certificate in CertificateDer::pem_file_iter(path).map_err(|e| wrong(&e))? {
            let certificate = certificate.map_err(|e| wrong(&e))?;
            roots.add(certificate).map_err(|e| wrong(&e))?;
        }
        if roots.is_empty() {
            return Err(wrong(&"there is no certificate in it"));
        }
        Ok(Some(roots))
    }

    /// Makes paths relative to the configuration's directory, and names the file of the
    /// registration.
    pub(super) fn resolve(&mut self, directory: &Path, data_dir: &Path, name: &str) {
        if let Some(ca) = &mut self.ca {
            *ca = directory.join(&ca);
        }
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let name: String = name.chars().map(plain).collect();
        self.registration = Some(data_dir.join(format!("signalk-{name}.json")));
    }
}

/// Address of a Signal K stream, `ws://…` or `wss://…`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignalKUrl(Uri);

impl SignalKUrl {
    fn parse(text: &str) -> Result<SignalKUrl, String> {
        let wrong = || {
            format!(
                "{text:?} is not an address as \"ws://10.0.0.5:3000/signalk/v1/stream\" or \"wss://…\""
            )
        };
        let uri: Uri = text.parse().map_err(|_| wrong())?;
        match (uri.scheme_str(), uri.host()) {
            (Some("ws" | "wss"), Some(host)) if !host.is_empty() => Ok(SignalKUrl(uri)),
            _ => Err(wrong()),
        }
    }

    /// Returns the whole address.
    pub fn uri(&self) -> &Uri {
        &self.0
    }

    /// Returns whether the connection is encrypted.
    pub fn is_secure(&self) -> bool {
        self.0.scheme_str() == Some("wss")
    }

    /// Returns the host.
    pub fn host(&self) -> &str {
        let host = self.0.host();
        host.expect("the host was checked when it was made")
    }

    /// Returns host and port to connect to.
    pub fn host_port(&self) -> String {
        let usual = if self.is_secure() { 443 } else { 80 };
        format!("{}:{}", self.host(), self.0.port_u16().unwrap_or(usual))
    }

    /// Returns the address of a path of the server's REST interface.
    pub fn rest(&self, path: &str) -> String {
        let scheme = if self.is_secure() { "https" } else { "http" };
        format!("{scheme}://{}{path}", self.host_port())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(value: &str) -> Result<SignalKConfig, String> {
        #[derive(Deserialize)]
        struct Table {
            signalk: SignalKConfig,
        }
        let table: Result<Table, _> = toml::from_str(&format!("signalk = {value}"));
        table
            .map(|table| table.signalk)
            .map_err(|error| error.message().to_owned())
    }

    #[test]
    fn an_address_alone_or_with_token_and_authority_is_read() {
        let short = read("\"ws://host:3000/signalk/v1/stream\"").unwrap();
        assert_eq!(short.url.host_port(), "host:3000");
        assert_eq!(short.url.rest("/signalk"), "http://host:3000/signalk");
        let long =
            read("{ url = \"wss://host/signalk/v1/stream\", token = \"t\", ca = \"a.pem\" }");
        let mut long = long.unwrap();
        assert_eq!(long.url.rest(""), "https://host:443");
        long.resolve(Path::new("/etc"), Path::new("/var"), "sk 1");
        assert_eq!(long.ca, Some(PathBuf::from("/etc/a.pem")));
        let kept = PathBuf::from("/var/signalk-sk_1.json");
        assert_eq!(long.registration, Some(kept));
    }

    #[test]
    fn what_cannot_be_connected_to_is_refused() {
        for wrong in [
            "\"http://host:3000\"",
            "\"ws://\"",
            "{ url = \"ws://host\", ca = \"a.pem\" }",
            "{ token = \"t\" }",
            "3000",
        ] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
