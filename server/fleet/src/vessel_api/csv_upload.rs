//! Upload of vessels as CSV, for a company that begins.
//!
//! Invariants: a file is stored whole or not at all, and every fault is reported with its line and
//! column, in the file's own words. A vessel that the fleet has already, by its name or IMO number,
//! is a fault.

use super::enter;
use crate::vessels::{self, NewVessel};
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, FromRef, State};
use axum::http::StatusCode;
use binnacle_platform::access::Writer;
use binnacle_platform::app::App;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::error::{Error, Problem, Result};
use binnacle_platform::http::{FileContent, Json};
use binnacle_platform::ids::VesselId;
use binnacle_schedule::calls::{CsvRows, FileError, FileErrors};
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// Maximum number of vessels of a file, and its length, bytes.
const MAX_VESSELS: usize = 2_000;
const MAX_BYTES: usize = 1 << 20;
const COLUMNS: [&str; 5] = ["name", "imo_number", "call_sign", "flag", "sister_class"];

pub(super) fn router<S>() -> OpenApiRouter<S>
where
    App: FromRef<S>,
    S: Clone + Send + Sync + 'static,
{
    OpenApiRouter::new()
        .routes(routes!(upload_vessels))
        .layer(DefaultBodyLimit::max(MAX_BYTES))
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
/// The file is stored whole or not at all. At most 2,000 vessels and 1 MiB.
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
    vessels::lock_entries(&mut tx, writer.operator).await?;
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
    let (mut rows, mut errors) = (Vec::new(), FileErrors::default());
    let mut file = CsvRows::open(bytes, &COLUMNS, &["name"])?;
    while let Some(row) = file.next_row()? {
        let row = match row {
            Ok(row) => row,
            Err(fault) => {
                errors.push(fault);
                continue;
            }
        };
        let line = row.line;
        if rows.len() == MAX_VESSELS {
            let what = format!("more than {MAX_VESSELS} vessels");
            return Err(FileError::new(line, "row", what));
        }
        let cell = |name: &str| row.cell(name).map(str::to_owned);
        let vessel = NewVessel {
            name: cell("name").unwrap_or_default(),
            imo_number: cell("imo_number"),
            call_sign: cell("call_sign"),
            flag: cell("flag"),
            degaussing: None,
            sister_class: cell("sister_class"),
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
