//! Files of the page, which are all in the program.

use super::state::PageState;
use axum::Router;
use axum::http::header::{CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::IntoResponse;
use axum::routing::get;

/// The page loads its own files, asks its own agent, and nothing else; it has no inline script.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; \
                      img-src data:; form-action 'none'; base-uri 'none'; frame-ancestors 'none'";

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Path, type and text of each file.
const FILES: [(&str, &str, &str); 8] = [
    (
        "/",
        "text/html; charset=utf-8",
        include_str!("site/page.html"),
    ),
    (
        "/page.css",
        "text/css; charset=utf-8",
        include_str!("site/page.css"),
    ),
    ("/display.js", SCRIPT, include_str!("site/display.js")),
    ("/page.js", SCRIPT, include_str!("site/page.js")),
    ("/pin.js", SCRIPT, include_str!("site/pin.js")),
    ("/curve.js", SCRIPT, include_str!("site/curve.js")),
    ("/logbook.js", SCRIPT, include_str!("site/logbook.js")),
    ("/azimuths.js", SCRIPT, include_str!("site/azimuths.js")),
];

/// Returns the routes of the files.
pub(super) fn routes() -> Router<PageState> {
    FILES
        .into_iter()
        .fold(Router::new(), |router, (path, kind, text)| {
            let headers = [(CONTENT_TYPE, kind), (CONTENT_SECURITY_POLICY, POLICY)];
            router.route(path, get(async move || (headers, text).into_response()))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_asks_nothing_of_the_outside_world() {
        for (path, _, text) in FILES {
            // The name of a vocabulary, which nobody fetches.
            let text = text.replace("http://www.w3.org/2000/svg", "");
            for outside in ["http://", "https://", "//cdn", "@import", "url("] {
                assert!(!text.contains(outside), "{path}: {outside}");
            }
        }
    }

    #[test]
    fn the_page_has_no_inline_script_or_style_and_names_each_file() {
        let (_, _, page) = FILES[0];
        for inline in ["<script>", "<style", " style=", " onclick="] {
            assert!(!page.contains(inline), "{inline}");
        }
        for (path, _, _) in &FILES[1..] {
            let name = format!("\"{}\"", &path[1..]);
            assert!(page.contains(&name), "{name}");
        }
    }
}
