//! SVG output of sheets, one below the other.
//!
//! Invariant: text is as wide as on the printed sheet, whatever font the reader has,
//! because each line states its length.

use super::font::{Face, width};
use super::{Mark, Point, Sheet, Style};
use std::fmt::Write;

/// Writes sheets as one SVG document; `title` is its accessible name.
pub fn svg(sheets: &[Sheet], title: &str) -> String {
    let width = sheets.iter().map(|sheet| sheet.width).fold(0.0, f32::max);
    let height = sheets.iter().fold(0.0, |sum, sheet| sum + sheet.height);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}pt\" height=\"{1}pt\" \
         viewBox=\"0 0 {0} {1}\" font-family=\"'Noto Sans', Arial, Helvetica, sans-serif\">\n\
         <title>{2}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        width,
        height,
        escape(title)
    );
    let mut above = 0.0;
    for sheet in sheets {
        // Writing to a string cannot fail.
        let _ = writeln!(svg, "<g transform=\"translate(0 {above})\">");
        put_marks(&mut svg, sheet);
        svg.push_str("</g>\n");
        above += sheet.height;
    }
    svg.push_str("</svg>\n");
    svg
}

fn put_marks(svg: &mut String, sheet: &Sheet) {
    for mark in &sheet.marks {
        // Writing to a string cannot fail.
        let _ = match mark {
            Mark::Text { at, style, text } => writeln!(svg, "{}", line_of_text(*at, *style, text)),
            Mark::Line { points, pen } => {
                let dash = match pen.dash {
                    0.0 => String::new(),
                    dash => format!(" stroke-dasharray=\"{dash}\""),
                };
                let (points, grey, width) = (list(points), shade(pen.grey), pen.width);
                writeln!(
                    svg,
                    "<polyline points=\"{points}\" fill=\"none\" stroke=\"{grey}\" \
                     stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash}/>"
                )
            }
            Mark::Area { points, grey } => {
                let (points, grey) = (list(points), shade(*grey));
                writeln!(svg, "<polygon points=\"{points}\" fill=\"{grey}\"/>")
            }
        };
    }
}

fn line_of_text(at: Point, style: Style, text: &str) -> String {
    let weight = match style.face {
        Face::Regular => "",
        Face::Bold => " font-weight=\"bold\"",
    };
    let fill = match style.grey {
        super::BLACK => String::new(),
        grey => format!(" fill=\"{}\"", shade(grey)),
    };
    format!(
        "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"{}\" textLength=\"{:.2}\" \
         lengthAdjust=\"spacingAndGlyphs\" xml:space=\"preserve\"{weight}{fill}>{}</text>",
        style.start(at.0, text),
        at.1,
        style.size,
        width(text, style.face, style.size),
        escape(text)
    )
}

fn list(points: &[Point]) -> String {
    let points = points.iter().map(|(x, y)| format!("{x:.2},{y:.2}"));
    points.collect::<Vec<_>>().join(" ")
}

fn shade(grey: u8) -> String {
    format!("#{grey:02x}{grey:02x}{grey:02x}")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_shown_and_not_obeyed() {
        let mut sheet = Sheet::a4();
        let name = "<script>\"Nao\" & Co</script>";
        sheet.text((10.0, 10.0), Style::plain(8.0), name);
        let svg = svg(&[sheet], name);
        assert!(!svg.contains("<script"), "{svg}");
        let shown = "&lt;script&gt;&quot;Nao&quot; &amp; Co&lt;/script&gt;</t";
        assert_eq!(svg.matches(shown).count(), 2, "{svg}");
    }

    #[test]
    fn end_anchored_text_begins_its_width_before_its_point() {
        let mut sheet = Sheet::a4();
        sheet.text((100.0, 10.0), Style::plain(10.0).end(), "00");
        let long = width("00", Face::Regular, 10.0);
        let begins = format!("<text x=\"{:.2}\"", 100.0 - long);
        assert!(svg(&[sheet.clone()], "").contains(&begins));
    }
}
