//! Signing in and out; one's sessions and password.
//!
//! Invariants: a session's token is stored only as a hash; it ends when its time
//! is over, when it was idle for long, when it is ended, and when the password changes
//! under another session. What a failed sign-in answers, and how long that takes, does
//! not tell whether there is such a user.

pub mod cookie;
mod credentials;
mod store;
pub mod throttle;
mod user;

pub(crate) use credentials::check_password;
pub use credentials::{open, prove};
pub(crate) use store::{Session, end, list};
pub use store::{create_user, end_all, find_user, lasts, name_of, set_password};
pub(crate) use user::user_sql;
pub use user::{Role, User, normal_email};
