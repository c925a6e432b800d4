//! Dashboard files, which are embedded when the server is built.
//!
//! Invariants: for a path that names no file the response is the dashboard's page, which does
//! its own routing. Files with a hash in their name may be cached for ever; all others are
//! revalidated.

mod preload;

use axum::extract::{FromRequestParts, Request, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, ETAG, IF_NONE_MATCH};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{Html, IntoResponse, Response};
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use rust_embed::{EmbeddedFile, RustEmbed};

#[derive(RustEmbed)]
#[folder = "../web/dist"]
#[allow_missing = true]
struct Files;

const NOT_BUILT: &str = "<!doctype html><html lang=en><meta charset=utf-8><title>Binnacle</title>\
    <h1>The dashboard is not built in</h1>\
    <p>Run <code>make web</code>, then build the server again.</p>\
    <p>The API is there: <a href=/api/docs>read about it</a>.</p></html>";

/// Serves a file, or the page of the dashboard.
pub async fn serve(State(app): State<App>, request: Request) -> Response {
    let (mut parts, _) = request.into_parts();
    let path = parts.uri.path().trim_start_matches('/').to_owned();
    if let Some(file) = Files::get(&path) {
        return answer(&path, &file, &parts.headers);
    }
    // A missing asset is an error, not a page: a stale page must not run it.
    if path.starts_with("assets/") {
        return (StatusCode::NOT_FOUND, "not found").into_response();
    }
    match Files::get("index.html") {
        Some(page) => {
            let mut answer = answer("index.html", &page, &parts.headers);
            let vessel = preload::vessel(&path);
            let reads =
                vessel.is_some() && Reader::from_request_parts(&mut parts, &app).await.is_ok();
            preload::add(
                preload::links(vessel, reads, &parts.headers),
                answer.headers_mut(),
            );
            answer
        }
        None => Html(NOT_BUILT).into_response(),
    }
}

fn answer(path: &str, file: &EmbeddedFile, request: &HeaderMap) -> Response {
    let hash = file.metadata.sha256_hash();
    let [a, b, c, d, e, f, g, h, ..] = hash;
    let tag = format!("\"{:016x}\"", u64::from_be_bytes([a, b, c, d, e, f, g, h]));
    let keep = if path.starts_with("assets/") {
        "public, max-age=31536000, immutable"
    } else {
        "no-cache"
    };
    let unchanged = request
        .get(IF_NONE_MATCH)
        .is_some_and(|known| known.as_bytes() == tag.as_bytes());
    if unchanged {
        return (StatusCode::NOT_MODIFIED, [(ETAG, tag)]).into_response();
    }
    let headers = [
        (CONTENT_TYPE, file.metadata.mimetype().to_owned()),
        (CACHE_CONTROL, keep.to_owned()),
        (ETAG, tag),
    ];
    (headers, file.data.clone().into_owned()).into_response()
}
