//! Fonts of a sheet, and the width of text set in them.
//!
//! The fonts are Noto Sans of the Noto Project, under the SIL Open Font License 1.1 (see
//! `fonts/OFL.txt`), reduced to Latin, Greek and Cyrillic letters and common signs. A
//! missing character is drawn as U+FFFD, for an archived document may not leave it out.

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, GlyphId, MetadataProvider};

static REGULAR: &[u8] = include_bytes!("../fonts/NotoSans-Regular.ttf");
static BOLD: &[u8] = include_bytes!("../fonts/NotoSans-Bold.ttf");

/// A font.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Noto Sans.
    Regular,
    /// Noto Sans Bold.
    Bold,
}

/// Glyph of a character.
pub(super) struct Drawn {
    /// Glyph id in the font.
    pub(super) id: GlyphId,
    /// Distance to the next glyph, as a fraction of the font size.
    pub(super) advance: f32,
    /// Byte offset of the character in the text.
    pub(super) at: usize,
    /// Length of the character in bytes.
    pub(super) length: usize,
}

impl Face {
    pub(super) fn bytes(self) -> &'static [u8] {
        match self {
            Face::Regular => REGULAR,
            Face::Bold => BOLD,
        }
    }

    /// Returns the glyphs of a text, one for each character.
    pub(super) fn draw(self, text: &str) -> Vec<Drawn> {
        let font = FontRef::new(self.bytes()).expect("the fonts are part of the program");
        let characters = font.charmap();
        let metrics = font.glyph_metrics(Size::new(1.0), LocationRef::default());
        let drawn = text.char_indices().map(|(at, character)| {
            let known = characters.map(character);
            let missing = || characters.map(char::REPLACEMENT_CHARACTER);
            let id = known.or_else(missing).unwrap_or(GlyphId::NOTDEF);
            Drawn {
                id,
                advance: metrics.advance_width(id).unwrap_or(0.0),
                at,
                length: character.len_utf8(),
            }
        });
        drawn.collect()
    }
}

/// Returns the width of a text in points.
pub fn width(text: &str, face: Face, size: f32) -> f32 {
    let advances = face.draw(text).into_iter().map(|drawn| drawn.advance);
    size * advances.sum::<f32>()
}

/// Truncates a text to a width, with an ellipsis where something is cut off.
pub fn cut(text: &str, face: Face, size: f32, room: f32) -> String {
    if width(text, face, size) <= room {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().collect();
    while kept.pop().is_some() {
        let shorter = format!("{}…", kept.iter().collect::<String>().trim_end());
        if width(&shorter, face, size) <= room {
            return shorter;
        }
    }
    String::new()
}

/// Wraps a text into lines that fit a width; a single word that is too long is truncated.
pub fn wrap(text: &str, face: Face, size: f32, room: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let word = cut(word, face, size, room);
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), face, size) <= room => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_as_wide_as_its_characters_and_grows_with_the_size() {
        let one = width("0", Face::Regular, 10.0);
        assert!((width("00", Face::Regular, 10.0) - 2.0 * one).abs() < 1e-4);
        assert!((width("0", Face::Regular, 20.0) - 2.0 * one).abs() < 1e-4);
        // Digits are equally wide, so that columns of them line up.
        assert!((width("1", Face::Regular, 10.0) - one).abs() < 1e-6);
        assert!(width("0", Face::Bold, 10.0) > 0.9 * one);
    }

    #[test]
    fn the_fonts_have_the_characters_of_the_cards() {
        for face in [Face::Regular, Face::Bold] {
            let missing = face.draw("船")[0].id;
            assert_ne!(missing, GlyphId::NOTDEF);
            for drawn in face.draw("Ñandú Ωμέγα Адмирал 0°–359° ±½ λχ −…")
            {
                assert_ne!(drawn.id, GlyphId::NOTDEF);
                assert_ne!(drawn.id, missing);
            }
        }
    }

    #[test]
    fn a_text_that_does_not_fit_is_truncated_with_an_ellipsis() {
        assert_eq!(cut("Nao", Face::Regular, 10.0, 100.0), "Nao");
        let text = cut("Nao Victoria", Face::Regular, 10.0, 40.0);
        assert!(text.starts_with("Nao") && text.ends_with('…'), "{text}");
        assert!(width(&text, Face::Regular, 10.0) <= 40.0);
        assert_eq!(cut("Nao", Face::Regular, 10.0, 1.0), "");
    }

    #[test]
    fn no_line_of_a_wrapped_text_is_too_wide_and_no_word_is_lost() {
        let text = "Predicted by a model of the ship, and not a certificate of adjustment.";
        let lines = wrap(text, Face::Regular, 8.0, 90.0);
        assert!(lines.len() > 2, "{lines:?}");
        assert!(
            lines
                .iter()
                .all(|line| width(line, Face::Regular, 8.0) <= 90.0)
        );
        assert_eq!(lines.join(" "), text);
    }
}
