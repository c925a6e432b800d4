//! Correctors and compass as found, in the printed record.

use super::values::{minute, word};
use binnacle_drawing::paper::Paper;
use serde_json::Value;

/// Reports of the correctors and the compass as found, before anything was moved.
pub(super) fn draw_as_found(paper: &mut Paper, record: &Value) {
    let reports = record["as_found"].as_array().into_iter().flatten();
    for (index, report) in reports.enumerate() {
        paper.keep_together(4);
        if index == 0 {
            paper.title("As found");
        }
        paper.fact("Reported", &minute(&report["at"]));
        paper.fact("Correctors", against_record(&report["difference"]));
        paper.fact("Compass", &checks(&report["dockside"]));
        let photos = report["photos"].as_array().map_or(0, Vec::len);
        if photos > 0 {
            paper.fact("Photographs", &photos.to_string());
        }
    }
}

fn against_record(difference: &Value) -> &'static str {
    match difference.as_str() {
        Some("record_wrong") => "other than recorded: the record was wrong",
        Some("moved_since") => {
            "other than recorded: moved since the headings of the model, which holds no longer"
        }
        _ => "as recorded",
    }
}

/// Results of the checks alongside, defects first.
fn checks(dockside: &Value) -> String {
    let names = [
        ("bubble", "bubble"),
        ("pivot", "pivot"),
        ("gimbals", "gimbals"),
        ("lubber_line", "lubber line"),
    ];
    let with = |result: &str| -> Vec<&str> {
        let named = names.iter().filter(|(key, _)| dockside[*key] == result);
        named.map(|(_, name)| *name).collect()
    };
    let of = |result: &str| {
        let found = with(result);
        (!found.is_empty()).then(|| format!("{result}: {}", found.join(", ")))
    };
    let spheres = &dockside["spheres_turned_deg"];
    let spheres = (!spheres.is_null())
        .then(|| format!("turned by {}° while a sphere was turned", word(spheres)));
    let parts = [of("defective"), of("sound"), spheres];
    parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
}
