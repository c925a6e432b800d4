//! CSV files in the form that a spreadsheet program expects.
//!
//! Invariants: without any of the parameters a file is as it was written, RFC 4180 with commas.
//! With them its fields are the same, but for the decimal sign of numbers.

use crate::error::Error;
use axum::body::{Body, BodyDataStream, Bytes};
use axum::extract::{Query, Request};
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use futures_util::{StreamExt, stream};
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

/// Byte order mark: by it Excel knows that a file is in UTF-8.
const BYTE_ORDER_MARK: &str = "\u{feff}";

/// Sign between the fields of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = CsvSeparator)]
pub enum Separator {
    /// A comma.
    #[default]
    Comma,
    /// A semicolon, where the comma is the decimal sign.
    Semicolon,
    /// A tab.
    Tab,
}

/// Decimal sign of numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = CsvDecimal)]
pub enum Decimal {
    /// A point.
    #[default]
    Point,
    /// A comma.
    Comma,
}

/// Form of a CSV file.
#[derive(Clone, Copy, Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct CsvForm {
    /// Sign between fields: a comma by default.
    #[serde(default)]
    #[param(inline)]
    pub separator: Separator,
    /// Decimal sign: a point by default. Excel in most of Europe expects `separator=semicolon`
    /// and `decimal=comma`.
    #[serde(default)]
    #[param(inline)]
    pub decimal: Decimal,
    /// True to begin with a byte order mark, by which Excel reads names in any language.
    #[serde(default)]
    pub bom: bool,
}

/// Converts a response in CSV to the form that the request asks for.
pub async fn convert(request: Request, next: Next) -> Response {
    let form = Query::<CsvForm>::try_from_uri(request.uri());
    let response = next.run(request).await;
    let kind = response.headers().get(CONTENT_TYPE);
    let is_csv = kind.is_some_and(|kind| kind.as_bytes().starts_with(b"text/csv"));
    if !is_csv || !response.status().is_success() {
        return response;
    }
    match form {
        Ok(Query(form)) => form.of(response),
        Err(rejection) => Error::from(rejection).into_response(),
    }
}

impl CsvForm {
    fn of(self, response: Response) -> Response {
        if !self.changes_fields() && !self.bom {
            return response;
        }
        let (mut parts, body) = response.into_parts();
        parts.headers.remove(CONTENT_LENGTH);
        let mark = if self.bom { BYTE_ORDER_MARK } else { "" };
        let converter = Converter {
            form: self,
            source: body.into_data_stream(),
            pending: Vec::new(),
            done: false,
        };
        let mark = stream::iter([Ok::<_, anyhow::Error>(Bytes::from(mark))]);
        let lines = stream::try_unfold(converter, Converter::next);
        Response::from_parts(parts, Body::from_stream(mark.chain(lines)))
    }

    fn changes_fields(self) -> bool {
        (self.separator, self.decimal) != Default::default()
    }

    fn rewritten(self, lines: &[u8]) -> anyhow::Result<Bytes> {
        if !self.changes_fields() {
            return Ok(Bytes::copy_from_slice(lines));
        }
        let records = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .from_reader(lines)
            .into_records();
        let separator = match self.separator {
            Separator::Comma => b',',
            Separator::Semicolon => b';',
            Separator::Tab => b'\t',
        };
        let mut writer = csv::WriterBuilder::new()
            .delimiter(separator)
            .flexible(true)
            .from_writer(Vec::new());
        for record in records {
            writer.write_record(record?.iter().map(|field| self.number_in(field)))?;
        }
        Ok(writer.into_inner()?.into())
    }

    /// Returns a field, a number with the decimal sign of the form.
    fn number_in(self, field: &str) -> String {
        if self.decimal == Decimal::Comma && field.contains('.') && field.parse::<f64>().is_ok() {
            return field.replace('.', ",");
        }
        field.to_owned()
    }
}

/// File being converted, line by line as it is read.
struct Converter {
    form: CsvForm,
    source: BodyDataStream,
    /// Bytes after the last whole line.
    pending: Vec<u8>,
    done: bool,
}

impl Converter {
    /// Returns the next whole lines; `None` at the end.
    async fn next(mut self) -> anyhow::Result<Option<(Bytes, Converter)>> {
        if self.done {
            return Ok(None);
        }
        let end = if let Some(bytes) = self.source.next().await {
            self.pending.extend_from_slice(&bytes?);
            end_of_lines(&self.pending)
        } else {
            self.done = true;
            self.pending.len()
        };
        let rest = self.pending.split_off(end);
        let lines = std::mem::replace(&mut self.pending, rest);
        let lines = self.form.rewritten(&lines)?;
        Ok(Some((lines, self)))
    }
}

/// Returns the end of the last whole line. A line end between quotes belongs to a field.
fn end_of_lines(bytes: &[u8]) -> usize {
    let mut is_quoted = false;
    let mut end = 0;
    for (at, byte) in bytes.iter().enumerate() {
        match byte {
            b'"' => is_quoted = !is_quoted,
            b'\n' if !is_quoted => end = at + 1,
            _ => {}
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_stay_the_same_but_for_the_decimal_sign() {
        let form = CsvForm {
            separator: Separator::Semicolon,
            decimal: Decimal::Comma,
            bom: false,
        };
        let written = "name,deviation_deg,note\n\"Bilbao, A5\",-1.5,\"a;b\"\nv1.2,2,\n";
        let expected = "name;deviation_deg;note\nBilbao, A5;-1,5;\"a;b\"\nv1.2;2;\n";
        let rewritten = form.rewritten(written.as_bytes()).unwrap();
        assert_eq!(std::str::from_utf8(&rewritten).unwrap(), expected);
    }

    #[test]
    fn a_line_that_comes_in_parts_is_converted_whole() {
        assert_eq!(end_of_lines(b"a,b\n1,"), 4);
        assert_eq!(end_of_lines(b"a,\"x\ny\"\n"), 8);
        assert_eq!(end_of_lines(b"a,\"x\n"), 0);
    }
}
