//! Throttle of wrong PINs: for each address, and for all of them, since a network has many.

use std::collections::HashMap;
use std::net::IpAddr;
use std::time::Duration;
use tokio::time::Instant;

/// Wrong PINs that an address may send at once, and all addresses together.
const OF_ADDRESS: f64 = 5.0;
const OF_ALL: f64 = 20.0;
/// Time after which one more may be sent.
const FORGIVEN_AFTER: Duration = Duration::from_mins(1);

/// Wrong PINs of late.
#[derive(Debug)]
pub(super) struct Throttle {
    of_address: HashMap<IpAddr, Count>,
    of_all: Count,
}

#[derive(Clone, Copy, Debug)]
struct Count {
    wrong: f64,
    at: Instant,
}

impl Count {
    fn at(now: Instant) -> Count {
        Count {
            wrong: 0.0,
            at: now,
        }
    }

    fn wrong(self, now: Instant) -> f64 {
        let forgiven = (now - self.at).as_secs_f64() / FORGIVEN_AFTER.as_secs_f64();
        (self.wrong - forgiven).max(0.0)
    }

    fn add(&mut self, now: Instant) {
        self.wrong = self.wrong(now) + 1.0;
        self.at = now;
    }
}

impl Throttle {
    pub(super) fn new(now: Instant) -> Throttle {
        Throttle {
            of_address: HashMap::new(),
            of_all: Count::at(now),
        }
    }

    /// Returns whether a PIN from this address may be tried.
    pub(super) fn allows(&self, address: IpAddr, now: Instant) -> bool {
        let known = self.of_address.get(&address);
        let of_address = known.map_or(0.0, |count| count.wrong(now));
        of_address <= OF_ADDRESS - 1.0 && self.of_all.wrong(now) <= OF_ALL - 1.0
    }

    /// Counts a wrong PIN.
    pub(super) fn count_wrong(&mut self, address: IpAddr, now: Instant) {
        self.of_address.retain(|_, count| count.wrong(now) > 0.0);
        let known = self.of_address.entry(address);
        known.or_insert(Count::at(now)).add(now);
        self.of_all.add(now);
    }

    /// Forgets the wrong PINs of an address that then sent the right one.
    pub(super) fn forgive(&mut self, address: IpAddr) {
        self.of_address.remove(&address);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(last: u8) -> IpAddr {
        [192, 168, 1, last].into()
    }

    #[test]
    fn after_five_wrong_ones_an_address_has_one_a_minute() {
        let start = Instant::now();
        let mut throttle = Throttle::new(start);
        for _ in 0..5 {
            assert!(throttle.allows(address(9), start));
            throttle.count_wrong(address(9), start);
        }
        assert!(!throttle.allows(address(9), start));
        assert!(throttle.allows(address(8), start));
        let minute = start + FORGIVEN_AFTER;
        assert!(throttle.allows(address(9), minute));
        throttle.count_wrong(address(9), minute);
        assert!(!throttle.allows(address(9), minute));
        throttle.forgive(address(9));
        assert!(throttle.allows(address(9), minute));
    }

    #[test]
    fn many_addresses_have_twenty_wrong_ones_together() {
        let start = Instant::now();
        let mut throttle = Throttle::new(start);
        let allowed = (0..200).filter(|last| {
            let allowed = throttle.allows(address(*last), start);
            if allowed {
                throttle.count_wrong(address(*last), start);
            }
            allowed
        });
        assert_eq!(allowed.count(), 20);
        assert_eq!(throttle.of_address.len(), 20);
        let day = start + Duration::from_hours(24);
        throttle.count_wrong(address(1), day);
        assert_eq!(throttle.of_address.len(), 1);
    }
}
