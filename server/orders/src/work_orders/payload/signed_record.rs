//! Completion of an adjustment, and signatures over its record.

use binnacle_compass::model::Model;
use binnacle_platform::ed25519;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{EntryId, FirmId, KeyId, ModelId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Completion of an adjustment.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = CompletionMade)]
pub(crate) struct Completion {
    /// Time of the adjustment.
    pub at: Time,
    /// The adjuster.
    pub adjuster_name: String,
    /// Licence number.
    pub adjuster_licence: String,
    /// Firm of the adjuster.
    #[schema(required)]
    pub firm: Option<String>,
    /// The adjuster's name, typed as a signature.
    pub signature: String,
    /// SHA-256 of the record, hexadecimal, which a firm's key signs.
    pub record_sha256: String,
    /// Entry of the adjustment in the logbook.
    pub logbook_entry: EntryId,
    /// Predicted model that holds from then on.
    pub model_id: ModelId,
    /// Content of that model.
    #[serde(rename = "model")]
    pub model_after: Model,
}

/// Signature by a firm's key.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = RecordSignature, example = json!({
    "public_key": "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a",
    "signature": "0".repeat(128)
}))]
pub(crate) struct SubmittedSignature {
    /// The Ed25519 public key (RFC 8032), 64 hexadecimal digits.
    #[schema(min_length = 64, max_length = 64)]
    pub public_key: String,
    /// Its signature over the 32 bytes of the record's SHA-256, 128 hexadecimal digits.
    #[schema(min_length = 128, max_length = 128)]
    pub signature: String,
}

/// Signature, with the owner of its key.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RecordedSignature {
    /// The signature.
    #[serde(flatten)]
    pub signature: SubmittedSignature,
    /// Owner of the key; `None` for a key that the order's firm has not registered.
    #[serde(default)]
    pub key: Option<KnownKey>,
}

/// Key that a firm had registered at the time of the signature.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub(crate) struct KnownKey {
    /// The key's id.
    pub id: KeyId,
    /// The firm's name for it.
    pub name: String,
    /// The firm.
    pub firm_id: FirmId,
    /// The firm's name at that time.
    pub firm_name: String,
}

impl SubmittedSignature {
    /// Verifies the signature over this record.
    ///
    /// # Errors
    /// Names the invalid key or signature.
    pub(crate) fn checked(&self, record_sha256: &str) -> Result<()> {
        let key = ed25519::key(&self.public_key)?;
        let record = ed25519::from_hex(record_sha256).unwrap_or_default();
        let called = "the record's SHA-256";
        ed25519::must_be_signed(&key, "signature", &self.signature, &record, called)
    }
}
