//! Layout of a card on a sheet of A4.
//!
//! Invariants: table and curve share their lines, so that a heading is read straight across. All
//! statements of the card stand on the one sheet.

mod chart;
mod foot;
mod head;
mod table;

use super::contents::Card;
use binnacle_drawing::{A4, About, MARGIN, Point, Sheet, Style};

const LEFT: f32 = MARGIN;
const RIGHT: f32 = A4.0 - MARGIN;
/// Distance from one line of the table to the next.
const LINE: f32 = 13.0;
/// Grey of secondary text.
const GREY: u8 = 90;

/// Draws the card's sheet.
pub(super) fn sheet(card: &Card) -> Sheet {
    let mut sheet = Sheet::a4();
    let below_head = head::draw(&mut sheet, card);
    let lines = table::Lines {
        top: below_head + 38.0,
    };
    table::draw(&mut sheet, card, &lines);
    chart::draw(&mut sheet, card, &lines);
    foot::draw(&mut sheet, card, lines.bottom() + 16.0);
    sheet
}

/// Returns the metadata of the document.
pub(super) fn about(card: &Card) -> About {
    About {
        title: format!(
            "Deviation card ({}): {}, {}",
            card.status.word(),
            card.vessel.name,
            card.compass.name
        ),
        created: card.model.fitted_at.0,
    }
}

/// Smallest legible size of type.
const SMALLEST: f32 = 6.0;

/// Draws a label in grey and its value within a width.
fn fact(sheet: &mut Sheet, at: Point, label: &str, value: &str, room: f32) {
    const LABEL: f32 = 74.0;
    let style = Style::plain(8.0);
    sheet.text(at, style.grey(GREY), label);
    let room = room - LABEL;
    // What is long is set smaller before anything of it is left out.
    let long = binnacle_drawing::width(value, style.face, style.size);
    let size = (style.size * room / long).clamp(SMALLEST, style.size);
    let value = binnacle_drawing::cut(value, style.face, size, room);
    sheet.text((at.0 + LABEL, at.1), Style::plain(size), value);
}

/// Distance between two lines of labelled text.
const LABELLED_STEP: f32 = 9.6;

/// Draws labelled text on as many lines as it needs. Returns the position of the next line.
fn draw_labelled(sheet: &mut Sheet, at: Point, label: &str, value: &str, room: f32) -> f32 {
    const LABEL: f32 = 68.0;
    let style = Style::plain(8.0);
    sheet.text(at, style.grey(GREY), label);
    let lines = binnacle_drawing::wrap(value, style.face, style.size, room - LABEL);
    for (index, line) in lines.iter().enumerate() {
        let y = at.1 + LABELLED_STEP * index as f32;
        sheet.text((at.0 + LABEL, y), style, line.as_str());
    }
    at.1 + LABELLED_STEP * lines.len().max(1) as f32
}

/// Text for an unknown value.
const UNKNOWN: &str = "not recorded";

/// Returns the value, or a mark for a missing one.
fn known(value: Option<&str>) -> &str {
    value.unwrap_or(UNKNOWN)
}
