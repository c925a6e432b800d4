//! Everything between the socket and the handlers: routes, limits, headers, and
//! the small types that read a request.

mod amended;
mod cross_site;
mod docs;
mod document;
mod file;
mod headers;
mod json;
mod page;
mod routes;

pub use amended::{Amended, never_null};
pub use file::{file, file_name};
pub use json::{
    Id, Json, Params, Valid, ValidOrNone, degrees, is_control, optional_text, text, time,
};
pub use page::{Listed, Page};
pub use routes::{MAX_JSON_BYTES, openapi, router};
