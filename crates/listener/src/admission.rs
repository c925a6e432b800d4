//! Places for connections: in total, and for each network.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Leading bits of an IPv6 address that count: a /56.
const IPV6_BITS: u32 = 56;

/// Addresses that one subscriber holds: an IPv4 address, or an IPv6 /56.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Network(IpAddr);

impl Network {
    fn of(address: IpAddr) -> Network {
        match address.to_canonical() {
            IpAddr::V6(ip) => {
                let mask = u128::MAX << (u128::BITS - IPV6_BITS);
                Network(IpAddr::V6((ip.to_bits() & mask).into()))
            }
            ipv4 @ IpAddr::V4(_) => Network(ipv4),
        }
    }
}

/// Places that are left.
#[derive(Debug)]
pub(crate) struct Admission {
    places: Arc<Semaphore>,
    networks: Option<Networks>,
}

/// Connections of each network.
#[derive(Clone, Debug)]
struct Networks {
    limit: usize,
    open: Arc<Mutex<HashMap<Network, usize>>>,
}

/// Place of one connection, free again when it is dropped.
#[derive(Debug)]
pub(crate) struct Place {
    _place: OwnedSemaphorePermit,
    _network: Option<NetworkPlace>,
}

#[derive(Debug)]
struct NetworkPlace {
    network: Network,
    networks: Networks,
}

impl Admission {
    pub(crate) fn new(connections: usize, per_network: Option<usize>) -> Admission {
        Admission {
            places: Arc::new(Semaphore::new(connections.min(Semaphore::MAX_PERMITS))),
            networks: per_network.map(|limit| Networks {
                limit,
                open: Arc::default(),
            }),
        }
    }

    /// Returns whether no place is left.
    pub(crate) fn is_full(&self) -> bool {
        self.places.available_permits() == 0
    }

    /// Waits for a place.
    pub(crate) async fn wait(&self) -> OwnedSemaphorePermit {
        let place = self.places.clone().acquire_owned().await;
        place.expect("the semaphore is never closed")
    }

    /// Gives a place to a connection, unless its network has too many.
    pub(crate) fn admit(&self, place: OwnedSemaphorePermit, peer: IpAddr) -> Option<Place> {
        let network = match &self.networks {
            Some(networks) => Some(networks.enter(Network::of(peer))?),
            None => None,
        };
        Some(Place {
            _place: place,
            _network: network,
        })
    }
}

impl Networks {
    fn enter(&self, network: Network) -> Option<NetworkPlace> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let count = open.entry(network).or_default();
        if *count >= self.limit {
            return None;
        }
        *count += 1;
        Some(NetworkPlace {
            network,
            networks: self.clone(),
        })
    }
}

impl Drop for NetworkPlace {
    fn drop(&mut self) {
        let open = &self.networks.open;
        let mut open = open.lock().unwrap_or_else(PoisonError::into_inner);
        if let Entry::Occupied(mut entry) = open.entry(self.network) {
            *entry.get_mut() -= 1;
            if *entry.get() == 0 {
                entry.remove();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    async fn admit(admission: &Admission, peer: &str) -> Option<Place> {
        admission.admit(admission.wait().await, peer.parse().unwrap())
    }

    #[tokio::test]
    async fn a_network_has_its_number_of_places_and_gets_them_back() {
        let admission = Admission::new(16, Some(2));
        let first = admit(&admission, "192.0.2.1").await.unwrap();
        let _second = admit(&admission, "::ffff:192.0.2.1").await.unwrap();
        assert!(admit(&admission, "192.0.2.1").await.is_none());
        assert!(admit(&admission, "192.0.2.2").await.is_some());
        drop(first);
        assert!(admit(&admission, "192.0.2.1").await.is_some());
    }

    #[tokio::test]
    async fn an_ipv6_56_is_one_network() {
        let admission = Admission::new(16, Some(1));
        let _first = admit(&admission, "2001:db8:1:2200::7").await.unwrap();
        assert!(admit(&admission, "2001:db8:1:22ff:9::1").await.is_none());
        assert!(admit(&admission, "2001:db8:1:2300::7").await.is_some());
    }

    #[tokio::test]
    async fn a_refused_connection_takes_no_place_and_nothing_is_remembered_of_it() {
        let admission = Admission::new(2, Some(1));
        let held = admit(&admission, "192.0.2.1").await.unwrap();
        for _ in 0..5 {
            assert!(admit(&admission, "192.0.2.1").await.is_none());
        }
        assert!(!admission.is_full());
        drop(held);
        assert_eq!(admission.places.available_permits(), 2);
        let networks = admission.networks.unwrap();
        assert!(networks.open.lock().unwrap().is_empty());
    }
}
