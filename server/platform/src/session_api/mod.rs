//! API of the signed-in user: signing in and out, sessions, password, second factor, tokens.

mod my_sessions;
mod second_factor;
mod sign_in;
mod tokens;

use crate::app::App;
use axum::extract::FromRef;
use utoipa_axum::router::OpenApiRouter;

/// Routes of the signed-in user.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .merge(sign_in::router())
        .merge(my_sessions::router())
        .merge(second_factor::router())
        .merge(tokens::router())
}
