//! Text of a configuration: the field at a position, and the position of a field.

use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Fields of a text and their positions, as far as the text can be read.
pub(super) struct Document<'a> {
    text: &'a str,
    root: DeTable<'a>,
    /// Set if it is no TOML: its fields are not all known then.
    is_broken: bool,
}

impl<'a> Document<'a> {
    /// Reads a text.
    pub(super) fn read(text: &'a str) -> Document<'a> {
        let (root, errors) = DeTable::parse_recoverable(text);
        Document {
            text,
            root: root.into_inner(),
            is_broken: !errors.is_empty(),
        }
    }

    /// Returns the line of a position, counted from 1.
    pub(super) fn line_at(&self, at: usize) -> usize {
        let before = self.text.get(..at).unwrap_or(self.text);
        before.matches('\n').count() + 1
    }

    /// Returns the key of the innermost field at a position; in a broken text, the first key of
    /// its line.
    pub(super) fn field_at(&self, at: usize) -> Option<&str> {
        if self.is_broken {
            return self.key_of_line(at);
        }
        field_in(&self.root, at)
    }

    fn key_of_line(&self, at: usize) -> Option<&str> {
        let line = self.text.lines().nth(self.line_at(at) - 1)?;
        let is_key = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        let key = line.split(|c| !is_key(c)).find(|key| !key.is_empty())?;
        key.rsplit('.').next()
    }

    /// Returns the bytes of the value of a field, given by its keys from the outermost one. A list
    /// has numbers for keys; a single value counts as its own first element.
    pub(super) fn span_of(&self, keys: &[String]) -> Option<Range<usize>> {
        let (first, rest) = keys.split_first()?;
        let mut value = self.root.get(first.as_str())?;
        for key in rest {
            value = match value.get_ref() {
                DeValue::Table(table) if key == "0" => table.get("0").unwrap_or(value),
                DeValue::Table(table) => table.get(key.as_str())?,
                DeValue::Array(list) => list.get(key.parse::<usize>().ok()?)?,
                _ if key == "0" => value,
                _ => return None,
            };
        }
        Some(value.span())
    }
}

fn field_in<'t>(table: &'t DeTable<'_>, at: usize) -> Option<&'t str> {
    table.iter().find_map(|(key, value)| {
        let is_here = |span: Range<usize>| (span.start..=span.end).contains(&at);
        let inner = field_of(value, at);
        let is_named = is_here(key.span()) || is_here(value.span());
        inner.or(is_named.then_some(key.get_ref()))
    })
}

/// Returns the key of the innermost field inside a value. The table of a header lies behind it,
/// outside its span.
fn field_of<'t>(value: &'t Spanned<DeValue<'_>>, at: usize) -> Option<&'t str> {
    match value.get_ref() {
        DeValue::Table(table) => field_in(table, at),
        DeValue::Array(list) => list.iter().find_map(|value| field_of(value, at)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "data_dir = \"d\"\n[roles]\ngyro = [\n    { talker = \"HE\" },\n    \
                        { talker = \"GP\", raw = true },\n]\n[output]\nudp = \"10.0.0.1:1\"\n";

    fn at(text: &str) -> usize {
        TEXT.find(text).unwrap()
    }

    #[test]
    fn a_position_belongs_to_its_innermost_field() {
        let document = Document::read(TEXT);
        for (text, field, line) in [
            ("\"d\"", Some("data_dir"), 1),
            ("roles", Some("roles"), 2),
            ("gyro", Some("gyro"), 3),
            ("{ talker = \"GP\"", Some("gyro"), 5),
            ("\"GP\"", Some("talker"), 5),
            ("true", Some("raw"), 5),
            ("\"10.0.0.1:1\"", Some("udp"), 8),
        ] {
            assert_eq!(document.field_at(at(text)), field, "{text}");
            assert_eq!(document.line_at(at(text)), line, "{text}");
        }
    }

    #[test]
    fn a_field_is_found_by_its_keys() {
        let document = Document::read(TEXT);
        let found = |keys: &[&str]| {
            let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
            document.span_of(&keys).map(|span| &TEXT[span])
        };
        assert_eq!(found(&["roles", "gyro", "1", "talker"]), Some("\"GP\""));
        assert_eq!(found(&["output", "udp", "0"]), Some("\"10.0.0.1:1\""));
        assert_eq!(found(&["output", "tcp_server", "0"]), None);
        assert_eq!(found(&["roles", "gyro", "7"]), None);
    }

    #[test]
    fn a_text_that_is_broken_off_still_has_its_fields() {
        let broken = "data_dir = \"d\"\nspool_mb = \n[inputs.bridge\nudp = ";
        let document = Document::read(broken);
        assert_eq!(document.field_at(0), Some("data_dir"));
        assert_eq!(document.field_at(26), Some("spool_mb"));
        assert_eq!(document.field_at(30), Some("bridge"));
    }
}
