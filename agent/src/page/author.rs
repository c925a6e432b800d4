//! Authors of requests: their address, their right to alter something, and the record of it.

use super::pin_guard::Unauthorised;
use super::request_guard::{Refusal, require_guard_header};
use super::state::PageState;
use axum::extract::{ConnectInfo, FromRequestParts};
use axum::http::StatusCode;
use axum::http::header::WWW_AUTHENTICATE;
use axum::http::request::Parts;
use axum::response::{IntoResponse, Response};
use std::net::{IpAddr, SocketAddr};
use tokio::time::Instant;

/// Header with the PIN.
pub(super) const PIN_HEADER: &str = "x-binnacle-pin";

/// Author of a request of this page, and of no other site.
#[derive(Clone, Copy, Debug)]
pub(super) struct Visitor {
    pub(super) address: IpAddr,
}

/// Author of a request who may alter something.
#[derive(Clone, Copy, Debug)]
pub(super) struct Author(Visitor);

impl Visitor {
    /// Records what an author did, or tried to do, for the page and for `actions`.
    pub(super) async fn record(self, page: &PageState, action: &str, result: &str) {
        let address = self.address.to_string();
        let recorded = page
            .spool
            .record_action(page.now(), &address, action, result);
        if let Err(error) = recorded.await {
            tracing::error!(%error, action, "an action on the page cannot be recorded");
        }
    }
}

impl Author {
    /// Records an action with its result, which it returns.
    pub(super) async fn record<T>(
        self,
        page: &PageState,
        action: &str,
        result: Result<T, Refusal>,
    ) -> Result<T, Refusal> {
        let said = match &result {
            Ok(_) => "done",
            Err((_, why)) => why,
        };
        self.0.record(page, action, said).await;
        result
    }
}

impl FromRequestParts<PageState> for Visitor {
    type Rejection = Response;

    async fn from_request_parts(parts: &mut Parts, page: &PageState) -> Result<Visitor, Response> {
        require_guard_header(&parts.headers).map_err(IntoResponse::into_response)?;
        let peer = ConnectInfo::<SocketAddr>::from_request_parts(parts, page).await;
        let ConnectInfo(peer) = peer.map_err(IntoResponse::into_response)?;
        Ok(Visitor {
            address: peer.ip().to_canonical(),
        })
    }
}

impl FromRequestParts<PageState> for Author {
    type Rejection = Response;

    async fn from_request_parts(parts: &mut Parts, page: &PageState) -> Result<Author, Response> {
        let visitor = Visitor::from_request_parts(parts, page).await?;
        let typed = parts.headers.get(PIN_HEADER);
        let typed = typed.map(|value| value.to_str().unwrap_or_default().to_owned());
        let checked = page.guard.check(visitor.address, typed, Instant::now());
        let Err(refused) = checked.await else {
            return Ok(Author(visitor));
        };
        // The others could be repeated without end, and nothing was tried by them.
        if refused == Unauthorised::Wrong {
            visitor.record(page, "PIN", "wrong").await;
        }
        Err(refused.into_response())
    }
}

impl IntoResponse for Unauthorised {
    fn into_response(self) -> Response {
        let said = self.to_string();
        match self {
            Unauthorised::NotHere => (StatusCode::FORBIDDEN, said).into_response(),
            Unauthorised::Throttled => (StatusCode::TOO_MANY_REQUESTS, said).into_response(),
            Unauthorised::Missing | Unauthorised::Wrong => {
                let scheme = [(WWW_AUTHENTICATE, "Binnacle-Pin")];
                (StatusCode::UNAUTHORIZED, scheme, said).into_response()
            }
        }
    }
}
