//! HTTP kit: limits, headers, and the small types that read a request.

mod amended;
pub mod cross_site;
mod file;
pub mod headers;
pub mod host;
mod json;
mod page;
mod rejections;
pub mod spreadsheet;
mod version;

pub use amended::{Amended, never_null};
pub use file::{FileContent, FileName, file};
pub use json::{
    Id, Json, MAX_TEXT, Params, Valid, ValidOrNone, degrees, is_control, optional_text, remark,
    text, time, unknown_name,
};
pub use page::{Listed, Page, Period};
pub use version::{IfMatch, Version, Versioned};

/// Largest JSON body, bytes.
pub const MAX_JSON_BYTES: usize = 64 * 1024;
