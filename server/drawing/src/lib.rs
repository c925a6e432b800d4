//! Sheets of paper: what is drawn on one, to be written as PDF and as SVG alike.
//!
//! What always holds:
//!
//! - Lengths are points, 1/72 inch, from the upper left corner, y downwards.
//! - There is no colour but grey, so that a printed sheet says what the screen says.
//! - The same sheet becomes the same bytes: nothing here knows the time.

mod font;
pub mod paper;
mod pdf;
mod svg;
pub mod words;

pub use font::{Face, cut, width, wrap};
pub use pdf::{About, pdf};
pub use svg::svg;

/// A point on a sheet.
pub type Point = (f32, f32);

/// Width and height of ISO 216 A4.
pub const A4: (f32, f32) = (595.28, 841.89);
/// What a printer may leave blank around it.
pub const MARGIN: f32 = 36.0;

/// Black, among greys from 0 to 255.
pub const BLACK: u8 = 0;

/// A page and everything on it, in the order in which it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    pub(crate) width: f32,
    pub(crate) height: f32,
    pub(crate) marks: Vec<Mark>,
}

/// Something drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Mark {
    /// A line of text whose baseline begins, ends or has its middle at a point.
    Text {
        at: Point,
        style: Style,
        text: String,
    },
    /// A line through points.
    Line { points: Vec<Point>, pen: Pen },
    /// The inside of a polygon.
    Area { points: Vec<Point>, grey: u8 },
}

/// How text looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Its face.
    pub face: Face,
    /// The font's size.
    pub size: f32,
    /// Which of its places is at the point given.
    pub anchor: Anchor,
    /// From 0, black, to 255.
    pub grey: u8,
}

/// A place in a line of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Where it begins.
    Start,
    /// Half-way.
    Middle,
    /// Where it ends.
    End,
}

/// How a line looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Its width.
    pub width: f32,
    /// From 0, black, to 255.
    pub grey: u8,
    /// Length of dashes and of the gaps between; 0 for none.
    pub dash: f32,
}

impl Sheet {
    /// A blank sheet, upright.
    pub fn a4() -> Sheet {
        Sheet {
            width: A4.0,
            height: A4.1,
            marks: Vec::new(),
        }
    }

    /// The same, lying.
    pub fn a4_lying() -> Sheet {
        Sheet {
            width: A4.1,
            height: A4.0,
            marks: Vec::new(),
        }
    }

    /// Writes a line of text.
    pub fn text(&mut self, at: Point, style: Style, text: impl Into<String>) {
        let text = text.into();
        if !text.is_empty() {
            self.marks.push(Mark::Text { at, style, text });
        }
    }

    /// Draws a line through points.
    pub fn line(&mut self, points: Vec<Point>, pen: Pen) {
        self.marks.push(Mark::Line { points, pen });
    }

    /// Draws a straight line of a width in black.
    pub fn rule(&mut self, from: Point, to: Point, width: f32) {
        self.line(vec![from, to], Pen::black(width));
    }

    /// Fills a polygon.
    pub fn area(&mut self, points: Vec<Point>, grey: u8) {
        self.marks.push(Mark::Area { points, grey });
    }

    /// Draws the outline of a rectangle in black.
    pub fn frame(&mut self, from: Point, to: Point, width: f32) {
        let corners = vec![from, (to.0, from.1), to, (from.0, to.1), from];
        self.line(corners, Pen::black(width));
    }
}

impl Style {
    /// Plain black text of a size.
    pub fn plain(size: f32) -> Style {
        Style {
            face: Face::Regular,
            size,
            anchor: Anchor::Start,
            grey: BLACK,
        }
    }

    /// Bold black text of a size.
    pub fn bold(size: f32) -> Style {
        Style {
            face: Face::Bold,
            ..Style::plain(size)
        }
    }

    /// The same in grey.
    pub fn grey(self, grey: u8) -> Style {
        Style { grey, ..self }
    }

    /// The same, about its middle.
    pub fn middle(self) -> Style {
        Style {
            anchor: Anchor::Middle,
            ..self
        }
    }

    /// The same, up to its end.
    pub fn end(self) -> Style {
        Style {
            anchor: Anchor::End,
            ..self
        }
    }

    /// Where a text begins that is anchored at `x`.
    fn start(self, x: f32, text: &str) -> f32 {
        let width = width(text, self.face, self.size);
        match self.anchor {
            Anchor::Start => x,
            Anchor::Middle => x - width / 2.0,
            Anchor::End => x - width,
        }
    }
}

impl Pen {
    /// A black pen.
    pub fn black(width: f32) -> Pen {
        Pen {
            width,
            grey: BLACK,
            dash: 0.0,
        }
    }

    /// The same in grey.
    pub fn grey(self, grey: u8) -> Pen {
        Pen { grey, ..self }
    }

    /// The same, dashed.
    pub fn dashed(self, dash: f32) -> Pen {
        Pen { dash, ..self }
    }
}
