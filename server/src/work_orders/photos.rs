//! Photographs: what was seen, kept as it came.
//!
//! What always holds: the kind of a file is told by its first octets, whatever it is
//! called; it is given out as that kind and never as a page.

use super::entry::sha256_hex;
use crate::error::{Error, Result};
use crate::http::optional_text;
use crate::ids::PhotoId;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// A photograph is not larger.
pub const MAX_BYTES: usize = 10 * 1024 * 1024;
/// So many belong to an order at most.
pub const MOST: usize = 40;

/// A photograph as the log has it.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = OrderPhoto)]
pub struct PhotoTaken {
    /// Its id.
    pub photo: PhotoId,
    /// SHA-256, hexadecimal.
    pub sha256: String,
    /// `image/jpeg`, `image/png` or `image/webp`.
    pub media_type: String,
    /// How large it is.
    pub bytes: usize,
    /// What it shows.
    #[schema(required)]
    pub caption: Option<String>,
}

/// What a photograph shows.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Caption {
    /// In a few words.
    #[param(max_length = 200)]
    caption: Option<String>,
}

impl PhotoTaken {
    /// A photograph of this id.
    ///
    /// # Errors
    /// When it is too large, or of no kind that is taken.
    pub fn new(id: PhotoId, bytes: &[u8], caption: &Caption) -> Result<PhotoTaken> {
        if bytes.len() > MAX_BYTES {
            return Err(Error::TooLarge(MAX_BYTES));
        }
        let media_type = media_type(bytes).ok_or_else(|| {
            Error::UnsupportedMediaType("a photograph is JPEG, PNG or WebP".to_owned())
        })?;
        Ok(PhotoTaken {
            photo: id,
            sha256: sha256_hex(bytes),
            media_type: media_type.to_owned(),
            bytes: bytes.len(),
            caption: optional_text("caption", caption.caption.as_deref())?,
        })
    }

    /// Its name in the archive, after the number of its entry.
    pub fn file(&self, seq: i64) -> String {
        let ending = self.media_type.rsplit('/').next().unwrap_or("bin");
        format!("photos/{seq:04}.{ending}")
    }
}

/// The kind of a file by its first octets.
fn media_type(bytes: &[u8]) -> Option<&'static str> {
    let webp = bytes.len() > 12 && bytes.starts_with(b"RIFF") && &bytes[8..12] == b"WEBP";
    match bytes {
        _ if bytes.starts_with(&[0xFF, 0xD8, 0xFF]) => Some("image/jpeg"),
        _ if bytes.starts_with(b"\x89PNG\r\n\x1a\n") => Some("image/png"),
        _ if webp => Some("image/webp"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_no_photograph_whatever_it_is_called() {
        assert_eq!(media_type(b"<html><script>"), None);
        assert_eq!(media_type(b"<svg onload=x>"), None);
        assert_eq!(media_type(b""), None);
        assert_eq!(media_type(b"RIFF0000WEBPVP8 "), Some("image/webp"));
        assert_eq!(media_type(&[0xFF, 0xD8, 0xFF, 0xE0]), Some("image/jpeg"));
    }
}
