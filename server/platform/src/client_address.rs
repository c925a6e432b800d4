//! Client address and program of a request.
//!
//! Invariants: nothing that a client says about itself is trusted. The address is that of
//! the connection, or the one seen by the outermost of our own proxies. `--proxies` gives
//! their number, and only the entries that they appended to `X-Forwarded-For` are read.

use crate::app::App;
use axum::extract::{ConnectInfo, FromRef, FromRequestParts};
use axum::http::header::USER_AGENT;
use axum::http::request::Parts;
use std::convert::Infallible;
use std::net::{IpAddr, SocketAddr};

/// Longest stored name of a client program, in characters.
const MAX_PROGRAM: usize = 200;

/// Origin of a request.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// Client address, if known.
    pub address: Option<IpAddr>,
    /// Client's `User-Agent`; may be empty.
    pub program: String,
}

impl Origin {
    /// Returns the address as it is stored and shown.
    pub fn address_text(&self) -> String {
        self.address.map_or_else(String::new, |ip| ip.to_string())
    }

    /// Returns the network under which requests and failed sign-ins are counted: an IPv4 address, or
    /// an IPv6 /64, because its holder controls all of its addresses.
    pub fn network(&self) -> String {
        match self.address {
            Some(IpAddr::V6(ip)) => {
                let [a, b, c, d, ..] = ip.segments();
                format!("address {a:x}:{b:x}:{c:x}:{d:x}::/64")
            }
            Some(ip) => format!("address {ip}"),
            None => "address unknown".to_owned(),
        }
    }

    /// Returns the IPv6 /48 of the address, of which one site may have all (RFC 6177, section 2).
    pub(crate) fn site(&self) -> Option<String> {
        let Some(IpAddr::V6(ip)) = self.address else {
            return None;
        };
        let [a, b, c, ..] = ip.segments();
        Some(format!("address {a:x}:{b:x}:{c:x}::/48"))
    }
}

impl Origin {
    /// Reads the origin of a request behind the configured number of proxies.
    pub fn of_request(parts: &Parts, app: &App) -> Origin {
        let peer = parts.extensions.get::<ConnectInfo<SocketAddr>>();
        let peer = peer.map(|ConnectInfo(peer)| peer.ip());
        let forwarded = parts.headers.get_all("x-forwarded-for");
        let forwarded: Vec<&str> = forwarded.iter().filter_map(|v| v.to_str().ok()).collect();
        let named = parts.headers.get(USER_AGENT).and_then(|v| v.to_str().ok());
        Origin {
            address: client(peer, &forwarded, usize::from(app.config.proxies)),
            program: named
                .unwrap_or_default()
                .chars()
                .take(MAX_PROGRAM)
                .collect(),
        }
    }
}

impl<S> FromRequestParts<S> for Origin
where
    App: FromRef<S>,
    S: Send + Sync,
{
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Origin, Infallible> {
        Ok(Origin::of_request(parts, &App::from_ref(state)))
    }
}

/// Returns the client address behind the given number of our own proxies.
fn client(peer: Option<IpAddr>, forwarded: &[&str], proxies: usize) -> Option<IpAddr> {
    let Some(before_last) = proxies.checked_sub(1) else {
        return peer.map(|ip| ip.to_canonical());
    };
    let entries = forwarded.iter().flat_map(|value| value.split(','));
    let seen: Vec<&str> = entries.map(str::trim).collect();
    let named = seen.iter().rev().nth(before_last);
    let parsed = named.and_then(|text| text.parse::<IpAddr>().ok());
    parsed.or(peer).map(|ip| ip.to_canonical())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the address found for the peer 192.0.2.1.
    fn seen(forwarded: &[&str], proxies: usize) -> String {
        let peer = "192.0.2.1".parse().unwrap();
        client(Some(peer), forwarded, proxies).unwrap().to_string()
    }

    #[test]
    fn only_own_proxies_are_trusted() {
        let forged = ["203.0.113.9, 198.51.100.7"];
        assert_eq!(seen(&forged, 0), "192.0.2.1");
        assert_eq!(seen(&forged, 1), "198.51.100.7");
        let apart = ["203.0.113.9", "198.51.100.7"];
        assert_eq!(seen(&apart, 1), "198.51.100.7");
        assert_eq!(seen(&apart, 2), "203.0.113.9");
        assert_eq!(seen(&[], 1), "192.0.2.1");
        assert_eq!(seen(&["unknown"], 1), "192.0.2.1");
        assert_eq!(seen(&["::ffff:203.0.113.9"], 1), "203.0.113.9");
    }

    #[test]
    fn addresses_of_one_ipv6_network_count_as_one() {
        let of = |text: &str| Origin {
            address: text.parse().ok(),
            ..Origin::default()
        };
        let one = of("2001:db8:1:2::7").network();
        assert_eq!(one, of("2001:db8:1:2:ffff::9").network());
        assert_ne!(one, of("2001:db8:1:3::7").network());
        let site = |text: &str| of(text).site();
        assert_eq!(site("2001:db8:1:2::7"), site("2001:db8:1:3::7"));
        assert_ne!(site("2001:db8:1:2::7"), site("2001:db8:2:2::7"));
        assert_eq!(site("192.0.2.1"), None);
        assert_ne!(of("192.0.2.1").network(), of("192.0.2.2").network());
    }
}
