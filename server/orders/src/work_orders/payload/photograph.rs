//! Photograph of an order.

use binnacle_platform::ids::PhotoId;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Photograph of an order.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = OrderPhoto)]
pub(crate) struct Photo {
    /// Its id.
    #[serde(rename = "photo")]
    pub id: PhotoId,
    /// SHA-256, hexadecimal.
    pub sha256: String,
    /// `image/jpeg`, `image/png` or `image/webp`.
    pub media_type: String,
    /// Size, bytes.
    pub bytes: usize,
    /// Caption.
    #[schema(required)]
    pub caption: Option<String>,
}

impl Photo {
    /// File name in the archive, by the number of the entry.
    pub(crate) fn file(&self, seq: i64) -> String {
        let ending = self.media_type.rsplit('/').next().unwrap_or("bin");
        format!("photos/{seq:04}.{ending}")
    }
}
