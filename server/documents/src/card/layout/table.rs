//! Table of deviations by compass heading.

use super::style::{GREY, LEFT, LINE};
use crate::card::contents::{Card, CardRow};
use binnacle_drawing::angles::{east_west, heading, heading_to_a_tenth, signed};
use binnacle_drawing::{Face, Pen, Sheet, Style};

/// Right edges of the columns; the last one ends the table.
const ENDS: [f32; 6] = [72.0, 126.0, 172.0, 226.0, 276.0, 312.0];
const TITLES: [[&str; 2]; 6] = [
    ["Compass", "heading"],
    ["", "Deviation"],
    ["95 %", "band"],
    ["Magnetic", "heading"],
    ["Observed", "less card"],
    ["", "Samples"],
];

/// Positions of the lines: one for each 15° from 000 to 360.
pub(super) struct Lines {
    /// The first line's middle.
    pub(super) top: f32,
}

impl Lines {
    /// Returns the height of a compass heading.
    pub(super) fn y(&self, compass_deg: f64) -> f32 {
        self.top + LINE * (compass_deg / 15.0) as f32
    }

    /// Returns the height below the last line.
    pub(super) fn bottom(&self) -> f32 {
        self.y(360.0) + LINE / 2.0
    }
}

/// Draws the table.
pub(super) fn draw(sheet: &mut Sheet, card: &Card, lines: &Lines) {
    let small = Style::plain(7.0).grey(GREY).end();
    for (end, [first, second]) in ENDS.into_iter().zip(TITLES) {
        sheet.text((end, lines.top - 20.0), small, first);
        sheet.text((end, lines.top - 11.5), small, second);
    }
    // North stands at both ends, as the curve does.
    let again = card.rows.first().map(|row| CardRow {
        compass_deg: 360.0,
        ..*row
    });
    for row in card.rows.iter().chain(&again) {
        line(sheet, row, lines);
    }
    let last = ENDS[ENDS.len() - 1];
    for eighth in 0..=8 {
        let y = lines.y(f64::from(eighth) * 45.0) - LINE / 2.0;
        sheet.line(vec![(LEFT, y), (last, y)], Pen::black(0.3).grey(150));
    }
    sheet.rule((LEFT, lines.bottom()), (last, lines.bottom()), 0.4);
    let rule = "magnetic = compass + east deviation, or − west deviation";
    let y = lines.bottom() + LINE / 2.0 + 2.0;
    sheet.text((LEFT, y), Style::plain(7.0).grey(GREY), rule);
}

/// Names the heading of a line. North is 360 where it closes the circle.
pub(super) fn line_name(compass_deg: f64) -> String {
    if compass_deg >= 360.0 {
        return "360°".to_owned();
    }
    heading(compass_deg)
}

fn line(sheet: &mut Sheet, row: &CardRow, lines: &Lines) {
    let baseline = lines.y(row.compass_deg) + 3.3;
    let is_main = row.compass_deg.rem_euclid(45.0) == 0.0;
    let plain = Style::plain(9.0);
    let bold = Style {
        face: Face::Bold,
        ..plain
    };
    let residual = row.residual_deg.map_or("–".to_owned(), signed);
    let cells = [
        (
            if is_main { bold } else { plain },
            line_name(row.compass_deg),
        ),
        (bold, east_west(row.deviation_deg)),
        (plain, format!("±{:.1}°", row.band95_deg)),
        (plain, heading_to_a_tenth(row.magnetic_deg)),
        (plain.grey(GREY), residual),
        (plain.grey(GREY), row.samples.to_string()),
    ];
    for (end, (style, text)) in ENDS.into_iter().zip(cells) {
        sheet.text((end, baseline), style.end(), text);
    }
}
