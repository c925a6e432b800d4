//! Protection against cross-site requests: changes requested by pages of other sites are
//! refused.
//!
//! Invariants: a request that declares another site as its origin changes nothing, whatever
//! cookie it carries. This is in addition to the cookie's `SameSite=Strict` and the header that
//! only our own pages send. Programs declare no origin, and authenticate with a token.

use crate::app::App;
use crate::error::Error;
use axum::extract::{Request, State};
use axum::http::header::{HOST, ORIGIN};
use axum::http::{HeaderMap, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// Header in which a browser states the origin of a request (Fetch Metadata).
const FETCH_SITE: &str = "sec-fetch-site";

/// Refuses a change that another site requests.
pub async fn refuse(State(app): State<App>, request: Request, next: Next) -> Response {
    let public_url = app.config.mail.public_url.as_deref();
    if request.method().is_safe() || is_of_our_own(request.headers(), public_url) {
        return next.run(request).await;
    }
    Error::Forbidden("a change cannot be requested from another site's page").into_response()
}

/// Checks that a request comes from one of our own pages, or from no page at all.
fn is_of_our_own(headers: &HeaderMap, public_url: Option<&str>) -> bool {
    if let Some(site) = headers.get(FETCH_SITE) {
        return site == "same-origin" || site == "none";
    }
    let Some(origin) = headers.get(ORIGIN) else {
        return true;
    };
    let Ok(origin) = origin.to_str() else {
        return false;
    };
    let host = headers.get(HOST).and_then(|host| host.to_str().ok());
    let at = |url: &str| {
        let uri = url.parse::<Uri>().ok();
        uri.and_then(|uri| Some(uri.authority()?.as_str().to_ascii_lowercase()))
    };
    let from = at(origin);
    from.is_some() && (from == host.map(str::to_ascii_lowercase) || from == public_url.and_then(at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::{HeaderName, HeaderValue};

    fn judged(said: &[(&'static str, &'static str)]) -> bool {
        let pairs = said.iter().map(|(name, value)| {
            (
                HeaderName::from_static(name),
                HeaderValue::from_static(value),
            )
        });
        is_of_our_own(&pairs.collect(), Some("https://binnacle.example/"))
    }

    #[test]
    fn a_page_of_ours_and_a_program_may() {
        let host = ("host", "10.0.0.7:8080");
        assert!(judged(&[host]));
        assert!(judged(&[host, ("sec-fetch-site", "same-origin")]));
        assert!(judged(&[host, ("sec-fetch-site", "none")]));
        assert!(judged(&[host, ("origin", "http://10.0.0.7:8080")]));
        // A proxy may call the server by another name than people do.
        assert!(judged(&[host, ("origin", "https://binnacle.example")]));
        let behind_proxy = ("origin", "https://binnacle.example:4430");
        let said = ("sec-fetch-site", "same-origin");
        assert!(judged(&[host, behind_proxy, said]));
    }

    #[test]
    fn another_sites_page_may_not() {
        let host = ("host", "binnacle.example");
        for said in [
            ("sec-fetch-site", "cross-site"),
            ("sec-fetch-site", "same-site"),
            ("origin", "https://evil.example"),
            ("origin", "https://binnacle.example.evil.example"),
            ("origin", "https://binnacle.example:8443"),
            ("origin", "null"),
            ("origin", ""),
        ] {
            assert!(!judged(&[host, said]), "{said:?}");
        }
    }
}
