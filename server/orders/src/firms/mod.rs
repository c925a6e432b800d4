//! Firms that adjust compasses, and the operators they work for.
//!
//! Invariant: an operator sees the firms that work for it, a firm sees itself, and a platform
//! admin, who connects them, sees all.

mod capacity;
mod engaged;
mod firm_api;
pub(crate) mod keys;
mod port_names;
mod store;
mod taken;
mod teams;
mod terms;
mod terms_api;

pub use capacity::{Requester, require_capacity};
pub use engaged::{EngagedFirm, of_operator};
pub use firm_api::QUOTA;
pub use port_names::named_port;
pub use store::{create, engage, exists, find_name};
pub use taken::{StoredBooking, Visit, list_bookings, teams_taken};
pub use terms::{Terms, TermsChanged, find_terms};

use axum::extract::FromRef;
use binnacle_platform::app::App;
use utoipa_axum::router::OpenApiRouter;

/// Routes of firms, their terms, teams and keys.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    firm_api::router()
        .merge(terms_api::router())
        .merge(teams::router())
        .merge(keys::router())
}
