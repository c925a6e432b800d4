//! Public addresses: the only ones that users may make the server call. Hosts of its own
//! network must not be reachable through it.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr};

/// Checks whether an address belongs to the public internet (IANA special-purpose address
/// registries, RFC 6890).
pub fn is_public(address: IpAddr) -> bool {
    match address {
        IpAddr::V4(address) => is_public_v4(address),
        IpAddr::V6(address) => match address.to_ipv4_mapped() {
            Some(mapped) => is_public_v4(mapped),
            None => is_public_v6(address),
        },
    }
}

/// Checks whether a name may belong to the public internet, as far as it shows: it has several labels,
/// and none of the ends that are reserved for a machine or its network (RFC 6761, section 6; RFC
/// 6762, section 3; RFC 8375; ICANN resolution 2024.07.29.06).
pub(super) fn may_be_public(name: &str) -> bool {
    const LOCAL: &[&str] = &[
        "localhost",
        "local",
        "internal",
        "test",
        "invalid",
        "home.arpa",
    ];
    let name = name.trim_end_matches('.').to_ascii_lowercase();
    let ends_locally = |end: &&str| {
        let before = name.strip_suffix(*end);
        before.is_some_and(|before| before.is_empty() || before.ends_with('.'))
    };
    name.contains('.') && !LOCAL.iter().any(ends_locally)
}

fn is_public_v4(address: Ipv4Addr) -> bool {
    let [a, b, c, _] = u32::from(address).to_be_bytes();
    let special = matches!(
        (a, b, c),
        (0 | 10 | 127 | 224.., _, _)       // this network, private, loopback, multicast and up
            | (100, 64..=127, _)           // shared by carriers
            | (169, 254, _)                // link-local
            | (172, 16..=31, _)            // private
            | (192, 168, _)                // private
            | (192, 0, 0 | 2)              // protocol assignments, documentation
            | (192, 88, 99)                // 6to4 relays
            | (198, 18..=19, _)            // benchmarks
            | (198, 51, 100)               // documentation
            | (203, 0, 113) // documentation
    );
    !special
}

/// Checks for global unicast 2000::/3, without the ranges that embed other addresses or are
/// reserved.
fn is_public_v6(address: Ipv6Addr) -> bool {
    let [a, b, ..] = address.segments();
    let special = a == 0x2002                      // 6to4
        || (a == 0x2001 && b < 0x0200)             // protocol assignments, Teredo
        || (a == 0x2001 && b == 0x0db8)            // documentation
        || (a == 0x3fff && b < 0x1000); // documentation
    (0x2000..0x4000).contains(&a) && !special
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_public_internet_is_public() {
        for public in [
            "1.1.1.1",
            "172.32.0.1",
            "100.128.0.1",
            "2606:4700::1111",
            "::ffff:8.8.8.8",
        ] {
            assert!(is_public(public.parse().unwrap()), "{public}");
        }
        for private in [
            "0.0.0.0",
            "10.1.2.3",
            "100.64.0.1",
            "127.0.0.1",
            "127.9.9.9",
            "169.254.169.254",
            "172.16.0.1",
            "172.31.255.255",
            "192.0.0.1",
            "192.0.2.1",
            "192.168.1.1",
            "198.18.0.1",
            "203.0.113.9",
            "224.0.0.1",
            "255.255.255.255",
            "::",
            "::1",
            "::ffff:127.0.0.1",
            "::ffff:10.0.0.1",
            "::127.0.0.1",
            "64:ff9b::7f00:1",
            "2001::1",
            "2001:db8::1",
            "2002:7f00:1::",
            "fc00::1",
            "fd12::1",
            "fe80::1",
            "ff02::1",
        ] {
            assert!(!is_public(private.parse().unwrap()), "{private}");
        }
    }
}
