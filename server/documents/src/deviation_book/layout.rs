//! Layout of a deviation book on sheets of A4 in landscape.

use super::entry::{Entry, Reference};
use super::select::Occasion;
use crate::card;
use binnacle_compass::result::SampleReason;
use binnacle_drawing::angles::{east_west, heading_to_a_tenth, latitude, longitude, signed};
use binnacle_drawing::{A4, Face, MARGIN, Pen, Sheet, Style, cut, wrap};
use binnacle_platform::time::Time;

const WIDTH: f32 = A4.1;
const HEIGHT: f32 = A4.0;
const LEFT: f32 = MARGIN;
const RIGHT: f32 = WIDTH - MARGIN;
const TOP: f32 = MARGIN + 74.0;
const LINE: f32 = 11.6;
const GREY: u8 = 90;
/// Entries on a sheet.
const ROWS: usize = 33;

/// Column of the observed deviation, in bold.
const DEVIATION: usize = 7;
/// Column of the observer.
const OBSERVER: usize = 10;
/// Column of the remarks.
const REMARKS: usize = 11;

/// Columns: two lines of title, where the text is anchored, and whether it ends there.
const COLUMNS: [([&str; 2], f32, bool); 12] = [
    (["", "UTC"], LEFT, false),
    (["", "Position"], 110.0, false),
    (["Compass", "heading"], 250.0, true),
    (["True", "heading"], 290.0, true),
    (["", "by"], 297.0, false),
    (["Compass", "error"], 392.0, true),
    (["", "Variation"], 438.0, true),
    (["Deviation", "observed"], 488.0, true),
    (["by the card", "(95 % band)"], 564.0, true),
    (["Observed", "less card"], 606.0, true),
    (["", "Observer"], 613.0, false),
    (["", "Remarks"], 662.0, false),
];

/// Vessel and period of the book.
pub(super) struct Book {
    pub(super) vessel: String,
    pub(super) imo_number: Option<String>,
    pub(super) compass: String,
    pub(super) from: Option<Time>,
    pub(super) to: Option<Time>,
}

/// Draws the book's sheets. Without an entry, one sheet states that.
pub(super) fn sheets(book: &Book, entries: &[Entry]) -> Vec<Sheet> {
    let pages: Vec<&[Entry]> = match entries {
        [] => vec![&[]],
        some => some.chunks(ROWS).collect(),
    };
    let of = pages.len();
    let page = |(index, rows): (usize, &&[Entry])| {
        let mut sheet = Sheet::a4_landscape();
        head(&mut sheet, book, index + 1, of);
        for (line, entry) in rows.iter().enumerate() {
            row(&mut sheet, entry, TOP + LINE * line as f32, line);
        }
        if rows.is_empty() {
            let says = "No settled stretch of heading was observed in this time.";
            sheet.text((LEFT, TOP + 8.0), Style::plain(9.0), says);
        }
        foot(&mut sheet);
        sheet
    };
    pages.iter().enumerate().map(page).collect()
}

fn head(sheet: &mut Sheet, book: &Book, page: usize, of: usize) {
    sheet.text(
        (LEFT, MARGIN + 14.0),
        Style::bold(15.0),
        "Compass deviation book",
    );
    let number = book.imo_number.as_ref();
    let number = number.map_or(String::new(), |number| format!(", IMO {number}"));
    let whose = format!("{}{number} – {}", book.vessel, book.compass);
    let whose = cut(&whose, Face::Bold, 10.0, 480.0);
    sheet.text((LEFT, MARGIN + 30.0), Style::bold(10.0), whose);
    let since = book
        .from
        .map_or("the first sample".to_owned(), Time::to_the_minute);
    let until = book.to.map_or("the last".to_owned(), Time::to_the_minute);
    let right = Style::plain(8.0).end();
    sheet.text(
        (RIGHT, MARGIN + 14.0),
        right,
        format!("page {page} of {of}"),
    );
    sheet.text(
        (RIGHT, MARGIN + 30.0),
        right,
        format!("from {since} to {until}"),
    );
    let rule = MARGIN + 38.0;
    sheet.rule((LEFT, rule), (RIGHT, rule), 1.0);
    for ([first, second], x, ends) in COLUMNS {
        let style = Style::plain(7.0).grey(GREY);
        let style = if ends { style.end() } else { style };
        sheet.text((x, TOP - 22.0), style, first);
        sheet.text((x, TOP - 13.5), style, second);
    }
    sheet.rule((LEFT, TOP - 9.0), (RIGHT, TOP - 9.0), 0.4);
}

fn row(sheet: &mut Sheet, entry: &Entry, y: f32, line: usize) {
    let cells = [
        entry.time.to_the_minute().replace(" UTC", ""),
        format!("{}  {}", latitude(entry.lat), longitude(entry.lon)),
        heading_to_a_tenth(entry.compass_deg),
        heading_to_a_tenth(entry.true_deg),
        by(entry.reference).to_owned(),
        east_west(entry.compass_error_deg),
        east_west(entry.variation_deg),
        east_west(entry.deviation_deg),
        by_the_card(entry),
        entry.difference_deg.map_or("–".to_owned(), signed),
        entry.initials.clone().unwrap_or_else(|| "agent".to_owned()),
        remarks(entry),
    ];
    for (column, ((_, x, ends), text)) in COLUMNS.into_iter().zip(cells).enumerate() {
        let style = if column == DEVIATION {
            Style::bold(8.0)
        } else {
            Style::plain(8.0)
        };
        let style = if ends { style.end() } else { style };
        let room = match column {
            OBSERVER => COLUMNS[REMARKS].1 - x - 3.0,
            REMARKS => RIGHT - x,
            _ => WIDTH,
        };
        let text = cut(&text, style.face, style.size, room);
        sheet.text((x, y), style, text);
    }
    if line % 3 == 2 {
        let under = y + 3.6;
        sheet.line(
            vec![(LEFT, under), (RIGHT, under)],
            Pen::black(0.3).grey(170),
        );
    }
}

fn by(reference: Reference) -> &'static str {
    match reference {
        Reference::Gyro => "gyro",
        Reference::Satellite => "satellite",
        Reference::GyroAndSatellite => "gyro, satellite",
        Reference::CourseOverGround => "course",
        Reference::SunAzimuth => "sun",
        Reference::SunAmplitude => "sun, amplitude",
        Reference::Body => "body",
        Reference::Transit => "transit",
        Reference::Quay => "quay",
    }
}

fn by_the_card(entry: &Entry) -> String {
    let Some(card_deg) = entry.card_deviation_deg else {
        return "none in force".to_owned();
    };
    let band = entry
        .card_band95_deg
        .map_or(String::new(), |band| format!(" ±{band:.1}°"));
    format!("{}{band}", east_west(card_deg))
}

fn remarks(entry: &Entry) -> String {
    let occasion = match entry.occasion {
        Occasion::Watch | Occasion::Azimuth => "",
        Occasion::Alteration => "course altered",
    };
    let gyro = entry.gyro_error_deg.map_or(String::new(), |error_deg| {
        format!("gyro error {}", east_west(error_deg))
    });
    let card = match entry.card_status {
        Some(card::CardStatus::Verified) => "card verified",
        Some(card::CardStatus::Predicted) | None => "",
    };
    let reason = entry.reason.map_or("", reason_in_words);
    let remark = entry.remark.as_deref().unwrap_or_default();
    let all = [occasion, &gyro, reason, card, remark].into_iter();
    let said = all.filter(|words| !words.is_empty());
    said.collect::<Vec<_>>().join("; ")
}

fn reason_in_words(reason: SampleReason) -> &'static str {
    match reason {
        SampleReason::NoReference => "no reference",
        SampleReason::ReferenceFailed => "reference failed",
        SampleReason::CompassStuck => "compass stuck",
        SampleReason::GnssInterference => "GNSS interference",
        SampleReason::OutsideFieldModel => "variation not known",
        SampleReason::FieldTooWeak => "field too weak",
        SampleReason::MagneticCargo => "magnetic cargo",
        SampleReason::Berth => "alongside",
        SampleReason::Disturbance => "disturbed",
        SampleReason::Outlier => "disagrees with the rest",
        SampleReason::NoModel => "",
        SampleReason::TooSlowForCourse => "too slow for the course over ground",
        SampleReason::TurningCourse => "turning",
    }
}

/// Left edge of the master's line.
const MASTER: f32 = RIGHT - 150.0;
const FOOT: f32 = 7.0;

/// Returns the text at the foot, beside the master's line.
fn foot_text() -> Vec<String> {
    let says = "Observed by the agent on board by itself, in settled stretches of heading: one in \
                each watch that has one, and after alterations of course of 20° or more; by the \
                officer whose initials are given, by an azimuth. A card is predicted where the \
                remarks do not say that it was verified.";
    wrap(says, Face::Regular, FOOT, MASTER - 14.0 - LEFT)
}

fn foot(sheet: &mut Sheet) {
    let y = HEIGHT - MARGIN;
    let small = Style::plain(FOOT).grey(GREY);
    for (above, line) in foot_text().into_iter().rev().enumerate() {
        sheet.text((LEFT, y - 8.5 * above as f32), small, line);
    }
    sheet.rule((MASTER, y - 9.0), (RIGHT, y - 9.0), 0.5);
    sheet.text((MASTER, y), small, "Seen by the master");
}

#[cfg(test)]
mod tests {
    use super::*;
    use binnacle_drawing::width;

    #[test]
    fn the_foot_leaves_the_masters_line_free() {
        let lines = foot_text();
        for line in &lines {
            let end = LEFT + width(line, Face::Regular, FOOT);
            assert!(end < MASTER, "{line} ends at {end}");
        }
        let last_row = TOP + LINE * ROWS as f32;
        assert!(HEIGHT - MARGIN - 8.5 * lines.len() as f32 > last_row);
    }
}
