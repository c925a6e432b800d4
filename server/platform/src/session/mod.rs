//! Sessions, users and password checks.
//!
//! Invariants: a session's token is stored only as a hash. A session ends when it expires, is
//! idle for too long, or is ended, and when the password is changed in another session. Neither
//! the response to a failed sign-in nor its duration reveals whether the user exists.

pub mod cookie;
mod credentials;
mod device;
mod store;
pub mod throttle;
mod user;

pub(crate) use credentials::check_password;
pub use credentials::{confirm_password, open};
pub use device::Visitor;
pub(crate) use device::forget_all as forget_devices;
pub(crate) use store::{Session, end, list};
pub use store::{create_user, end_all, find_user, is_valid, name_of, set_password};
pub(crate) use user::user_sql;
pub use user::{Role, User, normal_email};
