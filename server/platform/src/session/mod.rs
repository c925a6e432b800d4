//! Signing in and out; one's sessions and password.
//!
//! Invariants: a session's token is stored only as a hash; it ends when its time
//! is over, when it was idle for long, when it is ended, and when the password changes
//! under another session. What a failed sign-in answers, and how long that takes, does
//! not tell whether there is such a user.

pub mod cookie;
mod own;
mod sign_in;
mod store;
pub mod throttle;
mod user;

pub use own::end_all;
pub use sign_in::{open, prove};
pub use store::{create_user, find_user, lasts, name_of, set_password};
pub(crate) use user::user_sql;
pub use user::{Role, User, normal_email};

use crate::app::App;
use axum::extract::FromRef;
use utoipa_axum::router::OpenApiRouter;

/// The routes of this part.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .merge(sign_in::router())
        .merge(own::router())
}
