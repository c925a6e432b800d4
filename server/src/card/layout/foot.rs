//! The lower part: coefficients, the ship's state, what to know, who signs, and where
//! it all comes from.

use super::{FAINT, LEFT, RIGHT, UNKNOWN, fact};
use crate::card::contents::{Card, CargoAboard};
use crate::sheet::words::signed;
use crate::sheet::{A4, Face, MARGIN, Sheet, Style, wrap};
use binnacle_magnetics::handbook::Handbook;

const SECOND: f32 = 262.0;
/// Where the signatures begin, from the sheet's upper edge.
const SIGNATURES: f32 = A4.1 - MARGIN - 78.0;
const NOTE_LINE: f32 = 9.4;

/// Draws it below `top`.
pub(super) fn draw(sheet: &mut Sheet, card: &Card, top: f32) {
    coefficients(sheet, card, top + 8.0);
    state(sheet, card, top + 8.0);
    let below = correctors(sheet, card, top + 90.0);
    notes(sheet, card, below);
    signatures(sheet);
    source(sheet, card);
}

fn coefficients(sheet: &mut Sheet, card: &Card, top: f32) {
    let small = Style::plain(7.5).grey(FAINT);
    sheet.text((LEFT, top), Style::bold(8.0), "Coefficients");
    sheet.text((LEFT + 112.0, top), small.end(), "exact");
    sheet.text((LEFT + 168.0, top), small.end(), "handbook");
    let of = |found: &Handbook| {
        [
            found.a_deg,
            found.b_deg,
            found.c_deg,
            found.d_deg,
            found.e_deg,
        ]
    };
    let exact = of(&card.coefficients.exact);
    let handbook = of(&card.coefficients.handbook);
    let style = Style::plain(8.0);
    for (index, name) in ["A", "B", "C", "D", "E"].into_iter().enumerate() {
        let y = top + 11.0 * (index + 1) as f32;
        sheet.text((LEFT + 6.0, y), style, name);
        sheet.text((LEFT + 112.0, y), style.end(), signed(exact[index]));
        sheet.text((LEFT + 168.0, y), style.end(), signed(handbook[index]));
    }
    let constant = signed(card.coefficients.constant_deg);
    let says = format!("handbook A includes {constant} of alignment and offsets");
    sheet.text(
        (LEFT + 6.0, top + 66.0),
        Style::plain(6.8).grey(FAINT),
        says,
    );
}

fn state(sheet: &mut Sheet, card: &Card, top: f32) {
    let day = |time: crate::time::Time| time.0.to_string().chars().take(10).collect::<String>();
    let in_logbook = |time: Option<crate::time::Time>| {
        time.map_or("none in the logbook".to_owned(), |time| {
            format!("{} (logbook)", day(time))
        })
    };
    let degaussing = format!(
        "coils {UNKNOWN}; last degaussed: {}",
        in_logbook(card.degaussed_at)
    );
    let recorded = card
        .correctors
        .as_ref()
        .map_or(UNKNOWN.to_owned(), |found| {
            format!(
                "as below, recorded {} (revision {})",
                day(found.at),
                found.revision
            )
        });
    let facts = [
        ("Correctors", recorded),
        ("Degaussing", degaussing),
        ("Cargo", cargo(&card.cargo)),
        ("Last adjusted", in_logbook(card.adjusted_at)),
        (
            "Next due",
            "unknown: no rule of the flag is recorded".to_owned(),
        ),
    ];
    sheet.text((SECOND, top), Style::bold(8.0), "State");
    for (index, (label, value)) in facts.iter().enumerate() {
        let y = top + 11.0 * (index + 1) as f32;
        fact(sheet, (SECOND, y), label, value, RIGHT - SECOND);
    }
}

fn cargo(aboard: &[CargoAboard]) -> String {
    let words: Vec<String> = aboard
        .iter()
        .map(|cargo| {
            let what = cargo.cargo.as_deref().unwrap_or("of a kind not said");
            format!("{what} since {}", cargo.since.to_the_minute())
        })
        .collect();
    match words.as_slice() {
        [] => "no magnetic cargo in the logbook".to_owned(),
        some => format!("magnetic: {}", some.join(", ")),
    }
}

/// A line for each; answers with where the next thing begins.
fn correctors(sheet: &mut Sheet, card: &Card, top: f32) -> f32 {
    let Some(found) = &card.correctors else {
        return top;
    };
    sheet.text((LEFT, top), Style::bold(8.0), "Correctors");
    let lines = super::correctors::lines(found);
    for (index, (label, value)) in lines.iter().enumerate() {
        let at = (LEFT + 74.0, top + NOTE_LINE * index as f32);
        fact(sheet, at, label, value, RIGHT - LEFT - 74.0);
    }
    top + NOTE_LINE * lines.len() as f32 + 7.0
}

/// As many as there is room for; the last line says how many more there are.
fn notes(sheet: &mut Sheet, card: &Card, top: f32) {
    const SIZE: f32 = 7.5;
    let room = ((SIGNATURES - 14.0 - top) / NOTE_LINE) as usize;
    let mut lines: Vec<String> = Vec::new();
    let mut left = card.notes.len();
    for note in &card.notes {
        let wrapped = wrap(note, Face::Regular, SIZE, RIGHT - LEFT - 8.0);
        if lines.len() + wrapped.len() + 1 > room && left > 0 {
            break;
        }
        let marked = wrapped.into_iter().enumerate();
        lines.extend(marked.map(|(index, line)| match index {
            0 => format!("• {line}"),
            _ => format!("   {line}"),
        }));
        left -= 1;
    }
    if left > 0 {
        lines.push(format!("• {left} more: see the card as JSON"));
    }
    if !lines.is_empty() {
        sheet.text((LEFT, top), Style::bold(8.0), "Notes");
    }
    for (index, line) in lines.into_iter().enumerate() {
        let y = top + 11.0 + NOTE_LINE * index as f32;
        sheet.text((LEFT, y), Style::plain(SIZE), line);
    }
}

/// Blank: a person's pen fills them in.
fn signatures(sheet: &mut Sheet) {
    sheet.rule((LEFT, SIGNATURES), (RIGHT, SIGNATURES), 0.4);
    let width = (RIGHT - LEFT - 3.0 * 14.0) / 4.0;
    for (index, label) in ["Adjuster", "Licence", "Firm", "Date and signature"]
        .iter()
        .enumerate()
    {
        let left = LEFT + (width + 14.0) * index as f32;
        let y = SIGNATURES + 30.0;
        sheet.rule((left, y), (left + width, y), 0.5);
        sheet.text((left, y + 9.0), Style::plain(7.0).grey(FAINT), *label);
    }
}

fn source(sheet: &mut Sheet, card: &Card) {
    let model = &card.model;
    let rms = model
        .rms_deg
        .map_or(String::new(), |rms| format!(", residuals {rms:.2}° rms"));
    let lines = [
        format!(
            "Model version {} of {}, {}: {} samples from {} to {}{rms}.",
            model.version,
            model.fitted_at.to_the_minute(),
            model.estimator,
            model.samples_used,
            model.data_from.to_the_minute(),
            model.data_until.to_the_minute()
        ),
        format!("Data SHA-256 {}", model.input_hash),
    ];
    for (index, line) in lines.into_iter().enumerate() {
        let y = A4.1 - MARGIN - 14.0 + 9.5 * index as f32;
        sheet.text((LEFT, y), Style::plain(6.8).grey(FAINT), line);
    }
}
