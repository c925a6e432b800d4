//! Margins, greys and labelled text that the parts of the sheet share.

use binnacle_drawing::{A4, MARGIN, Point, Sheet, Style};

pub(super) const LEFT: f32 = MARGIN;
pub(super) const RIGHT: f32 = A4.0 - MARGIN;
/// Distance from one line of the table to the next.
pub(super) const LINE: f32 = 13.0;
/// Grey of secondary text.
pub(super) const GREY: u8 = 90;
/// Smallest legible size of type.
const SMALLEST: f32 = 6.0;
/// Distance between two lines of labelled text.
const LABELLED_STEP: f32 = 9.6;
/// Text for an unknown value.
pub(super) const UNKNOWN: &str = "not recorded";

/// Draws a label in grey and its value within a width.
pub(super) fn draw_fact(sheet: &mut Sheet, at: Point, label: &str, value: &str, room: f32) {
    const LABEL: f32 = 74.0;
    let style = Style::plain(8.0);
    sheet.text(at, style.grey(GREY), label);
    let room = room - LABEL;
    // A long value is set smaller before it is cut.
    let long = binnacle_drawing::width(value, style.face, style.size);
    let size = (style.size * room / long).clamp(SMALLEST, style.size);
    let value = binnacle_drawing::cut(value, style.face, size, room);
    sheet.text((at.0 + LABEL, at.1), Style::plain(size), value);
}

/// Draws labelled text on as many lines as it needs. Returns the position of the next line.
pub(super) fn draw_labelled(
    sheet: &mut Sheet,
    at: Point,
    label: &str,
    value: &str,
    room: f32,
) -> f32 {
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

/// Returns the value, or a mark for a missing one.
pub(super) fn known(value: Option<&str>) -> &str {
    value.unwrap_or(UNKNOWN)
}
