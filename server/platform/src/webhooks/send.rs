//! Signed delivery over HTTP.
//!
//! Invariants: a message goes only to an address that was checked, see [`crate::outbound`].
//! Nothing of the response is read but its status.

use super::store;
use crate::app::App;
use crate::outbound::{Reach, check_url, client};
use crate::outbox::{Attempt, Carrier, Channel, Claimed};
use anyhow::Context;
use hmac::{Hmac, KeyInit, Mac};
use reqwest::Client;
use sha2::Sha256;
use std::fmt::Write;

/// Header with time and signature.
pub const SIGNATURE_HEADER: &str = "Binnacle-Signature";

/// Sender of webhook messages.
#[derive(Clone, Debug)]
pub struct Sender {
    client: Client,
    reach: Reach,
}

impl Sender {
    /// Creates a sender without any connection.
    ///
    /// # Errors
    /// Fails when this machine has no root certificates.
    pub fn new(reach: Reach) -> anyhow::Result<Sender> {
        let client = client(reach)?;
        Ok(Sender { client, reach })
    }

    /// Sends a body and returns the status of the response.
    async fn send(
        &self,
        url: &str,
        secret: &str,
        seconds: i64,
        body: String,
    ) -> anyhow::Result<u16> {
        let url = check_url(url, self.reach)?;
        let request = self
            .client
            .post(url)
            .header("content-type", "application/json")
            .header(SIGNATURE_HEADER, signature(secret, seconds, &body))
            .body(body);
        // An address may contain a secret of the receiver, so no error message quotes it.
        let response = request.send().await.map_err(reqwest::Error::without_url)?;
        Ok(response.status().as_u16())
    }
}

impl Carrier for Sender {
    const CHANNEL: Channel = Channel::Webhook;

    async fn carry(&self, app: &App, claimed: &Claimed) -> anyhow::Result<Attempt> {
        let found = store::address(&app.db, claimed.receiver_id).await?;
        let to = found.context("the webhook was removed")?;
        let seconds = app.clock.now().micros() / 1_000_000;
        let public_url = app.config.mail.public_url.as_deref();
        let body = to.format.body(&claimed.body, public_url)?;
        Ok(match self.send(&to.url, &to.secret, seconds, body).await? {
            status @ 200..=299 => Attempt::Accepted(status),
            // The receiver may still be repaired, so no failure is permanent.
            status => Attempt::Deferred(status, format!("responded with status {status}")),
        })
    }
}

/// Returns the signature `t=SECONDS,v1=HEX`: HMAC-SHA-256 with the secret over the seconds
/// since 1970, a full stop and the body.
fn signature(secret: &str, seconds: i64, body: &str) -> String {
    let mut mac =
        Hmac::<Sha256>::new_from_slice(secret.as_bytes()).expect("HMAC takes a key of any length");
    mac.update(format!("{seconds}.").as_bytes());
    mac.update(body.as_bytes());
    let mut text = format!("t={seconds},v1=");
    for byte in mac.finalize().into_bytes() {
        write!(text, "{byte:02x}").expect("a String takes every write");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_signature_is_the_documented_one() {
        // printf '1763708400.{"kind":"test"}' | openssl dgst -sha256 -hmac bns_example
        assert_eq!(
            signature("bns_example", 1_763_708_400, r#"{"kind":"test"}"#),
            "t=1763708400,v1=d7c3aea61ac998a67c5f8131cdecbae128ce220c13266516a1068f0f2a7e974b"
        );
    }
}
