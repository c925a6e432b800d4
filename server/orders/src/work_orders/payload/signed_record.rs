//! Completion of an adjustment, and signatures over its record.

use binnacle_compass::model::Model;
use binnacle_platform::ed25519;
use binnacle_platform::error::Result;
use binnacle_platform::ids::{EntryId, FirmId, KeyId, ModelId};
use binnacle_platform::time::Time;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A completion as the log has it.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = CompletionMade)]
pub(crate) struct Completion {
    /// The moment of the adjustment.
    pub at: Time,
    /// The adjuster.
    pub adjuster_name: String,
    /// The number of their licence.
    pub adjuster_licence: String,
    /// Their firm.
    #[schema(required)]
    pub firm: Option<String>,
    /// Their name, typed as a signature.
    pub signature: String,
    /// SHA-256 of the record, hexadecimal: what a firm's key signs.
    pub record_sha256: String,
    /// The logbook's entry of the adjustment.
    pub logbook_entry: EntryId,
    /// The model that holds from then on, foretold.
    pub model_id: ModelId,
    /// The same, whole.
    #[serde(rename = "model")]
    #[schema(value_type = binnacle_fleet::models::ModelSchema)]
    pub model_after: Model,
}

/// A signature by a firm's key.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = RecordSignature)]
pub(crate) struct SubmittedSignature {
    /// The Ed25519 public key (RFC 8032), 64 hexadecimal digits.
    #[schema(min_length = 64, max_length = 64)]
    pub public_key: String,
    /// Its signature over the 32 octets of the record's SHA-256, 128 hexadecimal digits.
    #[schema(min_length = 128, max_length = 128)]
    pub signature: String,
}

/// A signature with what is known of its key.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RecordedSignature {
    /// The signature.
    #[serde(flatten)]
    pub signed: SubmittedSignature,
    /// Whose key it is; none for a key that the order's firm has not registered.
    #[serde(default)]
    pub key: Option<KnownKey>,
}

/// A key that a firm had registered when it signed.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub(crate) struct KnownKey {
    /// The key's id.
    pub id: KeyId,
    /// What the firm calls it.
    pub name: String,
    /// The firm.
    pub firm_id: FirmId,
    /// The firm's name then.
    pub firm_name: String,
}

impl SubmittedSignature {
    /// Whether the key signed this record.
    ///
    /// # Errors
    /// Names what is no key or no signature, or does not fit.
    pub(crate) fn checked(&self, record_sha256: &str) -> Result<()> {
        let key = ed25519::key(&self.public_key)?;
        let record = ed25519::from_hex(record_sha256).unwrap_or_default();
        let signature = ("signature", self.signature.as_str());
        ed25519::must_be_signed(&key, signature, &record, "the record's SHA-256")
    }
}
