//! Photographs, kept as they were uploaded.
//!
//! Invariants: the type of a file follows from its first bytes, whatever its name. It has a header
//! of that type with a plausible size. It is served as that type and never as a page.

use crate::work_orders::log::canonical_json::sha256_hex;
use crate::work_orders::payload::photograph::Photo;
use binnacle_platform::error::{Error, Result};
use binnacle_platform::http::optional_text;
use binnacle_platform::ids::PhotoId;
use serde::Deserialize;
use utoipa::IntoParams;

/// Largest photograph, bytes.
pub const MAX_BYTES: usize = 10 * 1024 * 1024;
/// Range of a picture's sides, pixels: from the smallest that shows a tray to the largest of a
/// camera.
const SIDE_RANGE_PX: std::ops::RangeInclusive<u32> = 16..=32_768;
/// Most photographs of an order.
pub const MAX_PHOTOS: usize = 40;

/// Caption of a photograph.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Caption {
    /// Short description.
    #[param(max_length = 200)]
    caption: Option<String>,
}

impl Photo {
    /// Validates the bytes of a photograph.
    ///
    /// # Errors
    /// Fails when it is too large, or of an unsupported type.
    pub(crate) fn new(id: PhotoId, bytes: &[u8], caption: &Caption) -> Result<Photo> {
        if bytes.len() > MAX_BYTES {
            return Err(Error::TooLarge(MAX_BYTES));
        }
        let media_type = media_type(bytes).ok_or_else(|| {
            Error::UnsupportedMediaType("a photograph is JPEG, PNG or WebP".to_owned())
        })?;
        let sides = size(media_type, bytes).unwrap_or([0, 0]);
        if !sides.iter().all(|side| SIDE_RANGE_PX.contains(side)) {
            return Err(Error::UnsupportedMediaType(format!(
                "the file begins as {media_type} but is not a complete picture: it is truncated \
                    or damaged"
            )));
        }
        Ok(Photo {
            id,
            sha256: sha256_hex(bytes),
            media_type: media_type.to_owned(),
            bytes: bytes.len(),
            caption: optional_text("caption", caption.caption.as_deref())?,
        })
    }
}

/// Type of a file by its first bytes.
fn media_type(bytes: &[u8]) -> Option<&'static str> {
    let webp = bytes.len() > 12 && bytes.starts_with(b"RIFF") && &bytes[8..12] == b"WEBP";
    match bytes {
        _ if bytes.starts_with(&[0xFF, 0xD8, 0xFF]) => Some("image/jpeg"),
        _ if bytes.starts_with(b"\x89PNG\r\n\x1a\n") => Some("image/png"),
        _ if webp => Some("image/webp"),
        _ => None,
    }
}

/// Width and height by the header; `None` for a truncated file or one without picture data.
fn size(media_type: &str, bytes: &[u8]) -> Option<[u32; 2]> {
    match media_type {
        "image/png" => png(bytes),
        "image/webp" => webp(bytes),
        _ => jpeg(bytes),
    }
}

fn array_at<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at.checked_add(N)?)?.try_into().ok()
}

/// Size of a PNG: `IHDR` comes first, and there is data (PNG, 5.6 and 11.2.1).
fn png(bytes: &[u8]) -> Option<[u32; 2]> {
    let has_data = bytes.windows(4).any(|kind| kind == b"IDAT");
    if array_at::<4>(bytes, 12)? != *b"IHDR" || !has_data {
        return None;
    }
    Some([
        u32::from_be_bytes(array_at(bytes, 16)?),
        u32::from_be_bytes(array_at(bytes, 20)?),
    ])
}

/// Size of a JPEG: segments up to the frame header, followed by a scan (ITU-T T.81, B.2).
fn jpeg(bytes: &[u8]) -> Option<[u32; 2]> {
    let mut at = 2;
    let mut found = None;
    loop {
        let [mark, kind, high, low] = array_at::<4>(bytes, at)?;
        let length = usize::from(u16::from_be_bytes([high, low]));
        match (mark, kind) {
            // Fill bytes before a marker.
            (0xFF, 0xFF) => {
                at += 1;
                continue;
            }
            (0xFF, 0xDA) => return found,
            // Start of frame; C4, C8 and CC are tables.
            (0xFF, 0xC0..=0xCF) if !matches!(kind, 0xC4 | 0xC8 | 0xCC) => {
                let [h1, h0, w1, w0] = array_at::<4>(bytes, at + 5)?;
                let sides = [[w1, w0], [h1, h0]];
                found = Some(sides.map(|side| u32::from(u16::from_be_bytes(side))));
            }
            (0xFF, _) => {}
            _ => return None,
        }
        at += 2 + length.max(2);
    }
}

/// Size of a WebP: lossy, lossless or extended (RFC 9649, 2.4 to 2.7).
fn webp(bytes: &[u8]) -> Option<[u32; 2]> {
    let less_one = |three: [u8; 3]| 1 + u32::from_le_bytes([three[0], three[1], three[2], 0]);
    match &array_at::<4>(bytes, 12)? {
        b"VP8 " => {
            let side = |at| Some(u32::from(u16::from_le_bytes(array_at(bytes, at)?) & 0x3FFF));
            Some([side(26)?, side(28)?])
        }
        b"VP8L" => {
            let packed = u32::from_le_bytes(array_at(bytes, 21)?);
            Some([1 + (packed & 0x3FFF), 1 + ((packed >> 14) & 0x3FFF)])
        }
        b"VP8X" => Some([
            less_one(array_at(bytes, 24)?),
            less_one(array_at(bytes, 27)?),
        ]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_a_header_and_a_size() {
        let jpeg = [
            0xFF, 0xD8, 0xFF, 0xE0, 0, 4, 0, 0, 0xFF, 0xC0, 0, 11, 8, 0x02, 0x58, 0x03, 0x20, 1, 1,
            0x11, 0, 0xFF, 0xDA, 0, 8,
        ];
        assert_eq!(size("image/jpeg", &jpeg), Some([800, 600]));
        assert_eq!(size("image/jpeg", &jpeg[..20]), None);
        assert_eq!(size("image/jpeg", &[0xFF, 0xD8, 0xFF, 0xE0]), None);
        let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
        assert_eq!(size("image/png", &png), None, "its first bytes alone");
        png.extend(b"\0\0\0\rIHDR\0\0\x03\x20\0\0\x02\x58\x08\x02\0\0\0crc.");
        assert_eq!(size("image/png", &png), None, "without data");
        png.extend(b"\0\0\0\x01IDATx");
        assert_eq!(size("image/png", &png), Some([800, 600]));
        let webp = b"RIFF\0\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\x1f\x03\0\x57\x02\0";
        assert_eq!(size("image/webp", webp), Some([800, 600]));
        assert_eq!(size("image/webp", &webp[..20]), None);
    }

    #[test]
    fn a_page_is_no_photograph_whatever_it_is_called() {
        assert_eq!(media_type(b"<html><script>"), None);
        assert_eq!(media_type(b"<svg onload=x>"), None);
        assert_eq!(media_type(b""), None);
        assert_eq!(media_type(b"RIFF0000WEBPVP8 "), Some("image/webp"));
        assert_eq!(media_type(&[0xFF, 0xD8, 0xFF, 0xE0]), Some("image/jpeg"));
    }
}
