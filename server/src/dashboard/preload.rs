//! Preload links of a page, in its `Link` headers (RFC 8288), so that a browser requests them at
//! once.
//!
//! Invariants: data is preloaded only with one of our cookies, and a vessel's data only for
//! users with a fleet. The page itself requests everything named, so that nothing is fetched in
//! vain.

use super::Files;
use axum::http::HeaderMap;
use axum::http::header::{COOKIE, HeaderValue, LINK};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;
use uuid::Uuid;

/// Manifest of the built files, by their sources.
const MANIFEST: &str = "files.json";
const VESSEL: &str = "src/pages/Vessel.svelte";
/// Page size with which the dashboard requests lists.
const LONGEST_PAGE: u32 = 10_000;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Built {
    file: String,
    #[serde(default)]
    imports: Vec<String>,
    #[serde(default)]
    is_entry: bool,
}

/// Files of a vessel's page, without those that every page loads.
static VESSELS_FILES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let manifest = Files::get(MANIFEST);
    let manifest = manifest.and_then(|file| serde_json::from_slice(&file.data).ok());
    files_of(VESSEL, &manifest.unwrap_or_default())
});

fn files_of(source: &str, manifest: &BTreeMap<String, Built>) -> Vec<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![source];
    while let Some(source) = open.pop() {
        let Some(built) = manifest.get(source).filter(|built| !built.is_entry) else {
            continue;
        };
        if found.insert(built.file.clone()) {
            open.extend(built.imports.iter().map(String::as_str));
        }
    }
    found.into_iter().collect()
}

/// Returns the vessel whose page, or one of whose tabs, is at `path`.
pub(super) fn vessel(path: &str) -> Option<Uuid> {
    let id = path.strip_prefix("vessels/")?.split('/').next()?;
    Uuid::try_parse(id).ok()
}

/// Returns the preload links of a vessel's page, or of any other, for a request with these
/// headers.
pub(super) fn links(
    vessel: Option<Uuid>,
    has_fleet: bool,
    request: &HeaderMap,
) -> Option<HeaderValue> {
    let mut links = Vec::new();
    if request.contains_key(COOKIE) {
        // Data of the vessel that the page shows first.
        let ours = vessel.filter(|_| has_fleet).map(|id| {
            [
                format!("vessels/{id}"),
                format!("vessels/{id}/needs"),
                format!("fleet?vessel={id}"),
                format!("work-orders?vessel={id}&limit={LONGEST_PAGE}"),
                format!("alerts?open=true&limit={LONGEST_PAGE}"),
            ]
        });
        let data = ["me".to_owned()]
            .into_iter()
            .chain(ours.into_iter().flatten());
        links.extend(
            data.map(|data| format!("</api/v1/{data}>; rel=preload; as=fetch; crossorigin")),
        );
    }
    if vessel.is_some() {
        links.extend(
            VESSELS_FILES
                .iter()
                .map(|file| format!("</{file}>; rel=modulepreload")),
        );
    }
    HeaderValue::try_from(links.join(", "))
        .ok()
        .filter(|links| !links.is_empty())
}

/// Adds the preload links to the response headers of a page.
pub(super) fn add(links: Option<HeaderValue>, headers: &mut HeaderMap) {
    headers.extend(links.map(|links| (LINK, links)));
}

#[cfg(test)]
mod tests {
    use super::*;

    const VESSELS_PAGE: &str = "vessels/0199aa00-0000-7000-8000-000000000003";

    #[test]
    fn a_page_preloads_its_own_files_and_imports_but_none_of_every_page() {
        let manifest = serde_json::from_str(
            r#"{
                "index.html": { "file": "assets/index.js", "isEntry": true },
                "src/pages/Vessel.svelte": {
                    "file": "assets/Vessel.js", "isDynamicEntry": true,
                    "imports": ["index.html", "_parts.js"]
                },
                "_parts.js": { "file": "assets/parts.js", "imports": ["_parts.js"] },
                "src/pages/Fleet.svelte": { "file": "assets/Fleet.js" }
            }"#,
        )
        .unwrap();
        assert_eq!(
            files_of(VESSEL, &manifest),
            ["assets/Vessel.js", "assets/parts.js"]
        );
        assert!(files_of("src/pages/None.svelte", &manifest).is_empty());
    }

    #[test]
    fn data_is_preloaded_only_for_users_who_may_be_signed_in_and_for_the_vessel_of_the_path() {
        let nobody = HeaderMap::new();
        let somebody = HeaderMap::from_iter([(COOKIE, HeaderValue::from_static("a=b"))]);
        let links = |path: &str, request: &HeaderMap| {
            let links = links(vessel(path), true, request);
            links.map_or(String::new(), |links| links.to_str().unwrap().to_owned())
        };
        assert_eq!(links("", &nobody), "");
        assert_eq!(
            links("alerts", &somebody),
            "</api/v1/me>; rel=preload; as=fetch; crossorigin"
        );
        assert!(!links(VESSELS_PAGE, &nobody).contains("/api/"));
        let both = links(VESSELS_PAGE, &somebody);
        assert!(both.contains("</api/v1/me>"), "{both}");
        assert!(
            both.contains(&format!("</api/v1/{VESSELS_PAGE}>; rel=preload; as=fetch")),
            "{both}"
        );
        assert!(
            both.contains(&format!("</api/v1/{VESSELS_PAGE}/needs>; rel=preload")),
            "{both}"
        );
        assert!(both.contains("</api/v1/fleet?vessel="), "{both}");
        assert_eq!(links(&format!("{VESSELS_PAGE}/changes"), &somebody), both);
        assert!(!links("vessels/none\r\nX: y", &somebody).contains("vessels"));
        let without_fleet = super::links(vessel(VESSELS_PAGE), false, &somebody);
        let without_fleet = without_fleet.unwrap();
        assert!(!without_fleet.to_str().unwrap().contains("/api/v1/vessels"));
    }
}
