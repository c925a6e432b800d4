//! Firms that adjust compasses, and the operators they work for.
//!
//! Invariant: an operator sees the firms that work for it, a firm sees itself, and a platform
//! admin, who connects them, sees all.

mod capacity;
mod firm_api;
pub(crate) mod keys;

mod store;
mod terms;

pub use capacity::{
    Booking, Requester, Visit, bookings, named_port, require_capacity, teams_taken,
};
pub use store::{create, engage, exists, find_name};
pub use terms::{Terms, TermsChanged, find_terms, of_operator};

use axum::extract::FromRef;
use binnacle_platform::app::App;
use utoipa_axum::router::OpenApiRouter;

/// Routes of firms, their terms and their keys.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    firm_api::router()
        .merge(terms::router())
        .merge(keys::router())
}
