//! Sheets that are written from the top, one after the other.

use super::{Face, MARGIN, Sheet, Style, wrap};

/// Where text begins.
pub const LEFT: f32 = MARGIN + 6.0;
/// Where it ends.
pub const RIGHT: f32 = 595.28 - MARGIN - 6.0;
const BOTTOM: f32 = 841.89 - MARGIN - 24.0;
/// From one line to the next.
pub const LINE: f32 = 11.0;
/// The size of text.
pub const SIZE: f32 = 8.3;
/// Where what is said of something begins.
pub const VALUE: f32 = LEFT + 96.0;

/// Sheets, and how far the last one is written.
pub struct Paper {
    sheets: Vec<Sheet>,
    y: f32,
}

impl Default for Paper {
    fn default() -> Paper {
        Paper::new()
    }
}

impl Paper {
    /// One blank sheet.
    pub fn new() -> Paper {
        let mut paper = Paper {
            sheets: Vec::new(),
            y: 0.0,
        };
        paper.turn();
        paper
    }

    /// The sheets, each with these lines at its foot and its number.
    pub fn finish(mut self, foot: &[String]) -> Vec<Sheet> {
        let of = self.sheets.len();
        let style = Style::plain(7.0).grey(90);
        for (index, sheet) in self.sheets.iter_mut().enumerate() {
            let page = format!("page {} of {of}", index + 1);
            sheet.rule((LEFT, BOTTOM + 6.0), (RIGHT, BOTTOM + 6.0), 0.4);
            sheet.text((RIGHT, BOTTOM + 16.0), style.end(), page);
            for (line, text) in foot.iter().enumerate() {
                let y = BOTTOM + 16.0 + 9.0 * line as f32;
                sheet.text((LEFT, y), style, text.as_str());
            }
        }
        self.sheets
    }

    fn turn(&mut self) {
        self.sheets.push(Sheet::a4());
        self.y = MARGIN + 14.0;
    }

    /// Turns the page unless so many lines have room on it.
    pub fn room_for(&mut self, lines: usize) {
        if self.y + LINE * lines as f32 > BOTTOM {
            self.turn();
        }
    }

    /// Puts a text on the line at hand.
    pub fn put(&mut self, x: f32, style: Style, text: &str) {
        let y = self.y;
        if let Some(sheet) = self.sheets.last_mut() {
            sheet.text((x, y), style, text);
        }
    }

    /// Goes on so far.
    pub fn down(&mut self, points: f32) {
        self.y += points;
    }

    /// What follows is called.
    pub fn title(&mut self, text: &str) {
        self.room_for(4);
        self.y += 7.0;
        self.put(LEFT, Style::bold(10.5), text);
        self.y += LINE + 2.0;
    }

    /// A text on as many lines as it takes, from `x` on.
    pub fn lines(&mut self, x: f32, style: Style, text: &str) {
        for line in wrap(text, style.face, style.size, RIGHT - x) {
            self.room_for(1);
            self.put(x, style, &line);
            self.y += LINE;
        }
    }

    /// What something is called and what is said of it; nothing where there is nothing.
    pub fn fact(&mut self, label: &str, value: &str) {
        if value.is_empty() {
            return;
        }
        for (index, line) in wrap(value, Face::Regular, SIZE, RIGHT - VALUE)
            .iter()
            .enumerate()
        {
            self.room_for(1);
            if index == 0 {
                self.put(LEFT, Style::plain(SIZE).grey(90), label);
            }
            self.put(VALUE, Style::plain(SIZE), line);
            self.y += LINE;
        }
    }

    /// Cells that end at places across.
    pub fn row(&mut self, style: Style, first: &str, cells: &[(f32, String)]) {
        self.room_for(1);
        self.put(LEFT, style, first);
        for (x, cell) in cells {
            self.put(*x, style.end(), cell);
        }
        self.y += LINE;
    }
}
