//! Lower part of the sheet: coefficients, the ship's state, notes, signatures and the source.

use super::qr_code;
use super::style::{GREY, LEFT, RIGHT, UNKNOWN, draw_labelled, known};
use crate::card::contents::{Card, MagneticCargo};
use binnacle_compass::deviation::CoefficientsInDegrees;
use binnacle_drawing::angles::signed;
use binnacle_drawing::{A4, Face, MARGIN, Sheet, Style, wrap};
use binnacle_fleet::binnacles::describe_setting;
use binnacle_platform::time::Time;

const SECOND: f32 = 262.0;
/// Right edges of the exact and of the handbook's coefficients.
const COEFFICIENTS: [f32; 2] = [LEFT + 72.0, LEFT + 116.0];
/// Left edge of the code by which the card is checked, and its side.
const CODE: (f32, f32) = (LEFT + 138.0, 66.0);
/// Its caption below it, beyond the quiet zone of four modules (ISO/IEC 18004).
const CAPTION: f32 = 10.0;
/// Upper edge of the signatures, from the sheet's upper edge.
const SIGNATURES: f32 = A4.1 - MARGIN - 68.0;
const NOTE_LINE: f32 = 9.4;

/// Draws the lower part below `top`.
pub(super) fn draw(sheet: &mut Sheet, card: &Card, top: f32) {
    coefficients(sheet, card, top + 8.0);
    check(sheet, card, top + 2.0);
    let below = state(sheet, card, top + 8.0).max(top + 80.0);
    let below = correctors(sheet, card, below + 5.0);
    notes(sheet, card, below + 5.0);
    signatures(sheet);
    source(sheet, card);
}

fn coefficients(sheet: &mut Sheet, card: &Card, top: f32) {
    let small = Style::plain(7.5).grey(GREY);
    sheet.text((LEFT, top), Style::bold(8.0), "Coefficients");
    sheet.text((COEFFICIENTS[0], top), small.end(), "exact");
    sheet.text((COEFFICIENTS[1], top), small.end(), "handbook");
    let of = |found: &CoefficientsInDegrees| {
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
        sheet.text((COEFFICIENTS[0], y), style.end(), signed(exact[index]));
        sheet.text((COEFFICIENTS[1], y), style.end(), signed(handbook[index]));
    }
    let constant = signed(card.coefficients.constant_deg);
    let says = format!("handbook A includes {constant} of offsets");
    sheet.text((LEFT + 6.0, top + 66.0), Style::plain(6.8).grey(GREY), says);
}

/// Draws the code by which the card is checked, where there is an address for it.
fn check(sheet: &mut Sheet, card: &Card, top: f32) {
    let Some(url) = &card.check_url else { return };
    let (left, side) = CODE;
    if qr_code::draw(sheet, (left, top), side, url) {
        let at = (left + side / 2.0, top + side + CAPTION);
        let small = Style::plain(6.5).grey(GREY).middle();
        sheet.text(at, small, "scan: is it in force?");
    }
}

/// Draws the ship's state. Returns the lower edge.
fn state(sheet: &mut Sheet, card: &Card, top: f32) -> f32 {
    let in_logbook = |time: Option<Time>| {
        time.map_or("none in the logbook".to_owned(), |time| {
            format!("{} (logbook)", time.day())
        })
    };
    let degaussing = format!(
        "{}; last degaussed: {}",
        known(card.degaussing.as_deref()),
        in_logbook(card.degaussed_at)
    );
    let adjusted = match (card.adjusted_at, &card.adjusted_by) {
        (Some(at), Some(by)) => format!("{} (work order {})", at.day(), by.order),
        (at, _) => in_logbook(at),
    };
    let recorded = card
        .correctors
        .as_ref()
        .map_or(UNKNOWN.to_owned(), |found| {
            format!(
                "as below, recorded {} (revision {})",
                found.at.day(),
                found.revision
            )
        });
    let adjuster = card.adjusted_by.as_ref().map_or(UNKNOWN.to_owned(), |by| {
        let licence = by
            .licence
            .as_ref()
            .map(|licence| format!("licence {licence}"));
        let all = [by.adjuster.clone(), licence, by.firm.clone()];
        all.into_iter().flatten().collect::<Vec<_>>().join(", ")
    });
    let facts = [
        ("Correctors", recorded),
        ("Degaussing", degaussing),
        ("Cargo", cargo(&card.cargo)),
        ("Last adjusted", adjusted),
        ("by", adjuster),
        ("Next due", next_due(card)),
    ];
    sheet.text((SECOND, top), Style::bold(8.0), "State");
    let at = top + 11.0;
    facts.iter().fold(at, |y, (label, value)| {
        draw_labelled(sheet, (SECOND, y), label, value, RIGHT - SECOND)
    })
}

fn next_due(card: &Card) -> String {
    if card.unverified_order.is_some() {
        return "no date yet: unverified berth adjustment".to_owned();
    }
    let Some(due) = &card.next_due else {
        return "unknown: no adjustment is on record".to_owned();
    };
    let flags = if due.flags_own_rules {
        ""
    } else {
        "; the flag’s own rules are not counted"
    };
    format!("{}: {}{flags}", due.on, due.reason)
}

fn cargo(on_board: &[MagneticCargo]) -> String {
    let words: Vec<String> = on_board
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

/// Draws the correctors in pairs, each as many lines as it takes. Returns the lower edge.
fn correctors(sheet: &mut Sheet, card: &Card, top: f32) -> f32 {
    let Some(found) = &card.correctors else {
        return top;
    };
    sheet.text((LEFT, top), Style::bold(8.0), "Correctors");
    let all = describe_setting(&found.setting, found.shape);
    all.chunks(2).fold(top + 11.0, |y, pair| {
        let columns = [(LEFT + 6.0, SECOND - 14.0), (SECOND, RIGHT)];
        let ends = pair
            .iter()
            .zip(columns)
            .map(|((label, value), (x, end))| draw_labelled(sheet, (x, y), label, value, end - x));
        ends.fold(y, f32::max)
    })
}

/// Draws as many notes as fit. The last line counts those left out.
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

/// Draws blank lines for signatures.
fn signatures(sheet: &mut Sheet) {
    sheet.rule((LEFT, SIGNATURES), (RIGHT, SIGNATURES), 0.4);
    let width = (RIGHT - LEFT - 3.0 * 14.0) / 4.0;
    for (index, label) in ["Adjuster", "Licence", "Firm", "Date and signature"]
        .iter()
        .enumerate()
    {
        let left = LEFT + (width + 14.0) * index as f32;
        let y = SIGNATURES + 26.0;
        sheet.rule((left, y), (left + width, y), 0.5);
        sheet.text((left, y + 9.0), Style::plain(7.0).grey(GREY), *label);
    }
}

fn source(sheet: &mut Sheet, card: &Card) {
    let model = &card.model;
    let made = format!(
        "Model version {} of {}",
        model.version,
        model.fitted_at.to_the_minute()
    );
    let lines = if let Some(order) = model.foretold_by {
        [
            format!(
                "{made}: predicted by work order {order} from {} samples of {} to {}.",
                model.samples_used,
                model.data_from.day(),
                model.data_until.day()
            ),
            format!("Record SHA-256 {}", model.input_hash),
        ]
    } else {
        let rms = model
            .rms_deg
            .map_or(String::new(), |rms| format!(", residuals {rms:.2}° rms"));
        [
            format!(
                "{made}, {}: {} samples from {} to {}{rms}.",
                model.estimator,
                model.samples_used,
                model.data_from.to_the_minute(),
                model.data_until.to_the_minute()
            ),
            format!("Data SHA-256 {}", model.input_hash),
        ]
    };
    for (index, line) in lines.into_iter().enumerate() {
        let y = A4.1 - MARGIN - 14.0 + 9.5 * index as f32;
        sheet.text((LEFT, y), Style::plain(6.8).grey(GREY), line);
    }
}
