//! Security headers of responses to browsers.

use axum::extract::Request;
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, HeaderName, HeaderValue, REFERRER_POLICY,
    STRICT_TRANSPORT_SECURITY, X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use axum::middleware::Next;
use axum::response::Response;

/// Content security policy: only our own resources, of the kinds that our pages use. Charts
/// need inline styles.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; \
    img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; manifest-src 'self'; \
    worker-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";
/// Permissions policy: our own pages may ask for the position, at the berth; no page needs
/// another device of the machine.
const PERMISSIONS: &str = "camera=(), geolocation=(self), microphone=(), payment=(), usb=()";
/// Strict transport security (RFC 6797): for a year, a browser uses only https for this host.
const HTTPS_ONLY: &str = "max-age=31536000";

/// Adds the header that restricts browsers to https.
pub async fn add_https_only(request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    let value = HeaderValue::from_static(HTTPS_ONLY);
    response
        .headers_mut()
        .insert(STRICT_TRANSPORT_SECURITY, value);
    response
}

/// Adds the security headers that a response does not set itself.
pub async fn add(request: Request, next: Next) -> Response {
    let is_api = request.uri().path().starts_with("/api/");
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    let mut default = |name: HeaderName, value: &'static str| {
        headers
            .entry(name)
            .or_insert(HeaderValue::from_static(value));
    };
    default(X_CONTENT_TYPE_OPTIONS, "nosniff");
    default(CONTENT_SECURITY_POLICY, POLICY);
    default(X_FRAME_OPTIONS, "DENY");
    default(REFERRER_POLICY, "same-origin");
    default(
        HeaderName::from_static("cross-origin-opener-policy"),
        "same-origin",
    );
    default(
        HeaderName::from_static("cross-origin-resource-policy"),
        "same-origin",
    );
    default(HeaderName::from_static("permissions-policy"), PERMISSIONS);
    if is_api {
        default(CACHE_CONTROL, "no-store");
    }
    response
}
