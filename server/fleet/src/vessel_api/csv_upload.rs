//! Upload of vessels as CSV, for a company that begins.
//!
//! Invariants: a file is stored whole or not at all, and every fault is reported with its line and
//! column, in the file's own words. A vessel that the fleet has already, by its name or IMO number,
//! is a fault.

use super::enter;
use crate::vessels::{self, NewVessel};
use axum::body::Bytes;
use axum::extract::{FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::Writer;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{FileContent, Json};
use binnacle_platform::ids::VesselId;
use binnacle_schedule::calls::{FileError, FileErrors};
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Maximum number of vessels of a file.
const MAX_VESSELS: usize = 2_000;
const COLUMNS: [&str; 5] = ["name", "imo_number", "call_sign", "flag", "sister_class"];

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new().routes(routes!(upload_vessels))
}

/// Result of an upload of vessels.
#[derive(Serialize, ToSchema)]
#[schema(as = VesselUpload, example = json!({ "created": 12 }))]
struct Uploaded {
    /// Number of new vessels.
    created: usize,
}

/// Enter vessels by a CSV file
///
/// The first line names the columns: `name`, and optionally `imo_number`, `call_sign`, `flag` and
/// `sister_class`, separated by commas or semicolons. Each vessel comes with its standard compass.
/// The file is stored whole or not at all. At most 2,000 vessels.
#[utoipa::path(post, path = "/vessels.csv", tag = "fleet",
    request_body(content = inline(FileContent), content_type = "text/csv",
        example = "name,imo_number,call_sign,flag\nNao Victoria,9074729,EAVN,ES\n"),
    responses((status = 201, body = Uploaded), (status = 401, body = Problem),
              (status = 403, body = Problem), (status = 413, body = Problem),
              (status = 422, description = "The file has errors; the detail names the first fifty \
                             with line and column", body = Problem)))]
async fn upload_vessels(
    State(app): State<App>,
    request: RequestContext,
    writer: Writer,
    body: Bytes,
) -> Result<(StatusCode, Json<Uploaded>)> {
    let (rows, mut errors) = match read(&body) {
        Ok(read) => read,
        Err(error) => (Vec::new(), FileErrors::from(error)),
    };
    let fleet = vessels::names(&app.db, writer.operator).await?;
    let mut known: BTreeMap<String, String> = BTreeMap::new();
    for vessel in fleet {
        known.insert(key(&vessel.name), "in the fleet already".to_owned());
        let number = vessel.imo_number;
        known.extend(number.map(|number| (number, format!("the IMO number of {}", vessel.name))));
    }
    for (line, vessel) in &rows {
        let named = ("name", key(&vessel.name), &vessel.name);
        let number = vessel.imo_number.as_ref();
        let numbered = number.map(|number| ("imo_number", number.clone(), number));
        for (field, key, text) in [named].into_iter().chain(numbered) {
            match known.get(&key) {
                Some(why) => errors.push(FileError::new(*line, field, format!("{text} is {why}"))),
                None => {
                    known.insert(key, format!("already on line {line}"));
                }
            }
        }
    }
    errors.into_result(()).map_err(|errors| Error::Invalid {
        field: "file",
        detail: errors.to_string(),
    })?;
    let now = app.clock.now().into();
    let mut tx = request.begin().await?;
    for (_, vessel) in &rows {
        enter(&mut tx, writer.operator, VesselId::new(), vessel, now).await?;
    }
    tx.commit().await?;
    let created = rows.len();
    Ok((StatusCode::CREATED, Json(Uploaded { created })))
}

/// Returns the key by which vessels' names are compared.
fn key(name: &str) -> String {
    name.to_lowercase()
}

/// Reads a file's vessels with their lines, and the faults of the others.
///
/// # Errors
/// [`FileError`] where reading cannot go on.
fn read(bytes: &[u8]) -> std::result::Result<(Vec<(usize, NewVessel)>, FileErrors), FileError> {
    let text = std::str::from_utf8(bytes)
        .map_err(|_| FileError::new(1, "row", "the file is not UTF-8 text"))?;
    let text = text.trim_start_matches('\u{feff}');
    let first = text.lines().next().unwrap_or_default();
    let separator = if first.contains(';') { b';' } else { b',' };
    let mut file = csv::ReaderBuilder::new()
        .delimiter(separator)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let unreadable = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line) as usize;
        FileError::new(line, "row", error.to_string())
    };
    let header = file.headers().map_err(unreadable)?.clone();
    for name in &header {
        if !COLUMNS.contains(&name) {
            let what = format!("is not a column; known columns are {}", COLUMNS.join(", "));
            return Err(FileError::new(1, name, what));
        }
    }
    if !header.iter().any(|name| name == "name") {
        return Err(FileError::new(1, "name", "the column is missing"));
    }
    let (mut rows, mut errors) = (Vec::new(), FileErrors::default());
    for record in file.records() {
        let record = record.map_err(unreadable)?;
        let line = record.position().map_or(1, csv::Position::line) as usize;
        if rows.len() == MAX_VESSELS {
            let what = format!("more than {MAX_VESSELS} vessels");
            return Err(FileError::new(line, "row", what));
        }
        let cell = |name: &str| {
            let at = header.iter().position(|column| column == name)?;
            record.get(at).filter(|text| !text.is_empty())
        };
        let vessel = NewVessel {
            name: cell("name").unwrap_or_default().to_owned(),
            imo_number: cell("imo_number").map(str::to_owned),
            call_sign: cell("call_sign").map(str::to_owned),
            flag: cell("flag").map(str::to_owned),
            degaussing: None,
            sister_class: cell("sister_class").map(str::to_owned),
        };
        match vessel.checked() {
            Ok(vessel) => rows.push((line, vessel)),
            Err(Error::Invalid { field, detail }) => {
                errors.push(FileError::new(line, field, detail));
            }
            Err(other) => errors.push(FileError::new(line, "row", other.to_string())),
        }
    }
    if rows.is_empty() && errors.is_empty() {
        return Err(FileError::new(1, "row", "the file names no vessel"));
    }
    Ok((rows, errors))
}
