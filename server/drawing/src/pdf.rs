//! PDF output of sheets, as PDF/A-2u (ISO 19005-2): whatever is needed to show and to search the
//! document decades later is in it.

use super::font::Face;
use super::{Mark, Pen, Point, Sheet};
use anyhow::{Result, anyhow};
use binnacle_compass::time::Timestamp;
use krilla::Document;
use krilla::SerializeSettings;
use krilla::color::luma;
use krilla::configure::{Archival, ConfigurationBuilder};
use krilla::geom::{PathBuilder, Point as PdfPoint};
use krilla::metadata::{DateTime, Metadata};
use krilla::num::NormalizedF32;
use krilla::page::PageSettings;
use krilla::paint::{Fill, FillRule, LineCap, LineJoin, Stroke, StrokeDash};
use krilla::surface::Surface;
use krilla::text::{Font, GlyphId, KrillaGlyph};
use std::array;

/// Metadata of a document.
#[derive(Clone, Debug)]
pub struct About {
    /// Document title.
    pub title: String,
    /// Time of the data that is drawn.
    pub created: Timestamp,
}

/// Fonts as one document embeds them.
struct Fonts([Font; 2]);

/// Writes sheets as a PDF document.
///
/// # Errors
/// Fails when the PDF writer rejects a sheet, which is a mistake in the code.
pub fn pdf(sheets: &[Sheet], about: &About) -> Result<Vec<u8>> {
    let fonts = Fonts::load()?;
    let archival = ConfigurationBuilder::new().with_archival_validator(Archival::A2_U);
    let mut document = Document::new_with(SerializeSettings {
        configuration: archival.finish().map_err(|error| anyhow!("{error:?}"))?,
        ..SerializeSettings::default()
    });
    for sheet in sheets {
        let page = PageSettings::from_wh(sheet.width, sheet.height)
            .ok_or_else(|| anyhow!("a sheet without size"))?;
        let mut page = document.start_page_with(page);
        let mut surface = page.surface();
        for mark in &sheet.marks {
            draw(&mut surface, mark, &fonts);
        }
        surface.finish();
        page.finish();
    }
    document.set_metadata(
        Metadata::new()
            .title(about.title.clone())
            .creator("Binnacle".to_owned())
            .language("en".to_owned())
            .creation_date(date(about.created)),
    );
    document.finish().map_err(|error| anyhow!("{error:?}"))
}

impl Fonts {
    fn load() -> Result<Fonts> {
        let load = |face: Face| {
            Font::new(face.bytes().into(), 0).ok_or_else(|| anyhow!("a font cannot be read"))
        };
        Ok(Fonts([load(Face::Regular)?, load(Face::Bold)?]))
    }

    fn font(&self, face: Face) -> Font {
        let Fonts([regular, bold]) = self;
        match face {
            Face::Regular => regular.clone(),
            Face::Bold => bold.clone(),
        }
    }
}

fn draw(surface: &mut Surface<'_>, mark: &Mark, fonts: &Fonts) {
    match mark {
        Mark::Text { at, style, text } => {
            surface.set_stroke(None);
            surface.set_fill(Some(fill(style.grey)));
            let glyphs: Vec<KrillaGlyph> = style
                .face
                .draw(text)
                .into_iter()
                .map(|drawn| {
                    let id = GlyphId::new(drawn.id.to_u32());
                    let place = drawn.at..drawn.at + drawn.length;
                    KrillaGlyph::new(id, drawn.advance, 0.0, 0.0, 0.0, place, None)
                })
                .collect();
            let start = PdfPoint::from_xy(style.start(at.0, text), at.1);
            let font = fonts.font(style.face);
            surface.draw_glyphs(start, &glyphs, font, text, style.size, false);
        }
        Mark::Line { points, pen } => {
            surface.set_fill(None);
            surface.set_stroke(Some(stroke(*pen)));
            path(surface, points, PathBuilder::finish);
        }
        Mark::Area { points, grey } => {
            surface.set_stroke(None);
            surface.set_fill(Some(fill(*grey)));
            path(surface, points, |mut path| {
                path.close();
                path.finish()
            });
        }
    }
}

fn path(
    surface: &mut Surface<'_>,
    points: &[Point],
    finish: impl Fn(PathBuilder) -> Option<krilla::geom::Path>,
) {
    let mut path = PathBuilder::new();
    for (index, (x, y)) in points.iter().enumerate() {
        match index {
            0 => path.move_to(*x, *y),
            _ => path.line_to(*x, *y),
        }
    }
    if let Some(path) = finish(path) {
        surface.draw_path(&path);
    }
}

fn fill(grey: u8) -> Fill {
    Fill {
        paint: luma::Color::new(grey).into(),
        opacity: NormalizedF32::ONE,
        rule: FillRule::default(),
    }
}

fn stroke(pen: Pen) -> Stroke {
    Stroke {
        paint: luma::Color::new(pen.grey).into(),
        width: pen.width,
        line_cap: LineCap::Butt,
        line_join: LineJoin::Round,
        dash: (pen.dash > 0.0).then(|| StrokeDash {
            array: vec![pen.dash, pen.dash],
            offset: 0.0,
        }),
        ..Stroke::default()
    }
}

/// Converts a timestamp, whose RFC 3339 text in UTC has year, month, day, hour, minute and
/// second.
fn date(time: Timestamp) -> DateTime {
    let text = time.to_string();
    let mut figures = text.split(|letter: char| !letter.is_ascii_digit());
    let [year, month, day, hour, minute, second] =
        array::from_fn(|_| figures.next().and_then(|f| f.parse().ok()).unwrap_or(0_u16));
    DateTime::new(year)
        .month(month as u8)
        .day(day as u8)
        .hour(hour as u8)
        .minute(minute as u8)
        .second(second as u8)
        .utc_offset_hour(0)
        .utc_offset_minute(0)
}

#[cfg(test)]
mod tests {
    use super::super::Style;
    use super::*;

    fn written(title: &str) -> Vec<u8> {
        let mut sheet = Sheet::a4();
        sheet.text(
            (100.0, 100.0),
            Style::bold(12.0).middle(),
            "Deviation 2.5° E",
        );
        sheet.rule((36.0, 110.0), (200.0, 110.0), 0.5);
        sheet.area(vec![(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)], 200);
        let about = About {
            title: title.to_owned(),
            created: Timestamp::parse("2026-11-21T07:00:00Z").unwrap(),
        };
        pdf(&[sheet.clone(), sheet], &about).unwrap()
    }

    #[test]
    fn the_same_sheets_become_the_same_bytes() {
        let document = written("Card");
        assert!(document.starts_with(b"%PDF-1."));
        assert_eq!(document, written("Card"));
        assert_ne!(document, written("Book"));
    }

    #[test]
    fn a_document_is_archival_whatever_a_name_is_written_with() {
        let mut sheet = Sheet::a4();
        let name = "船 \u{fffd}\u{fffe}\u{feff}\u{e000}\u{0}\u{7}\u{1f6a2} e\u{301}";
        sheet.text((100.0, 100.0), Style::plain(8.0), name);
        let about = About {
            title: name.to_owned(),
            created: Timestamp::parse("2026-11-21T07:00:00Z").unwrap(),
        };
        let document = pdf(&[sheet], &about).unwrap();
        let text = String::from_utf8_lossy(&document);
        assert!(text.contains("<pdfaid:part>2"), "{text}");
        assert!(text.contains("<pdfaid:conformance>U"), "{text}");
    }

    #[test]
    fn the_date_is_that_of_the_data() {
        let document = written("Card");
        let text = String::from_utf8_lossy(&document);
        assert!(text.contains("D:20261121070000"), "{text}");
        assert_eq!(text.matches("/Type/Page/").count(), 2, "{text}");
    }
}
