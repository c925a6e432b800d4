//! Logbook files: a list of entries, or a page of them as the API returns it.
//!
//! Invariants: an error names the file, the line and the field. An unknown field is an error,
//! because it may be a misspelt one. Withdrawn entries are ignored.

use super::BadInput;
use super::input::{json_error, text_file};
use binnacle_compass::logbook::LogbookEntry;
use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::value::RawValue;
use std::fmt::Display;
use std::path::Path;

/// Response of `GET /vessels/{id}/logbook`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a list of logbook entries")]
struct Page<'a> {
    #[serde(borrow)]
    items: Vec<&'a RawValue>,
    next: Option<String>,
}

/// Entry whose fields are still raw JSON, so that an error can name the field.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a logbook entry")]
struct Written<'a> {
    #[serde(borrow)]
    kind: Option<&'a RawValue>,
    #[serde(borrow)]
    from: Option<&'a RawValue>,
    #[serde(borrow)]
    to: Option<&'a RawValue>,
    #[serde(borrow)]
    cargo: Option<&'a RawValue>,
    #[serde(borrow)]
    note: Option<&'a RawValue>,
    withdrawn_at: Option<IgnoredAny>,
    // Fields of an entry in the API that no analysis needs.
    #[serde(rename = "id")]
    _id: Option<IgnoredAny>,
    #[serde(rename = "compass_id")]
    _compass_id: Option<IgnoredAny>,
    #[serde(rename = "hatch")]
    _hatch: Option<IgnoredAny>,
    #[serde(rename = "port")]
    _port: Option<IgnoredAny>,
    #[serde(rename = "author")]
    _author: Option<IgnoredAny>,
    #[serde(rename = "created_at")]
    _created_at: Option<IgnoredAny>,
    #[serde(rename = "created_by")]
    _created_by: Option<IgnoredAny>,
    #[serde(rename = "revision")]
    _revision: Option<IgnoredAny>,
    #[serde(rename = "revised_at")]
    _revised_at: Option<IgnoredAny>,
    #[serde(rename = "revised_by")]
    _revised_by: Option<IgnoredAny>,
    #[serde(rename = "withdrawn_by")]
    _withdrawn_by: Option<IgnoredAny>,
    #[serde(rename = "withdrawal_reason")]
    _withdrawal_reason: Option<IgnoredAny>,
}

/// File and its text.
struct Book<'a> {
    path: &'a Path,
    text: &'a str,
}

/// Returns the entries of a file, without the withdrawn ones.
pub(super) fn read(path: &Path) -> Result<Vec<LogbookEntry>, BadInput> {
    let text = text_file(path)?;
    let book = Book { path, text: &text };
    let mut entries = Vec::new();
    for item in book.items()? {
        entries.extend(book.entry(item)?);
    }
    Ok(entries)
}

impl Book<'_> {
    fn items(&self) -> Result<Vec<&RawValue>, BadInput> {
        let failed = |error: serde_json::Error| json_error(self.path, 0, "", &error);
        if !self.text.trim_start().starts_with('{') {
            return serde_json::from_str(self.text).map_err(failed);
        }
        let page: Page<'_> = serde_json::from_str(self.text).map_err(failed)?;
        if page.next.is_some() {
            let what = "next: there are more pages; give the items of all of them as one list";
            return Err(BadInput(format!("{}:1: {what}", self.path.display())));
        }
        Ok(page.items)
    }

    fn entry(&self, item: &RawValue) -> Result<Option<LogbookEntry>, BadInput> {
        let written: Written<'_> = serde_json::from_str(item.get())
            .map_err(|error| json_error(self.path, self.lines_before(item), "", &error))?;
        let required = |name, value: Option<_>| {
            value.ok_or_else(|| self.error_at(item, format!("{name}: is missing")))
        };
        let entry = LogbookEntry {
            kind: self.field("kind", required("kind", written.kind)?)?,
            from: self.field("from", required("from", written.from)?)?,
            to: self.optional("to", written.to)?,
            cargo: self.optional("cargo", written.cargo)?,
            note: self.optional("note", written.note)?.unwrap_or_default(),
        };
        let entry = entry
            .checked()
            .map_err(|error| self.error_at(item, error))?;
        Ok(written.withdrawn_at.is_none().then_some(entry))
    }

    fn optional<T: DeserializeOwned>(
        &self,
        name: &str,
        value: Option<&RawValue>,
    ) -> Result<Option<T>, BadInput> {
        value.map(|value| self.field(name, value)).transpose()
    }

    fn field<T: DeserializeOwned>(&self, name: &str, value: &RawValue) -> Result<T, BadInput> {
        serde_json::from_str(value.get()).map_err(|error| {
            let field = format!("{name}: ");
            json_error(self.path, self.lines_before(value), &field, &error)
        })
    }

    fn error_at(&self, item: &RawValue, what: impl Display) -> BadInput {
        let line = self.lines_before(item) + 1;
        BadInput(format!("{}:{line}: {what}", self.path.display()))
    }

    /// The value is a slice of the text.
    fn lines_before(&self, value: &RawValue) -> usize {
        let begin = value.get().as_ptr() as usize - self.text.as_ptr() as usize;
        self.text[..begin].matches('\n').count()
    }
}
