//! Page that shows the check of a printed card. It has no script, and loads nothing else.

use super::{CardCheck, CardState};
use binnacle_drawing::angles::{east_west, heading};
use std::fmt::Write;

const STYLE: &str = "body{font:17px/1.5 system-ui,sans-serif;max-width:32rem;margin:1.5rem auto;\
    padding:0 1rem}h1{font-size:1.3rem}p.state{padding:.8rem 1rem;border-radius:.4rem;\
    border:2px solid;font-weight:600}p.good{color:#14642b;background:#e5f5e9}\
    p.bad{color:#8a1c1c;background:#fdeaea}table{border-collapse:collapse;width:100%;\
    font-variant-numeric:tabular-nums}td,th{text-align:right;padding:.15rem .5rem;\
    border-bottom:1px solid #8884}dt{font-weight:600}dd{margin:0 0 .4rem}";

/// Returns the page of a card.
pub(super) fn of_card(check: &CardCheck) -> String {
    let (class, title) = match check.state {
        CardState::InForce => ("good", "In force"),
        CardState::Replaced => ("bad", "No longer valid"),
        CardState::Withdrawn => ("bad", "Withdrawn"),
        CardState::Suspected => ("bad", "Compass suspected"),
        CardState::Unconfirmed => ("bad", "Cannot be confirmed"),
    };
    let mut page = head(title);
    let _ = write!(
        page,
        "<h1>Deviation card</h1><p class='state {class}' role=status>{}</p><dl>",
        escape(&check.statement)
    );
    let facts = [
        ("Ship", check.vessel_name.clone()),
        ("IMO number", check.imo_number.clone().unwrap_or_default()),
        ("Compass", check.compass.clone()),
        ("Card for", check.at.to_the_minute()),
        ("Model version", check.model_version.to_string()),
        ("Checked", check.checked_at.to_the_minute()),
    ];
    for (label, value) in facts.iter().filter(|(_, value)| !value.is_empty()) {
        let _ = write!(page, "<dt>{label}</dt><dd>{}</dd>", escape(value));
    }
    page.push_str(
        "</dl><p>The paper must say the same:</p><table><thead><tr><th scope=col>Compass heading\
         <th scope=col>Deviation</thead><tbody>",
    );
    for row in &check.rows {
        let _ = write!(
            page,
            "<tr><th scope=row>{}<td>{}",
            heading(row.compass_deg),
            east_west(row.deviation_deg)
        );
    }
    page.push_str(
        "</table><p>A card is made from the ship’s own headings. It is not a certificate of \
         adjustment.</p></html>",
    );
    page
}

/// Returns the page for a code that is no card's.
pub(super) fn unknown() -> String {
    let mut page = head("Unknown card");
    page.push_str(
        "<h1>Deviation card</h1><p class='state bad' role=status>This service did not \
         issue this card. Treat the card as not valid.</p><p>If you typed the address, scan the \
         code instead.</p></html>",
    );
    page
}

fn head(title: &str) -> String {
    format!(
        "<!doctype html><html lang=en><meta charset=utf-8>\
         <meta name=viewport content='width=device-width'><meta name=robots content=noindex>\
         <title>{title} – deviation card</title><style>{STYLE}</style>"
    )
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
