//! Vector sheets that are written as PDF and as SVG from the same data.
//!
//! Invariants:
//!
//! - Lengths are points, 1/72 inch, from the upper left corner, y downwards.
//! - Grey is the only colour, so that a printed sheet shows the same as the screen.
//! - The same sheet gives the same bytes: nothing here reads the time.

pub mod angles;
mod font;
pub mod paper;
mod pdf;
mod svg;

pub use font::{Face, cut, width, wrap};
pub use pdf::{About, pdf};
pub use svg::svg;

/// A point on a sheet.
pub type Point = (f32, f32);

/// Width and height of ISO 216 A4.
pub const A4: (f32, f32) = (595.28, 841.89);
/// Blank margin, for printers that cannot print to the edge.
pub const MARGIN: f32 = 36.0;

/// Black, among greys from 0 to 255.
pub const BLACK: u8 = 0;

/// Page with everything drawn on it, in drawing order.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    pub(crate) width: f32,
    pub(crate) height: f32,
    pub(crate) marks: Vec<Mark>,
}

/// Element of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Mark {
    /// Line of text whose start, middle or end of the baseline is at a point.
    Text {
        at: Point,
        style: Style,
        text: String,
    },
    /// Line through points.
    Line { points: Vec<Point>, pen: Pen },
    /// Filled polygon.
    Area { points: Vec<Point>, grey: u8 },
}

/// Text style.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Font face.
    pub face: Face,
    /// Font size.
    pub size: f32,
    /// Part of the text that is placed at the given point.
    pub anchor: Anchor,
    /// Grey level from 0, black, to 255.
    pub grey: u8,
}

/// Reference point in a line of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Start of the text.
    Start,
    /// Middle of the text.
    Middle,
    /// End of the text.
    End,
}

/// Line style.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Line width.
    pub width: f32,
    /// Grey level from 0, black, to 255.
    pub grey: u8,
    /// Length of dashes and of the gaps between them; 0 for a solid line.
    pub dash: f32,
}

impl Sheet {
    /// Returns a blank sheet in portrait format.
    pub fn a4() -> Sheet {
        Sheet {
            width: A4.0,
            height: A4.1,
            marks: Vec::new(),
        }
    }

    /// Returns a blank sheet in landscape format.
    pub fn a4_landscape() -> Sheet {
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

    /// Draws a straight black line of the given width.
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
    /// Returns plain black text of a size.
    pub fn plain(size: f32) -> Style {
        Style {
            face: Face::Regular,
            size,
            anchor: Anchor::Start,
            grey: BLACK,
        }
    }

    /// Returns bold black text of a size.
    pub fn bold(size: f32) -> Style {
        Style {
            face: Face::Bold,
            ..Style::plain(size)
        }
    }

    /// Sets the grey level.
    pub fn grey(self, grey: u8) -> Style {
        Style { grey, ..self }
    }

    /// Centres the text on its point.
    pub fn middle(self) -> Style {
        Style {
            anchor: Anchor::Middle,
            ..self
        }
    }

    /// Ends the text at its point.
    pub fn end(self) -> Style {
        Style {
            anchor: Anchor::End,
            ..self
        }
    }

    /// Returns the x coordinate of the start of a text that is anchored at `x`.
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
    /// Returns a black pen.
    pub fn black(width: f32) -> Pen {
        Pen {
            width,
            grey: BLACK,
            dash: 0.0,
        }
    }

    /// Sets the grey level.
    pub fn grey(self, grey: u8) -> Pen {
        Pen { grey, ..self }
    }

    /// Sets the dash length.
    pub fn dashed(self, dash: f32) -> Pen {
        Pen { dash, ..self }
    }
}
