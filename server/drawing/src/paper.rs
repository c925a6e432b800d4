//! Running text on sheets, written from top to bottom with page breaks.

use super::{Face, MARGIN, Sheet, Style, wrap};

/// Left edge of text.
pub const LEFT: f32 = MARGIN + 6.0;
/// Right edge of text.
pub const RIGHT: f32 = 595.28 - MARGIN - 6.0;
const BOTTOM: f32 = 841.89 - MARGIN - 24.0;
/// Line spacing.
pub const LINE: f32 = 11.0;
/// Font size of body text.
pub const SIZE: f32 = 8.3;
/// Left edge of the values beside labels.
pub const VALUE: f32 = LEFT + 96.0;

/// Sheets with the position of the next line on the last one.
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
    /// Starts with one blank sheet.
    pub fn new() -> Paper {
        let mut paper = Paper {
            sheets: Vec::new(),
            y: 0.0,
        };
        paper.turn();
        paper
    }

    /// Returns the sheets, each with the given footer lines and its page number.
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

    /// Breaks the page unless the given number of lines fits on it.
    pub fn keep_together(&mut self, lines: usize) {
        if self.y + LINE * lines as f32 > BOTTOM {
            self.turn();
        }
    }

    /// Writes a text on the current line.
    pub fn put(&mut self, x: f32, style: Style, text: &str) {
        let y = self.y;
        if let Some(sheet) = self.sheets.last_mut() {
            sheet.text((x, y), style, text);
        }
    }

    /// Moves down by a distance.
    pub fn down(&mut self, points: f32) {
        self.y += points;
    }

    /// Writes a heading.
    pub fn title(&mut self, text: &str) {
        self.keep_together(4);
        self.y += 7.0;
        self.put(LEFT, Style::bold(10.5), text);
        self.y += LINE + 2.0;
    }

    /// Writes a text from `x` on, wrapped over as many lines as it needs.
    pub fn lines(&mut self, x: f32, style: Style, text: &str) {
        for line in wrap(text, style.face, style.size, RIGHT - x) {
            self.keep_together(1);
            self.put(x, style, &line);
            self.y += LINE;
        }
    }

    /// Writes a label and its value; nothing where the value is empty.
    pub fn fact(&mut self, label: &str, value: &str) {
        if value.is_empty() {
            return;
        }
        for (index, line) in wrap(value, Face::Regular, SIZE, RIGHT - VALUE)
            .iter()
            .enumerate()
        {
            self.keep_together(1);
            if index == 0 {
                self.put(LEFT, Style::plain(SIZE).grey(90), label);
            }
            self.put(VALUE, Style::plain(SIZE), line);
            self.y += LINE;
        }
    }

    /// Writes a table row whose cells end at the given x coordinates.
    pub fn row(&mut self, style: Style, first: &str, cells: &[(f32, String)]) {
        self.keep_together(1);
        self.put(LEFT, style, first);
        for (x, cell) in cells {
            self.put(*x, style.end(), cell);
        }
        self.y += LINE;
    }
}
