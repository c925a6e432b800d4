//! Right to alter what the agent has: by the PIN, or where none is set, by being at the agent's own
//! computer.

use super::throttle::Throttle;
use crate::config::Pin;
use std::net::IpAddr;
use tokio::sync::Mutex;
use tokio::time::Instant;

/// Guard of the actions that alter something.
#[derive(Debug)]
pub(crate) struct PinGuard {
    pin: Option<Pin>,
    /// Held while a PIN is compared: one at a time costs no more memory than one.
    throttle: Mutex<Throttle>,
}

/// Reason to refuse an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Unauthorised {
    /// No PIN is set, and the request comes over the network.
    #[error("no PIN is set for this page: changes are accepted on the agent's own computer alone")]
    NotHere,
    /// A PIN is set, and the request has none.
    #[error("this needs the PIN of this page")]
    Missing,
    /// The PIN is not the right one.
    #[error("the PIN is wrong")]
    Wrong,
    /// There were too many wrong ones.
    #[error("too many wrong PINs: wait a minute")]
    Throttled,
}

impl PinGuard {
    /// Guards by this PIN.
    pub(crate) fn new(pin: Option<Pin>, now: Instant) -> PinGuard {
        PinGuard {
            pin,
            throttle: Mutex::new(Throttle::new(now)),
        }
    }

    /// Returns whether a PIN is set.
    pub(super) fn has_pin(&self) -> bool {
        self.pin.is_some()
    }

    /// Returns whether an address may alter something, at the most with the PIN.
    pub(super) fn is_open_to(&self, address: IpAddr) -> bool {
        self.has_pin() || address.to_canonical().is_loopback()
    }

    /// Checks the PIN that came from an address.
    pub(super) async fn check(
        &self,
        address: IpAddr,
        typed: Option<String>,
        now: Instant,
    ) -> Result<(), Unauthorised> {
        let Some(pin) = &self.pin else {
            let is_here = self.is_open_to(address);
            return if is_here {
                Ok(())
            } else {
                Err(Unauthorised::NotHere)
            };
        };
        let typed = typed.ok_or(Unauthorised::Missing)?;
        let mut throttle = self.throttle.lock().await;
        if !throttle.allows(address, now) {
            return Err(Unauthorised::Throttled);
        }
        let pin = pin.clone();
        let compared = tokio::task::spawn_blocking(move || pin.matches(&typed));
        // A comparison that failed proves nothing.
        if compared.await.unwrap_or(false) {
            throttle.forgive(address);
            return Ok(());
        }
        throttle.count_wrong(address, now);
        Err(Unauthorised::Wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::LOCALHOST);
    const THERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(192, 168, 1, 9));

    #[tokio::test]
    async fn without_a_pin_only_the_own_computer_may_alter_something() {
        let now = Instant::now();
        let guard = PinGuard::new(None, now);
        for here in [
            HERE,
            "::1".parse().unwrap(),
            "::ffff:127.0.0.1".parse().unwrap(),
        ] {
            assert_eq!(guard.check(here, None, now).await, Ok(()));
        }
        let typed = Some("271828".to_owned());
        let refused = guard.check(THERE, typed, now).await;
        assert_eq!(refused, Err(Unauthorised::NotHere));
    }

    #[tokio::test]
    async fn with_a_pin_nobody_else_may_and_guesses_are_throttled() {
        let now = Instant::now();
        let guard = PinGuard::new(Pin::hash("271828").ok(), now);
        let check = async |typed: &str| guard.check(THERE, Some(typed.to_owned()), now).await;
        assert_eq!(
            guard.check(HERE, None, now).await,
            Err(Unauthorised::Missing)
        );
        assert_eq!(check("271828").await, Ok(()));
        for _ in 0..5 {
            assert_eq!(check("000000").await, Err(Unauthorised::Wrong));
        }
        assert_eq!(check("271828").await, Err(Unauthorised::Throttled));
    }
}
