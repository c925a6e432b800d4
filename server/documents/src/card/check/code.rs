//! Code on a printed card, by which anyone who holds the card can check it.
//!
//! It has what the card says, and the server's signature over that (Ed25519, RFC 8032). So nobody
//! else makes a code for other figures, and the server need not keep the cards that it draws.

use binnacle_compass::ship::EarthField;
use binnacle_compass::time::Timestamp;
use binnacle_platform::db::{self, Db};
use binnacle_platform::ed25519::{from_hex, to_hex};
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::secret::{base64url, from_base64url};
use binnacle_platform::signing_keys::{self, Seal, ServerKey};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};

/// Text before the content of each code: a signature over a card is none over anything else.
const SIGNED_AS: &[u8] = b"binnacle deviation card 1\n";
const SIGNATURE_BYTES: usize = 64;

/// Content of a printed card, as its code has it (postcard 1.0).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::card) struct CardContent {
    pub(in crate::card) vessel: VesselId,
    pub(in crate::card) compass: CompassId,
    /// Version of the model behind it.
    pub(in crate::card) version: i64,
    /// Start of the model's epoch, microseconds since 1970; none where no change began it.
    pub(in crate::card) epoch_from_us: Option<i64>,
    /// Time that the card is for, microseconds since 1970.
    pub(in crate::card) at_us: i64,
    /// Horizontal field at the card's place, nT.
    pub(in crate::card) h_nt: u32,
    /// Vertical field there, nT, down positive.
    pub(in crate::card) z_nt: i32,
    /// Deviation by compass heading from 0, each 15°, tenths of a degree, east positive.
    pub(in crate::card) deviation_tenths: Vec<i16>,
}

impl CardContent {
    /// Returns the code of a card with this content.
    ///
    /// # Errors
    /// Fails when the content cannot be encoded.
    pub(in crate::card) fn code(&self, key: &ServerKey) -> Result<String, postcard::Error> {
        let content = postcard::to_allocvec(self)?;
        let signature = from_hex(&key.sign(&signed(&content)).signature);
        Ok(base64url(
            &[content, signature.unwrap_or_default()].concat(),
        ))
    }

    /// Reads a code that one of the server's keys signed; none if it is anything else.
    pub(super) async fn read(db: &Db, code: &str) -> db::Result<Option<CardContent>> {
        let Some((content, signature)) = parts(code) else {
            return Ok(None);
        };
        let signature = to_hex(&signature);
        let is_signed = signing_keys::list(db).await?.into_iter().any(|key| {
            let seal = Seal {
                key: key.public_key,
                signature: signature.clone(),
            };
            seal.check(&signed(&content), "the card").is_ok()
        });
        Ok(if is_signed {
            postcard::from_bytes(&content).ok()
        } else {
            None
        })
    }

    pub(super) fn at(&self) -> Option<Time> {
        time(self.at_us)
    }

    pub(super) fn epoch_from(&self) -> Option<Time> {
        time(self.epoch_from_us?)
    }

    pub(super) fn earth(&self) -> EarthField {
        EarthField {
            h_nt: f64::from(self.h_nt),
            z_nt: f64::from(self.z_nt),
        }
    }
}

fn time(micros: i64) -> Option<Time> {
    Timestamp::from_micros(micros).ok().map(Time)
}

/// Divides a code into content and signature.
fn parts(code: &str) -> Option<(Vec<u8>, Vec<u8>)> {
    let mut content = from_base64url(code)?;
    let signature = content.split_off(content.len().checked_sub(SIGNATURE_BYTES)?);
    Some((content, signature))
}

fn signed(content: &[u8]) -> Vec<u8> {
    [SIGNED_AS, content].concat()
}
