//! Compass deviation book: compass errors observed under way, beside the card of that time.
//!
//! Invariants:
//!
//! - Every entry is an observation: one in each watch, one after each large alteration of course,
//!   and every azimuth that is not withdrawn.
//! - A card counts only for observations after it was made.

mod cards;
mod csv;
mod entry;
mod layout;
mod reader;
mod select;

use axum::body::{Body, Bytes};
use axum::extract::{FromRef, State};
use axum::response::Response;
use binnacle_compass::time::Timestamp;
use binnacle_drawing::{self, About};
use binnacle_fleet::compasses;
use binnacle_fleet::vessels;
use binnacle_platform::access::Reader;
use binnacle_platform::app::App;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{FileContent, FileName, Id, Json, Page, Params, file, time};
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use entry::{Entry, EntryKey};
use futures_util::{StreamExt, stream};
use layout::Book;
use reader::BookReader;
use serde::{Deserialize, Serialize};
use tracing::error;
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

/// Entries of a printed book: some 150 sheets.
const MOST_PRINTED: usize = 5_000;

/// Returns the routes.
pub fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(list_book))
        .routes(routes!(book_csv))
        .routes(routes!(book_pdf))
}

/// Compass and period of a book.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
struct Range {
    /// The first instant, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime, example = "2026-11-01T00:00:00Z")]
    from: Option<String>,
    /// The instant after the last, RFC 3339.
    #[param(value_type = Option<String>, format = DateTime, example = "2026-12-01T00:00:00Z")]
    to: Option<String>,
    /// A compass of the vessel; its first one by default.
    compass: Option<CompassId>,
}

/// A page of a deviation book.
#[derive(Serialize, ToSchema)]
#[schema(as = DeviationBook)]
struct BookPage {
    /// In order of time.
    items: Vec<Entry>,
    /// `after` of the next page.
    #[schema(required)]
    next: Option<String>,
}

/// Read a compass's deviation book
///
/// An entry for the first settled stretch of heading in each watch of four hours, and
/// for the first after each alteration of course by 20° or more. Watches in which none
/// was observed, as in port, have none. Each azimuth that an officer observed is an entry
/// with the officer's initials. `card_status` says what the card of the time was
/// worth then: `predicted`, or `verified` from when headings at sea had verified the
/// adjustment that it comes from.
#[utoipa::path(get, path = "/vessels/{id}/deviation-book", tag = "fleet",
    params(("id" = VesselId, Path), Range, Page),
    responses((status = 200, body = BookPage), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn list_book(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(range): Params<Range>,
    page: Page,
) -> Result<Json<BookPage>> {
    let (mut selection, _) = range.find(&app, reader, id).await?;
    let after = page.after_time()?;
    let after = after.map(|(micros, azimuth)| entry_key(micros, azimuth));
    let after = after.transpose()?;
    selection.from = selection.from.max(after.map(|after| after.time));
    let mut source = selection.open(&app, id).await?;
    let (found, _) = source.at_most(after, page.limit() + 1).await?;
    let listed = page.cut(found, |entry| {
        let key = entry.key();
        format!("{}.{}", key.time.0.micros(), key.azimuth)
    });
    Ok(Json(BookPage {
        items: listed.items,
        next: listed.next,
    }))
}

/// A compass's deviation book as CSV
#[utoipa::path(get, path = "/vessels/{id}/deviation-book.csv", tag = "fleet",
    params(("id" = VesselId, Path), Range),
    responses((status = 200, content_type = "text/csv", body = inline(FileContent)), (status = 401, body = Problem),
              (status = 404, body = Problem), (status = 422, body = Problem)))]
async fn book_csv(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(range): Params<Range>,
) -> Result<Response> {
    let (selection, book) = range.find(&app, reader, id).await?;
    let source = selection.open(&app, id).await?;
    let head = stream::iter([Ok(Bytes::from(csv::head()))]);
    let rest = stream::try_unfold(source, next_lines);
    let body = Body::from_stream(head.chain(rest));
    Ok(file("text/csv; charset=utf-8", &book.name("csv"), body))
}

/// Print a compass's deviation book
///
/// Sheets of A4 in landscape; at most 5000 entries.
#[utoipa::path(get, path = "/vessels/{id}/deviation-book.pdf", tag = "fleet",
    params(("id" = VesselId, Path), Range),
    responses((status = 200, content_type = "application/pdf", body = inline(FileContent)),
              (status = 401, body = Problem), (status = 404, body = Problem),
              (status = 422, description = "Also when there are more entries than are printed", body = Problem)))]
async fn book_pdf(
    State(app): State<App>,
    reader: Reader,
    Id(id): Id<VesselId>,
    Params(range): Params<Range>,
) -> Result<Response> {
    let (selection, book) = range.find(&app, reader, id).await?;
    let (entries, all) = selection
        .open(&app, id)
        .await?
        .at_most(None, MOST_PRINTED)
        .await?;
    if !all {
        return Err(Error::Invalid {
            field: "from, to",
            detail: format!("more than {MOST_PRINTED} entries lie between them"),
        });
    }
    let about = About {
        title: format!("Compass deviation book: {}, {}", book.vessel, book.compass),
        created: entries.last().map_or(selection.entered, |last| last.time).0,
    };
    let name = book.name("pdf");
    let drawn = move || binnacle_drawing::pdf(&layout::sheets(&book, &entries), &about);
    let bytes = tokio::task::spawn_blocking(drawn).await??;
    Ok(file("application/pdf", &name, bytes))
}

/// Selection of entries, parsed and checked.
struct Selection {
    compass: CompassId,
    from: Option<Time>,
    to: Option<Time>,
    /// Time at which the vessel was entered.
    entered: Time,
}

impl Range {
    async fn find(&self, app: &App, reader: Reader, id: VesselId) -> Result<(Selection, Book)> {
        let vessel = vessels::must_be_in_fleet(&app.db, reader.operator, id).await?;
        let compass = compasses::find(&app.db, id, self.compass).await?;
        let from = time("from", self.from.as_deref())?.map(Time);
        let to = time("to", self.to.as_deref())?.map(Time);
        if from.zip(to).is_some_and(|(from, to)| to < from) {
            return Err(Error::Invalid {
                field: "to",
                detail: "is earlier than from".to_owned(),
            });
        }
        let selection = Selection {
            compass: compass.id,
            from,
            to,
            entered: vessel.created_at,
        };
        let book = Book {
            vessel: vessel.name,
            imo_number: vessel.imo_number,
            compass: compass.name,
            from,
            to,
        };
        Ok((selection, book))
    }
}

impl Selection {
    async fn open(&self, app: &App, vessel: VesselId) -> Result<BookReader> {
        BookReader::open(&app.db, vessel, self.compass, self.from, self.to).await
    }
}

/// Returns the key that a cursor names.
fn entry_key(micros: i64, azimuth: Uuid) -> Result<EntryKey> {
    let time = Timestamp::from_micros(micros)
        .map_err(|_| Error::BadRequest(format!("after: {micros} is not the time of an entry")))?;
    Ok(EntryKey {
        time: Time(time),
        azimuth,
    })
}

impl Book {
    fn name(&self, ending: &'static str) -> FileName {
        FileName::new(&["deviation-book", &self.vessel, &self.compass], ending)
    }
}

/// Returns the next month's lines. A failure ends the file, and is logged.
async fn next_lines(mut source: BookReader) -> Result<Option<(Bytes, BookReader)>> {
    let lines = async {
        let entries = source.next().await?;
        entries.map(|entries| csv::lines(&entries)).transpose()
    };
    match lines.await {
        Ok(None) => Ok(None),
        Ok(Some(lines)) => Ok(Some((Bytes::from(lines), source))),
        Err(cause) => {
            error!(error = format!("{cause:?}"), "a deviation book was cut off");
            Err(cause)
        }
    }
}
